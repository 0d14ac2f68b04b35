#include "model/timed_stride.h"

#include "model/collision.h"
#include "model/double_support.h"
#include "model/trig.h"

#define MAX_STEPS 100000
#define MAX_BISECTIONS 60

void push_support_rates(const void *context, const real *state, real *rates)
{
    const struct push_support *push = (const struct push_support *)context;
    const struct walker_params *w = &push->walker->params;
    const real M = w->hip_mass_kg, m = w->leg_mass_kg, l = w->leg_length_m, g = w->gravity_m_s2;
    const real r = state[PUSH_ANKLE], l1 = l + r, c = r + REAL(0.5) * l;
    const real ts1 = state[PUSH_STANCE_RATE], tn1 = state[PUSH_SWING_RATE],
               r1 = state[PUSH_ANKLE_RATE];
    real ss, cs, sn, cn;
    real_sincos(state[PUSH_STANCE_ANGLE], &ss, &cs);
    real_sincos(state[PUSH_SWING_ANGLE], &sn, &cn);
    const real sd = ss * cn - cs * sn, cd = cs * cn + ss * sn;
    const real half = REAL(0.5) * m * l;
    const real moment = (M + m) * l1 + m * c;

    /* Mass matrix (a13 = 0) and what drives each coordinate. */
    const real a11 = (M + m) * l1 * l1 + m * c * c, a12 = -half * l1 * cd;
    const real a22 = REAL(0.5) * half * l, a23 = -half * sd, a33 = M + REAL(2.0) * m;
    const real f1 = REAL(-2.0) * moment * r1 * ts1 + half * l1 * sd * tn1 * tn1 + g * moment * ss;
    const real f2 = REAL(2.0) * half * cd * r1 * ts1 - half * l1 * sd * ts1 * ts1 - g * half * sn;
    const real f3 = moment * ts1 * ts1 - half * cd * tn1 * tn1 - g * a33 * cs +
                    w->ankle_stiffness_N_m * (push->spring_rest_m - r);

    /* Stance and ankle eliminated, then put back. */
    const real swing =
        (f2 - a12 / a11 * f1 - a23 / a33 * f3) / (a22 - a12 * a12 / a11 - a23 * a23 / a33);
    rates[PUSH_STANCE_ANGLE] = ts1;
    rates[PUSH_SWING_ANGLE] = tn1;
    rates[PUSH_ANKLE] = r1;
    rates[PUSH_STANCE_RATE] = (f1 - a12 * swing) / a11;
    rates[PUSH_SWING_RATE] = swing;
    rates[PUSH_ANKLE_RATE] = (f3 - a23 * swing) / a33;
}

/* Swing toe over the ground, m. */
static real toe_height_m(const struct walker *walker, const real *state)
{
    const real l = walker->params.leg_length_m;
    return (l + state[PUSH_ANKLE]) * real_cos(state[PUSH_STANCE_ANGLE]) -
           l * real_cos(state[PUSH_SWING_ANGLE]);
}

/* One step of h; the heel is held down while the spring does not lift it. */
static void push_step(const struct push_support *push, ode_method *method, real h,
                      const real *state, real *next)
{
    real rates[PUSH_SUPPORT_STATES];
    push_support_rates(push, state, rates);
    const int heel_down = state[PUSH_ANKLE] <= REAL(0.0) && state[PUSH_ANKLE_RATE] <= REAL(0.0) &&
                          rates[PUSH_ANKLE_RATE] <= REAL(0.0);
    if (!heel_down) {
        const struct ode ode = {push_support_rates, push, PUSH_SUPPORT_STATES};
        ode_step(&ode, method, h, state, next);
        return;
    }
    const struct ode ode = {single_support_rates, push->walker, SINGLE_SUPPORT_STATES};
    const real before[SINGLE_SUPPORT_STATES] = {state[PUSH_STANCE_ANGLE], state[PUSH_SWING_ANGLE],
                                                state[PUSH_STANCE_RATE], state[PUSH_SWING_RATE]};
    real after[SINGLE_SUPPORT_STATES];
    ode_step(&ode, method, h, before, after);
    next[PUSH_STANCE_ANGLE] = after[STANCE_ANGLE];
    next[PUSH_SWING_ANGLE] = after[SWING_ANGLE];
    next[PUSH_ANKLE] = REAL(0.0);
    next[PUSH_STANCE_RATE] = after[STANCE_RATE];
    next[PUSH_SWING_RATE] = after[SWING_RATE];
    next[PUSH_ANKLE_RATE] = REAL(0.0);
}

static enum stride_fault check_push(const real *state, real spring_rest_m)
{
    for (int i = 0; i < PUSH_SUPPORT_STATES; i++) {
        if (!real_is_finite(state[i])) {
            return STRIDE_NOT_FINITE;
        }
    }
    if (state[PUSH_STANCE_RATE] >= REAL(0.0)) {
        return STRIDE_WALKING_BACKWARDS;
    }
    if (real_abs(state[PUSH_STANCE_ANGLE]) > REAL_HALF_PI) {
        return STRIDE_FALLEN;
    }
    return state[PUSH_ANKLE] >= spring_rest_m && state[PUSH_ANKLE] > REAL(0.0) ? STRIDE_NO_LIFT_OFF
                                                                               : STRIDE_OK;
}

/* From the apex to where release comes, with the heel down. */
static void to_release(const struct walker *walker, const struct stride_settings *settings,
                       const struct apex *from, real time_s, real *state)
{
    const struct ode ode = {single_support_rates, walker, SINGLE_SUPPORT_STATES};
    real x[SINGLE_SUPPORT_STATES] = {REAL(0.0), from->swing_angle_rad, from->stance_rate_rad_s,
                                     from->swing_rate_rad_s};
    real left = time_s;
    for (int i = 0; i < MAX_STEPS && left > REAL(0.0); i++) {
        const real h = left < settings->single_step_s ? left : settings->single_step_s;
        ode_step(&ode, settings->method, h, x, x);
        left -= h;
    }
    state[PUSH_STANCE_ANGLE] = x[STANCE_ANGLE];
    state[PUSH_SWING_ANGLE] = x[SWING_ANGLE];
    state[PUSH_ANKLE] = REAL(0.0);
    state[PUSH_STANCE_RATE] = x[STANCE_RATE];
    state[PUSH_SWING_RATE] = x[SWING_RATE];
    state[PUSH_ANKLE_RATE] = REAL(0.0);
}

/* From release to the strike, ankle free. *time_s is what it took. */
static enum stride_fault to_early_strike(const struct push_support *push,
                                         const struct stride_settings *settings, real *state,
                                         real *time_s)
{
    const real h = settings->double_step_s;
    *time_s = REAL(0.0);
    if (toe_height_m(push->walker, state) <= REAL(0.0) && state[PUSH_STANCE_ANGLE] < REAL(0.0) &&
        state[PUSH_STANCE_RATE] + state[PUSH_SWING_RATE] < REAL(0.0)) {
        return STRIDE_OK; /* released in the very instant of the strike */
    }
    for (int i = 0; i < MAX_STEPS && *time_s < settings->phase_limit_s; i++) {
        real next[PUSH_SUPPORT_STATES];
        push_step(push, settings->method, h, state, next);
        if (toe_height_m(push->walker, next) <= REAL(0.0) &&
            toe_height_m(push->walker, state) > REAL(0.0) && next[PUSH_STANCE_ANGLE] < REAL(0.0)) {
            real low = REAL(0.0), high = h;
            for (int k = 0; k < MAX_BISECTIONS && high - low > REAL_EPSILON * h; k++) {
                const real middle = REAL(0.5) * (low + high);
                push_step(push, settings->method, middle, state, next);
                *(toe_height_m(push->walker, next) > REAL(0.0) ? &low : &high) = middle;
            }
            push_step(push, settings->method, high, state, next);
            *time_s += high;
            for (int k = 0; k < PUSH_SUPPORT_STATES; k++) {
                state[k] = next[k];
            }
            return check_push(state, push->spring_rest_m);
        }
        *time_s += h;
        for (int k = 0; k < PUSH_SUPPORT_STATES; k++) {
            state[k] = next[k];
        }
        const enum stride_fault fault = check_push(state, push->spring_rest_m);
        if (fault != STRIDE_OK) {
            return fault;
        }
    }
    return STRIDE_NO_HEEL_STRIKE;
}

/* Double support from ankle = (r, r') until r reaches the spring's rest, or for limit_s. */
static enum stride_fault extend(const struct double_support *phase,
                                const struct stride_settings *settings, real limit_s, real *ankle,
                                real *time_s)
{
    const struct ode ode = {double_support_rates, phase, DOUBLE_SUPPORT_STATES};
    const struct ode_event extended = {{REAL(1.0), REAL(0.0), REAL(0.0), REAL(0.0)},
                                       -phase->spring_rest_m};
    real spent = REAL(0.0);
    for (int i = 0; i < MAX_STEPS && spent < limit_s && ankle[ANKLE] < phase->spring_rest_m; i++) {
        real next[DOUBLE_SUPPORT_STATES];
        real h = settings->double_step_s;
        h = limit_s - spent < h ? limit_s - spent : h;
        ode_step(&ode, settings->method, h, ankle, next);
        if (!real_is_finite(next[ANKLE] + next[ANKLE_RATE]) ||
            !double_support_is_possible(phase, next[ANKLE])) {
            return STRIDE_NO_LIFT_OFF;
        }
        if (next[ANKLE] >= phase->spring_rest_m) {
            const real end[DOUBLE_SUPPORT_STATES] = {next[ANKLE], next[ANKLE_RATE]};
            h = ode_land(&ode, settings->method, &extended, ankle, h, end, next).step_s;
            next[ANKLE] = phase->spring_rest_m;
        }
        spent += h;
        ankle[ANKLE] = next[ANKLE];
        ankle[ANKLE_RATE] = next[ANKLE_RATE];
        if (next[ANKLE] < REAL(0.0)) { /* the heel comes down again and waits for the spring */
            ankle[ANKLE] = ankle[ANKLE_RATE] = REAL(0.0);
            spent = limit_s;
        }
    }
    *time_s += spent;
    return STRIDE_OK;
}

static enum stride_fault push_off(const struct walker *walker,
                                  const struct stride_settings *settings, const real *strike,
                                  real spring_rest_m, real late_s, struct stride_result *result)
{
    const real l = walker->params.leg_length_m, l1 = l + strike[PUSH_ANKLE];
    const real difference = strike[PUSH_STANCE_ANGLE] - strike[PUSH_SWING_ANGLE];
    const struct collision_rates before = {strike[PUSH_STANCE_RATE], strike[PUSH_SWING_RATE],
                                           strike[PUSH_ANKLE_RATE]};
    const struct collision_rates after =
        collision_apply(walker, difference, strike[PUSH_ANKLE], before);
    struct walker slack = *walker;
    struct double_support phase = {
        .walker = walker,
        .toe_distance_m = real_sqrt(l1 * l1 + l * l - REAL(2.0) * l1 * l * real_cos(difference)),
        .spring_rest_m = spring_rest_m};
    struct double_support held = phase;
    real ankle[DOUBLE_SUPPORT_STATES] = {strike[PUSH_ANKLE],
                                         collision_clamp_m_s(after.ankle_m_s, &result->clamped)};
    enum stride_fault fault = STRIDE_OK;

    slack.params.ankle_stiffness_N_m = REAL(0.0);
    held.walker = &slack;
    result->inter_leg_rad = real_abs(difference);
    result->step_length_m = phase.toe_distance_m;
    result->ankle_rate_m_s = ankle[ANKLE_RATE];
    if (!(phase.toe_distance_m > spring_rest_m)) {
        return STRIDE_NO_ROOM_TO_EXTEND;
    }
    if (late_s > REAL(0.0)) {
        fault = extend(&held, settings, late_s, ankle, &result->double_support_s);
    }
    if (fault == STRIDE_OK) {
        fault = extend(&phase, settings, settings->phase_limit_s, ankle, &result->double_support_s);
    }
    if (fault != STRIDE_OK || ankle[ANKLE] < spring_rest_m || ankle[ANKLE_RATE] < REAL(0.0)) {
        return fault != STRIDE_OK ? fault : STRIDE_NO_LIFT_OFF;
    }
    const struct chain_angles angles = double_support_angles(&phase, ankle[ANKLE]);
    result->lift_off[STANCE_ANGLE] = angles.leading_rad;
    result->lift_off[SWING_ANGLE] = angles.trailing_rad;
    result->lift_off[STANCE_RATE] = angles.leading_slope * ankle[ANKLE_RATE];
    result->lift_off[SWING_RATE] = angles.trailing_slope * ankle[ANKLE_RATE];
    return result->lift_off[STANCE_ANGLE] <= REAL(0.0) ? STRIDE_LIFT_OFF_PAST_APEX : STRIDE_OK;
}

enum stride_fault timed_stride(const struct walker *walker, const struct stride_settings *settings,
                               const struct apex *from, real spring_rest_m, real release_s,
                               struct stride_result *result)
{
    *result = (struct stride_result){.fault = STRIDE_OK};
    result->fault = stride_to_strike(walker, settings, from, result);
    if (result->fault == STRIDE_OK &&
        (!(spring_rest_m >= REAL(0.0)) || !real_is_finite(spring_rest_m + release_s))) {
        result->fault = STRIDE_BAD_INPUT;
    }
    if (result->fault != STRIDE_OK) {
        return result->fault;
    }
    real strike[PUSH_SUPPORT_STATES] = {
        result->strike[STANCE_ANGLE], result->strike[SWING_ANGLE], REAL(0.0),
        result->strike[STANCE_RATE],  result->strike[SWING_RATE],  REAL(0.0)};
    if (release_s < REAL(0.0)) {
        const struct push_support push = {walker, spring_rest_m};
        const real at_s = result->apex_to_strike_s + release_s;
        real rest_s = REAL(0.0);
        to_release(walker, settings, from, at_s > REAL(0.0) ? at_s : REAL(0.0), strike);
        result->fault = to_early_strike(&push, settings, strike, &rest_s);
        result->apex_to_strike_s = (at_s > REAL(0.0) ? at_s : REAL(0.0)) + rest_s;
        result->strike[STANCE_ANGLE] = strike[PUSH_STANCE_ANGLE];
        result->strike[SWING_ANGLE] = strike[PUSH_SWING_ANGLE];
        result->strike[STANCE_RATE] = strike[PUSH_STANCE_RATE];
        result->strike[SWING_RATE] = strike[PUSH_SWING_RATE];
    }
    if (result->fault == STRIDE_OK) {
        result->fault = push_off(walker, settings, strike, spring_rest_m, release_s, result);
    }
    if (result->fault == STRIDE_OK) {
        result->fault = stride_from_lift_off(walker, settings, result);
    }
    return result->fault;
}
