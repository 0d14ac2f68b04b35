/* The return map: from one apex (stance leg vertical, walking forward) to the next.
 *
 * Apex -> single support -> heel strike -> collision (and clamp) -> double support -> lift-off, legs
 * swap names -> single support -> apex. Paper eq. (12). Needs nothing but its arguments and keeps
 * nothing, so any number of walkers can be run side by side.
 */
#ifndef MODEL_STRIDE_H
#define MODEL_STRIDE_H

#include "model/ground.h"
#include "model/integrator.h"
#include "model/single_support.h"

struct apex {
    real stance_rate_rad_s; /* < 0; forward speed v = -stance_rate */
    real swing_angle_rad;
    real swing_rate_rad_s;
};

/* Why a stride has no next apex. Values are stable: they appear in logs. */
enum stride_fault {
    STRIDE_OK = 0,
    STRIDE_BAD_INPUT = 1,          /* a parameter out of range, a number that is not finite */
    STRIDE_WALKING_BACKWARDS = 2,  /* the stance rate came to be zero or positive */
    STRIDE_NO_ROOM_TO_EXTEND = 3,  /* toe distance d <= r0 */
    STRIDE_NO_LIFT_OFF = 4,        /* the ankle turned back (r' < 0), or took too long */
    STRIDE_FALLEN = 5,             /* |ts| > pi/2: the torso is below ground */
    STRIDE_INTER_LEG_ANGLE = 6,    /* more than pi between the legs */
    STRIDE_NO_HEEL_STRIKE = 7,     /* not within the time limit */
    STRIDE_LIFT_OFF_PAST_APEX = 8, /* the new stance leg was already past the vertical */
    STRIDE_NO_APEX = 9,            /* not reached within the time limit */
    STRIDE_NOT_FINITE = 10         /* the equations left the range of numbers */
};
#define STRIDE_FAULT_COUNT 11

/* How to integrate. Steps in seconds, all > 0. */
struct stride_settings {
    ode_method *method;
    real single_step_s; /* in single support */
    real double_step_s; /* in double support */
    real phase_limit_s; /* longest duration of one phase */
};

struct stride_result {
    enum stride_fault fault;
    struct apex
        next; /* valid when fault == STRIDE_OK, as all below; on a fault: as far as it got, else 0 */
    real apex_to_strike_s;
    real double_support_s;
    real lift_off_to_apex_s;
    real strike[SINGLE_SUPPORT_STATES]; /* just before the collision */
    real lift_off
        [SINGLE_SUPPORT_STATES]; /* just after, legs renamed: start of the new single support */
    real incline_rad;            /* of the line from toe to toe at heel strike; 0 on level ground */
    real inter_leg_rad;          /* 2a, at heel strike */
    real step_length_m;          /* d, toe to toe */
    real ankle_rate_m_s;         /* r'+ after collision and clamp */
    int clamped;                 /* the clamp acted */
};

#define stride_settings_fixed REAL_SYMBOL(stride_settings_fixed)
#define stride_settings_accurate REAL_SYMBOL(stride_settings_accurate)
#define stride REAL_SYMBOL(stride)
#define stride_on_ground REAL_SYMBOL(stride_on_ground)
#define stride_to_strike_on_ground REAL_SYMBOL(stride_to_strike_on_ground)
#define stride_from_lift_off REAL_SYMBOL(stride_from_lift_off)
#define stride_push_off REAL_SYMBOL(stride_push_off)
#define stride_to_strike REAL_SYMBOL(stride_to_strike)
#define stride_fault_name REAL_SYMBOL(stride_fault_name)

/* RK4 with steps of step_s > 0: for float, and where the step is given (1 ms). */
struct stride_settings stride_settings_fixed(const struct walker *walker, real step_s);

/* RK8 with steps scaled to the walker: in double, apex states good to about 1e-11 (tests hold it to 1e-10). */
struct stride_settings stride_settings_accurate(const struct walker *walker);

/* One stride with the spring's rest length (push-off) spring_rest_m = r0 >= 0, m.
 * Returns the fault, also in result->fault; never a NaN in result->next when STRIDE_OK.
 * The caller owns all; nothing is kept. Bounded: at most 2 * limit / step + 200 integration steps. */
enum stride_fault stride(const struct walker *walker, const struct stride_settings *settings,
                         const struct apex *from, real spring_rest_m, struct stride_result *result);

/* The same on ground that slopes, or with the next foothold higher or lower. Angles stay measured from
 * the vertical, the apex stays where the stance leg is vertical. *ground: slope below pi/2 in size, both
 * finite, else STRIDE_BAD_INPUT. */
enum stride_fault stride_on_ground(const struct walker *walker,
                                   const struct stride_settings *settings, const struct apex *from,
                                   real spring_rest_m, const struct ground *ground,
                                   struct stride_result *result);

/* The three phases by themselves, each with the faults of its own; each reads what the one before
 * it left in *result (apex -> strike -> lift_off -> next), so a caller may start anywhere. */
enum stride_fault stride_to_strike(const struct walker *walker,
                                   const struct stride_settings *settings, const struct apex *from,
                                   struct stride_result *result);
enum stride_fault stride_to_strike_on_ground(const struct walker *walker,
                                             const struct stride_settings *settings,
                                             const struct apex *from, const struct ground *ground,
                                             struct stride_result *result);
enum stride_fault stride_push_off(const struct walker *walker,
                                  const struct stride_settings *settings, real spring_rest_m,
                                  struct stride_result *result);
enum stride_fault stride_from_lift_off(const struct walker *walker,
                                       const struct stride_settings *settings,
                                       struct stride_result *result);

/* "walking backwards" and so on. A static string; never NULL, also for values outside the enum. */
const char *stride_fault_name(enum stride_fault fault);

#endif
