#include "model/double_support.h"

#include "model/trig.h"

/* The triangle of trailing leg, leading leg and ground. */
struct triangle {
    real trailing_m;   /* l1 = l + r */
    real cos_d, sin_d; /* of the angle between the legs, at the hip; sin_d > 0 */
    real hip_x_m;      /* X: the hip is at (-X, Y) from the trailing toe */
};

static struct triangle triangle_of(const struct double_support *phase, real ankle_m)
{
    const real l = phase->walker->params.leg_length_m, d = phase->toe_distance_m;
    struct triangle t;
    t.trailing_m = l + ankle_m;
    const real l1_squared = t.trailing_m * t.trailing_m;
    t.cos_d = (l1_squared + l * l - d * d) / (REAL(2.0) * l * t.trailing_m);
    t.sin_d = real_sqrt(REAL(1.0) - t.cos_d * t.cos_d);
    t.hip_x_m = (d * d - l * l + l1_squared) / (REAL(2.0) * d);
    return t;
}

int double_support_is_possible(const struct double_support *phase, real ankle_m)
{
    const real l = phase->walker->params.leg_length_m, l1 = l + ankle_m, d = phase->toe_distance_m;
    return l1 > REAL(0.0) && d > REAL(0.0) && l1 < l + d && l < l1 + d && d < l + l1;
}

void double_support_incline(struct double_support *phase, real incline_rad)
{
    const real half = real_sin(REAL(0.5) * incline_rad);
    phase->incline_rad = incline_rad;
    phase->incline_sin = real_sin(incline_rad);
    phase->incline_versine = REAL(2.0) * half * half;
}

struct chain double_support_chain(const struct double_support *phase, real ankle_m)
{
    const struct walker *w = phase->walker;
    const real M = w->params.hip_mass_kg, m = w->params.leg_mass_kg, l = w->params.leg_length_m;
    const real g = w->params.gravity_m_s2, d = phase->toe_distance_m;
    const struct triangle t = triangle_of(phase, ankle_m);

    /* Hip speed squared per r'^2, and its derivative; cos_d' = 1/l - cos_d/l1. */
    const real hip = REAL(1.0) / (t.sin_d * t.sin_d);
    const real hip_slope =
        REAL(2.0) * t.cos_d * (REAL(1.0) / l - t.cos_d / t.trailing_m) * hip * hip;
    /* The trailing leg's mass is at share s = (r + l/2) / (l + r) of the way to the hip: radial speed 1,
     * tangential speed s times the hip's, hence s^2 (hip - 1) + 1. */
    const real e = REAL(0.5) * l / t.trailing_m;
    const real s = REAL(1.0) - e;
    const real s_slope = e / t.trailing_m;
    const real mass_at_hip = M + REAL(0.25) * m + m * s * s;
    /* Height of the hip and its derivative: the leading leg's lean over sin_d; on an incline the hip's way
     * along the line of the toes is a height, too. */
    const real level = t.trailing_m * l * t.sin_d / d;
    const real level_slope = (d - t.hip_x_m) / (l * t.sin_d);
    const real height = level - level * phase->incline_versine + t.hip_x_m * phase->incline_sin;
    const real height_slope =
        level_slope - level_slope * phase->incline_versine + t.trailing_m / d * phase->incline_sin;
    const real weight_at_hip = M + REAL(0.5) * m + m * s;

    struct chain chain;
    chain.effective_mass_kg = mass_at_hip * hip + m * (REAL(1.0) - s * s);
    chain.mass_slope_kg_m =
        mass_at_hip * hip_slope + REAL(2.0) * m * s * s_slope * (hip - REAL(1.0));
    chain.potential_J = g * weight_at_hip * height;
    chain.potential_slope_N = g * (weight_at_hip * height_slope + m * s_slope * height);
    return chain;
}

struct chain_angles double_support_angles(const struct double_support *phase, real ankle_m)
{
    const real l = phase->walker->params.leg_length_m, d = phase->toe_distance_m;
    const struct triangle t = triangle_of(phase, ankle_m);
    struct chain_angles a;
    a.trailing_rad = real_acos(t.hip_x_m / t.trailing_m) - REAL_HALF_PI + phase->incline_rad;
    a.leading_rad = REAL_HALF_PI - real_acos((d - t.hip_x_m) / l) + phase->incline_rad;
    /* The hip's velocity, r' / sin D at right angles to the leading leg, has the tangential part
     * r' cos D / sin D on the trailing leg; it swings the leading leg forward over its toe. */
    a.trailing_slope = -t.cos_d / (t.sin_d * t.trailing_m);
    a.leading_slope = REAL(-1.0) / (t.sin_d * l);
    return a;
}

void double_support_rates(const void *context, const real *state, real *rates)
{
    const struct double_support *phase = (const struct double_support *)context;
    const struct chain chain = double_support_chain(phase, state[ANKLE]);
    const real v = state[ANKLE_RATE];
    const real spring =
        phase->walker->params.ankle_stiffness_N_m * (phase->spring_rest_m - state[ANKLE]);
    rates[ANKLE] = v;
    rates[ANKLE_RATE] =
        (spring - chain.potential_slope_N - REAL(0.5) * chain.mass_slope_kg_m * v * v) /
        chain.effective_mass_kg;
}

real double_support_energy_J(const struct double_support *phase, const real *state)
{
    const struct chain chain = double_support_chain(phase, state[ANKLE]);
    const real stretch = phase->spring_rest_m - state[ANKLE];
    return REAL(0.5) * chain.effective_mass_kg * state[ANKLE_RATE] * state[ANKLE_RATE] +
           chain.potential_J +
           REAL(0.5) * phase->walker->params.ankle_stiffness_N_m * stretch * stretch;
}
