/* A foot on the ground: heel and ball, each a spring with damping upward, and a bristle along the ground.
 *
 * Upward, after Hunt & Crossley (1975):  N = k d (1 - y'/v) for the depth d, never pulling. k and v are softer than
 * Geyer & Herr's (2010), whose foot meets the ground with several body weights. Along the ground the point is held by
 * a spring and a damper at where it came down; beyond mu N it slides, and takes its hold along.
 *
 * Pure functions, constant cost; only + - * / sqrt.
 */
#ifndef SIM_HOST_REFLEX_CONTACT_H
#define SIM_HOST_REFLEX_CONTACT_H

#include <stdbool.h>

#include "sim_host/reflex/multibody.h"

struct contact_params {
    double stiffness_N_m,
        give_m_s; /* k and v: the speed upward at which a pressed point presses no more */
    double hold_N_m, hold_damping_Ns_m;
    double friction; /* mu */
};

struct contact_point {
    bool touches;
    double hold_m; /* where along the ground it is held; while it touches */
};

/* A foot's sole on feet of this mass: 40 kN/m for 80 kg. */
void contact_default(double mass_kg, struct contact_params *params);

/* The ground's force on the point, N. height_m: of the ground below it. *slides_to (or NULL): where it is held from
 * now on. */
struct vector2 contact_force(const struct contact_params *params, const struct contact_point *point,
                             struct vector2 position_m, struct vector2 velocity_m_s,
                             double height_m, double *slides_to);

/* After a step: whether it touches, and where it is held. */
void contact_update(const struct contact_params *params, struct contact_point *point,
                    struct vector2 position_m, struct vector2 velocity_m_s, double height_m);

#endif
