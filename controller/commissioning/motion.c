#include "controller/commissioning/motion.h"

#include <assert.h>

#include "model/trig.h"

static_assert(TICKS_OF_MS(1000 * MOTION_SECONDS_MOST) < UINT16_MAX, "a phase is told in 16 bits");

#define FIRST_SHARE REAL(0.05)
#define SECOND_SHARE REAL(0.2)
#define PROVES_SECOND REAL(0.1)
#define FULL_SHARE REAL(1.0)
/* A motor's force has its friction and inertia in it, on a screw several per cent of the largest load: so
 * much more is nothing to stop for. */
#define FRICTION_SHARE REAL(0.1)
/* A motor this far beyond what it was sent to, as a part of it, has run away. */
#define BEYOND_RATIO REAL(1.5)
/* The bandwidth is where the motor does this part of its reference: 3 dB less (IEC 60050-702). */
#define BANDWIDTH_GAIN REAL(0.707)
#define FIRST_FREQUENCY_HZ REAL(1.0)
/* An oscillation takes this part of the reference's limits of speed and acceleration at most. */
#define OSCILLATION_SPEED_RATIO REAL(0.5)
#define OSCILLATION_ACCELERATION_RATIO REAL(0.8)
#define TWO_PI (REAL(2.0) * REAL_PI)

/* What is loaded only to hold, to be armed or to be cut takes a second; a return half of one. */
enum {
    LOAD_TICKS = TICKS_OF_MS(1000),
    RETURN_TICKS = TICKS_OF_MS(500),
    HOLD_TICKS = TICKS_OF_MS(300),
    SETTLE_TICKS = TICKS_OF_MS(500),
    CREEP_TICKS = TICKS_OF_MS(100), /* to zero, from where a motor is when it is enabled */
    WAIT_TICKS = TICKS_OF_MS(200),  /* what the drives do when they are enabled has died away */
    FIRST_CYCLES = 2,               /* of an oscillation: they begin from rest */
    ALL_PROVEN = 2,                 /* of a leg: all loads are allowed */
    HEAVY_SAMPLES = 2 /* force samples in a row: a single one may be the drive's own noise */
};

void motion_init(struct motion *motion)
{
    *motion = (struct motion){
        .renewal_ticks = UINT16_MAX, .release_ticks = UINT16_MAX, .unload_ticks = UINT16_MAX};
}

/* ---- what is asked ---------------------------------------------------------------- */

static void keep_samples(struct motion *motion, const struct controller_input *input)
{
    for (int side = 0; side < SIDE_COUNT; side++) {
        const struct sea_measurement *sea = &input->sea[side];
        if (sea->absent) {
            motion->proven[side] = ALL_PROVEN; /* there is nothing to show */
        }
        if (sea->force_age_ticks == 0) {
            motion->sample[side] = (struct motion_sample){
                sea->force_N, sea->precompression_m, (uint8_t)(motion->sample[side].number + 1u)};
        }
    }
}

bool motion_watch(struct motion *motion, const struct controller_input *input)
{
    const struct motion_request *request = &input->motion;
    if (request->renewal != motion->renewal) {
        motion->renewal = request->renewal;
        motion->renewal_ticks = 0;
    } else if (motion->renewal_ticks < UINT16_MAX) {
        motion->renewal_ticks++;
    }
    if (request->kind == MOTION_KIND_NONE) {
        motion->spent = false;
    }
    keep_samples(motion, input);
    return motion->renewal_ticks < MOTION_RENEWAL_TICKS && request->kind != MOTION_KIND_NONE &&
           !motion->spent;
}

real motion_share_allowed(const struct motion *motion)
{
    const uint8_t left = motion->proven[SIDE_LEFT], right = motion->proven[SIDE_RIGHT];
    const uint8_t least = left < right ? left : right;
    return least == 0 ? FIRST_SHARE : least == 1 ? SECOND_SHARE : FULL_SHARE;
}

/* ---- beginning and ending ---------------------------------------------------------- */

static void go_to(struct motion *motion, enum motion_phase phase)
{
    motion->phase = phase;
    motion->phase_ticks = 0;
}

static void end(struct motion *motion, enum motion_outcome outcome)
{
    motion->outcome = motion->outcome == MOTION_NONE_YET ? outcome : motion->outcome;
    motion->armed = motion->cut = false;
    go_to(motion, MOTION_IDLE);
}

/* Back to zero, whatever it was doing. */
static void turn_back(struct motion *motion, enum motion_outcome outcome)
{
    motion->outcome = outcome;
    motion->armed = motion->cut = false;
    motion->from_m = motion->reference_m[motion->side];
    go_to(motion, MOTION_RETURNS);
}

void motion_enter(struct motion *motion, const struct control_params *params,
                  const struct controller_input *input)
{
    const real within_m = params->sea_tolerance_m; /* as the supervisor's checks have seen it */
    for (int side = 0; side < SIDE_COUNT; side++) {
        motion->reference_m[side] =
            real_clamp(input->sea[side].precompression_m, -within_m, within_m);
    }
    motion->heavy_samples = 0;
    motion->armed = motion->cut = false;
    go_to(motion, MOTION_IDLE);
}

void motion_forget(struct motion *motion, bool by_fault)
{
    if (motion->phase != MOTION_IDLE) {
        end(motion, MOTION_INTERRUPTED);
    }
    /* A cut of the link leaves the drives in a fault; that is what it is for. */
    if (by_fault && motion->kind != MOTION_KIND_CUT) {
        motion->proven[SIDE_LEFT] = motion->proven[SIDE_RIGHT] = 0;
    }
    if (by_fault) {
        motion->spent = true;
    }
}

/* As fast as both limits of the reference allow for this size. */
static real fastest_Hz(const struct control_params *params, real size_m, real wanted_Hz)
{
    const real by_speed = OSCILLATION_SPEED_RATIO * params->sea_speed_max_m_s / (REAL_PI * size_m);
    const real by_acceleration =
        real_sqrt(OSCILLATION_ACCELERATION_RATIO * params->sea_acceleration_m_s2 /
                  (REAL(2.0) * REAL_PI * REAL_PI * size_m));
    const real least = by_speed < by_acceleration ? by_speed : by_acceleration;
    return wanted_Hz < least ? wanted_Hz : least;
}

static bool is_possible(const struct motion *motion, const struct controller_input *input)
{
    const struct motion_request *request = &input->motion;
    const bool known = request->kind == MOTION_KIND_MOVE || request->kind == MOTION_KIND_CHIRP ||
                       request->kind == MOTION_KIND_RELEASE || request->kind == MOTION_KIND_CUT;
    /* Written so that what is not a number is refused, too. */
    return known && request->side < SIDE_COUNT && !input->sea[request->side].absent &&
           request->share > REAL(0.0) && request->share <= motion_share_allowed(motion) &&
           request->seconds > REAL(0.0) && request->seconds <= (real)MOTION_SECONDS_MOST &&
           (request->kind != MOTION_KIND_CHIRP || request->frequency_Hz >= FIRST_FREQUENCY_HZ);
}

static void begin(struct motion *motion, const struct control_params *params,
                  const struct controller_input *input)
{
    const struct motion_request *request = &input->motion;
    motion->order = request->order;
    motion->outcome = MOTION_NONE_YET;
    motion->kind = request->kind;
    if (!is_possible(motion, input)) {
        end(motion, MOTION_REFUSED);
        return;
    }
    motion->side = request->side;
    motion->size_m = request->share * params->r0_max_m;
    motion->hold_ticks = ticks_from_seconds(request->seconds);
    motion->frequency_Hz = fastest_Hz(params, motion->size_m, request->frequency_Hz);
    motion->bandwidth_Hz = motion->last_frequency_Hz = REAL(0.0);
    motion->release_ticks = motion->unload_ticks = UINT16_MAX;
    motion->heavy_samples = 0;
    go_to(motion, MOTION_WAITS);
}

/* ---- the phases ----------------------------------------------------------------------- */

/* 0 at rest to 1 at rest, half a cosine. */
static real rise(uint32_t ticks, uint32_t all)
{
    const real part = (real)ticks / (real)all;
    return part >= REAL(1.0) ? REAL(1.0) : REAL(0.5) * (REAL(1.0) - real_cos(REAL_PI * part));
}

static bool is_there(const struct control_params *params, real reference_m, real measured_m)
{
    return real_abs(measured_m - reference_m) <= params->sea_tolerance_m;
}

static void begin_holding(struct motion *motion)
{
    motion->cycle_rad = REAL(0.0);
    motion->cycles = 0;
    motion->least_m = motion->greatest_m = REAL(0.0);
    motion->armed = motion->kind == MOTION_KIND_RELEASE;
    motion->cut = motion->kind == MOTION_KIND_CUT;
    go_to(motion, MOTION_HOLDS);
}

/* A move takes its time to load; an oscillation begins at zero. */
static void load(struct motion *motion, const struct control_params *params, real measured_m)
{
    real *reference = &motion->reference_m[motion->side];
    const uint32_t ticks = motion->kind == MOTION_KIND_MOVE ? motion->hold_ticks : LOAD_TICKS;
    if (motion->kind == MOTION_KIND_CHIRP) {
        begin_holding(motion);
        return;
    }
    *reference = motion->size_m * rise(motion->phase_ticks, ticks);
    if (motion->phase_ticks < ticks) {
        return;
    }
    if (is_there(params, *reference, measured_m)) {
        begin_holding(motion);
    } else if (motion->phase_ticks >= ticks + SETTLE_TICKS) {
        turn_back(motion, MOTION_NOT_REACHED);
    }
}

/* One cycle of the reference is over: how much of it did the motor do? */
static void end_cycle(struct motion *motion, real frequency_Hz)
{
    const real done_m = motion->greatest_m - motion->least_m;
    motion->cycles++;
    if (motion->cycles > FIRST_CYCLES && motion->bandwidth_Hz == REAL(0.0)) {
        motion->last_frequency_Hz = frequency_Hz;
        if (done_m < BANDWIDTH_GAIN * motion->size_m) {
            motion->bandwidth_Hz = frequency_Hz;
        }
    }
}

static void oscillate(struct motion *motion, real measured_m)
{
    const real part = (real)motion->phase_ticks / (real)motion->hold_ticks;
    const real frequency_Hz =
        FIRST_FREQUENCY_HZ + (motion->frequency_Hz - FIRST_FREQUENCY_HZ) * part;
    if (measured_m < motion->least_m) {
        motion->least_m = measured_m;
    }
    if (measured_m > motion->greatest_m) {
        motion->greatest_m = measured_m;
    }
    motion->cycle_rad += TWO_PI * frequency_Hz * CONTROL_PERIOD_S;
    if (motion->cycle_rad >= TWO_PI) {
        motion->cycle_rad -= TWO_PI;
        end_cycle(motion, frequency_Hz);
        motion->least_m = motion->greatest_m = measured_m;
    }
    motion->reference_m[motion->side] =
        motion->size_m * REAL(0.5) * (REAL(1.0) - real_cos(motion->cycle_rad));
}

/* Nothing is sent to the drives: the reference goes where the motor goes, and a drive that has not
 * unloaded by itself in time is unloaded from there. */
static void stay_cut(struct motion *motion, const struct control_params *params, real measured_m)
{
    const uint32_t limit =
        motion->hold_ticks < MOTION_CUT_TICKS ? motion->hold_ticks : MOTION_CUT_TICKS;
    motion->reference_m[motion->side] = real_clamp(measured_m, REAL(0.0), motion->size_m);
    if (is_there(params, REAL(0.0), measured_m)) {
        motion->unload_ticks = (uint16_t)motion->phase_ticks;
        turn_back(motion, MOTION_DONE);
    } else if (motion->phase_ticks >= limit) {
        turn_back(motion, MOTION_DONE); /* that it did not unload is the finding */
    }
}

static void hold(struct motion *motion, const struct control_params *params,
                 const struct sea_measurement *sea)
{
    switch (motion->kind) {
    case MOTION_KIND_CHIRP:
        oscillate(motion, sea->precompression_m);
        break;
    case MOTION_KIND_RELEASE:
        if (sea->latch != LATCH_CLOSED) {
            motion->release_ticks = (uint16_t)motion->phase_ticks;
            turn_back(motion, MOTION_DONE);
            return;
        }
        break;
    case MOTION_KIND_CUT:
        stay_cut(motion, params, sea->precompression_m);
        return;
    default:
        break;
    }
    const uint32_t ticks = motion->kind == MOTION_KIND_MOVE ? HOLD_TICKS : motion->hold_ticks;
    if (motion->phase_ticks >= ticks) {
        turn_back(motion, MOTION_DONE);
    }
}

/* What was moved without trouble allows the next larger loads. */
static void prove(struct motion *motion, const struct control_params *params)
{
    uint8_t *proven = &motion->proven[motion->side];
    if (motion->kind != MOTION_KIND_MOVE || motion->outcome != MOTION_DONE) {
        return;
    }
    if (*proven == 0) {
        *proven = 1;
    }
    if (motion->size_m > PROVES_SECOND * params->r0_max_m) {
        *proven = ALL_PROVEN;
    }
}

static void give_back(struct motion *motion, const struct control_params *params, real measured_m)
{
    const uint32_t ticks = motion->kind == MOTION_KIND_MOVE && motion->outcome == MOTION_DONE
                               ? motion->hold_ticks
                               : RETURN_TICKS;
    motion->reference_m[motion->side] =
        motion->from_m * (REAL(1.0) - rise(motion->phase_ticks, ticks));
    if (motion->phase_ticks < ticks) {
        return;
    }
    if (is_there(params, REAL(0.0), measured_m)) {
        prove(motion, params);
        end(motion, MOTION_DONE);
    } else if (motion->phase_ticks >= ticks + SETTLE_TICKS) {
        motion->outcome = MOTION_NOT_REACHED;
        end(motion, MOTION_NOT_REACHED);
    }
}

/* More than this stage allows, in force or in way. What a drive does that is cut off is its own. */
static bool is_beyond(struct motion *motion, const struct control_params *params,
                      const struct sea_measurement *sea)
{
    const real share = motion_share_allowed(motion);
    const real limit_N = (share < FULL_SHARE ? share + FRICTION_SHARE : BEYOND_RATIO) *
                         params->spring_stiffness_n_m * params->r0_max_m;
    if (sea->force_age_ticks == 0) {
        motion->heavy_samples =
            real_abs(sea->force_N) > limit_N ? (uint8_t)(motion->heavy_samples + 1u) : 0u;
    }
    const bool heavy = motion->heavy_samples >= HEAVY_SAMPLES;
    const bool far =
        sea->precompression_m > BEYOND_RATIO * motion->size_m + params->sea_tolerance_m ||
        sea->precompression_m < -BEYOND_RATIO * motion->size_m - params->sea_tolerance_m;
    return !motion->cut && (heavy || far);
}

static void step(struct motion *motion, const struct control_params *params,
                 const struct controller_input *input)
{
    const struct sea_measurement *sea = &input->sea[motion->side];
    const bool enabled = input->sea[SIDE_LEFT].state == DRIVE_ENABLED &&
                         input->sea[SIDE_RIGHT].state == DRIVE_ENABLED;
    const bool asks_for_end = input->motion.kind == MOTION_KIND_UNLOAD;
    const bool under_way = motion->phase != MOTION_IDLE && motion->phase != MOTION_RETURNS;
    if (under_way && (asks_for_end || is_beyond(motion, params, sea))) {
        turn_back(motion, asks_for_end ? MOTION_INTERRUPTED : MOTION_BEYOND);
    }
    switch (motion->phase) {
    case MOTION_WAITS:
        if (enabled && motion->phase_ticks >= WAIT_TICKS) {
            go_to(motion, MOTION_LOADS);
        }
        break;
    case MOTION_LOADS:
        load(motion, params, sea->precompression_m);
        break;
    case MOTION_HOLDS:
        hold(motion, params, sea);
        break;
    case MOTION_RETURNS:
        give_back(motion, params, sea->precompression_m);
        break;
    case MOTION_IDLE:
        break;
    }
}

/* A motor that was not quite at zero when it was enabled is not made to jump there. */
static void creep_to_zero(struct motion *motion, const struct control_params *params)
{
    const real step_m = params->sea_tolerance_m / (real)CREEP_TICKS;
    for (int side = 0; side < SIDE_COUNT; side++) {
        const real reference_m = motion->reference_m[side];
        motion->reference_m[side] -= real_clamp(reference_m, -step_m, step_m);
    }
}

void motion_update(struct motion *motion, const struct control_params *params,
                   const struct controller_input *input)
{
    const struct motion_request *request = &input->motion;
    motion->phase_ticks++;
    if (motion->phase == MOTION_IDLE || motion->phase == MOTION_WAITS) {
        creep_to_zero(motion, params);
    }
    if (motion->phase == MOTION_IDLE && request->order != motion->order &&
        request->kind != MOTION_KIND_UNLOAD) {
        begin(motion, params, input);
    }
    step(motion, params, input);
}
