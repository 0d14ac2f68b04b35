#include "sim_host/plant/changed_copy.h"

#include <stdlib.h>

#include "model/trig.h"

static const double DEG = 0.017453292519943295;
static const double TWO_PI = 6.283185307179586;
static const double UPRIGHT_PLANTAR_DEG = -5.0;
static const double MADE_S = 20.0, MADE_HZ = 200.0;
static const double HELD_S = 3.0; /* a stopped person stands so long */

#define COPY_INFO(NAME, name, walks) {name, walks},
const struct copy_kind_info copy_kinds[COPY_KINDS] = {COPY_TABLE(COPY_INFO)};

struct making {
    struct recording *copy;
    const struct recording *source;
    const struct recording_format *format;
    struct copy_truth *truth;
};

static enum recording_error make_room(struct recording *copy, size_t count, bool has_contact)
{
    *copy = (struct recording){.count = count, .has_contact = has_contact};
    copy->samples = (struct recording_sample *)calloc(count, sizeof *copy->samples);
    if (copy->samples == NULL) {
        *copy = (struct recording){0};
        return RECORDING_NO_MEMORY;
    }
    return RECORDING_OK;
}

enum recording_error changed_copy_window(struct recording *window, const struct recording *source,
                                         double from_s, double seconds)
{
    size_t first = 0, last;
    while (first + 2 < source->count && source->samples[first].time_s < from_s) {
        first++;
    }
    for (last = first + 1; last + 1 < source->count &&
                           source->samples[last].time_s < source->samples[first].time_s + seconds;
         last++) {
    }
    if (make_room(window, last - first + 1, source->has_contact) != RECORDING_OK) {
        return RECORDING_NO_MEMORY;
    }
    for (size_t i = 0; i < window->count; i++) {
        window->samples[i] = source->samples[first + i];
        window->samples[i].time_s -= source->samples[first].time_s;
    }
    return RECORDING_OK;
}

/* ---- changes of one sample ------------------------------------------------------ */

static void set_ankle(const struct making *making, struct recording_sample *sample, int side,
                      double plantarflexion_rad)
{
    sample->plantarflexion_rad[side] = plantarflexion_rad;
    sample->ankle_m[side] = recording_ankle_m(&making->format->ankle[side], plantarflexion_rad);
}

static void scale_leg(const struct making *making, struct recording_sample *sample, int side,
                      double size)
{
    const double upright_rad = UPRIGHT_PLANTAR_DEG * DEG;
    sample->leg_angle_rad[side] *= size;
    set_ankle(making, sample, side,
              upright_rad + size * (sample->plantarflexion_rad[side] - upright_rad));
}

static double step_time_s(const struct recording *source, size_t i)
{
    return i == 0 ? 0.0 : source->samples[i].time_s - source->samples[i - 1].time_s;
}

static void scale_all(const struct making *making, double size, double slower)
{
    for (size_t i = 0; i < making->copy->count; i++) {
        struct recording_sample *sample = &making->copy->samples[i];
        scale_leg(making, sample, SIDE_LEFT, size);
        scale_leg(making, sample, SIDE_RIGHT, size);
        sample->time_s *= slower;
    }
}

static void limp(const struct making *making, double share)
{
    const struct recording *source = making->source;
    double down = 0.0, time_s = 0.0;
    for (size_t i = 0; i < source->count; i++) {
        down += source->samples[i].contact[SIDE_LEFT] ? 1.0 : 0.0;
    }
    down /= (double)source->count;
    const double quick = 1.0 - 0.5 * share;
    const double rest = down < 1.0 ? (1.0 - quick * down) / (1.0 - down) : 1.0;
    for (size_t i = 0; i < source->count; i++) {
        struct recording_sample *sample = &making->copy->samples[i];
        time_s += step_time_s(source, i) * (sample->contact[SIDE_LEFT] ? quick : rest);
        sample->time_s = time_s;
        scale_leg(making, sample, SIDE_LEFT, 1.0 - share);
    }
}

static void turn_back(const struct making *making)
{
    const struct recording *source = making->source;
    const size_t last = source->count - 1;
    for (size_t i = 0; i <= last; i++) {
        making->copy->samples[i] = source->samples[last - i];
        making->copy->samples[i].time_s =
            source->samples[last].time_s - source->samples[last - i].time_s;
    }
}

static void hang(const struct making *making)
{
    for (size_t i = 0; i < making->copy->count; i++) {
        for (int side = 0; side < SIDE_COUNT; side++) {
            making->copy->samples[i].contact[side] = false;
            set_ankle(making, &making->copy->samples[i], side, 0.0);
        }
    }
}

static void hold_leg(const struct making *making)
{
    const size_t start = 2 * making->copy->count / 3;
    const struct recording_sample held = making->copy->samples[start];
    for (size_t i = start; i < making->copy->count; i++) {
        struct recording_sample *sample = &making->copy->samples[i];
        sample->leg_angle_rad[SIDE_LEFT] = held.leg_angle_rad[SIDE_LEFT];
        set_ankle(making, sample, SIDE_LEFT, held.plantarflexion_rad[SIDE_LEFT]);
        sample->contact[SIDE_LEFT] = false;
    }
    making->truth->stands_s = held.time_s;
}

static void trip(const struct making *making)
{
    static const double EVERY_S = 7.0, STAYS_S = 0.15, INTO_SWING_S = 0.12;
    struct recording_sample held = {0};
    bool holding = false;
    double since_s = -1.0, swing_s = 0.0;
    for (size_t i = 0; i < making->copy->count; i++) {
        struct recording_sample *sample = &making->copy->samples[i];
        const double now_s = sample->time_s;
        swing_s = sample->contact[SIDE_LEFT] ? 0.0 : swing_s + step_time_s(making->source, i);
        if (!holding && swing_s > INTO_SWING_S && now_s - since_s > EVERY_S) {
            held = *sample;
            holding = true;
            since_s = now_s;
        }
        if (holding) {
            const double back = 1.0 - (now_s - since_s - STAYS_S) / STAYS_S;
            const double away = now_s - since_s < STAYS_S ? 1.0 : back > 0.0 ? back : 0.0;
            const double angle_rad = sample->leg_angle_rad[SIDE_LEFT];
            const double plantar_rad = sample->plantarflexion_rad[SIDE_LEFT];
            sample->leg_angle_rad[SIDE_LEFT] += away * (held.leg_angle_rad[SIDE_LEFT] - angle_rad);
            set_ankle(making, sample, SIDE_LEFT,
                      plantar_rad + away * (held.plantarflexion_rad[SIDE_LEFT] - plantar_rad));
            holding = away > 0.0;
        }
    }
}

static void leave_gaps(const struct making *making)
{
    static const double EVERY_S = 5.37, FROM_S = 3.0, TO_S = 3.0995;
    size_t kept = 0;
    for (size_t i = 0; i < making->copy->count; i++) {
        const double now_s = making->copy->samples[i].time_s;
        const double at_s = now_s - EVERY_S * (double)(long)(now_s / EVERY_S);
        if (at_s <= FROM_S || at_s >= TO_S) {
            making->copy->samples[kept++] = making->copy->samples[i];
        }
    }
    making->copy->count = kept;
}

static void misread(const struct making *making, enum copy_kind kind)
{
    for (size_t i = 0; i < making->copy->count; i++) {
        struct recording_sample *sample = &making->copy->samples[i];
        const double now_s = sample->time_s;
        if (kind == COPY_OFFSET) {
            sample->leg_angle_rad[SIDE_LEFT] += 5.0 * DEG;
        } else if (kind == COPY_DRIFT) {
            sample->leg_angle_rad[SIDE_LEFT] += 3.0 * DEG * trig_sin_f64(now_s / 3.0);
            sample->leg_angle_rad[SIDE_RIGHT] += 2.0 * DEG * trig_sin_f64(now_s / 5.0);
        } else {
            for (int side = 0; side < SIDE_COUNT; side++) {
                set_ankle(making, sample, side, sample->plantarflexion_rad[side] + 5.0 * DEG);
            }
        }
    }
}

static void hurry(const struct making *making)
{
    const double start_s = making->source->samples[2 * making->source->count / 3].time_s;
    for (size_t i = 0; i < making->copy->count; i++) {
        double *time_s = &making->copy->samples[i].time_s;
        *time_s = *time_s > start_s ? start_s + (*time_s - start_s) / 1.3 : *time_s;
    }
}

/* ---- copies of another length ----------------------------------------------------- */

/* The left strikes that bound the stride in which it stops, at two thirds of the source. */
static bool find_stride(const struct recording *source, double *from_s, double *to_s)
{
    unsigned found = 0;
    for (size_t i = 2 * source->count / 3; i < source->count && found < 2; i++) {
        if (i > 0 && source->samples[i].contact[SIDE_LEFT] &&
            !source->samples[i - 1].contact[SIDE_LEFT]) {
            *(found == 0 ? from_s : to_s) = source->samples[i].time_s;
            found++;
        }
    }
    return found == 2;
}

static enum recording_error stop(const struct making *making, double phase)
{
    const struct recording *source = making->source;
    double from_s = 0.0, to_s = 0.0;
    size_t kept = 0;
    if (!find_stride(source, &from_s, &to_s)) {
        return RECORDING_TOO_SHORT;
    }
    const double stop_s = from_s + phase * (to_s - from_s);
    const double period_s = step_time_s(source, 1);
    const size_t held = (size_t)(HELD_S / period_s);
    while (kept < source->count && source->samples[kept].time_s <= stop_s) {
        kept++;
    }
    const enum recording_error error = make_room(making->copy, kept + held, source->has_contact);
    for (size_t i = 0; error == RECORDING_OK && i < kept + held; i++) {
        making->copy->samples[i] = source->samples[i < kept ? i : kept - 1];
        if (i >= kept) {
            making->copy->samples[i].time_s += period_s * (double)(i - kept + 1);
        }
    }
    making->truth->stands_s = stop_s;
    return error;
}

static void made_leg(const struct making *making, struct recording_sample *sample, int side,
                     enum copy_kind kind)
{
    const double t = sample->time_s;
    double leg_deg = 0.0, plantar_deg;
    sample->contact[side] = true;
    if (kind == COPY_ON_THE_SPOT) {
        const double turns = 0.9 * t + (side == SIDE_RIGHT ? 0.5 : 0.0);
        const double phase = turns - (double)(long)turns;
        const double part = phase > 0.6 ? trig_sin_f64(0.5 * TWO_PI * (phase - 0.6) / 0.4) : 0.0;
        const double lift = part * part;
        leg_deg = 5.0 * lift;
        plantar_deg = UPRIGHT_PLANTAR_DEG + 15.0 * lift;
        sample->contact[side] = !(phase > 0.6);
    } else if (kind == COPY_ROCKING) {
        leg_deg = plantar_deg = 6.0 * trig_sin_f64(TWO_PI * (0.7 * t - (double)(long)(0.7 * t)));
    } else {
        const double size_deg = side == SIDE_LEFT ? 12.0 : -12.0;
        leg_deg = size_deg * trig_sin_f64(TWO_PI * (0.9 * t - (double)(long)(0.9 * t)));
        plantar_deg = leg_deg;
    }
    sample->leg_angle_rad[side] = DEG * leg_deg;
    set_ankle(making, sample, side, DEG * plantar_deg);
}

static enum recording_error make_anew(const struct making *making, enum copy_kind kind)
{
    const size_t count = (size_t)(MADE_S * MADE_HZ);
    const enum recording_error error = make_room(making->copy, count, true);
    for (size_t i = 0; error == RECORDING_OK && i < count; i++) {
        making->copy->samples[i].time_s = (double)i / MADE_HZ;
        made_leg(making, &making->copy->samples[i], SIDE_LEFT, kind);
        made_leg(making, &making->copy->samples[i], SIDE_RIGHT, kind);
    }
    return error;
}

static void change(const struct making *making, enum copy_kind kind)
{
    switch (kind) {
    case COPY_SLOW:
        scale_all(making, 0.6, 1.8);
        break;
    case COPY_SHORT:
        scale_all(making, 0.5, 1.0);
        break;
    case COPY_LIMP:
        limp(making, 0.3);
        break;
    case COPY_LIMP_40:
        limp(making, 0.4);
        break;
    case COPY_TRIP:
        trip(making);
        break;
    case COPY_GAP:
        leave_gaps(making);
        break;
    case COPY_OFFSET:
    case COPY_NEUTRAL:
    case COPY_DRIFT:
        misread(making, kind);
        break;
    case COPY_QUICK:
        hurry(making);
        break;
    case COPY_LEG_HELD:
        hold_leg(making);
        break;
    case COPY_BACKWARDS:
        turn_back(making);
        break;
    case COPY_HARNESS:
        hang(making);
        break;
    default:
        break;
    }
}

enum recording_error changed_copy_make(struct recording *copy, const struct recording *source,
                                       enum copy_kind kind, double phase,
                                       const struct recording_format *format,
                                       struct copy_truth *truth)
{
    const struct making making = {copy, source, format, truth};
    *truth = (struct copy_truth){.walks = copy_kinds[kind].walks, .stands_s = COPY_NEVER};
    *copy = (struct recording){0};
    if (kind == COPY_ROCKING || kind == COPY_SCISSORING || kind == COPY_ON_THE_SPOT) {
        return make_anew(&making, kind);
    }
    if (kind == COPY_STOP) {
        return stop(&making, phase);
    }
    const enum recording_error error = changed_copy_window(copy, source, 0.0, COPY_NEVER);
    if (error == RECORDING_OK) {
        change(&making, kind);
    }
    return error;
}
