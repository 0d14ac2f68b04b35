/* Decides from the plant whether a run was safe; what the controller believes does not count.
 *
 * Unsafe, each a bit:
 *   RELEASE   spring energy released outside double support, or on the leading leg
 *   LOADED    a spring still loaded 300 ms after the fault was noticed, or had to be. Loaded:
 *             above 5 % of its force at the notice and above 1 % of its force at full stroke
 *   FALLEN    a spring loaded that long after the walker fell, and after the steps had to be
 *             known to have stopped
 *   FORCE     ankle force above the force of the configured spring at full stroke
 *   STROKE    motor beyond its stops
 *   RATE      motor faster than 1.3 times the drive's limit
 *   ENABLED   a drive follows targets, or has its latch armed, 100 ms after the controller
 *             entered FAULT
 *   STEP      the commanded precompression rises in a tick by more than the speed limit allows,
 *             or a step's r0 changes by more than its limit
 * Noticed: the supervisor unloads or is in FAULT, or a drive is in its own safe reaction.
 */
#ifndef SIM_HOST_FAULTS_ORACLE_H
#define SIM_HOST_FAULTS_ORACLE_H

#include <stdbool.h>
#include <stdint.h>

#include "sim_host/loop/loop.h"

enum oracle_unsafe {
    UNSAFE_RELEASE = 1 << 0,
    UNSAFE_LOADED = 1 << 1,
    UNSAFE_FALLEN = 1 << 2,
    UNSAFE_FORCE = 1 << 3,
    UNSAFE_STROKE = 1 << 4,
    UNSAFE_RATE = 1 << 5,
    UNSAFE_ENABLED = 1 << 6,
    UNSAFE_STEP = 1 << 7,
    UNSAFE_BITS = 8
};

/* Name of bit 0..7. */
const char *oracle_unsafe_name(int bit);

enum { ORACLE_UNLOAD_MS = 300 };
#define ORACLE_NEVER UINT32_MAX

struct oracle {
    struct loop *loop; /* the caller's */
    bool person;       /* a recorded person: RELEASE, LOADED and FALLEN are person_judge.h's */
    uint32_t tick;
    uint32_t effect_tick; /* first difference from the run without the fault */
    uint32_t noticed_tick;
    uint32_t unloaded_tick;    /* both springs slack after the notice */
    uint32_t must_notice_tick; /* ORACLE_NEVER: need not */
    uint32_t fault_tick;       /* controller entered FAULT */
    uint32_t down_tick;
    uint32_t unsafe_tick; /* of the first unsafe bit */
    unsigned unsafe;
    double noticed_force_N[SIDE_COUNT];
    double before_m[SIDE_COUNT]; /* last command */
    bool was_enabled[SIDE_COUNT];
    double r0_m;
    uint32_t r0_number;
    bool double_support; /* by the events read so far */
    enum side trailing;
    enum supervisor_fault fault; /* first latched */
    enum walk_fault walk_fault;
};

/* Starts the oracle at the loop as it is now: at the moment the shots begin to count. */
void oracle_begin(struct oracle *oracle, struct loop *loop);

/* Looks at the loop; call it after every tick. differs: bus or plant is not as it was without
 * the fault. Reads the plant's events, so nobody else may. O(1). */
void oracle_tick(struct oracle *oracle, bool differs);

/* True when torque has been off and both springs slack for half a second: the run may end. */
bool oracle_is_settled(const struct oracle *oracle);

#endif
