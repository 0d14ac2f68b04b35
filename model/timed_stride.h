/* A stride whose spring is released before, at or after heel strike.
 *
 * Early: the stance ankle extends while the other leg still swings (three degrees of freedom: stance angle,
 * swing angle, ankle), the strike comes when l + r and l reach the same ground, and the general collision map
 * with r and r' before impact applies. The heel stays down as long as spring and motion do not lift it.
 * Late: double support begins with the spring held; the ankle extends freely until the release.
 * At 0 it is stride(). Level ground.
 */
#ifndef MODEL_TIMED_STRIDE_H
#define MODEL_TIMED_STRIDE_H

#include "model/stride.h"

#define timed_stride REAL_SYMBOL(timed_stride)
#define push_support_rates REAL_SYMBOL(push_support_rates)

/* State of single support with the ankle free. */
enum push_support_index {
    PUSH_STANCE_ANGLE = 0,
    PUSH_SWING_ANGLE = 1,
    PUSH_ANKLE = 2,
    PUSH_STANCE_RATE = 3,
    PUSH_SWING_RATE = 4,
    PUSH_ANKLE_RATE = 5,
    PUSH_SUPPORT_STATES = 6
};

/* Context of push_support_rates. */
struct push_support {
    const struct walker *walker; /* kept by the caller */
    real spring_rest_m;          /* r0 */
};

/* d(state)/dt with the toe pinned, the spring acting and the heel free (Lagrange; the same drawing as
 * general collision of model/README.md). The swing leg needs a mass: m > 0. Constant cost. */
void push_support_rates(const void *push_support, const real *state, real *rates);

/* stride() with the release release_s after the heel strike that would happen without it (< 0: before it).
 * Precondition: m > 0. Faults beside stride()'s: STRIDE_NO_LIFT_OFF also when the spring has run out before
 * the strike (the walker would fly). Returns the fault, also in result->fault; strike[] and apex_to_strike_s
 * are those of the true strike. Bounded like stride(). */
enum stride_fault timed_stride(const struct walker *walker, const struct stride_settings *settings,
                               const struct apex *from, real spring_rest_m, real release_s,
                               struct stride_result *result);

#endif
