/* Periodic walks of the return map, with or without the step law: evaluation, derivative, Newton.
 *
 * A problem is a walker, a push-off r0, the law's gain and a period. With gain kp the push-off of each stride is
 * r0 + kp (v - v*). Here v is its apex speed, and v* = f(r0) the speed of the long branch's gait at r0 (paper
 * eq. 16 in forward speed). So the long branch's gaits stay where they are.
 */
#ifndef SIM_HOST_GAIT_ORBIT_H
#define SIM_HOST_GAIT_ORBIT_H

#include "sim_host/gait/linear.h"
#include "sim_host/gait/stride_derivative.h"

#define ORBIT_MAX_PERIOD 1024

/* What may be varied. */
enum parameter {
    PARAMETER_R0,
    PARAMETER_M,
    PARAMETER_LEG_MASS,
    PARAMETER_L,
    PARAMETER_K,
    PARAMETER_G,
    PARAMETER_KP,
    PARAMETER_COUNT
};

struct problem {
    struct walker_params params;
    double r0_m;
    double kp;  /* m per rad/s; 0: no law */
    int period; /* 1..ORBIT_MAX_PERIOD */
    /* Kept by problem_prepare; what the caller puts into reference_x is its first guess. */
    struct walker walker;
    struct stride_settings settings;
    double reference_x[3];                      /* the long branch's gait at r0 (only with kp) */
    double reference_speed_by[PARAMETER_COUNT]; /* d(v*)/d(parameter) */
};

enum orbit_status {
    ORBIT_OK = 0,
    ORBIT_FAULT = -1,          /* the walker falls on the way: see fault and fault_step */
    ORBIT_NO_CONVERGENCE = -2, /* Newton did not settle */
    ORBIT_BAD_WALKER = -3,     /* a parameter out of range: see walker_error */
    ORBIT_NO_REFERENCE = -4    /* the law's reference gait was not found */
};

struct orbit {
    double x[3];       /* first apex: stance rate, swing angle, swing rate */
    double next[3];    /* the apex `period` strides on */
    double residual;   /* largest |next - x|, rates in units of sqrt(g/l) */
    double by_x[3][3]; /* d(next)/dx */
    double by_parameter[3][PARAMETER_COUNT];
    struct stride_result first;                     /* the first stride */
    double distance_m, duration_s, spring_energy_J; /* over the whole period */
    int clamped_strides;
    enum stride_fault fault;
    int fault_step; /* 0-based stride of the fault */
    enum walker_error walker_error;
};

/* Derives the walker and, with kp, the reference gait (Newton from reference_x). Call after any change. */
enum orbit_status problem_prepare(struct problem *problem, struct orbit *scratch);

double problem_get(const struct problem *problem, enum parameter parameter);
void problem_set(struct problem *problem, enum parameter parameter, double value);

/* "r0", "M", ...; NULL beyond the end. */
const char *parameter_name(enum parameter parameter);

/* Runs `period` strides from orbit->x and fills the rest. differentiate 0 leaves the derivatives out
 * (five times cheaper). Returns ORBIT_OK or ORBIT_FAULT. */
enum orbit_status orbit_evaluate(const struct problem *problem, int differentiate,
                                 struct orbit *orbit);

/* Newton from orbit->x; afterwards *orbit is fully evaluated at the solution. Residual below
 * 1e-12. At most 30 iterations. */
enum orbit_status orbit_find(const struct problem *problem, struct orbit *orbit);

/* 1 when the walk already repeats after a proper divisor of its period (differences below 1e-7). */
int orbit_repeats_earlier(const struct problem *problem, const struct orbit *orbit);

/* The law's push-off at an apex of this stance rate (rad/s), m; below 0 the stride refuses it. */
double problem_push_off(const struct problem *problem, double stance_rate);

/* One apex to the next with the law: the stride's push-off is put into *r0_m. */
enum stride_fault problem_stride(const struct problem *problem, const double x[3], double next[3],
                                 double *r0_m, struct stride_result *result);

const char *orbit_status_name(enum orbit_status status);

#endif
