#include "sim_host/plant/recorded_person.h"

/* The quantities that are interpolated, per side. */
enum quantity { LEG_ANGLE, ANKLE };

static double sampled(const struct recording *recording, size_t i, enum quantity quantity, int side)
{
    const struct recording_sample *sample = &recording->samples[i];
    return quantity == LEG_ANGLE ? sample->leg_angle_rad[side] : sample->ankle_m[side];
}

/* Slope at sample i through its neighbours (one-sided at the ends). */
static double slope_at(const struct recording *recording, size_t i, enum quantity quantity,
                       int side)
{
    const size_t low = i > 0 ? i - 1 : 0;
    const size_t high = i + 1 < recording->count ? i + 1 : i;
    const double span_s = recording->samples[high].time_s - recording->samples[low].time_s;
    return (sampled(recording, high, quantity, side) - sampled(recording, low, quantity, side)) /
           span_s;
}

struct value {
    double value, rate;
};

/* Catmull-Rom between samples i and i + 1, at part u of the way. */
static struct value between(const struct recording *recording, size_t i, double u,
                            enum quantity quantity, int side)
{
    const double h = recording->samples[i + 1].time_s - recording->samples[i].time_s;
    const double a = sampled(recording, i, quantity, side);
    const double b = sampled(recording, i + 1, quantity, side);
    const double ra = h * slope_at(recording, i, quantity, side);
    const double rb = h * slope_at(recording, i + 1, quantity, side);
    const double c2 = 3.0 * (b - a) - 2.0 * ra - rb, c3 = 2.0 * (a - b) + ra + rb;
    return (struct value){
        .value = a + u * (ra + u * (c2 + u * c3)),
        .rate = (ra + u * (2.0 * c2 + u * 3.0 * c3)) / h,
    };
}

static void hold_sample(const struct recording_sample *sample, struct recorded_person_state *state)
{
    for (int side = 0; side < SIDE_COUNT; side++) {
        state->leg_angle_rad[side] = sample->leg_angle_rad[side];
        state->ankle_m[side] = sample->ankle_m[side];
        state->contact[side] = sample->contact[side];
        state->leg_rate_rad_s[side] = 0.0;
        state->ankle_rate_m_s[side] = 0.0;
    }
}

void recorded_person_at(const struct recording *recording, double time_s, size_t *cursor,
                        struct recorded_person_state *state)
{
    const struct recording_sample *samples = recording->samples;
    size_t i = *cursor < recording->count ? *cursor : recording->count - 1;
    while (i > 0 && samples[i].time_s > time_s) {
        i--;
    }
    while (i + 1 < recording->count && samples[i + 1].time_s <= time_s) {
        i++;
    }
    *cursor = i;
    state->finished = i + 1 == recording->count;
    if (state->finished || time_s <= 0.0) {
        hold_sample(&samples[i], state);
        return;
    }
    const double u = (time_s - samples[i].time_s) / (samples[i + 1].time_s - samples[i].time_s);
    for (int side = 0; side < SIDE_COUNT; side++) {
        const struct value leg = between(recording, i, u, LEG_ANGLE, side);
        struct value ankle = between(recording, i, u, ANKLE, side);
        if (ankle.value <= 0.0) {
            ankle = (struct value){0.0, 0.0}; /* the heel is down */
        }
        state->leg_angle_rad[side] = leg.value;
        state->leg_rate_rad_s[side] = leg.rate;
        state->ankle_m[side] = ankle.value;
        state->ankle_rate_m_s[side] = ankle.rate;
        state->contact[side] = samples[i].contact[side];
    }
}
