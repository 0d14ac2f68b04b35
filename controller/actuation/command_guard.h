/* The last gate before the drives: no command rises too fast, none lies out of reach, none is not
 * a number.
 *
 * The stages before keep to their limits. The guard does not rely on that: its limits are numbers
 * of its own, computed when the device engaged, because a failing memory may change the parameters
 * before the check of their CRC notices.
 */
#ifndef CONTROLLER_ACTUATION_COMMAND_GUARD_H
#define CONTROLLER_ACTUATION_COMMAND_GUARD_H

#include "controller/control_params.h"
#include "controller/signals.h"

#define command_guard_begin REAL_SYMBOL(command_guard_begin)
#define command_guard_begin_motions REAL_SYMBOL(command_guard_begin_motions)
#define command_guard_limit REAL_SYMBOL(command_guard_limit)

struct command_guard {
    real slew_limit_m;                   /* what a command may rise in one tick */
    real command_limit_m;                /* and how far a command may lie on either side of zero */
    struct sea_request last[SIDE_COUNT]; /* the requests of the last tick */
};

/* A walk begins: the limits by the parameters of now. No command lies further than the largest r0, r0_max_m
 * or the ceiling to which it may be raised, and sea_tolerance_m, where a slack spring may begin. */
void command_guard_begin(struct command_guard *guard, const struct control_params *params);

/* Commissioning: commands up to this share of r0_max_m, and slower than a step's. */
void command_guard_begin_motions(struct command_guard *guard, const struct control_params *params,
                                 real share);

/* Once a tick, on both requests. Where powered, limits their rise against those of the last tick. What
 * has risen to command_limit_m is held there and disarmed. A request that is not finite, below
 * -command_limit_m, or beyond the limit in the first tick becomes zero, disabled and disarmed. Where not
 * powered, each request becomes that. Remembers both for the next tick. Constant cost. */
void command_guard_limit(struct command_guard *guard, bool powered,
                         struct sea_request request[SIDE_COUNT]);

#endif
