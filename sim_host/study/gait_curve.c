/* Works in the walker's own units (M = 1, l = 1, g = 1): there a walker is two numbers, m/M and
 * k l / (M g), and a gait one more, r0 / l. From the paper's gait at r0 = 0.05 the branch is followed
 * first to the wanted walker, then along r0. */
#include "sim_host/study/gait_curve.h"

#include <stddef.h>

#include "model/stride.h"
#include "sim_host/study/fixed_point.h"

#define START_R0 0.05
#define WALKER_STEP 0.1 /* of the way from the paper's walker to the wanted one */
#define R0_STEP 0.004
#define SMALLEST_SHARE (1.0 / 4096.0)

/* A point of the path in parameter space. */
struct place {
    double mass_ratio, stiffness, r0;
};

struct gait {
    struct place place;
    double x[3];
};

static struct place between(const struct place *a, const struct place *b, double share)
{
    const struct place p = {a->mass_ratio + share * (b->mass_ratio - a->mass_ratio),
                            a->stiffness + share * (b->stiffness - a->stiffness),
                            a->r0 + share * (b->r0 - a->r0)};
    return p;
}

static enum fixed_point_status solve(const struct place *place, double x[3],
                                     struct stride_result *result)
{
    const struct walker_params params = {1.0, place->mass_ratio, 1.0, place->stiffness, 1.0};
    struct walker walker;
    if (walker_init(&walker, &params) != WALKER_OK) {
        return FIXED_POINT_FAULT;
    }
    const struct stride_settings settings = stride_settings_accurate(&walker);
    return fixed_point_find(&walker, &settings, place->r0, x, result);
}

/* Follows the branch in a straight line to `target`, with secant prediction and steps as long as they go. */
static int follow(struct gait *gait, const struct place *target, double first_share,
                  struct stride_result *result)
{
    const struct place from = gait->place;
    double share = 0.0, step = first_share, before_share = 0.0;
    double before[3] = {gait->x[0], gait->x[1], gait->x[2]};
    if (first_share >= 1.0) {
        step = 1.0;
    }
    while (share < 1.0) {
        const double to = share + step < 1.0 ? share + step : 1.0;
        const struct place place = between(&from, target, to);
        double x[3];
        for (int i = 0; i < 3; i++) {
            const double slope =
                share > before_share ? (gait->x[i] - before[i]) / (share - before_share) : 0.0;
            x[i] = gait->x[i] + slope * (to - share);
        }
        if (solve(&place, x, result) != FIXED_POINT_OK) {
            step *= 0.5;
            if (step < SMALLEST_SHARE * first_share) {
                return 0;
            }
            continue;
        }
        for (int i = 0; i < 3; i++) {
            before[i] = gait->x[i];
            gait->x[i] = x[i];
        }
        before_share = share;
        share = to;
        gait->place = place;
    }
    gait->place = *target;
    return 1;
}

static void report(const struct gait *gait, const struct gait_walker *walker,
                   const struct stride_result *result, struct gait_point *point)
{
    const double l = walker->leg_length_m;
    const double unit_s = __builtin_sqrt(l / walker->gravity_m_s2);
    point->speed_rad_s = -gait->x[0] / unit_s;
    point->apex[0] = gait->x[0] / unit_s;
    point->apex[1] = gait->x[1];
    point->apex[2] = gait->x[2] / unit_s;
    for (int i = 0; i < 4; i++) {
        const double scale = i < 2 ? 1.0 : 1.0 / unit_s;
        point->strike[i] = result->strike[i] * scale;
        point->lift_off[i] = result->lift_off[i] * scale;
    }
    point->apex_to_strike_s = result->apex_to_strike_s * unit_s;
    point->double_support_s = result->double_support_s * unit_s;
    point->lift_off_to_apex_s = result->lift_off_to_apex_s * unit_s;
    point->step_length_m = result->step_length_m * l;
    point->inter_leg_rad = result->inter_leg_rad;
    point->clamped = result->clamped;
}

struct gait_walker gait_walker_of_paper(void)
{
    const struct walker_params paper = walker_paper_params();
    const struct gait_walker walker = {paper.hip_mass_kg, paper.leg_mass_kg, paper.leg_length_m,
                                       paper.ankle_stiffness_N_m, paper.gravity_m_s2};
    return walker;
}

static int walker_is_good(const struct gait_walker *walker)
{
    const struct walker_params params = {walker->hip_mass_kg, walker->leg_mass_kg,
                                         walker->leg_length_m, walker->ankle_stiffness_N_m,
                                         walker->gravity_m_s2};
    struct walker checked;
    return walker_init(&checked, &params) == WALKER_OK;
}

static int grid_is_good(double first, double last, int count, double length)
{
    return count >= 1 && first >= GAIT_CURVE_FLOOR * length && last <= 0.4 * length &&
           (count == 1 || last > first);
}

enum gait_curve_error gait_curve(const struct gait_walker *walker, double r0_min_m,
                                 double r0_step_m, int count, struct gait_point *points,
                                 int *reached)
{
    int unused;
    int *const good = reached != NULL ? reached : &unused;
    *good = 0;
    if (!walker_is_good(walker)) {
        return GAIT_CURVE_BAD_WALKER;
    }
    const double l = walker->leg_length_m;
    if (!grid_is_good(r0_min_m, r0_min_m + (count - 1) * r0_step_m, count, l)) {
        return GAIT_CURVE_BAD_GRID;
    }
    const struct gait_walker paper = gait_walker_of_paper();
    const double unit_s = __builtin_sqrt(paper.leg_length_m / paper.gravity_m_s2);
    struct gait gait = {
        {paper.leg_mass_kg, paper.ankle_stiffness_N_m / paper.gravity_m_s2, START_R0},
        {-0.406959924 * unit_s, -0.059568706, 1.756768065 * unit_s}};
    struct place target = {
        walker->leg_mass_kg / walker->hip_mass_kg,
        walker->ankle_stiffness_N_m * l / (walker->hip_mass_kg * walker->gravity_m_s2), START_R0};
    struct stride_result result;
    if (!follow(&gait, &target, WALKER_STEP, &result)) {
        return GAIT_CURVE_LOST;
    }
    for (int i = 0; i < count; i++) {
        points[i].r0_m = r0_min_m + i * r0_step_m;
        target.r0 = points[i].r0_m / l;
        const double way = target.r0 - gait.place.r0;
        const double distance = way < 0.0 ? -way : way;
        const double share = distance > R0_STEP ? R0_STEP / distance : 1.0;
        if (!follow(&gait, &target, share, &result)) {
            return GAIT_CURVE_LOST;
        }
        report(&gait, walker, &result, &points[i]);
        *good = i + 1;
    }
    return GAIT_CURVE_OK;
}

const char *gait_curve_error_name(enum gait_curve_error error)
{
    switch (error) {
    case GAIT_CURVE_OK:
        return "no error";
    case GAIT_CURVE_BAD_WALKER:
        return "a parameter of the walker is out of range";
    case GAIT_CURVE_BAD_GRID:
        return "r0 must be 0.002 to 0.4 leg lengths, rising, one point or more";
    case GAIT_CURVE_LOST:
        return "the branch of period-1 gaits could not be followed this far from the paper's walker";
    }
    return "unknown error";
}
