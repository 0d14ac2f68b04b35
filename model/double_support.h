/* Double support: both toes on the ground, the trailing ankle's spring extends. One degree of freedom: r.
 *
 * A closed chain: trailing toe at the origin, leading toe at (-d, 0), trailing leg of length l + r,
 * leading leg of length l. All masses' positions follow from r, so
 *     mu(r) r'' = k (r0 - r) - dV/dr - mu'(r) r'^2 / 2.
 * With D the angle between the legs, cos D = ((l+r)^2 + l^2 - d^2) / (2 l (l+r)), the hip moves with
 * speed r' / sin D at right angles to the leading leg; that gives mu without any trigonometry.
 */
#ifndef MODEL_DOUBLE_SUPPORT_H
#define MODEL_DOUBLE_SUPPORT_H

#include "model/walker.h"

enum double_support_index { ANKLE = 0, ANKLE_RATE = 1, DOUBLE_SUPPORT_STATES = 2 }; /* m, m/s */

/* What holds during one double support; context of double_support_rates. */
struct double_support {
    const struct walker *walker; /* kept by the caller */
    real toe_distance_m;         /* d > 0 */
    real spring_rest_m;          /* r0: the motor's position, metres of spring */
    /* Incline of the line from toe to toe, rad, > 0 uphill; with its sine and 1 - cosine, which
     * double_support_incline() sets. All zero on level ground. */
    real incline_rad, incline_sin, incline_versine;
};

/* Everything that follows from r. */
struct chain {
    real effective_mass_kg; /* mu */
    real mass_slope_kg_m;   /* mu' = d mu / dr */
    real potential_J;       /* V, gravity only */
    real potential_slope_N; /* dV/dr */
};

struct chain_angles {
    real trailing_rad, leading_rad;     /* ts, tn of the legs before they swap names */
    real trailing_slope, leading_slope; /* dts/dr, dtn/dr in rad/m */
};

#define double_support_incline REAL_SYMBOL(double_support_incline)
#define double_support_is_possible REAL_SYMBOL(double_support_is_possible)
#define double_support_chain REAL_SYMBOL(double_support_chain)
#define double_support_angles REAL_SYMBOL(double_support_angles)
#define double_support_rates REAL_SYMBOL(double_support_rates)
#define double_support_energy_J REAL_SYMBOL(double_support_energy_J)

/* Turns the ground: sets the three incline fields. */
void double_support_incline(struct double_support *phase, real incline_rad);

/* 1 when the two legs reach between the toes with the ankle at r: the triangle exists and is not flat. */
int double_support_is_possible(const struct double_support *phase, real ankle_m);

/* Precondition of all that follow: double_support_is_possible; else the results are not finite.
 * Constant cost, callable from anywhere. */
struct chain double_support_chain(const struct double_support *phase, real ankle_m);

/* Leg angles and their derivatives by r (two inverse cosines). Rates = slope * r'. */
struct chain_angles double_support_angles(const struct double_support *phase, real ankle_m);

/* d(r, r')/dt with the spring released, in the integrator's form. */
void double_support_rates(const void *phase, const real *state, real *rates);

/* Kinetic + gravitational + spring energy, J; constant along a motion. */
real double_support_energy_J(const struct double_support *phase, const real *state);

#endif
