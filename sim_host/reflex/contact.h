/* A foot on the ground: heel and ball, each a spring with damping square to it, and a bristle along it.
 *
 * Square to the ground, after Hunt & Crossley (1975):  N = k d (1 - y'/v) for the depth d, never pulling. k and v are softer than
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
    double hold_m; /* where along the ground (ground_frame.along) it is held; while it touches */
};

/* The ground below a foot, a straight line. All zero: level, at height 0. */
struct ground_line {
    double height_m; /* where x is 0 */
    double slope;    /* rise over run; uphill walking forward is positive */
};

static inline double ground_height_m(const struct ground_line *ground, double x_m)
{
    return ground->height_m + ground->slope * x_m;
}

/* The same as contacts use it. */
struct ground_frame {
    struct vector2 along; /* of length 1 */
    double offset_m;      /* of the line, square to itself, from the origin */
};

/* Cost: a square root. */
struct ground_frame ground_frame_of(const struct ground_line *ground);

/* A foot's sole on feet of this mass: 40 kN/m for 80 kg. */
void contact_default(double mass_kg, struct contact_params *params);

/* The ground's force on the point, N. *slides_to (or NULL): where it is held from now on. */
struct vector2 contact_force(const struct contact_params *params, const struct contact_point *point,
                             struct vector2 position_m, struct vector2 velocity_m_s,
                             const struct ground_frame *ground, double *slides_to);

/* After a step: whether it touches, and where it is held. */
void contact_update(const struct contact_params *params, struct contact_point *point,
                    struct vector2 position_m, struct vector2 velocity_m_s,
                    const struct ground_frame *ground);

#endif
