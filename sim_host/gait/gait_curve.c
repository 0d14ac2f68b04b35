#include "sim_host/gait/gait_curve.h"

#include <stddef.h>

#include "sim_host/gait/branch.h"

static void report(const struct branch_gait *gait, const struct gait_walker *walker,
                   struct gait_point *point)
{
    const struct stride_result *result = &gait->stride;
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
    return count >= 1 && first >= GAIT_CURVE_FLOOR * length &&
           last <= GAIT_CURVE_CEILING * length && (count == 1 || last > first);
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
    const double ratio = walker->leg_mass_kg / walker->hip_mass_kg;
    const double stiffness =
        walker->ankle_stiffness_N_m * l / (walker->hip_mass_kg * walker->gravity_m_s2);
    struct branch_gait gait = branch_start(BRANCH_LONG);
    if (!branch_follow(&gait, ratio, stiffness, gait.r0)) {
        return GAIT_CURVE_LOST;
    }
    for (int i = 0; i < count; i++) {
        points[i].r0_m = r0_min_m + i * r0_step_m;
        if (!branch_follow(&gait, ratio, stiffness, points[i].r0_m / l)) {
            return GAIT_CURVE_LOST;
        }
        report(&gait, walker, &points[i]);
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
