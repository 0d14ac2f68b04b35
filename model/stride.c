#include "model/stride.h"

#include "model/collision.h"
#include "model/double_support.h"
#include "model/trig.h"

#define MAX_STEPS_PER_PHASE 100000
#define MAX_HALVINGS 12
#define MAX_GROUND_LANDINGS 40 /* about 8 are enough */

static const struct ground level_ground = {REAL(0.0), REAL(0.0)};
static const struct ode_event legs_closest = {{REAL(0.0), REAL(0.0), REAL(1.0), REAL(1.0)},
                                              REAL(0.0)};
static const struct ode_event stance_vertical = {{REAL(1.0), REAL(0.0), REAL(0.0), REAL(0.0)},
                                                 REAL(0.0)};

static int all_finite(const real *values, int count)
{
    for (int i = 0; i < count; i++) {
        if (!real_is_finite(values[i])) {
            return 0;
        }
    }
    return 1;
}

static enum stride_fault check_single_support(const real *state)
{
    if (!all_finite(state, SINGLE_SUPPORT_STATES)) {
        return STRIDE_NOT_FINITE;
    }
    if (state[STANCE_RATE] >= REAL(0.0)) {
        return STRIDE_WALKING_BACKWARDS;
    }
    if (real_abs(state[STANCE_ANGLE]) > REAL_HALF_PI) {
        return STRIDE_FALLEN;
    }
    if (real_abs(state[STANCE_ANGLE] - state[SWING_ANGLE]) > REAL_PI) {
        return STRIDE_INTER_LEG_ANGLE;
    }
    return STRIDE_OK;
}

static int settings_are_good(const struct stride_settings *settings)
{
    return settings->single_step_s > REAL(0.0) && settings->double_step_s > REAL(0.0) &&
           settings->phase_limit_s > REAL(0.0) && real_is_finite(settings->phase_limit_s);
}

/* The event "the toe is at the ground's height" for the legs' present opening: ts + tn = 2 incline. The toe
 * is above the ground where its value is positive. */
static struct ode_event toe_on_ground(const struct ground *ground, const real *state)
{
    const real opening = real_abs(state[STANCE_ANGLE] - state[SWING_ANGLE]);
    const struct ode_event event = {{REAL(1.0), REAL(1.0), REAL(0.0), REAL(0.0)},
                                    REAL(-2.0) * ground_incline_rad(ground, opening)};
    return event;
}

static real height_sign(const struct ground *ground, const real *state)
{
    const struct ode_event event = toe_on_ground(ground, state);
    return ode_event_value(&event, state);
}

/* Lands where the toe meets the ground between `state` (above) and `end` (not above). A rise of the ground makes the
 * event depend on the opening of the legs: no function that ode_land() knows, so it is searched between the two by
 * regula falsi, the value of an end that stays being halved (Illinois). */
static real land_on_ground(const struct ode *ode, ode_method *method, const struct ground *ground,
                           const real *state, real length, const real *end, real *landed)
{
    if (ground->height_rise == REAL(0.0)) {
        const struct ode_event event = toe_on_ground(ground, end);
        return ode_land(ode, method, &event, state, length, end, landed).step_s;
    }
    real low = REAL(0.0), high = length, step = length;
    real above = height_sign(ground, state), below = height_sign(ground, end);
    for (int i = 0, side = 0; i < MAX_GROUND_LANDINGS; i++) {
        step = low + (high - low) * above / (above - below);
        ode_step(ode, method, step, state, landed);
        const real value = height_sign(ground, landed);
        if (real_abs(value) <= REAL(4.0) * REAL_EPSILON) {
            break;
        }
        if (value > REAL(0.0)) {
            low = step;
            above = value;
            below *= side > 0 ? REAL(0.5) : REAL(1.0);
            side = 1;
        } else {
            high = step;
            below = value;
            above *= side < 0 ? REAL(0.5) : REAL(1.0);
            side = -1;
        }
    }
    return step;
}

/* The swing leg still closes up with the stance leg or passes it: on level ground the toe cannot come down
 * then, and where the next foothold lies lower, what it does there is the scuff that is ignored, too. */
static int is_passing(const struct ground *ground, const real *state)
{
    return ground->height_rise != REAL(0.0) && ode_event_value(&legs_closest, state) >= REAL(0.0);
}

/* One step in single support on the way to heel strike, cut at the strike if it falls within.
 * The toe touches the ground where its height over it falls through zero; rising is the mid-stance scuff,
 * ignored. Returns 1 at the strike; *step_s is then the time to it, and `next` the state there. */
static int strike_within(const struct ode *ode, ode_method *method, const struct ground *ground,
                         const real *state, real *next, real *step_s)
{
    const real before = height_sign(ground, state);
    const real after = height_sign(ground, next);
    real end[SINGLE_SUPPORT_STATES];
    if (after > REAL(0.0) || !real_is_finite(after) || is_passing(ground, next)) {
        return 0;
    }
    real length = *step_s;
    for (int i = 0; i < SINGLE_SUPPORT_STATES; i++) {
        end[i] = next[i];
    }
    if (before <= REAL(0.0) || is_passing(ground, state)) {
        /* Up and down again within one step? Look at the highest point of g between. */
        real top[SINGLE_SUPPORT_STATES];
        if (!(ode_event_value(&legs_closest, state) > REAL(0.0) &&
              ode_event_value(&legs_closest, next) < REAL(0.0))) {
            return 0;
        }
        const struct ode_landing peak =
            ode_land(ode, method, &legs_closest, state, length, next, top);
        if (!(height_sign(ground, top) > REAL(0.0))) {
            return 0;
        }
        *step_s =
            peak.step_s + land_on_ground(ode, method, ground, top, length - peak.step_s, end, next);
        return 1;
    }
    *step_s = land_on_ground(ode, method, ground, state, length, end, next);
    return 1;
}

enum stride_fault stride_to_strike_on_ground(const struct walker *walker,
                                             const struct stride_settings *settings,
                                             const struct apex *from, const struct ground *ground,
                                             struct stride_result *result)
{
    const struct ode ode = {single_support_rates, walker, SINGLE_SUPPORT_STATES};
    real state[SINGLE_SUPPORT_STATES] = {REAL(0.0), from->swing_angle_rad, from->stance_rate_rad_s,
                                         from->swing_rate_rad_s};
    real time = REAL(0.0);
    if (!settings_are_good(settings) || !all_finite(state, SINGLE_SUPPORT_STATES) ||
        !(real_abs(ground->slope_rad) < REAL_HALF_PI) || !real_is_finite(ground->height_rise)) {
        return STRIDE_BAD_INPUT;
    }
    enum stride_fault fault = check_single_support(state);
    for (int i = 0; fault == STRIDE_OK; i++) {
        real next[SINGLE_SUPPORT_STATES];
        real step = settings->single_step_s;
        if (time >= settings->phase_limit_s || i >= MAX_STEPS_PER_PHASE) {
            return STRIDE_NO_HEEL_STRIKE;
        }
        ode_step(&ode, settings->method, step, state, next);
        const int struck = strike_within(&ode, settings->method, ground, state, next, &step);
        time += step;
        fault = check_single_support(next);
        for (int k = 0; k < SINGLE_SUPPORT_STATES; k++) {
            state[k] = result->strike[k] = next[k];
        }
        result->apex_to_strike_s = time;
        if (struck && fault == STRIDE_OK && state[STANCE_ANGLE] < REAL(0.0)) {
            const real opening = real_abs(state[STANCE_ANGLE] - state[SWING_ANGLE]);
            result->incline_rad = ground_incline_rad(ground, opening);
            return STRIDE_OK;
        }
    }
    return fault;
}

enum stride_fault stride_to_strike(const struct walker *walker,
                                   const struct stride_settings *settings, const struct apex *from,
                                   struct stride_result *result)
{
    return stride_to_strike_on_ground(walker, settings, from, &level_ground, result);
}

static enum stride_fault check_double_support(const real *state)
{
    if (!all_finite(state, DOUBLE_SUPPORT_STATES)) {
        return STRIDE_NOT_FINITE;
    }
    return state[ANKLE_RATE] < REAL(0.0) ? STRIDE_NO_LIFT_OFF : STRIDE_OK;
}

/* Integrates r from 0 to r0; lift_off receives r and r' there. */
static enum stride_fault extend_ankle(const struct double_support *phase,
                                      const struct stride_settings *settings, real *lift_off,
                                      real *time_s)
{
    const struct ode ode = {double_support_rates, phase, DOUBLE_SUPPORT_STATES};
    const struct ode_event extended = {{REAL(1.0), REAL(0.0), REAL(0.0), REAL(0.0)},
                                       -phase->spring_rest_m};
    real step = settings->double_step_s;
    int halvings = 0;
    enum stride_fault fault = check_double_support(lift_off);
    *time_s = REAL(0.0);
    for (int i = 0; fault == STRIDE_OK && lift_off[ANKLE] < phase->spring_rest_m; i++) {
        real next[DOUBLE_SUPPORT_STATES];
        if (*time_s >= settings->phase_limit_s || i >= MAX_STEPS_PER_PHASE) {
            return STRIDE_NO_LIFT_OFF;
        }
        ode_step(&ode, settings->method, step, lift_off, next);
        if (!(all_finite(next, DOUBLE_SUPPORT_STATES) &&
              double_support_is_possible(phase, next[ANKLE])) &&
            halvings < MAX_HALVINGS) {
            /* The step ran beyond the point where the legs can still reach: go there more slowly. */
            step *= REAL(0.5);
            halvings++;
            continue;
        }
        real length = step;
        if (next[ANKLE] >= phase->spring_rest_m) {
            real end[DOUBLE_SUPPORT_STATES] = {next[ANKLE], next[ANKLE_RATE]};
            length = ode_land(&ode, settings->method, &extended, lift_off, step, end, next).step_s;
            next[ANKLE] = phase->spring_rest_m;
        }
        *time_s += length;
        fault = check_double_support(next);
        lift_off[ANKLE] = next[ANKLE];
        lift_off[ANKLE_RATE] = next[ANKLE_RATE];
    }
    return fault;
}

enum stride_fault stride_push_off(const struct walker *walker,
                                  const struct stride_settings *settings, real spring_rest_m,
                                  struct stride_result *result)
{
    const real *strike = result->strike;
    if (!settings_are_good(settings) || !all_finite(strike, SINGLE_SUPPORT_STATES) ||
        !(spring_rest_m >= REAL(0.0)) || !real_is_finite(spring_rest_m)) {
        return STRIDE_BAD_INPUT;
    }
    const real difference = strike[STANCE_ANGLE] - strike[SWING_ANGLE];
    result->inter_leg_rad = real_abs(difference);
    if (result->inter_leg_rad > REAL_PI) {
        return STRIDE_INTER_LEG_ANGLE;
    }
    struct double_support phase = {.walker = walker,
                                   .toe_distance_m = REAL(2.0) * walker->params.leg_length_m *
                                                     real_sin(REAL(0.5) * result->inter_leg_rad),
                                   .spring_rest_m = spring_rest_m};
    double_support_incline(&phase, result->incline_rad);
    result->step_length_m = phase.toe_distance_m;
    if (!(phase.toe_distance_m > spring_rest_m)) {
        return STRIDE_NO_ROOM_TO_EXTEND;
    }
    result->ankle_rate_m_s = collision_clamp_m_s(
        collision_ankle_rate_m_s(walker, difference, strike[STANCE_RATE], strike[SWING_RATE]),
        &result->clamped);

    real ankle[DOUBLE_SUPPORT_STATES] = {REAL(0.0), result->ankle_rate_m_s};
    const enum stride_fault fault =
        extend_ankle(&phase, settings, ankle, &result->double_support_s);
    if (fault != STRIDE_OK) {
        return fault;
    }
    /* Legs swap names: the leading leg becomes the stance leg. No impact; angles and rates carry over. */
    const struct chain_angles angles = double_support_angles(&phase, ankle[ANKLE]);
    result->lift_off[STANCE_ANGLE] = angles.leading_rad;
    result->lift_off[SWING_ANGLE] = angles.trailing_rad;
    result->lift_off[STANCE_RATE] = angles.leading_slope * ankle[ANKLE_RATE];
    result->lift_off[SWING_RATE] = angles.trailing_slope * ankle[ANKLE_RATE];
    return result->lift_off[STANCE_ANGLE] <= REAL(0.0) ? STRIDE_LIFT_OFF_PAST_APEX
                                                       : check_single_support(result->lift_off);
}

enum stride_fault stride_from_lift_off(const struct walker *walker,
                                       const struct stride_settings *settings,
                                       struct stride_result *result)
{
    const struct ode ode = {single_support_rates, walker, SINGLE_SUPPORT_STATES};
    real state[SINGLE_SUPPORT_STATES];
    real time = REAL(0.0);
    for (int k = 0; k < SINGLE_SUPPORT_STATES; k++) {
        state[k] = result->lift_off[k];
    }
    if (!settings_are_good(settings) || !all_finite(state, SINGLE_SUPPORT_STATES)) {
        return STRIDE_BAD_INPUT;
    }
    if (state[STANCE_ANGLE] <= REAL(0.0)) {
        return STRIDE_LIFT_OFF_PAST_APEX;
    }
    enum stride_fault fault = check_single_support(state);
    for (int i = 0; fault == STRIDE_OK; i++) {
        real next[SINGLE_SUPPORT_STATES];
        real step = settings->single_step_s;
        if (time >= settings->phase_limit_s || i >= MAX_STEPS_PER_PHASE) {
            return STRIDE_NO_APEX;
        }
        ode_step(&ode, settings->method, step, state, next);
        const int upright = next[STANCE_ANGLE] <= REAL(0.0);
        if (upright) {
            real end[SINGLE_SUPPORT_STATES];
            for (int k = 0; k < SINGLE_SUPPORT_STATES; k++) {
                end[k] = next[k];
            }
            step =
                ode_land(&ode, settings->method, &stance_vertical, state, step, end, next).step_s;
        }
        time += step;
        result->lift_off_to_apex_s = time;
        fault = check_single_support(next);
        for (int k = 0; k < SINGLE_SUPPORT_STATES; k++) {
            state[k] = next[k];
        }
        if (upright && fault == STRIDE_OK) {
            result->next.stance_rate_rad_s = state[STANCE_RATE];
            result->next.swing_angle_rad = state[SWING_ANGLE];
            result->next.swing_rate_rad_s = state[SWING_RATE];
            return STRIDE_OK;
        }
    }
    return fault;
}

enum stride_fault stride_on_ground(const struct walker *walker,
                                   const struct stride_settings *settings, const struct apex *from,
                                   real spring_rest_m, const struct ground *ground,
                                   struct stride_result *result)
{
    *result = (struct stride_result){.fault = STRIDE_OK};
    result->fault = stride_to_strike_on_ground(walker, settings, from, ground, result);
    if (result->fault == STRIDE_OK) {
        result->fault = stride_push_off(walker, settings, spring_rest_m, result);
    }
    if (result->fault == STRIDE_OK) {
        result->fault = stride_from_lift_off(walker, settings, result);
    }
    return result->fault;
}

enum stride_fault stride(const struct walker *walker, const struct stride_settings *settings,
                         const struct apex *from, real spring_rest_m, struct stride_result *result)
{
    return stride_on_ground(walker, settings, from, spring_rest_m, &level_ground, result);
}
