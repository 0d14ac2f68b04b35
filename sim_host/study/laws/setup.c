#include "sim_host/study/laws/setup.h"

int law_setup_init(struct law_setup *setup, const struct subject *subject, enum law_mode law,
                   char *message)
{
    if (subject_control_params(subject, &setup->params, message) != 0) {
        return -1;
    }
    setup->params.law = (real)law;
    setup->params.speed_ramp_rad_s = REAL(1.0);
    setup->params.terrain_speed_rad_s =
        (real)(LAWS_TERRAIN_SPEED * __builtin_sqrt(subject->person.gravity_m_s2 / 9.80665 /
                                                   subject->person.leg_length_m));
    setup->params.r0_change_max_m = setup->params.r0_max_m;
    setup->params.r0_change_ceiling_m = setup->params.r0_max_m;
    setup->truth = subject_gait_walker(subject);
    setup->accuracy = LAWS_COARSE;
    return 0;
}

double law_setup_gait(const struct law_setup *setup, double speed_rad_s, double apex[3])
{
    struct gait_branch_point gait;
    apex[0] = -(double)gait_branch_at(setup->params.branch, (real)speed_rad_s, &gait);
    apex[1] = (double)gait.swing_angle_rad;
    apex[2] = (double)gait.swing_rate_rad_s;
    return (double)gait.r0_m;
}

struct batch_walker laws_batch_walker(const struct gait_walker *walker)
{
    return (struct batch_walker){walker->hip_mass_kg, walker->leg_mass_kg, walker->leg_length_m,
                                 walker->ankle_stiffness_N_m, walker->gravity_m_s2};
}

void laws_walk_start(const struct law_setup *setup, struct laws_walk *walk, const double apex[3],
                     double r0_m, double speed_rad_s)
{
    step_law_init(&walk->law, &setup->params);
    walk->law.r0_m = (real)r0_m;
    walk->law.command_rad_s = (real)speed_rad_s;
    for (int i = 0; i < 3; i++) {
        walk->apex[i] = apex[i];
    }
    walk->r0_m = r0_m;
    walk->steps = 0;
}

double laws_walk_answer(const struct law_setup *setup, struct laws_walk *walk, double desired_rad_s,
                        const double seen[3])
{
    const struct apex_estimate estimate = {(real)seen[0], (real)seen[1], (real)seen[2], REAL(1.0)};
    (void)step_law_update(&walk->law, &setup->params, &estimate, (real)desired_rad_s);
    while (!walk->law.is_final) {
        (void)step_law_work(&walk->law, &setup->params);
    }
    walk->r0_m = (double)walk->law.r0_m;
    walk->steps++;
    return walk->r0_m;
}

int laws_walk_step(const struct law_setup *setup, struct laws_walk *walk, double desired_rad_s,
                   const double seen[3], double slope_rad, double rise)
{
    (void)laws_walk_answer(setup, walk, desired_rad_s, seen != NULL ? seen : walk->apex);
    (void)laws_stride(&setup->truth, setup->accuracy, walk->apex, walk->r0_m, slope_rad, rise,
                      &walk->stride);
    for (int i = 0; i < 3; i++) {
        walk->apex[i] = walk->stride.next[i];
    }
    return walk->stride.fault;
}
