#include "sim_host/gait/branch.h"

#include <stddef.h>

#define LONGEST_STEP_RATIO 0.01
#define LONGEST_STEP_STIFFNESS 0.1 /* share of the stiffness itself */
#define LONGEST_STEP_R0 0.004
#define LARGEST_CORRECTION 0.02 /* of the prediction, in own units */
#define MOST_STEPS 200.0
#define SMALLEST_RATIO (1.0 / 4096.0)

struct branch_gait branch_start(enum branch branch)
{
    const struct walker_params paper = walker_paper_params();
    const double unit_s = real_sqrt(paper.leg_length_m / paper.gravity_m_s2);
    struct branch_gait gait = {.mass_ratio = paper.leg_mass_kg,
                               .stiffness = paper.ankle_stiffness_N_m / paper.gravity_m_s2,
                               .r0 = 0.05};
    static const double gaits[2][3] = {{-0.406959924, -0.059568706, 1.756768065},
                                       {-0.521217, -0.205854, 1.416979}};
    for (int i = 0; i < 3; i++) {
        gait.x[i] = gaits[branch][i] * (i == 1 ? 1.0 : unit_s);
    }
    return gait;
}

/* Newton from gait->x; 0 also when it ends far from there, on the other branch perhaps. */
static int solve(struct branch_gait *gait)
{
    struct problem problem = {.params = {1.0, gait->mass_ratio, 1.0, gait->stiffness, 1.0},
                              .r0_m = gait->r0,
                              .period = 1};
    struct orbit orbit = {.x = {gait->x[0], gait->x[1], gait->x[2]}};
    if (problem_prepare(&problem, &orbit) != ORBIT_OK || orbit_find(&problem, &orbit) != ORBIT_OK) {
        return 0;
    }
    for (int i = 0; i < 3; i++) {
        if (real_abs(orbit.x[i] - gait->x[i]) > LARGEST_CORRECTION) {
            return 0;
        }
        gait->x[i] = orbit.x[i];
    }
    gait->stride = orbit.first;
    return 1;
}

/* Share of the way that one step may take at most. */
static double longest_share(const struct branch_gait *from, double mass_ratio, double stiffness,
                            double r0)
{
    double steps = real_abs(mass_ratio - from->mass_ratio) / LONGEST_STEP_RATIO;
    const double softer = stiffness < from->stiffness ? stiffness : from->stiffness;
    const double k_steps =
        real_abs(stiffness - from->stiffness) / (LONGEST_STEP_STIFFNESS * softer);
    const double r0_steps = real_abs(r0 - from->r0) / LONGEST_STEP_R0;
    steps = k_steps > steps ? k_steps : steps;
    steps = r0_steps > steps ? r0_steps : steps;
    steps = steps < MOST_STEPS ? steps : MOST_STEPS; /* a walker too far off shall fail soon */
    return steps > 1.0 ? 1.0 / steps : 1.0;
}

int branch_follow(struct branch_gait *gait, double mass_ratio, double stiffness, double r0)
{
    const struct branch_gait from = *gait;
    const double longest = longest_share(&from, mass_ratio, stiffness, r0);
    double share = 0.0, step = longest, before_share = 0.0;
    double before[3] = {gait->x[0], gait->x[1], gait->x[2]};
    while (share < 1.0) {
        const double to = share + step < 1.0 - 1e-9 ? share + step : 1.0;
        struct branch_gait next = *gait;
        next.mass_ratio = from.mass_ratio + to * (mass_ratio - from.mass_ratio);
        next.stiffness = from.stiffness + to * (stiffness - from.stiffness);
        next.r0 = to == 1.0 ? r0 : from.r0 + to * (r0 - from.r0);
        for (int i = 0; i < 3 && share > before_share; i++) {
            next.x[i] += (gait->x[i] - before[i]) / (share - before_share) * (to - share);
        }
        if (!solve(&next)) {
            step *= 0.5;
            if (step < SMALLEST_RATIO * longest) {
                return 0;
            }
            continue;
        }
        for (int i = 0; i < 3; i++) {
            before[i] = gait->x[i];
        }
        before_share = share;
        share = to;
        *gait = next;
        step = 2.0 * step < longest ? 2.0 * step : longest;
    }
    return 1;
}

int branch_find(enum branch branch, const struct walker_params *params, double r0_m, double x[3],
                double *lost_r0_m)
{
    struct branch_gait gait = branch_start(branch);
    const double l = params->leg_length_m;
    const double ratio = params->leg_mass_kg / params->hip_mass_kg;
    const double stiffness =
        params->ankle_stiffness_N_m * l / (params->hip_mass_kg * params->gravity_m_s2);
    const double unit_s = real_sqrt(l / params->gravity_m_s2);
    const int found = branch_follow(&gait, ratio, stiffness, gait.r0) &&
                      branch_follow(&gait, ratio, stiffness, r0_m / l);
    if (lost_r0_m != NULL) {
        *lost_r0_m = gait.r0 * l;
    }
    for (int i = 0; i < 3; i++) {
        x[i] = gait.x[i] / (i == 1 ? 1.0 : unit_s);
    }
    return found;
}
