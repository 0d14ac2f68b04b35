/* May it move? The one place that decides, as a const table.
 *
 * States and conditions are plain enumerations and bits, so that a program can
 * walk through every state under every combination of conditions. The first row
 * that matches decides; stop rules stand before state rules.
 *
 *   INIT -> SELF_TEST -> STANDBY -> ENGAGING -> WALKING -> UNLOADING -> STANDBY
 *   Any fault: a powered spring is unloaded first (UNLOADING), then torque goes off and
 *   FAULT is latched until a reset at standstill.
 *   In INIT nodes may be missing without a limit of time. Once they are all there, what is
 *   wrong (a drive in fault since power-up) becomes a fault after unload_timeout_s.
 *
 * Commissioning: a tool that renews its request may have one leg moved a little (commissioning/motion.h):
 *   STANDBY -> COMMISSIONING -> UNLOADING -> STANDBY
 * Never while a walk is requested, and a request for one ends it.
 *
 * Engaging: in test mode (engage_steps = 0: a hand supports a walker without a push-off of its
 * own) the first spring is loaded at once and the first apex counts. Otherwise the drives stay
 * at zero spring until so many steady steps have been seen. Either way engaging has a limit of
 * time (conditions.c): a request that no walk follows ends in UNLOADING and is then spent.
 */
#ifndef CONTROLLER_SUPERVISOR_SUPERVISOR_H
#define CONTROLLER_SUPERVISOR_SUPERVISOR_H

#include <stdbool.h>
#include <stdint.h>

#include "model/real.h"

#define supervisor_init REAL_SYMBOL(supervisor_init)
#define supervisor_next REAL_SYMBOL(supervisor_next)
#define supervisor_update REAL_SYMBOL(supervisor_update)
#define supervisor_force_fault REAL_SYMBOL(supervisor_force_fault)
#define supervisor_rows REAL_SYMBOL(supervisor_rows)
#define supervisor_fault_name REAL_SYMBOL(supervisor_fault_name)

/* The values appear on the bus and in logs. */
enum supervisor_state {
    SUPERVISOR_INIT = 0,      /* waiting for the nodes, and for them to be well */
    SUPERVISOR_SELF_TEST = 1, /* values fresh and plausible, springs slack? */
    SUPERVISOR_STANDBY = 2,   /* all well, torque off */
    SUPERVISOR_ENGAGING = 3,  /* drives enabled, steps not verified yet */
    SUPERVISOR_WALKING = 4,
    SUPERVISOR_UNLOADING = 5,     /* bounded-rate unload, then torque off */
    SUPERVISOR_FAULT = 6,         /* latched, torque off */
    SUPERVISOR_COMMISSIONING = 7, /* drives enabled, small motions that a tool asks for */
    SUPERVISOR_STATES = 8
};

/* Why it stopped; the value appears on the bus and in logs. */
enum supervisor_fault {
    SUPERVISOR_FAULT_NONE = 0,
    SUPERVISOR_FAULT_EMERGENCY_STOP = 1,
    SUPERVISOR_FAULT_NODE_LOST = 2, /* heartbeat or NMT state */
    SUPERVISOR_FAULT_SENSOR_STALE = 3,
    SUPERVISOR_FAULT_DRIVE_STALE = 4,
    SUPERVISOR_FAULT_DRIVE = 5,        /* a drive reports fault or left enabled by itself */
    SUPERVISOR_FAULT_SENSOR_RANGE = 6, /* not finite or beyond what a leg can do */
    SUPERVISOR_FAULT_FALL = 7,         /* a leg beyond the fall angle */
    SUPERVISOR_FAULT_PARAMETERS = 8,   /* none usable, or their checksum changed by itself */
    SUPERVISOR_FAULT_SENSOR_RATE = 9,  /* values that no motion explains */
    SUPERVISOR_FAULT_SENSOR_STUCK = 10,
    SUPERVISOR_FAULT_SPRING = 11,    /* motor, ankle, latch and force contradict */
    SUPERVISOR_FAULT_SELF_TEST = 12, /* springs not slack or values not fresh in time: homing */
    SUPERVISOR_FAULT_FOLLOWING = 13, /* the motor does not follow its reference */
    SUPERVISOR_FAULT_LEGS = 14,      /* the same leg carried the body twice in a row */
    SUPERVISOR_FAULT_NOT_FINITE = 15,
    SUPERVISOR_FAULT_UNLOAD = 16,       /* springs not known to be slack in time */
    SUPERVISOR_FAULT_RESTARTED = 17,    /* the processor restarted by itself: crash or watchdog */
    SUPERVISOR_FAULT_FOREIGN = 18,      /* another node sends with identifiers of this bus */
    SUPERVISOR_FAULT_NODE_WRITTEN = 19, /* somebody else wrote to a drive or sensor over SDO */
    SUPERVISOR_FAULT_NODE_CHANGED = 20, /* a drive's setting is not what it was at the set-up */
    SUPERVISOR_FAULT_LATCH_LEFT = 21,   /* what the latch tells did not change in three releases */
    SUPERVISOR_FAULT_LATCH_RIGHT = 22,
    SUPERVISOR_FAULT_PLACEMENT = 23, /* a person's sensors or latches are misplaced: placement.h */
    SUPERVISOR_FAULTS = 24
};

/* Conditions, one bit each. */
enum supervisor_condition {
    SUPERVISOR_IF_FAULT = 1 << 0,     /* some fault condition is true now */
    SUPERVISOR_IF_NODES = 1 << 1,     /* all nodes operational, or one reports an error */
    SUPERVISOR_IF_PLAUSIBLE = 1 << 2, /* no fault, all values fresh, springs slack */
    SUPERVISOR_IF_WALK_REQUESTED = 1 << 3,
    SUPERVISOR_IF_ENABLED = 1 << 4,  /* both drives report enabled */
    SUPERVISOR_IF_STEPPING = 1 << 5, /* an apex within the step time-out */
    SUPERVISOR_IF_UNLOADED = 1 << 6, /* both springs slack */
    SUPERVISOR_IF_TIMEOUT = 1 << 7,  /* the state has lasted as long as it may */
    SUPERVISOR_IF_RESET = 1 << 8,    /* reset asked for */
    SUPERVISOR_IF_STANDSTILL = 1 << 9,
    SUPERVISOR_IF_LATCHED = 1 << 10, /* a fault is latched */
    SUPERVISOR_IF_STEADY = 1 << 11,  /* enough steady steps to begin */
    /* not two unsteady steps, nor three missing pushes, in a row */
    SUPERVISOR_IF_REGULAR = 1 << 12,
    SUPERVISOR_IF_MOTION_REQUESTED = 1 << 13, /* a tool asks for motions, and is still there */
    SUPERVISOR_CONDITION_BITS = 14
};

/* From any state of `from` (bit mask of 1 << state): if all of `require` and
 * none of `forbid` are true, go to `to`. */
struct supervisor_row {
    uint16_t from;
    uint16_t require;
    uint16_t forbid;
    enum supervisor_state to;
};

enum { SUPERVISOR_ROWS = 20 };
extern const struct supervisor_row supervisor_rows[SUPERVISOR_ROWS];

struct supervisor {
    enum supervisor_state state;
    enum supervisor_fault latched; /* the first fault since the last reset */
    uint32_t since_tick;           /* the state began; in INIT, the last tick without all nodes */
    uint32_t updated_tick;         /* of the last supervisor_update that went through its rules */
};

/* Pure: where this table goes from `state` under `conditions` (IF_LATCHED among
 * them); `state` itself when no row matches. Bounded by rows. */
enum supervisor_state supervisor_next(const struct supervisor_row *rows, int count,
                                      enum supervisor_state state, uint16_t conditions);

void supervisor_init(struct supervisor *supervisor);

/* One tick. conditions: bits of enum supervisor_condition (IF_LATCHED is set by
 * this function itself). fault: the reason when IF_FAULT is set. The first fault is
 * latched, in INIT only when it lasts (nodes are still missing); FAULT is never entered
 * without one. In INIT the state's time begins anew while nodes are missing. At most one transition a tick. Returns true when the state changed. */
bool supervisor_update(struct supervisor *supervisor, uint32_t tick, uint16_t conditions,
                       enum supervisor_fault fault);

/* Enters FAULT at once and latches `fault`, whatever the table says: for a fault that is known
 * outside the control loop (no usable settings, a restart). since_tick is left as it is. A reset
 * at standstill ends it as any fault; call it again every tick to make it last. fault: not
 * SUPERVISOR_FAULT_NONE. Constant cost; loop only. */
void supervisor_force_fault(struct supervisor *supervisor, enum supervisor_fault fault);

/* "emergency stop" and so on; a static string, never NULL, for any value. */
const char *supervisor_fault_name(enum supervisor_fault fault);

/* True in the states in which drives may be under torque. */
static inline bool supervisor_may_enable(enum supervisor_state state)
{
    return state == SUPERVISOR_ENGAGING || state == SUPERVISOR_WALKING ||
           state == SUPERVISOR_UNLOADING || state == SUPERVISOR_COMMISSIONING;
}

/* True in the states in which springs are loaded and latches armed for steps. */
static inline bool supervisor_may_assist(enum supervisor_state state)
{
    return state == SUPERVISOR_ENGAGING || state == SUPERVISOR_WALKING;
}

#endif
