#include "sim_host/study/paper/cascade.h"

#include <stddef.h>

#define LARGEST_BIRTH 4e-3  /* amplitude of the first doubled walk, scaled units */
#define MOST_HALVINGS 15    /* down to 1e-7 */
#define BIRTH_RESIDUAL 2e-3 /* of the amplitude: the doubled walk is that near to being one */

struct search {
    struct branch_point found;
    int has_found;
};

static int until_doubling(void *context, const struct branch_point *point)
{
    struct search *search = context;
    if (point->event == EVENT_DOUBLING) {
        search->found = *point;
        search->has_found = 1;
        return 0;
    }
    return 1;
}

static int keep_last(void *context, const struct branch_point *point)
{
    struct search *search = context;
    search->found = *point;
    return 1;
}

static struct continuation setup(const struct problem *problem, enum parameter over, double from,
                                 double to, double step)
{
    const struct continuation continuation = {.problem = *problem,
                                              .over = over,
                                              .from = from,
                                              .to = to,
                                              .slack = 1e-6 * real_abs(to - from),
                                              .first_step = step,
                                              .longest_step = 16.0 * step,
                                              .most_points = 4000,
                                              .locate_events = 1};
    return continuation;
}

/* Turns the walk to the stride where the doubled one parts from it most: there the amplitude is largest
 * and Newton has most room. x and the eigenvector of -1 go in and out, both in scaled units' sense. */
static int turn_to_widest(const struct problem *problem, double x[3], double vector[3])
{
    struct problem single = *problem;
    struct orbit step = {.x = {x[0], x[1], x[2]}};
    double w[3] = {vector[0], vector[1], vector[2]}, widest = 0.0;
    single.period = 1;
    for (int k = 0; k < problem->period; k++) {
        const double unit_s = problem->walker.time_unit_s;
        const double size = real_sqrt((w[0] * w[0] + w[2] * w[2]) * unit_s * unit_s + w[1] * w[1]);
        if (size > widest) {
            widest = size;
            for (int i = 0; i < 3; i++) {
                x[i] = step.x[i];
                vector[i] = w[i] / size;
            }
        }
        if (orbit_evaluate(&single, 1, &step) != ORBIT_OK) {
            return 0;
        }
        const double before[3] = {w[0], w[1], w[2]};
        for (int i = 0; i < 3; i++) {
            w[i] = step.by_x[i][0] * before[0] + step.by_x[i][1] * before[1] +
                   step.by_x[i][2] * before[2];
        }
        for (int i = 0; i < 3; i++) {
            step.x[i] = step.next[i];
        }
    }
    return 1;
}

/* Finds how far along the vector the doubled walk may be started. */
static double birth_amplitude(const struct problem *doubled, const double x[3],
                              const double vector[3])
{
    double size = LARGEST_BIRTH;
    for (int halvings = 0; halvings < MOST_HALVINGS; halvings++) {
        struct orbit orbit;
        for (int i = 0; i < 3; i++) {
            orbit.x[i] = x[i] + size * vector[i];
        }
        if (orbit_evaluate(doubled, 0, &orbit) == ORBIT_OK &&
            orbit.residual < BIRTH_RESIDUAL * size) {
            break;
        }
        size *= 0.5;
    }
    return size;
}

/* Follows the doubled walk from its birth, along the eigenvector of -1, towards `to`. */
static struct continuation_report follow_doubled(const struct problem *problem, enum parameter over,
                                                 const struct doubling *doubling, double to,
                                                 branch_visitor *visit, struct search *search)
{
    struct problem here = *problem;
    struct orbit orbit = {.x = {doubling->x[0], doubling->x[1], doubling->x[2]}};
    struct continuation_report report = {END_LOST, ORBIT_FAULT, STRIDE_OK, doubling->parameter, 0};
    double x[3] = {doubling->x[0], doubling->x[1], doubling->x[2]}, vector[3];
    problem_set(&here, over, doubling->parameter);
    here.period = doubling->new_period / 2;
    if (problem_prepare(&here, &orbit) != ORBIT_OK ||
        orbit_evaluate(&here, 1, &orbit) != ORBIT_OK) {
        return report;
    }
    linear_eigenvector3((const double(*)[3])orbit.by_x, -1.0, vector);
    if (!turn_to_widest(&here, x, vector)) {
        return report;
    }
    here.period = doubling->new_period;
    const double size = birth_amplitude(&here, x, vector);
    double tangent[LINEAR_MAX] = {0.0};
    for (int i = 0; i < 3; i++) {
        x[i] += size * vector[i];
        tangent[i] = vector[i] * (i == 1 ? 1.0 : here.walker.time_unit_s);
    }
    const struct continuation continuation =
        setup(&here, over, doubling->parameter, to, 0.5 * size);
    return continuation_follow(&continuation, x, tangent, visit, search);
}

int cascade_find(const struct problem *problem, enum parameter over, double from, double to,
                 const double x[3], int most, struct doubling *doublings,
                 struct continuation_report *report, cascade_visitor *visit, void *context)
{
    struct search search = {.has_found = 0};
    const struct continuation first = setup(problem, over, from, to, 2e-3);
    *report = continuation_follow(&first, x, NULL, until_doubling, &search);
    int count = 0;
    while (search.has_found) {
        struct doubling *d = &doublings[count];
        d->parameter = search.found.parameter;
        d->new_period = problem->period << (count + 1);
        for (int i = 0; i < 3; i++) {
            d->x[i] = search.found.orbit.x[i];
        }
        d->residual = search.found.orbit.residual;
        d->ratio = 0.0;
        if (count >= 2) {
            d->ratio = (d[-1].parameter - d[-2].parameter) / (d->parameter - d[-1].parameter);
        }
        if (visit != NULL) {
            visit(context, d);
        }
        count++;
        if (count >= most || d->new_period > ORBIT_MAX_PERIOD) {
            break;
        }
        search.has_found = 0;
        *report = follow_doubled(problem, over, d, to, until_doubling, &search);
    }
    return count;
}

int cascade_double_to(const struct problem *problem, enum parameter over,
                      const struct doubling *doubling, double to, double x[3])
{
    struct search search = {.has_found = 0};
    const struct continuation_report report =
        follow_doubled(problem, over, doubling, to, keep_last, &search);
    for (int i = 0; i < 3; i++) {
        x[i] = search.found.orbit.x[i];
    }
    return report.end == END_REACHED;
}
