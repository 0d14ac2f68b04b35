#include "sim_host/gait/orbit.h"

#include <stddef.h>

#define MAX_ITERATIONS 30
#define TOLERANCE 1e-12

static const char *const parameter_names[PARAMETER_COUNT] = {"r0", "M", "m", "l", "k", "g", "kp"};

const char *parameter_name(enum parameter parameter)
{
    return (unsigned)parameter < PARAMETER_COUNT ? parameter_names[parameter] : NULL;
}

static double *parameter_field(struct problem *problem, enum parameter parameter)
{
    switch (parameter) {
    case PARAMETER_M:
        return &problem->params.hip_mass_kg;
    case PARAMETER_LEG_MASS:
        return &problem->params.leg_mass_kg;
    case PARAMETER_L:
        return &problem->params.leg_length_m;
    case PARAMETER_K:
        return &problem->params.ankle_stiffness_N_m;
    case PARAMETER_G:
        return &problem->params.gravity_m_s2;
    case PARAMETER_KP:
        return &problem->kp;
    case PARAMETER_R0:
    case PARAMETER_COUNT:
        break;
    }
    return &problem->r0_m;
}

double problem_get(const struct problem *problem, enum parameter parameter)
{
    struct problem copy = *problem;
    return *parameter_field(&copy, parameter);
}

void problem_set(struct problem *problem, enum parameter parameter, double value)
{
    *parameter_field(problem, parameter) = value;
}

double problem_push_off(const struct problem *problem, double stance_rate)
{
    return problem->kp == 0.0
               ? problem->r0_m
               : problem->r0_m + problem->kp * (problem->reference_x[0] - stance_rate);
}

enum stride_fault problem_stride(const struct problem *problem, const double x[3], double next[3],
                                 double *r0_m, struct stride_result *result)
{
    const struct apex from = {x[0], x[1], x[2]};
    *r0_m = problem_push_off(problem, x[0]);
    if (stride(&problem->walker, &problem->settings, &from, *r0_m, result) != STRIDE_OK) {
        return result->fault;
    }
    next[0] = result->next.stance_rate_rad_s;
    next[1] = result->next.swing_angle_rad;
    next[2] = result->next.swing_rate_rad_s;
    return STRIDE_OK;
}

/* d(next)/d(parameter) of one stride with given r0 of its own. k and m come from the variational
 * equations; M, l and g follow from the model's homogeneity: scaling all masses and k, or lengths
 * with k ~ 1/l and rates ~ 1/sqrt(l), or g with k ~ g and rates ~ sqrt(g), maps walks on walks. */
static void by_parameters(const struct problem *problem, const struct stride_derivative *d,
                          const double x[3], const double next[3], double r0,
                          double by[3][PARAMETER_COUNT])
{
    const struct walker_params *p = &problem->params;
    for (int i = 0; i < 3; i++) {
        const double is_rate = i == 1 ? 0.0 : 1.0;
        const double half_rates =
            0.5 * (d->next[i][0] * x[0] + d->next[i][2] * x[2] - is_rate * next[i]);
        const double by_k = d->next[i][BY_STIFFNESS], by_r0 = d->next[i][BY_SPRING_REST];
        by[i][PARAMETER_R0] = by_r0;
        by[i][PARAMETER_K] = by_k;
        by[i][PARAMETER_LEG_MASS] = d->next[i][BY_LEG_MASS];
        by[i][PARAMETER_M] =
            -(p->leg_mass_kg * d->next[i][BY_LEG_MASS] + p->ankle_stiffness_N_m * by_k) /
            p->hip_mass_kg;
        by[i][PARAMETER_L] =
            (half_rates - r0 * by_r0 + p->ankle_stiffness_N_m * by_k) / p->leg_length_m;
        by[i][PARAMETER_G] = (-half_rates - p->ankle_stiffness_N_m * by_k) / p->gravity_m_s2;
        by[i][PARAMETER_KP] = 0.0;
    }
}

/* Adds what the law does: r0 of the stride follows the apex speed, the reference and the gain. */
static void close_loop(const struct problem *problem, const double x[3], double by_x[3][3],
                       double by[3][PARAMETER_COUNT])
{
    for (int i = 0; i < 3; i++) {
        const double by_r0 = by[i][PARAMETER_R0];
        by_x[i][0] -= problem->kp * by_r0;
        for (int q = 0; q < PARAMETER_COUNT; q++) {
            by[i][q] -= problem->kp * problem->reference_speed_by[q] * by_r0;
        }
        by[i][PARAMETER_KP] += by_r0 * (problem->reference_x[0] - x[0]);
    }
}

/* Derivatives after one more stride: chain rule. */
static void chain(struct orbit *orbit, double by_x[3][3], double by[3][PARAMETER_COUNT])
{
    double total[3][PARAMETER_COUNT];
    for (int i = 0; i < 3; i++) {
        for (int q = 0; q < PARAMETER_COUNT; q++) {
            total[i][q] = by[i][q];
            for (int j = 0; j < 3; j++) {
                total[i][q] += by_x[i][j] * orbit->by_parameter[j][q];
            }
        }
    }
    for (int i = 0; i < 3; i++) {
        for (int q = 0; q < PARAMETER_COUNT; q++) {
            orbit->by_parameter[i][q] = total[i][q];
        }
    }
    linear_multiply3((const double(*)[3])by_x, (const double(*)[3])orbit->by_x, orbit->by_x);
}

static void start_evaluation(struct orbit *orbit)
{
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            orbit->by_x[i][j] = i == j ? 1.0 : 0.0;
        }
        for (int q = 0; q < PARAMETER_COUNT; q++) {
            orbit->by_parameter[i][q] = 0.0;
        }
        orbit->next[i] = orbit->x[i];
    }
    orbit->distance_m = orbit->duration_s = orbit->spring_energy_J = 0.0;
    orbit->clamped_strides = 0;
    orbit->fault = STRIDE_OK;
    orbit->fault_step = 0;
    orbit->walker_error = WALKER_OK;
    orbit->residual = 0.0;
}

enum orbit_status orbit_evaluate(const struct problem *problem, int differentiate,
                                 struct orbit *orbit)
{
    start_evaluation(orbit);
    for (int step = 0; step < problem->period; step++) {
        const double x[3] = {orbit->next[0], orbit->next[1], orbit->next[2]};
        const struct apex from = {x[0], x[1], x[2]};
        const double r0 = problem_push_off(problem, x[0]);
        struct stride_result result;
        struct stride_derivative derivative;
        const enum stride_fault fault =
            differentiate ? stride_differentiate(&problem->walker, &problem->settings, &from, r0,
                                                 &result, &derivative)
                          : stride(&problem->walker, &problem->settings, &from, r0, &result);
        if (step == 0) {
            orbit->first = result;
        }
        if (fault != STRIDE_OK) {
            orbit->fault = fault;
            orbit->fault_step = step;
            return ORBIT_FAULT;
        }
        orbit->next[0] = result.next.stance_rate_rad_s;
        orbit->next[1] = result.next.swing_angle_rad;
        orbit->next[2] = result.next.swing_rate_rad_s;
        orbit->distance_m += result.step_length_m;
        orbit->duration_s +=
            result.apex_to_strike_s + result.double_support_s + result.lift_off_to_apex_s;
        orbit->spring_energy_J += 0.5 * problem->params.ankle_stiffness_N_m * r0 * r0;
        orbit->clamped_strides += result.clamped;
        if (differentiate) {
            double by_x[3][3], by[3][PARAMETER_COUNT];
            for (int i = 0; i < 9; i++) {
                by_x[i / 3][i % 3] = derivative.next[i / 3][i % 3];
            }
            by_parameters(problem, &derivative, x, orbit->next, r0, by);
            close_loop(problem, x, by_x, by);
            chain(orbit, by_x, by);
        }
    }
    for (int i = 0; i < 3; i++) {
        const double unit = i == 1 ? 1.0 : problem->walker.time_unit_s;
        const double off = real_abs(orbit->next[i] - orbit->x[i]) * unit;
        orbit->residual = off > orbit->residual ? off : orbit->residual;
    }
    return ORBIT_OK;
}

/* The Newton correction: (I - by_x) dx = next - x. */
static int correction(const struct orbit *orbit, double dx[3])
{
    double a[LINEAR_MAX][LINEAR_MAX] = {{0.0}}, b[3];
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            a[i][j] = (i == j ? 1.0 : 0.0) - orbit->by_x[i][j];
        }
        b[i] = orbit->next[i] - orbit->x[i];
    }
    return linear_solve(3, (const double(*)[LINEAR_MAX])a, b, dx);
}

enum orbit_status orbit_find(const struct problem *problem, struct orbit *orbit)
{
    for (int i = 0; i < MAX_ITERATIONS; i++) {
        double dx[3];
        const enum orbit_status status = orbit_evaluate(problem, 1, orbit);
        if (status != ORBIT_OK) {
            return status;
        }
        if (orbit->residual < TOLERANCE) {
            return ORBIT_OK;
        }
        if (!correction(orbit, dx)) {
            return ORBIT_NO_CONVERGENCE;
        }
        for (int k = 0; k < 3; k++) {
            orbit->x[k] += dx[k];
        }
    }
    return ORBIT_NO_CONVERGENCE;
}

int orbit_repeats_earlier(const struct problem *problem, const struct orbit *orbit)
{
    struct orbit part = *orbit;
    struct problem shorter = *problem;
    for (int divisor = 1; divisor <= problem->period / 2; divisor++) {
        shorter.period = divisor;
        if (problem->period % divisor == 0 && orbit_evaluate(&shorter, 0, &part) == ORBIT_OK &&
            part.residual < 1e-7) {
            return 1;
        }
    }
    return 0;
}

enum orbit_status problem_prepare(struct problem *problem, struct orbit *scratch)
{
    scratch->walker_error = walker_init(&problem->walker, &problem->params);
    if (scratch->walker_error != WALKER_OK) {
        return ORBIT_BAD_WALKER;
    }
    problem->settings = stride_settings_accurate(&problem->walker);
    for (int q = 0; q < PARAMETER_COUNT; q++) {
        problem->reference_speed_by[q] = 0.0;
    }
    if (problem->kp == 0.0) {
        return ORBIT_OK;
    }
    struct problem open = *problem;
    struct orbit gait = {
        .x = {problem->reference_x[0], problem->reference_x[1], problem->reference_x[2]}};
    open.kp = 0.0;
    open.period = 1;
    if (orbit_find(&open, &gait) != ORBIT_OK) {
        return ORBIT_NO_REFERENCE;
    }
    for (int i = 0; i < 3; i++) {
        problem->reference_x[i] = gait.x[i];
    }
    /* v* = -x0 of the gait: (I - by_x) dx/dp = by_parameter. */
    for (int q = 0; q < PARAMETER_COUNT; q++) {
        double dx[3];
        for (int i = 0; i < 3; i++) {
            gait.next[i] = gait.x[i] + gait.by_parameter[i][q];
        }
        if (!correction(&gait, dx)) {
            return ORBIT_NO_REFERENCE;
        }
        problem->reference_speed_by[q] = -dx[0];
    }
    return ORBIT_OK;
}

const char *orbit_status_name(enum orbit_status status)
{
    switch (status) {
    case ORBIT_OK:
        return "found";
    case ORBIT_FAULT:
        return "the walker falls on the way";
    case ORBIT_NO_CONVERGENCE:
        return "Newton's method does not settle";
    case ORBIT_BAD_WALKER:
        return "a parameter of the walker is out of range";
    case ORBIT_NO_REFERENCE:
        return "the law has no reference gait here (the long branch ends)";
    }
    return "unknown status";
}
