#include "controller/estimator/model_observer.h"

#include "controller/estimator/observer_gains.h"
#include "model/collision.h"
#include "model/integrator.h"
#include "model/trig.h"

/* A prediction this far off, for so long, is not the model's error: it is another body, a
 * support from outside or a stumble. */
#define GROSS_RAD REAL(0.015)
#define GROSS_TICKS TICKS_OF_MS(15)

/* At a strike on level ground theta_s + theta_n is 0. Within this, the state places the strike
 * better than its detection does; beyond, the ground was not level. */
#define LEVEL_RAD REAL(0.01)

/* The ankle's corrections in double support, per second and per second squared: a pole pair
 * at 40 rad/s. The push-off's own motion has 10 rad/s, so a wrong impact is corrected within
 * it. */
#define ANKLE_GAIN_S REAL(56.0)
#define ANKLE_RATE_GAIN_S2 REAL(1600.0)

/* The model's lift-off may differ from the detected one by so much. */
#define LIFT_OFF_MAX_AGE_S REAL(0.03)

#define NOISE_GAIN REAL(0.002)
#define FIRST_NOISE_RAD REAL(0.0004) /* a 14-bit encoder, until it is measured */

void model_observer_init(struct model_observer *observer, const struct control_params *params)
{
    const struct walker_params body = {params->torso_mass_kg, params->leg_mass_kg,
                                       params->leg_length_m, params->spring_stiffness_n_m,
                                       params->gravity_m_s2};
    *observer = (struct model_observer){0};
    observer->usable = walker_init(&observer->walker, &body) == WALKER_OK;
    observer->noise_rad2 = FIRST_NOISE_RAD * FIRST_NOISE_RAD;
}

void model_observer_lose(struct model_observer *observer)
{
    observer->phase = MODEL_LOST;
}

/* A tick's error by the midpoint rule is 1e-10 rad, far below any sensor, and it costs half. */
static ode_method *method_for(real h_s)
{
    return real_abs(h_s) <= CONTROL_PERIOD_S ? ODE_MIDPOINT : ODE_RK4;
}

void model_observer_step(const struct model_observer *observer, real h_s, real *state)
{
    const struct ode ode = {single_support_rates, &observer->walker, SINGLE_SUPPORT_STATES};
    ode_step(&ode, method_for(h_s), h_s, state, state);
}

static void step_double(const struct model_observer *observer, real rest_m, real h_s, real *ankle)
{
    const struct double_support phase = {.walker = &observer->walker,
                                         .toe_distance_m = observer->toe_distance_m,
                                         .spring_rest_m = rest_m};
    const struct ode ode = {double_support_rates, &phase, DOUBLE_SUPPORT_STATES};
    ode_step(&ode, method_for(h_s), h_s, ankle, ankle);
}

static bool all_finite(const real *value, int count)
{
    real sum = REAL(0.0);
    for (int i = 0; i < count; i++) {
        sum += value[i];
    }
    return real_is_finite(sum);
}

/* ---- single support ----------------------------------------------------------- */

/* Advances to the knots around now (within a stance time only grows) and interpolates there. */
static void advance_gains(struct model_observer *observer, uint32_t tick, real stance[2],
                          real swing[2])
{
    const real since =
        (real)(tick - observer->since_tick) * CONTROL_PERIOD_S / observer->walker.time_unit_s;
    while (observer->knot + 2 < OBSERVER_GAIN_KNOTS &&
           observer_gains[observer->knot + 1].since <= since) {
        observer->knot++;
    }
    const uint32_t last = OBSERVER_GAIN_KNOTS - 2;
    const struct observer_gain *a = &observer_gains[observer->knot < last ? observer->knot : last];
    const struct observer_gain *b = a + 1;
    const real part = real_clamp((since - a->since) / (b->since - a->since), REAL(0.0), REAL(1.0));
    for (int i = 0; i < 2; i++) {
        stance[i] = a->stance[i] + part * (b->stance[i] - a->stance[i]);
        swing[i] = a->swing[i] + part * (b->swing[i] - a->swing[i]);
    }
}

static void correct(struct model_observer *observer, const real gain[2], int angle, int rate,
                    real error_rad)
{
    const real per_tick = CONTROL_PERIOD_S / observer->walker.time_unit_s;
    const real part = gain[0] * per_tick;
    observer->state[angle] += (part < REAL(0.9) ? part : REAL(0.9)) * error_rad;
    observer->state[rate] += gain[1] * per_tick / observer->walker.time_unit_s * error_rad;
}

static void approach(real *mean, real value)
{
    *mean += NOISE_GAIN * (value - *mean);
}

/* Noise shows in the differences of errors, twice its square: white noise already from
 * one tick to the next; over some more, before the model's own error has changed, slow
 * noise too. */
static void watch_noise(struct model_observer *observer, enum side side, uint32_t tick,
                        real error_rad)
{
    real *kept = observer->error_rad[side];
    const real last = error_rad - kept[(tick - 1) % MODEL_SLOW_TICKS];
    const real oldest = error_rad - kept[tick % MODEL_SLOW_TICKS];
    if (observer->errors > 0) {
        approach(&observer->noise_rad2, REAL(0.5) * last * last);
    }
    if (observer->errors >= MODEL_SLOW_TICKS) {
        const real slow = REAL(0.5) * oldest * oldest - observer->noise_rad2;
        approach(&observer->slow_rad2, slow);
    }
    kept[tick % MODEL_SLOW_TICKS] = error_rad;
}

static void advance_single(struct model_observer *observer, const struct controller_input *input)
{
    const enum side stance = observer->stance, swing = side_other(stance);
    real stance_gain[2], swing_gain[2];
    model_observer_step(observer, CONTROL_PERIOD_S, observer->state);
    advance_gains(observer, input->tick, stance_gain, swing_gain);
    const real stance_off = input->leg[stance].leg_angle_rad - observer->state[STANCE_ANGLE];
    const real swing_off = input->leg[swing].leg_angle_rad - observer->state[SWING_ANGLE];
    if (input->leg[stance].age_ticks == 0) {
        correct(observer, stance_gain, STANCE_ANGLE, STANCE_RATE, stance_off);
    }
    if (input->leg[swing].age_ticks == 0) {
        correct(observer, swing_gain, SWING_ANGLE, SWING_RATE, swing_off);
    }
    watch_noise(observer, stance, input->tick, stance_off);
    watch_noise(observer, swing, input->tick, swing_off);
    observer->errors++;
    const bool gross = real_abs(stance_off) > GROSS_RAD || real_abs(swing_off) > GROSS_RAD;
    observer->off_ticks = gross ? observer->off_ticks + 1 : 0;
    if (observer->off_ticks >= GROSS_TICKS || !all_finite(observer->state, SINGLE_SUPPORT_STATES)) {
        model_observer_lose(observer);
    }
    real *kept = observer->history[input->tick % MODEL_HISTORY];
    for (int i = 0; i < SINGLE_SUPPORT_STATES; i++) {
        kept[i] = observer->state[i];
    }
}

/* ---- double support ----------------------------------------------------------- */

static void advance_double(struct model_observer *observer, const struct controller_input *input)
{
    const enum side trailing = observer->stance;
    step_double(observer, input->sea[trailing].precompression_m,
                CONTROL_PERIOD_S + observer->behind_s, observer->ankle);
    observer->behind_s = REAL(0.0);
    const real off = input->leg[trailing].ankle_extension_m - observer->ankle[ANKLE];
    if (input->leg[trailing].age_ticks == 0) {
        observer->ankle[ANKLE] += ANKLE_GAIN_S * CONTROL_PERIOD_S * off;
        observer->ankle[ANKLE_RATE] += ANKLE_RATE_GAIN_S2 * CONTROL_PERIOD_S * off;
    }
    const struct double_support phase = {.walker = &observer->walker,
                                         .toe_distance_m = observer->toe_distance_m,
                                         .spring_rest_m = REAL(0.0)};
    if (!all_finite(observer->ankle, DOUBLE_SUPPORT_STATES) ||
        !double_support_is_possible(&phase, observer->ankle[ANKLE])) {
        model_observer_lose(observer);
    }
}

void model_observer_advance(struct model_observer *observer, const struct controller_input *input)
{
    switch (observer->phase) {
    case MODEL_SINGLE:
        advance_single(observer, input);
        break;
    case MODEL_DOUBLE:
        advance_double(observer, input);
        break;
    default:
        break;
    }
}

/* ---- events ------------------------------------------------------------------- */

/* How long after a state, on level ground, the strike is by the state itself, when it is
 * not far from where it was detected, `detected_s` after the state; else just that. */
static real strike_after_s(const real *state, real detected_s)
{
    const real sum = state[STANCE_ANGLE] + state[SWING_ANGLE];
    const real rate = state[STANCE_RATE] + state[SWING_RATE];
    if (real_abs(sum + rate * detected_s) > LEVEL_RAD || !(rate < REAL(0.0))) {
        return detected_s;
    }
    return -sum / rate;
}

/* The state at a strike detected age_s before the newest sample, out of the history;
 * true age in *since_s. One step of the model: a strike's tick has much else to do. */
static bool recall_strike(const struct model_observer *observer, uint32_t tick, real age_s,
                          real *state, real *since_s)
{
    const real ticks = age_s * (real)CONTROL_RATE_HZ;
    if (!real_is_within(ticks, REAL(0.0), (real)(MODEL_HISTORY - 2))) {
        return false;
    }
    const uint32_t whole = (uint32_t)ticks;
    if (tick - observer->since_tick < whole + 2) {
        return false;
    }
    const real *kept = observer->history[(tick - whole) % MODEL_HISTORY];
    for (int i = 0; i < SINGLE_SUPPORT_STATES; i++) {
        state[i] = kept[i];
    }
    const real after_s = strike_after_s(state, ((real)whole - ticks) * CONTROL_PERIOD_S);
    model_observer_step(observer, after_s, state);
    *since_s = (real)whole * CONTROL_PERIOD_S - after_s;
    return true;
}

void model_observer_strike(struct model_observer *observer, uint32_t tick, real age_s, real rest_m)
{
    real strike[SINGLE_SUPPORT_STATES] = {REAL(0.0)}, since_s = REAL(0.0);
    if (observer->phase != MODEL_SINGLE ||
        !recall_strike(observer, tick, age_s, strike, &since_s)) {
        model_observer_lose(observer);
        return;
    }
    const real difference = strike[STANCE_ANGLE] - strike[SWING_ANGLE];
    observer->toe_distance_m = REAL(2.0) * observer->walker.params.leg_length_m *
                               real_abs(real_sin(REAL(0.5) * difference));
    observer->ankle[ANKLE] = REAL(0.0);
    observer->ankle[ANKLE_RATE] =
        collision_clamp_m_s(collision_ankle_rate_m_s(&observer->walker, difference,
                                                     strike[STANCE_RATE], strike[SWING_RATE]),
                            NULL);
    const struct double_support phase = {.walker = &observer->walker,
                                         .toe_distance_m = observer->toe_distance_m,
                                         .spring_rest_m = rest_m};
    if (!double_support_is_possible(&phase, REAL(0.0))) {
        model_observer_lose(observer);
        return;
    }
    observer->phase = MODEL_DOUBLE;
    observer->behind_s = since_s; /* caught up in the next tick: this one has enough to do */
}

/* observer->state was age_s before the newest sample. */
static void enter_single(struct model_observer *observer, enum side stance, uint32_t tick,
                         real age_s)
{
    model_observer_step(observer, age_s, observer->state);
    if (!all_finite(observer->state, SINGLE_SUPPORT_STATES)) {
        model_observer_lose(observer);
        return;
    }
    observer->phase = MODEL_SINGLE;
    observer->stance = stance;
    observer->since_tick = tick;
    observer->knot = 0;
    observer->off_ticks = 0;
    observer->errors = 0;
}

void model_observer_lift_off(struct model_observer *observer, uint32_t tick, real rest_m)
{
    const struct double_support phase = {.walker = &observer->walker,
                                         .toe_distance_m = observer->toe_distance_m,
                                         .spring_rest_m = rest_m};
    const bool known = observer->phase == MODEL_DOUBLE && observer->ankle[ANKLE_RATE] > REAL(0.0);
    if (!known || !double_support_is_possible(&phase, rest_m)) {
        model_observer_lose(observer);
        return;
    }
    const real rate = observer->ankle[ANKLE_RATE];
    const real age_s = (observer->ankle[ANKLE] - rest_m) / rate;
    const struct chain_angles angles = double_support_angles(&phase, rest_m);
    observer->state[STANCE_ANGLE] = angles.leading_rad;
    observer->state[SWING_ANGLE] = angles.trailing_rad;
    observer->state[STANCE_RATE] = angles.leading_slope * rate;
    observer->state[SWING_RATE] = angles.trailing_slope * rate;
    if (!(real_abs(age_s) < LIFT_OFF_MAX_AGE_S)) {
        model_observer_lose(observer);
        return;
    }
    enter_single(observer, side_other(observer->stance), tick, age_s);
}

void model_observer_begin(struct model_observer *observer, enum side stance, uint32_t tick,
                          const real *state, real age_s)
{
    if (!observer->usable) {
        return;
    }
    for (int i = 0; i < SINGLE_SUPPORT_STATES; i++) {
        observer->state[i] = state[i];
    }
    enter_single(observer, stance, tick, age_s);
}
