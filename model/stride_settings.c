#include "model/stride.h"

/* A phase of walking lasts one to three of the walker's time units sqrt(l/g); slow walks near r0 = 0 take ten. */
#define PHASE_LIMIT_UNITS REAL(60.0)

struct stride_settings stride_settings_fixed(const struct walker *walker, real step_s)
{
    const struct stride_settings settings = {ODE_RK4, step_s, step_s,
                                             PHASE_LIMIT_UNITS * walker->time_unit_s};
    return settings;
}

struct stride_settings stride_settings_accurate(const struct walker *walker)
{
    const struct stride_settings settings = {ODE_RK8, REAL(0.1) * walker->time_unit_s,
                                             REAL(0.2) * walker->push_time_s,
                                             PHASE_LIMIT_UNITS * walker->time_unit_s};
    return settings;
}

const char *stride_fault_name(enum stride_fault fault)
{
    static const char *const names[STRIDE_FAULT_COUNT] = {
        "none",
        "bad input",
        "walking backwards",
        "no room to extend",
        "no lift-off",
        "fallen",
        "inter-leg angle",
        "no heel strike",
        "lift-off past the apex",
        "no apex",
        "not finite",
    };
    return (unsigned)fault < STRIDE_FAULT_COUNT ? names[fault] : "unknown fault";
}
