/* A walk at 0.6 rad/s in the simulated loop, ticked by the injector of faults: the default subject, or another.
 *
 * The loop and the injector are the caller's, and may be static: nothing here has memory of its own.
 */
#ifndef TESTS_SUPPORT_INJECTED_WALK_H
#define TESTS_SUPPORT_INJECTED_WALK_H

#include "sim_host/faults/injector.h"
#include "tests/support/assert_close.h"

/* No walk of these tests takes longer to its first steps. */
enum { INJECTED_WALK_TICKS_MAX = 60000 };

/* Makes a loop that is about to walk. subject: NULL for the default one. engage_steps: a person has the device
 * on, and the springs engage after so many steps; 0: a compass walker on the bench. The test fails where the
 * subject or the loop is refused. */
static inline void injected_walk_prepare(struct loop *loop, const struct subject *subject,
                                         unsigned engage_steps)
{
    struct subject taken;
    struct control_params params;
    struct loop_config config;
    char message[LOOP_MESSAGE_MAX] = "";
    if (subject != NULL) {
        taken = *subject;
    } else {
        subject_default(&taken);
    }
    ck_assert_msg(subject_control_params(&taken, &params, message) == 0, "%s", message);
    params.start_r0_m = speed_table_inverse(&params.table, (real)0.6);
    ck_assert_msg(loop_configure(&config, &taken, &params, 0.6, SENSORS_17BIT, 1, message) == 0,
                  "%s", message);
    if (engage_steps > 0) {
        loop_configure_person(&config, engage_steps);
    }
    ck_assert_msg(loop_init(loop, &config, NULL, message) == 0, "%s", message);
}

/* Ticks a prepared loop until its law has planned so many steps, without a fault of the injector. The test fails
 * where it does not walk then. */
static inline void injected_walk_begin(struct injector *injector, struct loop *loop, unsigned steps)
{
    ck_assert(injector_prepare(loop));
    injector_begin(injector, loop, NULL, 0);
    while (loop->tick < INJECTED_WALK_TICKS_MAX &&
           loop->rig.task.controller.plan.law.steps < steps) {
        injector_tick(injector);
    }
    ck_assert_int_eq(loop->rig.task.output.state, SUPERVISOR_WALKING);
}

#endif
