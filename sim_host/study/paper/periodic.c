#include "sim_host/study/paper/periodic.h"

#include <stddef.h>

#include "sim_host/gait/branch.h"
#include "sim_host/study/paper/cascade.h"

#define SETTLING_STRIDES 2000
#define RECURRENCES 600
#define RECURRENCE_TRIES 12

int periodic_walk(const struct problem *problem, int strides, double x[3])
{
    for (int i = 0; i < strides; i++) {
        double next[3], r0;
        struct stride_result result;
        if (problem_stride(problem, x, next, &r0, &result) != STRIDE_OK) {
            return 0;
        }
        for (int k = 0; k < 3; k++) {
            x[k] = next[k];
        }
    }
    return 1;
}

void periodic_push_off_gait(const struct problem *problem, double size, double x[3])
{
    struct orbit orbit = {.x = {x[0], x[1], x[2]}};
    struct problem single = *problem;
    double vector[3] = {0.0, 0.0, 0.0};
    single.period = 1;
    if (orbit_evaluate(&single, 1, &orbit) == ORBIT_OK) {
        struct eigenvalue values[3];
        linear_eigenvalues3((const double(*)[3])orbit.by_x, values);
        linear_eigenvector3((const double(*)[3])orbit.by_x, values[0].re, vector);
    }
    for (int i = 0; i < 3; i++) {
        x[i] += size * vector[i];
    }
}

static int is_wanted(const struct problem *problem, struct orbit *orbit)
{
    return orbit_find(problem, orbit) == ORBIT_OK && !orbit_repeats_earlier(problem, orbit);
}

/* Tries Newton from the states of a long walk that nearly return after `period` strides, nearest first. */
static int from_near_returns(const struct problem *problem, const double start[3],
                             struct orbit *orbit)
{
    static const double sizes[] = {1e-4, -1e-4, 1e-2, -1e-2};
    double states[RECURRENCES][3];
    struct problem single = *problem;
    single.period = 1;
    for (unsigned s = 0; s < sizeof sizes / sizeof sizes[0]; s++) {
        double x[3] = {start[0], start[1], start[2]};
        periodic_push_off_gait(&single, sizes[s], x);
        if (!periodic_walk(problem, SETTLING_STRIDES, x)) {
            continue;
        }
        for (int i = 0; i < RECURRENCES; i++) {
            for (int k = 0; k < 3; k++) {
                states[i][k] = x[k];
            }
            if (!periodic_walk(problem, 1, x)) {
                return 0;
            }
        }
        double floor = -1.0;
        for (int attempt = 0; attempt < RECURRENCE_TRIES; attempt++) {
            int best = -1;
            double nearest = 1e300;
            for (int i = 0; i + problem->period < RECURRENCES; i++) {
                const double off = real_abs(states[i + problem->period][0] - states[i][0]) +
                                   real_abs(states[i + problem->period][1] - states[i][1]);
                if (off > floor && off < nearest) {
                    nearest = off;
                    best = i;
                }
            }
            if (best < 0) {
                break;
            }
            floor = nearest;
            for (int k = 0; k < 3; k++) {
                orbit->x[k] = states[best][k];
            }
            if (is_wanted(problem, orbit)) {
                return 1;
            }
        }
    }
    return 0;
}

/* The walk born in the cascade that starts at r0 = from, followed to the problem's r0. */
static int from_cascade(const struct problem *problem, double from_m, struct orbit *orbit)
{
    struct doubling doublings[CASCADE_MAX];
    struct continuation_report report;
    struct problem start = *problem;
    struct orbit scratch;
    double x[3];
    int wanted = 0;
    while (wanted < CASCADE_MAX && (1 << wanted) < problem->period) {
        wanted++;
    }
    start.period = 1;
    start.r0_m = from_m;
    if ((1 << wanted) != problem->period || from_m == problem->r0_m ||
        !branch_find(BRANCH_LONG, &start.params, from_m, x, NULL)) {
        return 0;
    }
    for (int i = 0; i < 3; i++) {
        start.reference_x[i] = x[i];
    }
    if (problem_prepare(&start, &scratch) != ORBIT_OK ||
        cascade_find(&start, PARAMETER_R0, from_m, problem->r0_m, x, wanted, doublings, &report,
                     NULL, NULL) < wanted) {
        return 0;
    }
    return cascade_double_to(&start, PARAMETER_R0, &doublings[wanted - 1], problem->r0_m,
                             orbit->x) &&
           is_wanted(problem, orbit);
}

int periodic_find(struct problem *problem, const double x[3], int period, struct orbit *orbit)
{
    const double l = problem->params.leg_length_m;
    problem->period = period;
    if (period == 1) {
        for (int i = 0; i < 3; i++) {
            orbit->x[i] = x[i];
        }
        return orbit_find(problem, orbit) == ORBIT_OK;
    }
    return (period < RECURRENCES && from_near_returns(problem, x, orbit)) ||
           from_cascade(problem, 0.05 * l, orbit) || from_cascade(problem, 0.3 * l, orbit);
}
