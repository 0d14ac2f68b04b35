#include "model/single_support.h"

#include "model/trig.h"

void single_support_rates(const void *context, const real *state, real *rates)
{
    const struct walker *w = (const struct walker *)context;
    const real ts_rate = state[STANCE_RATE], tn_rate = state[SWING_RATE];
    real ss, cs, sn, cn;
    real_sincos(state[STANCE_ANGLE], &ss, &cs);
    real_sincos(state[SWING_ANGLE], &sn, &cn);
    const real sin_d = ss * cn - cs * sn;
    const real cos_d = cs * cn + ss * sn;

    /* Swing leg, over m l^2 / 4: tn'' = 2 (cos D ts'' - pull). */
    const real pull = sin_d * ts_rate * ts_rate + w->gravity_per_length_s2 * sn;
    const real torque = w->half_leg_mass_kg * sin_d * tn_rate * tn_rate +
                        w->gravity_per_length_s2 * w->stance_weight_kg * ss -
                        REAL(2.0) * w->half_leg_mass_kg * cos_d * pull;
    const real inertia = w->stance_inertia_kg - REAL(2.0) * w->half_leg_mass_kg * cos_d * cos_d;
    const real ts_acceleration = torque / inertia;

    rates[STANCE_ANGLE] = ts_rate;
    rates[SWING_ANGLE] = tn_rate;
    rates[STANCE_RATE] = ts_acceleration;
    rates[SWING_RATE] = REAL(2.0) * (cos_d * ts_acceleration - pull);
}

real single_support_energy_J(const struct walker *walker, const real *state)
{
    const real m = walker->params.leg_mass_kg, l = walker->params.leg_length_m;
    const real a = state[STANCE_RATE], b = state[SWING_RATE];
    const real cos_d = real_cos(state[STANCE_ANGLE] - state[SWING_ANGLE]);
    const real kinetic = REAL(0.5) * walker->stance_inertia_kg * a * a + REAL(0.125) * m * b * b -
                         REAL(0.5) * m * cos_d * a * b;
    const real height = walker->stance_weight_kg * real_cos(state[STANCE_ANGLE]) -
                        REAL(0.5) * m * real_cos(state[SWING_ANGLE]);
    return l * (l * kinetic + walker->params.gravity_m_s2 * height);
}

struct point single_support_hip(const struct walker *walker, const real *state)
{
    const real l = walker->params.leg_length_m;
    const struct point hip = {l * real_sin(state[STANCE_ANGLE]), l * real_cos(state[STANCE_ANGLE])};
    return hip;
}

struct point single_support_swing_toe(const struct walker *walker, const real *state)
{
    const real l = walker->params.leg_length_m;
    const struct point toe = {l * (real_sin(state[STANCE_ANGLE]) - real_sin(state[SWING_ANGLE])),
                              l * (real_cos(state[STANCE_ANGLE]) - real_cos(state[SWING_ANGLE]))};
    return toe;
}

struct point single_support_swing_toe_speed(const struct walker *walker, const real *state)
{
    const real l = walker->params.leg_length_m;
    const real stance = l * state[STANCE_RATE], swing = l * state[SWING_RATE];
    const struct point speed = {
        stance * real_cos(state[STANCE_ANGLE]) - swing * real_cos(state[SWING_ANGLE]),
        swing * real_sin(state[SWING_ANGLE]) - stance * real_sin(state[STANCE_ANGLE])};
    return speed;
}
