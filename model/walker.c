#include "model/walker.h"

struct limit {
    enum walker_error error;
    real low, high;
};

static int is_outside(real value, const struct limit *limit)
{
    return !(value >= limit->low && value <= limit->high); /* a NaN is outside, too */
}

enum walker_error walker_init(struct walker *walker, const struct walker_params *params)
{
    static const struct limit limits[] = {
        {WALKER_BAD_HIP_MASS, REAL(1e-3), REAL(1e4)},
        {WALKER_BAD_LEG_MASS, REAL(0.0), REAL(1e4)},
        {WALKER_BAD_LEG_LENGTH, REAL(0.01), REAL(100.0)},
        {WALKER_BAD_ANKLE_STIFFNESS, REAL(1e-3), REAL(1e8)},
        {WALKER_BAD_GRAVITY, REAL(1e-3), REAL(1e3)},
    };
    const real values[] = {params->hip_mass_kg, params->leg_mass_kg, params->leg_length_m,
                           params->ankle_stiffness_N_m, params->gravity_m_s2};
    _Static_assert(sizeof values / sizeof values[0] == sizeof limits / sizeof limits[0],
                   "a limit per field");
    for (unsigned i = 0; i < sizeof limits / sizeof limits[0]; i++) {
        if (is_outside(values[i], &limits[i])) {
            return limits[i].error;
        }
    }
    if (params->leg_mass_kg > params->hip_mass_kg) {
        return WALKER_BAD_MASS_RATIO;
    }
    const real M = params->hip_mass_kg, m = params->leg_mass_kg;
    walker->params = *params;
    walker->gravity_per_length_s2 = params->gravity_m_s2 / params->leg_length_m;
    walker->stance_inertia_kg = M + REAL(1.25) * m;
    walker->stance_weight_kg = M + REAL(1.5) * m;
    walker->half_leg_mass_kg = REAL(0.5) * m;
    walker->time_unit_s = real_sqrt(params->leg_length_m / params->gravity_m_s2);
    walker->push_time_s = real_sqrt((M + REAL(2.0) * m) / params->ankle_stiffness_N_m);
    return WALKER_OK;
}

const char *walker_error_name(enum walker_error error)
{
    switch (error) {
    case WALKER_OK:
        return "parameters are good";
    case WALKER_BAD_HIP_MASS:
        return "hip mass M must be 0.001 to 10000 kg";
    case WALKER_BAD_LEG_MASS:
        return "leg mass m must be 0 to 10000 kg";
    case WALKER_BAD_LEG_LENGTH:
        return "leg length l must be 0.01 to 100 m";
    case WALKER_BAD_ANKLE_STIFFNESS:
        return "ankle stiffness k must be 0.001 to 1e8 N/m";
    case WALKER_BAD_GRAVITY:
        return "gravity g must be 0.001 to 1000 m/s^2";
    case WALKER_BAD_MASS_RATIO:
        return "leg mass m must not be larger than the hip mass M";
    }
    return "unknown parameter error";
}

struct walker_params walker_paper_params(void)
{
    const struct walker_params paper = {REAL(1.0), REAL(0.01), REAL(1.0), REAL(100.0),
                                        REAL(9.80665)};
    return paper;
}
