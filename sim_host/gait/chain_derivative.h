/* Double support's closed chain with its derivatives by r, d and m. Double only. */
#ifndef SIM_HOST_GAIT_CHAIN_DERIVATIVE_H
#define SIM_HOST_GAIT_CHAIN_DERIVATIVE_H

#include "model/double_support.h"

/* A number with its derivatives by the ankle's extension r, the toe distance d and a leg's mass m. */
struct dual {
    double value, by_r, by_d, by_m;
};

struct chain_dual {
    struct dual effective_mass, mass_slope, potential_slope; /* mu, mu', dV/dr */
    struct dual leading, trailing;                           /* angles */
    struct dual leading_slope, trailing_slope;               /* by r */
};

/* Same equations as model/double_support.c; same precondition. */
struct chain_dual chain_differentiate(const struct double_support *phase, double ankle_m);

#endif
