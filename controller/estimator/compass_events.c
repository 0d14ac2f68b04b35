#include "controller/estimator/compass_events.h"

/* Without any extension this long after heel strike there is no push-off: the
 * support has passed to the leading leg. */
#define NO_PUSH_OFF_S REAL(0.03)

/* A loaded spring that was not released this long after the crossing was not armed. */
#define RELEASE_WAIT_S REAL(0.15)

/* A crossing this short before the extension was seen is the heel strike itself. */
#define SAME_STRIKE_S REAL(0.03)

/* Extension that has stopped growing for this long has reached its end. */
#define EXTENSION_SETTLED_S REAL(0.02)

/* Ratios of the leg length: an extension that counts as one, and how close to
 * the spring's rest length the ankle counts as fully extended. */
#define EXTENSION_SEEN_RATIO REAL(0.001)
#define EXTENSION_DONE_RATIO REAL(0.0002)

void compass_events_begin_phase(struct compass_events *events, uint32_t tick)
{
    events->swing_passed = false;
    events->crossed = false;
    events->extension_peak_m = REAL(0.0);
    events->extension_peak_tick = tick;
}

/* How long before the tick a value went from `before` (> 0) to `now` (<= 0), by the
 * straight line between the two samples. */
static real since_crossing_s(real before, real now)
{
    const real fall = before - now;
    return fall > REAL(0.0) ? CONTROL_PERIOD_S * (-now / fall) : REAL(0.0);
}

static void watch_sum(struct compass_events *events, const struct control_params *params,
                      const struct controller_input *input, enum side stance)
{
    const real sum = input->leg[SIDE_LEFT].leg_angle_rad + input->leg[SIDE_RIGHT].leg_angle_rad;
    const real before = events->sum_rad;
    events->sum_rad = sum;
    if (sum > params->angle_hysteresis_rad) {
        events->swing_passed = true; /* the scuff, rising through 0, lies behind */
    }
    if (events->swing_passed && !events->crossed && sum <= REAL(0.0) &&
        input->leg[stance].leg_angle_rad < REAL(0.0)) {
        events->crossed = true;
        events->crossing_tick = input->tick;
        events->crossing_before_s = since_crossing_s(before, sum);
    }
}

static real crossing_age_s(const struct compass_events *events, uint32_t tick)
{
    return seconds_since(tick, events->crossing_tick) + events->crossing_before_s;
}

struct compass_event compass_events_watch_strike(struct compass_events *events,
                                                 const struct control_params *params,
                                                 const struct controller_input *input,
                                                 enum side stance)
{
    const real seen = EXTENSION_SEEN_RATIO * params->leg_length_m;
    const struct leg_measurement *trailing = &input->leg[stance];
    const real growth = trailing->ankle_extension_m - events->extension_before_m;
    const bool loaded = input->sea[stance].precompression_m > REAL(2.0) * params->sea_tolerance_m;
    struct compass_event event = {false, REAL(0.0)};

    watch_sum(events, params, input, stance);
    events->extension_before_m = trailing->ankle_extension_m;
    const real age_s = crossing_age_s(events, input->tick);
    if (loaded && trailing->leg_angle_rad < REAL(0.0) && growth > REAL(0.0) &&
        trailing->ankle_extension_m > seen) {
        event.happened = true;
        event.age_s = events->crossed && age_s < SAME_STRIKE_S
                          ? age_s
                          : CONTROL_PERIOD_S * trailing->ankle_extension_m / growth;
        event.age_s = real_clamp(event.age_s, REAL(0.0), SAME_STRIKE_S);
    } else if (events->crossed && (!loaded || age_s > RELEASE_WAIT_S)) {
        event = (struct compass_event){true, age_s};
    }
    return event;
}

struct compass_event compass_events_watch_lift_off(struct compass_events *events,
                                                   const struct control_params *params,
                                                   const struct controller_input *input,
                                                   enum side leaving, uint32_t since_tick)
{
    const real extension = input->leg[leaving].ankle_extension_m;
    const real seen = EXTENSION_SEEN_RATIO * params->leg_length_m;
    const real done = EXTENSION_DONE_RATIO * params->leg_length_m;
    const real rest = input->sea[leaving].precompression_m - done;
    const real before = events->extension_before_m;

    events->extension_before_m = extension;
    if (extension > events->extension_peak_m) {
        events->extension_peak_m = extension;
        events->extension_peak_tick = input->tick;
    }
    if (events->extension_peak_m < seen) {
        return (struct compass_event){seconds_since(input->tick, since_tick) >= NO_PUSH_OFF_S,
                                      REAL(0.0)};
    }
    if (extension >= rest) {
        return (struct compass_event){
            true, extension > before
                      ? real_clamp(CONTROL_PERIOD_S * (extension - rest) / (extension - before),
                                   REAL(0.0), CONTROL_PERIOD_S)
                      : REAL(0.0)};
    }
    const real settled_s = seconds_since(input->tick, events->extension_peak_tick);
    return (struct compass_event){
        extension < events->extension_peak_m - seen || settled_s >= EXTENSION_SETTLED_S, settled_s};
}
