#include "sim_host/reflex/contact.h"

#include <math.h>
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

struct ground_frame ground_frame_of(const struct ground_line *ground)
{
    const double cosine = 1.0 / sqrt(1.0 + ground->slope * ground->slope);
    return (struct ground_frame){{cosine, cosine * ground->slope}, cosine * ground->height_m};
}

/* Along the ground and square to it. */
static struct vector2 on_ground(const struct ground_frame *ground, struct vector2 vector)
{
    const struct vector2 along = ground->along;
    return (struct vector2){along.x * vector.x + along.y * vector.y,
                            along.x * vector.y - along.y * vector.x};
}

static struct vector2 in_world(const struct ground_frame *ground, struct vector2 vector)
{
    const struct vector2 along = ground->along;
    return (struct vector2){along.x * vector.x - along.y * vector.y,
                            along.y * vector.x + along.x * vector.y};
}

struct vector2 contact_force(const struct contact_params *params, const struct contact_point *point,
                             struct vector2 position_m, struct vector2 velocity_m_s,
                             const struct ground_frame *ground, double *slides_to)
{
    const struct vector2 at_m = on_ground(ground, position_m);
    const struct vector2 speed_m_s = on_ground(ground, velocity_m_s);
    const double depth_m = ground->offset_m - at_m.y;
    const double hold_m = point->touches ? point->hold_m : at_m.x;
    struct vector2 force = {0.0, 0.0};
    if (slides_to != NULL) {
        *slides_to = hold_m;
    }
    if (depth_m <= 0.0) {
        return force;
    }
    force.y = params->stiffness_N_m * depth_m * (1.0 - speed_m_s.y / params->give_m_s);
    force.y = force.y > 0.0 ? force.y : 0.0;
    const double most = params->friction * force.y;
    const double damping = params->hold_damping_Ns_m * speed_m_s.x;
    force.x = -params->hold_N_m * (at_m.x - hold_m) - damping;
    if (force.x > most || force.x < -most) {
        force.x = force.x > 0.0 ? most : -most;
        if (slides_to != NULL) {
            *slides_to = at_m.x + (force.x + damping) / params->hold_N_m;
        }
    }
    return in_world(ground, force);
}

void contact_update(const struct contact_params *params, struct contact_point *point,
                    struct vector2 position_m, struct vector2 velocity_m_s,
                    const struct ground_frame *ground)
{
    double hold_m;
    (void)contact_force(params, point, position_m, velocity_m_s, ground, &hold_m);
    point->touches = ground->offset_m - on_ground(ground, position_m).y > 0.0;
    point->hold_m = hold_m;
}
