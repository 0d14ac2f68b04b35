#include "sim_host/batch/benchmark_phases.h"

#include "model/collision.h"
#include "model/trig.h"

double benchmark_event(enum benchmark_phase phase, const struct double_support *support,
                       const double *state)
{
    switch (phase) {
    case PHASE_TO_STRIKE:
        return state[STANCE_ANGLE] + state[SWING_ANGLE];
    case PHASE_PUSH_OFF:
        return support->spring_rest_m - state[ANKLE];
    default:
        return state[STANCE_ANGLE];
    }
}

static int solve_one(const struct benchmark_solver *solver, const struct reference_stride *row,
                     double tolerance, double next[3])
{
    const struct batch_walker *w = &row->walker;
    const struct walker_params params = {w->hip_mass_kg, w->leg_mass_kg, w->leg_length_m,
                                         w->ankle_stiffness_N_m, w->gravity_m_s2};
    double x[SINGLE_SUPPORT_STATES] = {0.0, row->apex[1], row->apex[0], row->apex[2]};
    if (walker_init(solver->walker, &params) != WALKER_OK ||
        !solver->run(solver->solver, PHASE_TO_STRIKE, tolerance, x)) {
        return 0;
    }
    const double difference = x[STANCE_ANGLE] - x[SWING_ANGLE];
    *solver->support = (struct double_support){
        .walker = solver->walker,
        .toe_distance_m = 2.0 * w->leg_length_m * real_sin(0.5 * real_abs(difference)),
        .spring_rest_m = row->push_m};
    double r[SINGLE_SUPPORT_STATES] = {
        0.0, collision_clamp_m_s(collision_ankle_rate_m_s(solver->walker, difference,
                                                          x[STANCE_RATE], x[SWING_RATE]),
                                 NULL)};
    if (!solver->run(solver->solver, PHASE_PUSH_OFF, tolerance, r)) {
        return 0;
    }
    const struct chain_angles angles = double_support_angles(solver->support, r[ANKLE]);
    x[STANCE_ANGLE] = angles.leading_rad;
    x[SWING_ANGLE] = angles.trailing_rad;
    x[STANCE_RATE] = angles.leading_slope * r[ANKLE_RATE];
    x[SWING_RATE] = angles.trailing_slope * r[ANKLE_RATE];
    if (!solver->run(solver->solver, PHASE_TO_APEX, tolerance, x)) {
        return 0;
    }
    next[0] = x[STANCE_RATE];
    next[1] = x[SWING_ANGLE];
    next[2] = x[SWING_RATE];
    return 1;
}

int benchmark_solve(void *solver, const struct benchmark_rows *rows, double tolerance,
                    double (*next)[3])
{
    for (int i = 0; i < rows->count; i++) {
        if (!solve_one(solver, &rows->row[i], tolerance, next[i])) {
            return 0;
        }
    }
    return 1;
}
