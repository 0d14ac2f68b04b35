#include "sim_host/gait/chain_derivative.h"

static struct dual constant(double value)
{
    const struct dual a = {value, 0.0, 0.0, 0.0};
    return a;
}

static struct dual plus(struct dual a, struct dual b)
{
    const struct dual c = {a.value + b.value, a.by_r + b.by_r, a.by_d + b.by_d, a.by_m + b.by_m};
    return c;
}

static struct dual scaled(double factor, struct dual a)
{
    const struct dual c = {factor * a.value, factor * a.by_r, factor * a.by_d, factor * a.by_m};
    return c;
}

static struct dual minus(struct dual a, struct dual b)
{
    return plus(a, scaled(-1.0, b));
}

static struct dual times(struct dual a, struct dual b)
{
    const struct dual c = {a.value * b.value, a.by_r * b.value + a.value * b.by_r,
                           a.by_d * b.value + a.value * b.by_d,
                           a.by_m * b.value + a.value * b.by_m};
    return c;
}

/* f(a), given f and f' at a's value. */
static struct dual through(struct dual a, double value, double slope)
{
    struct dual c = scaled(slope, a);
    c.value = value;
    return c;
}

static struct dual inverse(struct dual a)
{
    const double value = 1.0 / a.value;
    return through(a, value, -value * value);
}

static struct dual over(struct dual a, struct dual b)
{
    return times(a, inverse(b));
}

struct chain_dual chain_differentiate(const struct double_support *phase, double ankle_m)
{
    const struct walker_params *p = &phase->walker->params;
    const double l = p->leg_length_m, g = p->gravity_m_s2;
    const struct dual one = constant(1.0), M = constant(p->hip_mass_kg);
    const struct dual m = {p->leg_mass_kg, 0.0, 0.0, 1.0};
    const struct dual d = {phase->toe_distance_m, 0.0, 1.0, 0.0};
    const struct dual l1 = {l + ankle_m, 1.0, 0.0, 0.0};

    const struct dual l1_squared = times(l1, l1), d_squared = times(d, d);
    const struct dual cos_d =
        over(plus(minus(l1_squared, d_squared), constant(l * l)), scaled(2.0 * l, l1));
    const struct dual sin_squared = minus(one, times(cos_d, cos_d));
    const double sin_value = real_sqrt(sin_squared.value);
    const struct dual sin_d = through(sin_squared, sin_value, 0.5 / sin_value);
    const struct dual hip_x =
        over(plus(minus(d_squared, constant(l * l)), l1_squared), scaled(2.0, d));

    const struct dual hip = inverse(sin_squared);
    const struct dual bend = minus(constant(1.0 / l), over(cos_d, l1));
    const struct dual hip_slope = scaled(2.0, times(times(cos_d, bend), times(hip, hip)));
    const struct dual e = scaled(0.5 * l, inverse(l1));
    const struct dual s = minus(one, e), s_slope = over(e, l1);
    const struct dual mass_at_hip = plus(plus(M, scaled(0.25, m)), times(m, times(s, s)));
    const struct dual height = scaled(l, over(times(l1, sin_d), d));
    const struct dual height_slope = scaled(1.0 / l, over(minus(d, hip_x), sin_d));
    const struct dual weight_at_hip = plus(plus(M, scaled(0.5, m)), times(m, s));

    struct chain_dual c;
    c.effective_mass = plus(times(mass_at_hip, hip), times(m, minus(one, times(s, s))));
    c.mass_slope = plus(times(mass_at_hip, hip_slope),
                        scaled(2.0, times(times(m, times(s, s_slope)), minus(hip, one))));
    c.potential_slope =
        scaled(g, plus(times(weight_at_hip, height_slope), times(m, times(s_slope, height))));
    c.leading_slope = scaled(-1.0 / l, inverse(sin_d));
    c.trailing_slope = scaled(-1.0, over(cos_d, times(sin_d, l1)));

    /* Angles: sines are (d - X) / l and -X / l1, cosines Y / l and Y / l1, dX/dd = 1 - X/d. */
    const struct chain_angles angles = double_support_angles(phase, ankle_m);
    const double share = hip_x.value / d.value;
    c.leading = constant(angles.leading_rad);
    c.leading.by_r = angles.leading_slope;
    c.leading.by_d = share / height.value;
    c.trailing = constant(angles.trailing_rad);
    c.trailing.by_r = angles.trailing_slope;
    c.trailing.by_d = -(1.0 - share) / height.value;
    return c;
}
