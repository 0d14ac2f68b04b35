#include "sim_host/gait/stride_derivative.h"

#include "model/collision.h"
#include "model/trig.h"
#include "sim_host/gait/chain_derivative.h"

#define COLUMNS SENSITIVITY_COLUMNS
#define SINGLE_STATES (SINGLE_SUPPORT_STATES * (1 + COLUMNS))
#define DOUBLE_STATES (DOUBLE_SUPPORT_STATES * (1 + COLUMNS))
_Static_assert(SINGLE_STATES <= ODE_MAX_STATES, "the integrator must hold state and sensitivities");

/* State first, then one row of COLUMNS per state: row(y, n, i)[c] = d(state i)/d(column c). */
static double *row(double *y, int states, int i)
{
    return y + states + i * COLUMNS;
}

/* d(accelerations)/d(state, m) in single support; state order as in single_support.h, m last. */
static void single_support_jacobian(const struct walker *w, const double *y, double stance[5],
                                    double swing[5])
{
    const double a = y[STANCE_RATE], b = y[SWING_RATE], h = w->half_leg_mass_kg;
    const double gl = w->gravity_per_length_s2, weight = w->stance_weight_kg;
    double ss, cs, sn, cn;
    real_sincos(y[STANCE_ANGLE], &ss, &cs);
    real_sincos(y[SWING_ANGLE], &sn, &cn);
    const double s = ss * cn - cs * sn, c = cs * cn + ss * sn;
    const double pull = s * a * a + gl * sn;
    const double torque = h * s * b * b + gl * weight * ss - 2.0 * h * c * pull;
    const double inertia = w->stance_inertia_kg - 2.0 * h * c * c;
    const double acceleration = torque / inertia;
    const double cos_by[5] = {-s, s, 0.0, 0.0, 0.0};
    const double pull_by[5] = {c * a * a, gl * cn - c * a * a, 2.0 * s * a, 0.0, 0.0};
    const double inertia_by[5] = {4.0 * h * c * s, -4.0 * h * c * s, 0.0, 0.0, 1.25 - c * c};
    const double torque_by[5] = {
        h * c * b * b + gl * weight * cs - 2.0 * h * (c * pull_by[0] - s * pull),
        -h * c * b * b - 2.0 * h * (c * pull_by[1] + s * pull), -2.0 * h * c * pull_by[2],
        2.0 * h * s * b, 0.5 * s * b * b + 1.5 * gl * ss - c * pull};
    for (int i = 0; i < 5; i++) {
        stance[i] = (torque_by[i] - acceleration * inertia_by[i]) / inertia;
        swing[i] = 2.0 * (cos_by[i] * acceleration + c * stance[i] - pull_by[i]);
    }
}

static void single_variational(const void *context, const double *y, double *rates)
{
    const struct walker *w = (const struct walker *)context;
    double stance[5], swing[5];
    single_support_rates(w, y, rates);
    single_support_jacobian(w, y, stance, swing);
    for (int c = 0; c < COLUMNS; c++) {
        const double *S = y + SINGLE_SUPPORT_STATES + c;
        double *out = rates + SINGLE_SUPPORT_STATES + c;
        double first = c == BY_LEG_MASS ? stance[4] : 0.0;
        double second = c == BY_LEG_MASS ? swing[4] : 0.0;
        for (int i = 0; i < SINGLE_SUPPORT_STATES; i++) {
            first += stance[i] * S[i * COLUMNS];
            second += swing[i] * S[i * COLUMNS];
        }
        out[STANCE_ANGLE * COLUMNS] = S[STANCE_RATE * COLUMNS];
        out[SWING_ANGLE * COLUMNS] = S[SWING_RATE * COLUMNS];
        out[STANCE_RATE * COLUMNS] = first;
        out[SWING_RATE * COLUMNS] = second;
    }
}

struct push_off {
    struct double_support phase;
    double distance_by[COLUMNS]; /* d(toe distance)/d(column) */
};

static void double_variational(const void *context, const double *y, double *rates)
{
    const struct push_off *push = (const struct push_off *)context;
    const struct chain_dual c = chain_differentiate(&push->phase, y[ANKLE]);
    const double k = push->phase.walker->params.ankle_stiffness_N_m;
    const double stretch = push->phase.spring_rest_m - y[ANKLE], v = y[ANKLE_RATE];
    const double mu = c.effective_mass.value;
    const double acceleration =
        (k * stretch - c.potential_slope.value - 0.5 * c.mass_slope.value * v * v) / mu;
    const double by_r = (-k - c.potential_slope.by_r - 0.5 * c.mass_slope.by_r * v * v -
                         acceleration * c.effective_mass.by_r) /
                        mu;
    const double by_v = -c.mass_slope.value * v / mu;
    const double by_d = (-c.potential_slope.by_d - 0.5 * c.mass_slope.by_d * v * v -
                         acceleration * c.effective_mass.by_d) /
                        mu;
    const double by_m = (-c.potential_slope.by_m - 0.5 * c.mass_slope.by_m * v * v -
                         acceleration * c.effective_mass.by_m) /
                        mu;
    rates[ANKLE] = v;
    rates[ANKLE_RATE] = acceleration;
    for (int i = 0; i < COLUMNS; i++) {
        const double *S = y + DOUBLE_SUPPORT_STATES + i;
        double *out = rates + DOUBLE_SUPPORT_STATES + i;
        double direct = by_d * push->distance_by[i];
        direct += i == BY_SPRING_REST ? k / mu : 0.0;
        direct += i == BY_STIFFNESS ? stretch / mu : 0.0;
        direct += i == BY_LEG_MASS ? by_m : 0.0;
        out[ANKLE * COLUMNS] = S[ANKLE_RATE * COLUMNS];
        out[ANKLE_RATE * COLUMNS] = by_r * S[0] + by_v * S[COLUMNS] + direct;
    }
}

/* Integrates for exactly duration_s in equal steps of at most step_s. */
static void integrate(const struct ode *ode, const struct stride_settings *settings, double step_s,
                      double duration_s, double *y)
{
    int steps = (int)(duration_s / step_s) + 1;
    for (int i = 0; i < steps; i++) {
        ode_step(ode, settings->method, duration_s / steps, y, y);
    }
}

/* Saltation: sensitivities at fixed time become sensitivities at the event, whose time shifts by
 * dT = -event_by / event_rate when the column's quantity is changed. */
static void shift_to_event(double *y, int states, const double *rates,
                           const double event_by[COLUMNS], double event_rate)
{
    for (int c = 0; c < COLUMNS; c++) {
        const double shift = -event_by[c] / event_rate;
        for (int i = 0; i < states; i++) {
            row(y, states, i)[c] += rates[i] * shift;
        }
    }
}

/* Single support in y, for a duration, ending on the event sum weight[i] * angle[i] = const. */
static void run_single(const struct walker *w, const struct stride_settings *settings,
                       double duration_s, double stance_weight, double swing_weight, double *y)
{
    const struct ode ode = {single_variational, w, SINGLE_STATES};
    double rates[SINGLE_STATES], event_by[COLUMNS];
    integrate(&ode, settings, settings->single_step_s, duration_s, y);
    single_variational(w, y, rates);
    for (int c = 0; c < COLUMNS; c++) {
        event_by[c] =
            stance_weight * row(y, 4, STANCE_ANGLE)[c] + swing_weight * row(y, 4, SWING_ANGLE)[c];
    }
    shift_to_event(y, SINGLE_SUPPORT_STATES, rates, event_by,
                   stance_weight * rates[STANCE_ANGLE] + swing_weight * rates[SWING_ANGLE]);
}

/* The collision: sensitivities of d and r'+ from those of the strike state. */
static void collide(const struct walker *w, const struct stride_result *result, double *strike,
                    struct stride_derivative *derivative)
{
    const double M = w->params.hip_mass_kg, m = w->params.leg_mass_kg, l = w->params.leg_length_m;
    const double a = result->strike[STANCE_RATE], b = result->strike[SWING_RATE];
    const double difference = result->strike[STANCE_ANGLE] - result->strike[SWING_ANGLE];
    const double Q = 3.0 * m + 4.0 * M;
    double s, c;
    real_sincos(difference, &s, &c);
    const double divisor = 4.0 * m + 8.0 * M + 6.0 * m * s * s;
    const double drive = Q * c * a - m * b;
    const double rate = 2.0 * l * s * drive / divisor;
    const double by_difference =
        (2.0 * l * (c * drive - s * s * Q * a) - rate * 12.0 * m * s * c) / divisor;
    const double by_m = (2.0 * l * s * (3.0 * c * a - b) - rate * (4.0 + 6.0 * s * s)) / divisor;
    for (int i = 0; i < COLUMNS; i++) {
        const double difference_by =
            row(strike, 4, STANCE_ANGLE)[i] - row(strike, 4, SWING_ANGLE)[i];
        /* d = 2 l sin(-difference / 2) */
        derivative->after_collision[0][i] = -l * real_cos(0.5 * difference) * difference_by;
        derivative->after_collision[1][i] = result->clamped
                                                ? 0.0
                                                : by_difference * difference_by +
                                                      2.0 * l * s *
                                                          (Q * c * row(strike, 4, STANCE_RATE)[i] -
                                                           m * row(strike, 4, SWING_RATE)[i]) /
                                                          divisor +
                                                      (i == BY_LEG_MASS ? by_m : 0.0);
    }
}

/* Push-off: from d and r'+ to the state just after lift-off, with sensitivities, in `after`. */
static void push_off(const struct walker *w, const struct stride_settings *settings, double r0,
                     const struct stride_result *result, const struct stride_derivative *derivative,
                     double *after)
{
    struct push_off push = {
        {.walker = w, .toe_distance_m = result->step_length_m, .spring_rest_m = r0}, {0.0}};
    const struct ode ode = {double_variational, &push, DOUBLE_STATES};
    double y[DOUBLE_STATES] = {0.0, result->ankle_rate_m_s}, rates[DOUBLE_STATES],
           event_by[COLUMNS];
    for (int i = 0; i < COLUMNS; i++) {
        push.distance_by[i] = derivative->after_collision[0][i];
        row(y, 2, ANKLE_RATE)[i] = derivative->after_collision[1][i];
    }
    integrate(&ode, settings, settings->double_step_s, result->double_support_s, y);
    double_variational(&push, y, rates);
    for (int i = 0; i < COLUMNS; i++) {
        event_by[i] = row(y, 2, ANKLE)[i] - (i == BY_SPRING_REST ? 1.0 : 0.0);
    }
    shift_to_event(y, DOUBLE_SUPPORT_STATES, rates, event_by, y[ANKLE_RATE]);

    const struct chain_dual chain = chain_differentiate(&push.phase, r0);
    const struct dual angle[2] = {chain.leading, chain.trailing};
    const struct dual slope[2] = {chain.leading_slope, chain.trailing_slope};
    const double v = y[ANKLE_RATE];
    for (int k = 0; k < 2; k++) { /* stance (leading), swing (trailing) */
        after[STANCE_ANGLE + k] = angle[k].value;
        after[STANCE_RATE + k] = slope[k].value * v;
        for (int i = 0; i < COLUMNS; i++) {
            const double r_by = row(y, 2, ANKLE)[i], v_by = row(y, 2, ANKLE_RATE)[i];
            const double d_by = push.distance_by[i];
            row(after, 4, STANCE_ANGLE + k)[i] = angle[k].by_r * r_by + angle[k].by_d * d_by;
            row(after, 4, STANCE_RATE + k)[i] =
                slope[k].value * v_by + v * (slope[k].by_r * r_by + slope[k].by_d * d_by);
        }
    }
}

enum stride_fault stride_differentiate(const struct walker *walker,
                                       const struct stride_settings *settings,
                                       const struct apex *from, double spring_rest_m,
                                       struct stride_result *result,
                                       struct stride_derivative *derivative)
{
    if (stride(walker, settings, from, spring_rest_m, result) != STRIDE_OK) {
        return result->fault;
    }
    double y[SINGLE_STATES] = {0.0, from->swing_angle_rad, from->stance_rate_rad_s,
                               from->swing_rate_rad_s};
    row(y, 4, STANCE_RATE)[BY_STANCE_RATE] = 1.0;
    row(y, 4, SWING_ANGLE)[BY_SWING_ANGLE] = 1.0;
    row(y, 4, SWING_RATE)[BY_SWING_RATE] = 1.0;
    run_single(walker, settings, result->apex_to_strike_s, 1.0, 1.0, y);
    collide(walker, result, y, derivative);
    push_off(walker, settings, spring_rest_m, result, derivative, y);
    run_single(walker, settings, result->lift_off_to_apex_s, 1.0, 0.0, y);
    for (int i = 0; i < COLUMNS; i++) {
        derivative->next[0][i] = row(y, 4, STANCE_RATE)[i];
        derivative->next[1][i] = row(y, 4, SWING_ANGLE)[i];
        derivative->next[2][i] = row(y, 4, SWING_RATE)[i];
    }
    return STRIDE_OK;
}
