#include "sim_host/study/paper/continuation.h"

#include <stddef.h>

#define UNKNOWNS 4
#define MAX_CORRECTIONS 8
#define CORRECTION_TOLERANCE 1e-12
#define SMALLEST_STEP 1e-9
#define LARGEST_TURN 0.96 /* cosine between tangents of neighbouring points */
#define LOCATE_TOLERANCE 1e-11

struct walk {
    struct continuation setup;
    double scale[UNKNOWNS]; /* unknown = scale * scaled unknown */
    enum orbit_status status;
    enum stride_fault fault;
};

static double dot(const double *a, const double *b)
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
}

static void set_scale(struct walk *walk)
{
    const double unit_s = walk->setup.problem.walker.time_unit_s;
    walk->scale[0] = walk->scale[2] = 1.0 / unit_s;
    walk->scale[1] = 1.0;
    walk->scale[3] = real_abs(walk->setup.to - walk->setup.from);
}

/* Evaluates the walk at scaled unknowns u. */
static int evaluate(struct walk *walk, const double u[UNKNOWNS], struct branch_point *point)
{
    struct problem *problem = &walk->setup.problem;
    point->parameter = u[3] * walk->scale[3];
    problem_set(problem, walk->setup.over, point->parameter);
    walk->status = problem_prepare(problem, &point->orbit);
    if (walk->status != ORBIT_OK) {
        return 0;
    }
    for (int i = 0; i < 3; i++) {
        point->orbit.x[i] = u[i] * walk->scale[i];
    }
    walk->status = orbit_evaluate(problem, 1, &point->orbit);
    walk->fault = point->orbit.fault;
    return walk->status == ORBIT_OK;
}

/* Rows of d(next - x)/du, scaled to the state's units. */
static void periodicity_rows(const struct walk *walk, const struct orbit *orbit,
                             double a[LINEAR_MAX][LINEAR_MAX])
{
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            a[i][j] = (orbit->by_x[i][j] - (i == j ? 1.0 : 0.0)) * walk->scale[j] / walk->scale[i];
        }
        a[i][3] = orbit->by_parameter[i][walk->setup.over] * walk->scale[3] / walk->scale[i];
    }
}

/* Newton on (periodicity, tangent . (u - predicted) = 0). */
static int correct(struct walk *walk, const double tangent[UNKNOWNS], double u[UNKNOWNS],
                   struct branch_point *point, int *corrections)
{
    double predicted[UNKNOWNS];
    for (int i = 0; i < UNKNOWNS; i++) {
        predicted[i] = u[i];
    }
    for (*corrections = 0; *corrections < MAX_CORRECTIONS; ++*corrections) {
        double a[LINEAR_MAX][LINEAR_MAX] = {{0.0}}, b[UNKNOWNS], du[UNKNOWNS], along = 0.0;
        if (!evaluate(walk, u, point)) {
            return 0;
        }
        periodicity_rows(walk, &point->orbit, a);
        for (int i = 0; i < UNKNOWNS; i++) {
            a[3][i] = tangent[i];
            along += tangent[i] * (u[i] - predicted[i]);
        }
        for (int i = 0; i < 3; i++) {
            b[i] = (point->orbit.x[i] - point->orbit.next[i]) / walk->scale[i];
        }
        b[3] = -along;
        if (point->orbit.residual < CORRECTION_TOLERANCE && real_abs(along) < 1e-10) {
            return 1;
        }
        if (!linear_solve(UNKNOWNS, (const double(*)[LINEAR_MAX])a, b, du)) {
            break;
        }
        for (int i = 0; i < UNKNOWNS; i++) {
            u[i] += du[i];
        }
    }
    walk->status = ORBIT_NO_CONVERGENCE;
    return 0;
}

/* The unit tangent, pointing like `like`; and all that is derived from the point. */
static int finish(const struct walk *walk, const double like[UNKNOWNS], struct branch_point *point)
{
    double a[LINEAR_MAX][LINEAR_MAX] = {{0.0}}, b[UNKNOWNS] = {0.0, 0.0, 0.0, 1.0};
    const double(*J)[3] = (const double(*)[3])point->orbit.by_x;
    periodicity_rows(walk, &point->orbit, a);
    for (int i = 0; i < UNKNOWNS; i++) {
        a[3][i] = like[i];
    }
    if (!linear_solve(UNKNOWNS, (const double(*)[LINEAR_MAX])a, b, point->tangent)) {
        return 0;
    }
    const double size = real_sqrt(dot(point->tangent, point->tangent));
    for (int i = 0; i < UNKNOWNS; i++) {
        point->tangent[i] /= size;
    }
    linear_eigenvalues3(J, point->values);
    point->fold_test = point->tangent[3];
    point->doubling_test = linear_determinant3(J, 1.0);
    point->event = EVENT_NONE;
    return 1;
}

static void scaled_unknowns(const struct walk *walk, const struct branch_point *point,
                            double u[UNKNOWNS])
{
    for (int i = 0; i < 3; i++) {
        u[i] = point->orbit.x[i] / walk->scale[i];
    }
    u[3] = point->parameter / walk->scale[3];
}

/* A point at arclength `step` from `from` along its tangent. */
static int step_along(struct walk *walk, const struct branch_point *from, double step,
                      struct branch_point *to, int *corrections)
{
    double u[UNKNOWNS];
    scaled_unknowns(walk, from, u);
    for (int i = 0; i < UNKNOWNS; i++) {
        u[i] += step * from->tangent[i];
    }
    return correct(walk, from->tangent, u, to, corrections) && finish(walk, from->tangent, to);
}

static double test_value(const struct branch_point *point, enum continuation_event event)
{
    return event == EVENT_FOLD ? point->fold_test : point->doubling_test;
}

/* The event between a and the point `length` further on, where the test has the other sign. Regula falsi
 * (Illinois), on the step from a. */
static int locate(struct walk *walk, const struct branch_point *a, const struct branch_point *b,
                  double length, enum continuation_event event, struct branch_point *found)
{
    double low = 0.0, high = length;
    double low_value = test_value(a, event), high_value = test_value(b, event);
    int last_side = 0;
    for (int i = 0; i < 60; i++) {
        int unused;
        const double step = (low * high_value - high * low_value) / (high_value - low_value);
        if (!step_along(walk, a, step, found, &unused)) {
            return 0;
        }
        const double value = test_value(found, event);
        const int side = (value < 0.0) == (low_value < 0.0) ? -1 : 1;
        *(side < 0 ? &low : &high) = step;
        *(side < 0 ? &low_value : &high_value) = value;
        if (side == last_side) {
            *(side < 0 ? &high_value : &low_value) *= 0.5;
        }
        last_side = side;
        if (real_abs(value) < LOCATE_TOLERANCE || high - low < 1e-14 * length) {
            break;
        }
    }
    found->event = event;
    return 1;
}

/* The point exactly at parameter `to`, from one just short of it. */
static int land_at(struct walk *walk, const struct branch_point *near, double to,
                   struct branch_point *landed)
{
    const double fixed[UNKNOWNS] = {0.0, 0.0, 0.0, 1.0};
    double u[UNKNOWNS];
    int unused;
    scaled_unknowns(walk, near, u);
    const double step = (to / walk->scale[3] - u[3]) / near->tangent[3];
    for (int i = 0; i < UNKNOWNS; i++) {
        u[i] += step * near->tangent[i];
    }
    u[3] = to / walk->scale[3];
    return correct(walk, fixed, u, landed, &unused) && finish(walk, near->tangent, landed);
}

/* Tells of events between two points, in order of their place. 0: the visitor wants to stop. */
static int tell_events(struct walk *walk, const struct branch_point *a,
                       const struct branch_point *b, double length, branch_visitor *visit,
                       void *context)
{
    for (int e = EVENT_FOLD; e <= EVENT_DOUBLING; e++) {
        struct branch_point found;
        const enum continuation_event event = (enum continuation_event)e;
        if (walk->setup.locate_events &&
            (test_value(a, event) < 0.0) != (test_value(b, event) < 0.0) &&
            locate(walk, a, b, length, event, &found) && !visit(context, &found)) {
            return 0;
        }
    }
    return 1;
}

static int start(struct walk *walk, const double start_x[3], const double *start_tangent,
                 struct branch_point *point)
{
    const double fixed[UNKNOWNS] = {0.0, 0.0, 0.0, 1.0};
    const double towards[UNKNOWNS] = {0.0, 0.0, 0.0,
                                      walk->setup.to > walk->setup.from ? 1.0 : -1.0};
    double u[UNKNOWNS];
    int unused;
    set_scale(walk);
    for (int i = 0; i < 3; i++) {
        u[i] = start_x[i] / walk->scale[i];
    }
    u[3] = walk->setup.from / walk->scale[3];
    return correct(walk, start_tangent != NULL ? start_tangent : fixed, u, point, &unused) &&
           finish(walk, start_tangent != NULL ? start_tangent : towards, point);
}

struct continuation_report continuation_follow(const struct continuation *continuation,
                                               const double start_x[3], const double *start_tangent,
                                               branch_visitor *visit, void *context)
{
    struct walk walk = {.setup = *continuation};
    struct continuation_report report = {END_LOST, ORBIT_OK, STRIDE_OK, continuation->from, 0};
    struct branch_point here, next;
    const double sign = continuation->to > continuation->from ? 1.0 : -1.0;
    double step = continuation->first_step;
    if (!start(&walk, start_x, start_tangent, &here)) {
        report.last_status = walk.status;
        report.last_fault = walk.fault;
        return report;
    }
    for (report.points = 1;; report.points++) {
        int corrections;
        report.parameter = here.parameter;
        if (!visit(context, &here)) {
            report.end = END_STOPPED;
            return report;
        }
        if (report.points >= continuation->most_points) {
            report.end = END_TOO_LONG;
            return report;
        }
        while (!step_along(&walk, &here, step, &next, &corrections) ||
               dot(here.tangent, next.tangent) < LARGEST_TURN) {
            report.last_status = walk.status;
            report.last_fault = walk.fault;
            step *= 0.5;
            if (step < SMALLEST_STEP) {
                return report;
            }
        }
        const int beyond = sign * (next.parameter - continuation->to) >= 0.0;
        const int back = sign * (next.parameter - continuation->from) < -continuation->slack;
        if (beyond || back) {
            const struct branch_point outside = next;
            const double end = beyond ? continuation->to : continuation->from;
            if (!land_at(&walk, &here, end, &next)) {
                next = outside;
            }
            double u[UNKNOWNS], v[UNKNOWNS], length = 0.0;
            scaled_unknowns(&walk, &here, u);
            scaled_unknowns(&walk, &next, v);
            for (int i = 0; i < UNKNOWNS; i++) {
                length += (v[i] - u[i]) * here.tangent[i];
            }
            step = length;
        }
        if (!tell_events(&walk, &here, &next, step, visit, context)) {
            report.end = END_STOPPED;
            return report;
        }
        here = next;
        if (beyond || back) {
            report.end =
                visit(context, &here) ? (beyond ? END_REACHED : END_RETURNED) : END_STOPPED;
            report.parameter = here.parameter;
            report.points++;
            return report;
        }
        if (corrections <= 3) {
            step =
                1.5 * step < continuation->longest_step ? 1.5 * step : continuation->longest_step;
        }
    }
}

const char *continuation_end_name(enum continuation_end end)
{
    switch (end) {
    case END_REACHED:
        return "reached the end of the range";
    case END_RETURNED:
        return "turned at a fold and came back to the start of the range";
    case END_STOPPED:
        return "stopped";
    case END_LOST:
        return "the branch could not be followed further";
    case END_TOO_LONG:
        return "the limit on the number of points was reached";
    }
    return "unknown end";
}
