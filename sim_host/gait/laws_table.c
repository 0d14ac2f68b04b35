#include "sim_host/gait/laws_table.h"

#include <string.h>

#include "sim_host/gait/late_gait.h"
#include "sim_host/gait/late_stride.h"
#include "sim_host/gait/linear.h"
#include "sim_host/gait/loop_gain.h"

#define PAPER_GRAVITY_M_S2 9.80665 /* its leg is 1 m */
#define FIRST_R0 0.005
#define LAST_R0 0.262
#define LATE_LAST_R0 0.255 /* beyond it an ankle comes back before a late release */
#define NEWTON_MAX 30
#define NEWTON_DONE 1e-12
#define LATE_DONE 1e-10 /* by differences */
#define RICCATI_MAX 20000
#define RICCATI_DONE 1e-13

struct laws_weights laws_weights_default(void)
{
    return (struct laws_weights){1.0, 0.1, 0.01, 0.1, 0.1};
}

static int differentiate(const struct walker *walker, double delay_s, const double x[3],
                         double r0_m, double next[3], struct stride_derivative *derivative)
{
    const struct apex from = {x[0], x[1], x[2]};
    struct stride_result result;
    if (late_gait_differentiate(walker, delay_s, &from, r0_m, &result, derivative) != STRIDE_OK) {
        return 0;
    }
    next[0] = result.next.stance_rate_rad_s;
    next[1] = result.next.swing_angle_rad;
    next[2] = result.next.swing_rate_rad_s;
    return 1;
}

/* The gait at point->speed_rad_s; in: first guess of its other three numbers. */
static int find_gait(const struct walker *walker, double delay_s, struct laws_point *point)
{
    for (int i = 0; i < NEWTON_MAX; i++) {
        const double x[3] = {-point->speed_rad_s, point->swing_angle_rad, point->swing_rate_rad_s};
        double next[3], residual[3], correction[3], largest = 0.0;
        double system[LINEAR_MAX][LINEAR_MAX] = {{0.0}};
        struct stride_derivative d;
        if (!differentiate(walker, delay_s, x, point->r0_m, next, &d)) {
            return 0;
        }
        for (int k = 0; k < 3; k++) {
            residual[k] = x[k] - next[k];
            largest = real_abs(residual[k]) > largest ? real_abs(residual[k]) : largest;
            system[k][0] = d.next[k][BY_SWING_ANGLE] - (k == 1 ? 1.0 : 0.0);
            system[k][1] = d.next[k][BY_SWING_RATE] - (k == 2 ? 1.0 : 0.0);
            system[k][2] = d.next[k][BY_SPRING_REST];
            point->input[k] = d.next[k][BY_SPRING_REST];
            for (int j = 0; j < 3; j++) {
                point->map[k][j] = d.next[k][j];
            }
        }
        if (largest * walker->time_unit_s < (delay_s > 0.0 ? LATE_DONE : NEWTON_DONE)) {
            return 1;
        }
        if (!linear_solve(3, (const double(*)[LINEAR_MAX])system, residual, correction)) {
            return 0;
        }
        point->swing_angle_rad += correction[0];
        point->swing_rate_rad_s += correction[1];
        point->r0_m += correction[2];
    }
    return 0;
}

/* One Riccati step: P <- Q + A'PA - A'PB (R + B'PB)^-1 B'PA; gain = (R + B'PB)^-1 B'PA. */
static double riccati_step(const struct laws_point *point, const double q[3], double r,
                           double p[3][3], double gain[3])
{
    double pa[3][3], pb[3], bpa[3], next[3][3], change = 0.0, scale = r;
    for (int i = 0; i < 3; i++) {
        pb[i] = 0.0;
        for (int k = 0; k < 3; k++) {
            pb[i] += p[i][k] * point->input[k];
        }
        for (int j = 0; j < 3; j++) {
            pa[i][j] = 0.0;
            for (int k = 0; k < 3; k++) {
                pa[i][j] += p[i][k] * point->map[k][j];
            }
        }
    }
    for (int j = 0; j < 3; j++) {
        scale += point->input[j] * pb[j];
        bpa[j] = 0.0;
        for (int k = 0; k < 3; k++) {
            bpa[j] += pb[k] * point->map[k][j];
        }
    }
    for (int i = 0; i < 3; i++) {
        gain[i] = bpa[i] / scale;
        for (int j = 0; j < 3; j++) {
            next[i][j] = (i == j ? q[i] : 0.0) - bpa[i] * bpa[j] / scale;
            for (int k = 0; k < 3; k++) {
                next[i][j] += point->map[k][i] * pa[k][j];
            }
        }
    }
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            const double difference = real_abs(next[i][j] - p[i][j]);
            change = difference > change ? difference : change;
        }
    }
    memcpy(p, next, sizeof next);
    return change;
}

static int solve_riccati(struct laws_point *point, const double q[3], double r)
{
    double p[3][3] = {{q[0], 0.0, 0.0}, {0.0, q[1], 0.0}, {0.0, 0.0, q[2]}};
    for (int i = 0; i < RICCATI_MAX; i++) {
        const double change = riccati_step(point, q, r, p, point->lqr_gain);
        if (change < RICCATI_DONE * p[0][0]) {
            const double cost[6] = {p[0][0],           p[1][1],           p[2][2],
                                    p[0][1] + p[1][0], p[0][2] + p[2][0], p[1][2] + p[2][1]};
            memcpy(point->cost, cost, sizeof cost);
            return 1;
        }
    }
    return 0;
}

static void apply(double a[3][3], const double v[3], double result[3])
{
    for (int i = 0; i < 3; i++) {
        result[i] = a[i][0] * v[0] + a[i][1] * v[1] + a[i][2] * v[2];
    }
}

/* Ackermann: the last row of [B AB AAB]^-1, times A^3. */
static int solve_deadbeat(struct laws_point *point)
{
    double ab[3], aab[3], row[3];
    apply(point->map, point->input, ab);
    apply(point->map, ab, aab);
    const double transposed[LINEAR_MAX][LINEAR_MAX] = {
        {point->input[0], point->input[1], point->input[2]},
        {ab[0], ab[1], ab[2]},
        {aab[0], aab[1], aab[2]}};
    const double last[3] = {0.0, 0.0, 1.0};
    if (!linear_solve(3, transposed, last, row)) {
        return 0;
    }
    for (int power = 0; power < 3; power++) {
        double next[3];
        for (int j = 0; j < 3; j++) {
            next[j] =
                row[0] * point->map[0][j] + row[1] * point->map[1][j] + row[2] * point->map[2][j];
        }
        memcpy(row, next, sizeof next);
    }
    memcpy(point->deadbeat_gain, row, sizeof row);
    return 1;
}

/* First guess for entry i: on the line through the two before. */
static void guess(struct laws_table *table, int i, const struct gait_point *first)
{
    struct laws_point *p = &table->point[i];
    p->speed_rad_s = table->speed_min_rad_s + i * table->speed_step_rad_s;
    if (i == 0) {
        p->r0_m = first->r0_m;
        p->swing_angle_rad = first->apex[1];
        p->swing_rate_rad_s = first->apex[2];
        return;
    }
    const struct laws_point *a = &table->point[i > 1 ? i - 2 : 0], *b = &table->point[i - 1];
    p->r0_m = 2.0 * b->r0_m - a->r0_m;
    p->swing_angle_rad = 2.0 * b->swing_angle_rad - a->swing_angle_rad;
    p->swing_rate_rad_s = 2.0 * b->swing_rate_rad_s - a->swing_rate_rad_s;
}

enum laws_table_error laws_table_make(const struct gait_walker *gait_walker, double length_scale,
                                      double delay_s, const struct laws_weights *weights,
                                      struct laws_table *table)
{
    const struct walker_params params = {
        gait_walker->hip_mass_kg, gait_walker->leg_mass_kg, gait_walker->leg_length_m,
        gait_walker->ankle_stiffness_N_m, gait_walker->gravity_m_s2};
    struct walker walker;
    struct gait_point ends[2];
    const double last_r0 = delay_s > 0.0 ? LATE_LAST_R0 : LAST_R0;
    *table = (struct laws_table){.count = LAWS_TABLE_POINTS};
    if (walker_init(&walker, &params) != WALKER_OK ||
        late_gait_curve(gait_walker, delay_s, FIRST_R0 * length_scale,
                        (last_r0 - FIRST_R0) * length_scale, 2, ends, NULL) != GAIT_CURVE_OK) {
        return LAWS_TABLE_NO_CURVE;
    }
    const double time_scale = walker.time_unit_s * __builtin_sqrt(PAPER_GRAVITY_M_S2);
    const double q[3] = {weights->speed * time_scale * time_scale, weights->swing_angle,
                         weights->swing_rate * time_scale * time_scale};
    table->speed_min_rad_s = ends[0].speed_rad_s;
    table->speed_step_rad_s = (ends[1].speed_rad_s - ends[0].speed_rad_s) / (LAWS_TABLE_POINTS - 1);
    table->r0_weight = weights->r0 / (length_scale * length_scale);
    table->travel_weight = weights->travel * time_scale;
    for (int i = 0; i < LAWS_TABLE_POINTS; i++) {
        guess(table, i, &ends[0]);
        if (!find_gait(&walker, delay_s, &table->point[i])) {
            return LAWS_TABLE_LOST;
        }
    }
    for (int i = 0; i < LAWS_TABLE_POINTS; i++) {
        if (!solve_riccati(&table->point[i], q, table->r0_weight)) {
            return LAWS_TABLE_NO_RICCATI;
        }
        if (!solve_deadbeat(&table->point[i])) {
            return LAWS_TABLE_UNCONTROLLABLE;
        }
    }
    return LAWS_TABLE_OK;
}

static int points_from(const struct laws_table *table, double r0_low_m, struct loop_point *points)
{
    int count = 0;
    for (int i = 0; i < table->count; i++) {
        const struct laws_point *from = &table->point[i];
        if (from->r0_m >= r0_low_m) {
            struct loop_point *to = &points[count++];
            to->r0_m = from->r0_m;
            to->speed_rad_s = from->speed_rad_s;
            memcpy(to->by_apex, from->map, sizeof to->by_apex);
            memcpy(to->by_r0, from->input, sizeof to->by_r0);
        }
    }
    return count;
}

void laws_table_gain_range(const struct laws_table *table, double r0_low_m, double gain,
                           double unit, double *low, double *high)
{
    struct loop_point points[LAWS_TABLE_POINTS];
    const int count = points_from(table, r0_low_m, points);
    const double step = 0.0005 * unit;
    *low = *high = gain;
    if (count == 0 || loop_gain_largest(points, count, gain) >= LAWS_TABLE_BORNE) {
        return;
    }
    while (*low - step >= 0.0 && loop_gain_largest(points, count, *low - step) < LAWS_TABLE_BORNE) {
        *low -= step;
    }
    while (*high < 0.2 * unit &&
           loop_gain_largest(points, count, *high + step) < LAWS_TABLE_BORNE) {
        *high += step;
    }
}

double laws_table_gain(const struct laws_table *table, double r0_low_m, double wanted, double unit,
                       double *largest)
{
    struct loop_point points[LAWS_TABLE_POINTS];
    const int count = points_from(table, r0_low_m, points);
    double gain = wanted;
    *largest = loop_gain_largest(points, count, gain);
    if (*largest > LAWS_TABLE_CALM) {
        gain = loop_gain_best(points, count, unit);
        *largest = loop_gain_largest(points, count, gain);
    }
    return gain;
}

const char *laws_table_error_name(enum laws_table_error error)
{
    switch (error) {
    case LAWS_TABLE_OK:
        return "no error";
    case LAWS_TABLE_NO_CURVE:
        return "no curve of steady gaits over the law's range";
    case LAWS_TABLE_LOST:
        return "a gait was lost between two speeds";
    case LAWS_TABLE_NO_RICCATI:
        return "the Riccati iteration did not come to rest";
    case LAWS_TABLE_UNCONTROLLABLE:
        return "the push-off does not reach every state";
    }
    return "unknown error";
}
