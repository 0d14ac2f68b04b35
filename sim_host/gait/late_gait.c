#include "sim_host/gait/late_gait.h"

#include <stddef.h>

#include "model/timed_stride.h"
#include "sim_host/gait/late_stride.h"
#include "sim_host/gait/linear.h"

#define DIFFERENCE 1e-6
#define NEWTON_MAX 20
#define NEWTON_DONE 1e-10
/* A delay is approached in steps of this, or in smaller ones: each gait is the guess for the next. */
#define STEP_S 0.002

enum { APEX_STATES = 3, COLUMNS = BY_SPRING_REST + 1, FINER_MOST = 16 };

static enum stride_fault step(const struct walker *walker, double delay_s, const double by[COLUMNS],
                              struct stride_result *result)
{
    const struct stride_settings settings = stride_settings_accurate(walker);
    const struct apex from = {by[BY_STANCE_RATE], by[BY_SWING_ANGLE], by[BY_SWING_RATE]};
    return timed_stride(walker, &settings, &from, by[BY_SPRING_REST], delay_s, result);
}

static void next_of(const struct stride_result *result, double next[APEX_STATES])
{
    next[0] = result->next.stance_rate_rad_s;
    next[1] = result->next.swing_angle_rad;
    next[2] = result->next.swing_rate_rad_s;
}

enum stride_fault late_gait_differentiate(const struct walker *walker, double delay_s,
                                          const struct apex *from, double spring_rest_m,
                                          struct stride_result *result,
                                          struct stride_derivative *derivative)
{
    if (!(delay_s > 0.0)) {
        const struct stride_settings settings = stride_settings_accurate(walker);
        return stride_differentiate(walker, &settings, from, spring_rest_m, result, derivative);
    }
    const double at[COLUMNS] = {from->stance_rate_rad_s, from->swing_angle_rad,
                                from->swing_rate_rad_s, spring_rest_m};
    for (int column = 0; column < COLUMNS; column++) {
        double side[2][APEX_STATES];
        for (int s = 0; s < 2; s++) {
            double moved[COLUMNS] = {at[0], at[1], at[2], at[3]};
            moved[column] += s == 0 ? -DIFFERENCE : DIFFERENCE;
            const enum stride_fault fault = step(walker, delay_s, moved, result);
            if (fault != STRIDE_OK) {
                return fault;
            }
            next_of(result, side[s]);
        }
        for (int i = 0; i < APEX_STATES; i++) {
            derivative->next[i][column] = (side[1][i] - side[0][i]) / (2.0 * DIFFERENCE);
        }
    }
    return step(walker, delay_s, at, result);
}

static double residual_of(const struct stride_result *result, const double x[APEX_STATES],
                          double residual[APEX_STATES])
{
    double next[APEX_STATES], largest = 0.0;
    next_of(result, next);
    for (int k = 0; k < APEX_STATES; k++) {
        residual[k] = x[k] - next[k];
        largest = __builtin_fmax(largest, __builtin_fabs(residual[k]));
    }
    return largest;
}

/* Newton on the three apex states at this r0; in: a guess. */
static int find(const struct walker *walker, double delay_s, double r0_m, double x[APEX_STATES],
                struct stride_result *result)
{
    for (int i = 0; i < NEWTON_MAX; i++) {
        const struct apex from = {x[0], x[1], x[2]};
        double residual[APEX_STATES], correction[APEX_STATES];
        double system[LINEAR_MAX][LINEAR_MAX] = {{0.0}};
        struct stride_derivative d;
        if (late_gait_differentiate(walker, delay_s, &from, r0_m, result, &d) != STRIDE_OK) {
            return 0;
        }
        const double largest = residual_of(result, x, residual);
        if (largest * walker->time_unit_s < NEWTON_DONE) {
            return 1;
        }
        for (int k = 0; k < APEX_STATES; k++) {
            for (int j = 0; j < APEX_STATES; j++) {
                system[k][j] = d.next[k][j] - (k == j ? 1.0 : 0.0);
            }
        }
        if (!linear_solve(APEX_STATES, (const double(*)[LINEAR_MAX])system, residual, correction)) {
            return 0;
        }
        for (int k = 0; k < APEX_STATES; k++) {
            x[k] += correction[k];
        }
    }
    return 0;
}

static void report(const double x[APEX_STATES], const struct stride_result *result,
                   struct gait_point *point)
{
    point->speed_rad_s = -x[0];
    for (int i = 0; i < APEX_STATES; i++) {
        point->apex[i] = x[i];
    }
    for (int i = 0; i < 4; i++) {
        point->strike[i] = result->strike[i];
        point->lift_off[i] = result->lift_off[i];
    }
    point->apex_to_strike_s = result->apex_to_strike_s;
    point->double_support_s = result->double_support_s;
    point->lift_off_to_apex_s = result->lift_off_to_apex_s;
    point->step_length_m = result->step_length_m;
    point->inter_leg_rad = result->inter_leg_rad;
    point->clamped = result->clamped;
}

static int approach(const struct walker *walker, double delay_s, int parts,
                    struct gait_point *point)
{
    struct stride_result result;
    double x[APEX_STATES] = {point->apex[0], point->apex[1], point->apex[2]};
    for (int k = 1; k <= parts; k++) {
        if (!find(walker, delay_s * k / parts, point->r0_m, x, &result)) {
            return 0;
        }
    }
    report(x, &result, point);
    return 1;
}

static int delay_gait(const struct walker *walker, double delay_s, struct gait_point *point)
{
    const int parts = 1 + (int)(delay_s / STEP_S);
    for (int finer = 1; finer <= FINER_MOST; finer *= 2) {
        if (approach(walker, delay_s, finer * parts, point)) {
            return 1;
        }
    }
    return 0;
}

/* Where a slow ankle comes back before its spring is released, the map jumps, and a gait may be missing. */
static void bridge(struct gait_point points[3])
{
    const double r0_m = points[1].r0_m;
    points[1] = points[0];
    points[1].r0_m = r0_m;
    points[1].speed_rad_s = 0.5 * (points[0].speed_rad_s + points[2].speed_rad_s);
    for (int i = 0; i < APEX_STATES; i++) {
        points[1].apex[i] = 0.5 * (points[0].apex[i] + points[2].apex[i]);
    }
}

static enum gait_curve_error delay_curve(const struct walker *walker, double delay_s, int count,
                                         struct gait_point *points, int *good)
{
    for (*good = 0; *good < count; (*good)++) {
        const int i = *good;
        if (delay_gait(walker, delay_s, &points[i])) {
            continue;
        }
        if (i == 0 || i + 1 == count || !delay_gait(walker, delay_s, &points[i + 1])) {
            return GAIT_CURVE_LOST;
        }
        bridge(&points[i - 1]);
        (*good)++;
    }
    return GAIT_CURVE_OK;
}

enum gait_curve_error late_gait_curve(const struct gait_walker *walker, double delay_s,
                                      double r0_min_m, double r0_step_m, int count,
                                      struct gait_point *points, int *reached)
{
    int unused = 0;
    int *const good = reached != NULL ? reached : &unused;
    const struct walker_params params = {walker->hip_mass_kg, walker->leg_mass_kg,
                                         walker->leg_length_m, walker->ankle_stiffness_N_m,
                                         walker->gravity_m_s2};
    struct walker model;
    const enum gait_curve_error error =
        gait_curve(walker, r0_min_m, r0_step_m, count, points, good);
    if (error != GAIT_CURVE_OK || !(delay_s > 0.0)) {
        return error;
    }
    *good = 0;
    if (!(delay_s <= LATE_GAIT_MOST_S) || walker_init(&model, &params) != WALKER_OK) {
        return GAIT_CURVE_BAD_WALKER;
    }
    return delay_curve(&model, delay_s, count, points, good);
}
