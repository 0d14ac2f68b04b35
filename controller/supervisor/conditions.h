/* The supervisor's conditions: one bit each, from what the stages before know.
 *
 * The supervisor's table (supervisor.h) sees nothing of the world but these bits. The conditions
 * of the gait (STEPPING, STEADY, REGULAR) come from the step monitor, which runs behind the
 * supervisor: they are one tick old.
 */
#ifndef CONTROLLER_SUPERVISOR_CONDITIONS_H
#define CONTROLLER_SUPERVISOR_CONDITIONS_H

#include "controller/actuation/sea_reference.h"
#include "controller/control_params.h"
#include "controller/screening/checks.h"
#include "controller/signals.h"
#include "controller/supervisor/step_monitor.h"
#include "controller/supervisor/supervisor.h"

#define conditions_find REAL_SYMBOL(conditions_find)

/* What the conditions are made of. */
struct conditions_view {
    const struct control_params *params;
    const struct controller_input *input; /* screened */
    const struct checks *checks;
    const struct step_monitor *step_monitor;
    const struct sea_reference *sea; /* SIDE_COUNT */
    bool motion_requested;           /* commissioning: by a tool that is still there */
    bool walk_wanted; /* requested, not spent, and the wearer does not forbid it (wearer.h) */
    bool pushes_fail; /* three in a row were prescribed and not given (push_watch.h) */
};

/* Bits of enum supervisor_condition that are true in this tick, but for IF_LATCHED, which the
 * supervisor sets itself. *supervisor: as the last tick left it. fault: the tick's, or
 * SUPERVISOR_FAULT_NONE. Pure, constant cost. */
uint16_t conditions_find(const struct supervisor *supervisor, const struct conditions_view *view,
                         enum supervisor_fault fault);

#endif
