#include "controller/laws/gait_branch.h"

static int point_is_good(const struct gait_branch_point *point)
{
    const real gait = point->r0_m + point->swing_angle_rad + point->swing_rate_rad_s;
    real sum = gait;
    for (int i = 0; i < GAIT_BRANCH_COSTS; i++) {
        sum += point->cost[i];
    }
    for (int i = 0; i < 3; i++) {
        sum += point->lqr_gain[i] + point->deadbeat_gain[i];
    }
    return real_is_finite(sum) && point->r0_m > REAL(0.0) && point->cost[0] > REAL(0.0);
}

int gait_branch_check(const struct gait_branch *branch)
{
    if (branch->count < GAIT_BRANCH_MIN || branch->count > GAIT_BRANCH_MAX ||
        !(branch->speed_min_rad_s > REAL(0.0)) || !(branch->speed_step_rad_s > REAL(0.0)) ||
        !(branch->r0_weight >= REAL(0.0)) || !(branch->travel_weight > REAL(0.0)) ||
        !real_is_finite(branch->speed_min_rad_s + branch->speed_step_rad_s + branch->r0_weight +
                        branch->travel_weight)) {
        return 0;
    }
    for (uint32_t i = 0; i < branch->count; i++) {
        if (!point_is_good(&branch->point[i]) ||
            (i > 0 && !(branch->point[i].r0_m > branch->point[i - 1].r0_m))) {
            return 0;
        }
    }
    return 1;
}

/* The cubic through y at s = -1, 0, 1, 2 (Lagrange). */
static real cubic_through(const real y[4], real s)
{
    const real a = y[2] - y[1];
    const real b = y[1] - y[0];
    const real c = y[3] - y[2];
    const real third = (c - REAL(2.0) * a + b) * (REAL(1.0) / REAL(6.0));
    const real second = REAL(0.5) * (a - b);
    return y[1] + s * (a + (s - REAL(1.0)) * (second + (s + REAL(1.0)) * third));
}

static real between(real from, real to, real part)
{
    return from + part * (to - from);
}

real gait_branch_at(const struct gait_branch *branch, real speed_rad_s,
                    struct gait_branch_point *gait)
{
    const real last = (real)(branch->count - 1u);
    const real position = real_clamp(
        (speed_rad_s - branch->speed_min_rad_s) / branch->speed_step_rad_s, REAL(0.0), last);
    uint32_t interval = real_is_within(position, REAL(0.0), last) ? (uint32_t)position : 0u;
    if (interval > branch->count - 2u) {
        interval = branch->count - 2u;
    }
    uint32_t first = interval > 0u ? interval - 1u : 0u;
    if (first > branch->count - 4u) {
        first = branch->count - 4u;
    }
    const struct gait_branch_point *p = &branch->point[first];
    const real s = position - (real)(first + 1u);
    const real r0[4] = {p[0].r0_m, p[1].r0_m, p[2].r0_m, p[3].r0_m};
    const real angle[4] = {p[0].swing_angle_rad, p[1].swing_angle_rad, p[2].swing_angle_rad,
                           p[3].swing_angle_rad};
    const real rate[4] = {p[0].swing_rate_rad_s, p[1].swing_rate_rad_s, p[2].swing_rate_rad_s,
                          p[3].swing_rate_rad_s};
    gait->r0_m = cubic_through(r0, s);
    gait->swing_angle_rad = cubic_through(angle, s);
    gait->swing_rate_rad_s = cubic_through(rate, s);

    const struct gait_branch_point *low = &branch->point[interval];
    const struct gait_branch_point *high = low + 1;
    const real part = position - (real)interval;
    for (int i = 0; i < GAIT_BRANCH_COSTS; i++) {
        gait->cost[i] = between(low->cost[i], high->cost[i], part);
    }
    for (int i = 0; i < 3; i++) {
        gait->lqr_gain[i] = between(low->lqr_gain[i], high->lqr_gain[i], part);
        gait->deadbeat_gain[i] = between(low->deadbeat_gain[i], high->deadbeat_gain[i], part);
    }
    return branch->speed_min_rad_s + position * branch->speed_step_rad_s;
}

void gait_branch_departure(const struct gait_branch_point *gait, real speed_rad_s,
                           const struct apex *apex, real departure[3])
{
    departure[0] = apex->stance_rate_rad_s + speed_rad_s;
    departure[1] = apex->swing_angle_rad - gait->swing_angle_rad;
    departure[2] = apex->swing_rate_rad_s - gait->swing_rate_rad_s;
}

real gait_branch_cost(const struct gait_branch *branch, const struct gait_branch_point *gait,
                      real speed_rad_s, const struct apex *apex, real r0_m)
{
    real e[3];
    gait_branch_departure(gait, speed_rad_s, apex, e);
    const real *p = gait->cost;
    const real push = r0_m - gait->r0_m;
    return e[0] * (p[0] * e[0] + p[3] * e[1] + p[4] * e[2]) + e[1] * (p[1] * e[1] + p[5] * e[2]) +
           p[2] * e[2] * e[2] + branch->r0_weight * push * push;
}

real gait_branch_distance(const struct gait_branch *branch, const struct gait_branch_point *target,
                          real target_speed_rad_s, const struct apex *apex, real r0_m)
{
    real least = gait_branch_cost(branch, target, target_speed_rad_s, apex, r0_m);
    for (uint32_t i = 0; i < branch->count; i++) {
        const real speed = branch->speed_min_rad_s + (real)i * branch->speed_step_rad_s;
        const real travel = branch->travel_weight * real_abs(target_speed_rad_s - speed);
        if (travel < least) { /* else this entry cannot be the least: costs are not negative */
            const real cost =
                travel + gait_branch_cost(branch, &branch->point[i], speed, apex, r0_m);
            least = cost < least ? cost : least;
        }
    }
    return least;
}
