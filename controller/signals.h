/* What flows between the stages of the controller, with the unit in each name.
 *
 * One tick, in the order of controller_update():
 *
 *        .------------------ last requests, of the tick before ------------------.
 *        v                                                                       |
 *   sense -> screen -> supervise -> estimate -> decide -> actuate -> guard ------+--> drives
 *                         ^  \         |   \       ^         ^ ^
 *                         |   \        |    \      |         | |
 *                         |    `-- state: may it move? ---------|
 *                         |            |      `-- gait_state ---'
 *                         `------------'
 *                  gait_state of the tick before: the
 *                  supervisor runs ahead of the observer
 *
 * Every stage after `screen` sees all screened measurements. So the motors' positions also reach
 * `estimate`: the observer takes them for the springs' rest lengths.
 *
 * Angles follow model/: 0 is vertical, positive is the foot ahead of the hip, so
 * the stance leg's angle falls while walking forward. Arrays are indexed by
 * enum side. Enum values are explicit: they appear on the bus and in logs.
 */
#ifndef CONTROLLER_SIGNALS_H
#define CONTROLLER_SIGNALS_H

#include <stdbool.h>
#include <stdint.h>

#include "model/foot_contact.h"
#include "model/real.h"
#include "model/sea_state.h"
#include "model/side.h"
#include "model/tick.h"

/* Both computed in double, then rounded once: at 1 ms they are REAL(0.001) and 1000. */
#define CONTROL_PERIOD_S ((real)(TICK_PERIOD_US / 1.0e6))
#define CONTROL_RATE_HZ (1.0e6 / TICK_PERIOD_US)

/* From tick `then` to tick `tick`, which is not before it. */
static inline real seconds_since(uint32_t tick, uint32_t then)
{
    return (real)(tick - then) * CONTROL_PERIOD_S;
}

/* The whole number of ticks nearest to a time from 0 to 4e6 s; 0 for any other time and for NaN. */
static inline uint32_t ticks_from_seconds(real seconds)
{
    return real_is_within(seconds, REAL(0.0), REAL(4.0e6))
               ? (uint32_t)(seconds * (real)CONTROL_RATE_HZ + REAL(0.5))
               : 0u;
}

/* An age that stands for "never received". */
enum { AGE_NEVER = UINT16_MAX };

/* One leg's sensor, as sampled at a SYNC. */
struct leg_measurement {
    real leg_angle_rad;     /* -pi..pi */
    real ankle_extension_m; /* 0 = heel down; positive = ankle extended */
    uint16_t age_ticks;     /* 0 = sampled at the newest SYNC; AGE_NEVER = no value yet */
    enum foot_contact foot; /* of the foot switch, if there is one */
};

struct sea_measurement {
    real precompression_m; /* motor position in metres of spring, 0 = unloaded */
    enum drive_state state;
    uint16_t age_ticks;
    enum latch_state latch;
    real force_N;              /* of the motor on the spring, compression positive */
    uint16_t force_age_ticks;  /* AGE_NEVER = the drive's protocol does not tell */
    bool absent;               /* this leg has no drive: nothing is loaded there */
    enum foot_contact contact; /* of the other foot, as the latch's node hears it */
};

/* A motion that a tool asks for at commissioning; the values appear on the bus. */
enum motion_kind {
    MOTION_KIND_NONE = 0,    /* nothing is asked for */
    MOTION_KIND_MOVE = 1,    /* to the share in `seconds`, hold for a moment, and back */
    MOTION_KIND_CHIRP = 2,   /* oscillate between zero and the share, faster and faster */
    MOTION_KIND_RELEASE = 3, /* load, arm the latch for `seconds` or until it opens, and back */
    MOTION_KIND_CUT = 4,     /* load, then send the drives nothing: do they unload by themselves? */
    MOTION_KIND_UNLOAD = 5   /* end what is under way, back to zero */
};

struct motion_request {
    uint8_t order;   /* a change begins the motion below */
    uint8_t renewal; /* a change says that the tool is still there */
    enum motion_kind kind;
    enum side side;
    real share;        /* of the largest load, 0..1 */
    real seconds;      /* above 0, at most MOTION_SECONDS_MOST */
    real frequency_Hz; /* MOTION_KIND_CHIRP: the last one, at least 1 */
};
enum { MOTION_SECONDS_MOST = 20 };

/* Everything one control tick sees. */
struct controller_input {
    uint32_t tick; /* of the SYNC that ended the cycle; the values were sampled at the one before */
    struct leg_measurement leg[SIDE_COUNT];
    struct sea_measurement sea[SIDE_COUNT];
    real desired_speed_rad_s;     /* forward apex speed asked for, > 0 */
    bool nodes_operational;       /* all four nodes alive, in NMT operational, without an error */
    bool node_error;              /* one of them reports an error of its own */
    bool emergency_stop;          /* true = pressed, or its state unknown */
    bool foreign_node;            /* somebody else sends with identifiers of this bus */
    bool node_written;            /* somebody else wrote to a drive or sensor over SDO */
    bool node_changed;            /* a drive is no longer as it was set up */
    bool parameters_corrupt;      /* their checksum is no longer that of the checked ones */
    bool walk_requested;          /* the operator asks for assistance */
    bool wearer_pressed;          /* the wearer's button */
    bool reset_requested;         /* clear a latched fault; obeyed at standstill only */
    bool zero_requested;          /* find the leg sensors' offsets; obeyed while not assisting */
    struct motion_request motion; /* commissioning; obeyed in STANDBY without a walk requested */
};

/* What happened in the gait, at most one of each kind a tick. */
enum gait_event_kind {
    GAIT_APEX = 0,        /* the stance leg passed the vertical */
    GAIT_HEEL_STRIKE = 1, /* side = the foot that landed */
    GAIT_LIFT_OFF = 2,    /* side = the foot that left the ground */
    GAIT_EVENT_KINDS = 3
};

struct gait_event {
    bool happened; /* reported in this tick; the event itself may be older */
    enum side side;
    uint32_t tick;      /* first SYNC at or after the event */
    real before_tick_s; /* the event lies this long before that SYNC, >= 0: interpolated */
    real speed_rad_s;   /* GAIT_APEX: forward speed -theta', > 0; otherwise 0 */
};

/* The walker's whole state at an apex (there the stance leg's angle is 0): what
 * the return map starts from. Written together with the GAIT_APEX event. */
struct apex_estimate {
    real stance_rate_rad_s; /* < 0 walking forward; the event's speed is its negative */
    real swing_angle_rad;
    real swing_rate_rad_s;
    real confidence; /* weight of the model in the values above, 0..1; 0 = from the samples alone */
};

enum gait_phase {
    PHASE_UNKNOWN = 0,
    PHASE_SINGLE_SUPPORT = 1, /* stance = the supporting leg */
    PHASE_DOUBLE_SUPPORT = 2  /* stance = the trailing leg, the one that pushes off */
};

struct gait_state {
    enum gait_phase phase;
    enum side stance;
    uint32_t phase_since_tick;
    bool stance_past_apex; /* single support, and theta_s already negative */
    bool strike_near; /* the stance leg's latch may be armed: the other foot lands, or has landed */
    bool walk_shown;  /* the last step was one of forward walking (a compass walker's always is) */
    bool walk_denied; /* in this tick: what happens is no forward walking */
    uint8_t misplaced; /* sensors or latches of a person: placement.h; 0 = none found */
    struct gait_event event[GAIT_EVENT_KINDS];
    struct apex_estimate apex; /* of the newest GAIT_APEX event; zeros before the first */
    /* Gait phase of each leg: part of its stride gone by since its heel strike, 0..1 (it stays
     * 1 while a stride lasts longer than the ones before); -1 = not known. */
    real stride_share[SIDE_COUNT];
};

/* One SEA's command of this tick. */
struct sea_request {
    real precompression_m; /* 0..stroke limit, already rate limited */
    bool enable;           /* torque on, follow the target */
    bool latch_armed;      /* the node may release by itself at the other foot's heel strike */
};

/* The record of one step, made once, at the apex. */
struct step_record {
    uint32_t number; /* 1 = the first apex; 0 = none yet */
    uint32_t tick;
    enum side side;
    real measured_speed_rad_s;
    real
        commanded_speed_rad_s; /* that the law steers for: after the ramp; on uneven ground it may be more than was asked */
    real r0_m;          /* what the law asked for, after its limits */
    bool used_fallback; /* predictive law: eq. (16) gave it, the search did not */
};

#endif
