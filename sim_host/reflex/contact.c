#include "sim_host/reflex/contact.h"

#include <stddef.h>

#define STIFFNESS_PER_KG 500.0 /* N/m: 40 kN/m for 80 kg */
#define GIVE_M_S 0.6
#define HOLD_PER_KG 375.0       /* N/m */
#define HOLD_DAMPING_PER_KG 6.0 /* N s/m */
#define FRICTION 0.8            /* Geyer & Herr (2010), sliding */

void contact_default(double mass_kg, struct contact_params *params)
{
    *params = (struct contact_params){STIFFNESS_PER_KG * mass_kg, GIVE_M_S, HOLD_PER_KG * mass_kg,
                                      HOLD_DAMPING_PER_KG * mass_kg, FRICTION};
}

struct vector2 contact_force(const struct contact_params *params, const struct contact_point *point,
                             struct vector2 position_m, struct vector2 velocity_m_s,
                             double height_m, double *slides_to)
{
    const double depth_m = height_m - position_m.y;
    const double hold_m = point->touches ? point->hold_m : position_m.x;
    struct vector2 force = {0.0, 0.0};
    if (slides_to != NULL) {
        *slides_to = hold_m;
    }
    if (depth_m <= 0.0) {
        return force;
    }
    force.y = params->stiffness_N_m * depth_m * (1.0 - velocity_m_s.y / params->give_m_s);
    force.y = force.y > 0.0 ? force.y : 0.0;
    const double most = params->friction * force.y;
    const double damping = params->hold_damping_Ns_m * velocity_m_s.x;
    force.x = -params->hold_N_m * (position_m.x - hold_m) - damping;
    if (force.x > most || force.x < -most) {
        force.x = force.x > 0.0 ? most : -most;
        if (slides_to != NULL) {
            *slides_to = position_m.x + (force.x + damping) / params->hold_N_m;
        }
    }
    return force;
}

void contact_update(const struct contact_params *params, struct contact_point *point,
                    struct vector2 position_m, struct vector2 velocity_m_s, double height_m)
{
    double hold_m;
    (void)contact_force(params, point, position_m, velocity_m_s, height_m, &hold_m);
    point->touches = height_m - position_m.y > 0.0;
    point->hold_m = hold_m;
}
