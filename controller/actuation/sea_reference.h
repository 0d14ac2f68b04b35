/* From the step's precompression to the motor's reference and the latch, per leg.
 *
 *   UNLOADED --own heel strike--> LOADING (towards the last r0)
 *   LOADING --apex, the law's r0--> TRIMMED --spring at r0--> ARMED
 *   ARMED, other foot lands--> the node releases by itself; reference is held
 *   --own lift-off--> UNLOADING --spring slack--> UNLOADED
 *
 * The reference is limited in speed and acceleration, so that it never steps.
 * The latch is armed only past the apex, with the law's r0 loaded, and is
 * disarmed at lift-off: at no other time can the node release the spring.
 */
#ifndef CONTROLLER_ACTUATION_SEA_REFERENCE_H
#define CONTROLLER_ACTUATION_SEA_REFERENCE_H

#include "controller/control_params.h"
#include "controller/signals.h"

#define sea_reference_init REAL_SYMBOL(sea_reference_init)
#define sea_reference_begin_loading REAL_SYMBOL(sea_reference_begin_loading)
#define sea_reference_set_target REAL_SYMBOL(sea_reference_set_target)
#define sea_reference_hurry_back REAL_SYMBOL(sea_reference_hurry_back)
#define sea_reference_unload REAL_SYMBOL(sea_reference_unload)
#define sea_reference_stop_limits REAL_SYMBOL(sea_reference_stop_limits)
#define sea_reference_stop REAL_SYMBOL(sea_reference_stop)
#define sea_reference_update REAL_SYMBOL(sea_reference_update)

enum sea_phase {
    SEA_UNLOADED = 0,
    SEA_LOADING = 1,
    SEA_TRIMMED = 2,
    SEA_ARMED = 3,
    SEA_UNLOADING = 4
};

struct sea_reference {
    enum sea_phase phase;
    real target_m;   /* where the motor shall go, metres of spring */
    real position_m; /* the reference now */
    real speed_m_s;
    real stop_speed_m_s; /* > 0: unloading in a hurry or because of a stop, with these limits */
    real stop_acceleration_m_s2;
};

/* Limits of a stop: numbers of their own, which no change of the parameters touches. */
struct sea_stop {
    real speed_m_s;
    real acceleration_m_s2;
    real left_behind_m; /* a motor this far behind its reference is not made to chase it */
};

/* Starts unloaded with the reference at the motor's position, so that enabling
 * does not kick. position_m is the measured one. */
void sea_reference_init(struct sea_reference *sea, real position_m);

/* Stance begins: compress towards r0_m (the last step's). */
void sea_reference_begin_loading(struct sea_reference *sea, real r0_m);

/* The law's answer for this push-off; ignored unless the spring is being loaded. */
void sea_reference_set_target(struct sea_reference *sea, real r0_m);

/* Back to zero, disarmed: after lift-off, and at every stop. */
void sea_reference_unload(struct sea_reference *sea);

/* Back to zero with limits of its own, until it is loaded again. */
void sea_reference_hurry_back(struct sea_reference *sea, real speed_m_s, real acceleration_m_s2);

/* The limits of stops under these parameters: faster than a step. */
struct sea_stop sea_reference_stop_limits(const struct control_params *params);

/* Unloads with the limits of a stop, until the next init. A reference that the motor has left
 * behind begins at the motor. measured_m is the motor's position in metres of spring. */
void sea_reference_stop(struct sea_reference *sea, const struct sea_stop *limits, real measured_m);

/* Advances one tick. measured_m is the motor's position in metres of spring.
 * The command's enable field is left to the supervisor. Constant cost. */
struct sea_request sea_reference_update(struct sea_reference *sea,
                                        const struct control_params *params, real measured_m);

#endif
