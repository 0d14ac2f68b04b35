#include "controller/screening/zeroing.h"

/* Quiet standing sways by about half a degree; a step or a bow moves a leg by more than
 * this (peak to peak). */
#define SWAY_RAD REAL(0.035)
#define MOUNTING_MAX_RAD REAL(0.2)
#define ANKLE_MAX_M REAL(0.03)
#define MISSING_MAX 20u

#define SAMPLES ((uint32_t)(ZEROING_S * (real)CONTROL_RATE_HZ))

void zeroing_start(struct zeroing *zeroing)
{
    *zeroing = (struct zeroing){.state = ZEROING_RUNNING};
}

void zeroing_stop(struct zeroing *zeroing)
{
    if (zeroing->state == ZEROING_RUNNING) {
        zeroing->state = ZEROING_MOVED;
    }
}

static bool is_good(const struct leg_measurement *leg)
{
    return leg->age_ticks == 0 && real_is_finite(leg->leg_angle_rad) &&
           real_is_finite(leg->ankle_extension_m);
}

static void collect(struct zeroing *zeroing, const struct leg_measurement *leg)
{
    for (int side = 0; side < SIDE_COUNT; side++) {
        const real angle = leg[side].leg_angle_rad;
        if (zeroing->samples == 0 || angle < zeroing->least_rad[side]) {
            zeroing->least_rad[side] = angle;
        }
        if (zeroing->samples == 0 || angle > zeroing->greatest_rad[side]) {
            zeroing->greatest_rad[side] = angle;
        }
        /* As means: sums of thousands would lose the float's last digits. */
        const real weight = REAL(1.0) / (real)(zeroing->samples + 1);
        real *mean = &zeroing->mean.angle_rad[side];
        real *ankle = &zeroing->mean.ankle_m[side];
        *mean += weight * (angle - *mean);
        *ankle += weight * (leg[side].ankle_extension_m - *ankle);
    }
    zeroing->samples++;
}

static enum zeroing_state verdict(const struct zeroing *zeroing)
{
    for (int side = 0; side < SIDE_COUNT; side++) {
        if (zeroing->greatest_rad[side] - zeroing->least_rad[side] > SWAY_RAD) {
            return ZEROING_MOVED;
        }
        if (real_abs(zeroing->mean.angle_rad[side]) > MOUNTING_MAX_RAD ||
            real_abs(zeroing->mean.ankle_m[side]) > ANKLE_MAX_M) {
            return ZEROING_TOO_FAR;
        }
    }
    return zeroing->samples >= SAMPLES ? ZEROING_DONE : ZEROING_RUNNING;
}

void zeroing_update(struct zeroing *zeroing, const struct leg_measurement *leg)
{
    if (zeroing->state != ZEROING_RUNNING) {
        return;
    }
    if (!is_good(&leg[SIDE_LEFT]) || !is_good(&leg[SIDE_RIGHT])) {
        zeroing->missing++;
        if (zeroing->missing > MISSING_MAX) {
            zeroing->state = ZEROING_NO_SAMPLE;
        }
        return;
    }
    collect(zeroing, leg);
    zeroing->state = verdict(zeroing);
}
