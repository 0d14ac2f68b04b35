/* The ground of one stride: where the next foothold lies as seen from this one.
 *
 * Angles stay measured from the vertical. Between two footholds nothing but the strike and the double
 * support notice the ground: the line from toe to toe is inclined by some angle e, the legs (of equal
 * length) are then symmetric about its normal, ts + tn = 2 e, and the closed chain of the double
 * support is the level one turned by e. A foothold of another height is met where the toe comes down to it with
 * ts + tn falling; what the toe does as it passes the stance foot is the scuff that is ignored on level
 * ground, too (Byl, Tedrake 2009 draw uneven ground in the same way).
 */
#ifndef MODEL_GROUND_H
#define MODEL_GROUND_H

#include "model/real.h"

/* All zero = level ground. */
struct ground {
    real slope_rad;   /* > 0 uphill in walking direction (-x), below pi/2 in size */
    real height_rise; /* next foothold above the slope line through this one, in leg lengths */
};

#define ground_incline_rad REAL_SYMBOL(ground_incline_rad)

/* The incline e of the line from toe to toe for a foothold at inter-leg angle |D| = inter_leg_rad.
 * Exactly 0 on level ground, exactly the slope without rise. A rise that the step cannot reach gives
 * the steepest incline. Constant cost; callable from anywhere. */
real ground_incline_rad(const struct ground *ground, real inter_leg_rad);

#endif
