#include "controller/estimator/stride_clock.h"

/* A stride differing more than this from the mean starts a new mean. */
#define STRIDE_CHANGE_RATIO REAL(0.3)
#define STRIDE_MEAN_GAIN REAL(0.5)
#define STRIDE_LONGEST_S REAL(4.0)

void stride_clock_strike(struct stride_clock *clock, const struct gait_event *strike)
{
    const enum side side = strike->side;
    const real stride_s = seconds_since(strike->tick, clock->leg[side].strike_tick) -
                          strike->before_tick_s + clock->leg[side].strike_before_s;
    const real mean = clock->stride_s;
    if (clock->leg[side].started && stride_s <= STRIDE_LONGEST_S) {
        const bool anew = real_abs(stride_s - mean) > STRIDE_CHANGE_RATIO * mean;
        clock->stride_s = anew ? stride_s : mean + STRIDE_MEAN_GAIN * (stride_s - mean);
    }
    clock->leg[side].started = true;
    clock->leg[side].strike_tick = strike->tick;
    clock->leg[side].strike_before_s = strike->before_tick_s;
}

static real share_of(const struct stride_clock *clock, enum side side, uint32_t tick)
{
    if (!clock->leg[side].started || !(clock->stride_s > REAL(0.0))) {
        return REAL(-1.0);
    }
    const real since_s =
        seconds_since(tick, clock->leg[side].strike_tick) + clock->leg[side].strike_before_s;
    return since_s > STRIDE_LONGEST_S ? REAL(-1.0)
                                      : real_clamp(since_s / clock->stride_s, REAL(0.0), REAL(1.0));
}

void stride_clock_shares(const struct stride_clock *clock, uint32_t tick, real share[SIDE_COUNT])
{
    share[SIDE_LEFT] = share_of(clock, SIDE_LEFT, tick);
    share[SIDE_RIGHT] = share_of(clock, SIDE_RIGHT, tick);
}
