#include "controller/supervisor/conditions.h"

#include "controller/estimator/body_table.h"

/* A person's steps have stopped when none came for so many times the last one. */
enum { LATE_STEPS = 2 };
/* Least time in STANDBY. */
enum { REST_TICKS = TICKS_OF_MS(50) };
/* Unloading lasts so long at least: from full stroke it takes less than 0.3 s. */
enum { UNLOAD_LEAST_TICKS = TICKS_OF_MS(200) };
/* The self test may take so many times as long as unloading: a drive that has just
 * come back may still be unloading by itself. */
enum { SELF_TEST_TIMES = 5 };
/* A request is given up when no walk has begun after so long. In test mode a spring is loaded
 * meanwhile and somebody stands beside it; a person may take their time to set off. */
enum { ENGAGE_TEST_MODE_TICKS = TICKS_OF_MS(10000), ENGAGE_TICKS = TICKS_OF_MS(60000) };

static bool is_stepping(const struct conditions_view *view, bool standstill)
{
    const struct step_monitor *steps = view->step_monitor;
    uint32_t longest = ticks_from_seconds(view->params->step_timeout_s);
    const uint32_t late = LATE_STEPS * steps->step_ticks[0];
    if (!control_params_test_mode(view->params) && late > 0 && late < longest) {
        longest = late;
    }
    /* Who stands still does not step, however short ago the last step was. */
    return steps->seen && view->input->tick - steps->known_tick <= longest && !standstill;
}

static bool is_steady(const struct conditions_view *view)
{
    return control_params_test_mode(view->params)
               ? view->step_monitor->seen
               : (real)view->step_monitor->steady >= view->params->engage_steps;
}

static bool is_regular(const struct conditions_view *view)
{
    return control_params_test_mode(view->params) ||
           (view->step_monitor->unsteady < STEP_MONITOR_IRREGULAR && !view->pushes_fail);
}

/* How long this state may last; states without a limit get some number that no rule looks at. */
static uint32_t time_limit_ticks(enum supervisor_state state, const struct control_params *params)
{
    const uint32_t unload_ticks = ticks_from_seconds(params->unload_timeout_s);
    switch (state) {
    case SUPERVISOR_SELF_TEST:
        return SELF_TEST_TIMES * unload_ticks;
    case SUPERVISOR_ENGAGING:
        return control_params_test_mode(params) ? ENGAGE_TEST_MODE_TICKS : ENGAGE_TICKS;
    default:
        return unload_ticks;
    }
}

static bool is_overdue(const struct supervisor *supervisor, const struct conditions_view *view)
{
    return view->input->tick - supervisor->since_tick >=
           time_limit_ticks(supervisor->state, view->params);
}

/* Both references are back at zero, and the state has lasted long enough: a motor whose encoder
 * reads zero although the motor is elsewhere gets the time to follow. */
static bool references_back(const struct supervisor *supervisor, const struct conditions_view *view)
{
    const real tolerance = view->params->sea_tolerance_m;
    return view->input->tick - supervisor->since_tick >= UNLOAD_LEAST_TICKS &&
           real_abs(view->sea[SIDE_LEFT].position_m) <= tolerance &&
           real_abs(view->sea[SIDE_RIGHT].position_m) <= tolerance;
}

/* A drive must have switched off before it is enabled again: that takes some telegrams, and
 * what it reports meanwhile is old. */
static bool is_at_rest(const struct supervisor *supervisor, const struct conditions_view *view)
{
    return supervisor->state != SUPERVISOR_STANDBY ||
           view->input->tick - supervisor->since_tick >= REST_TICKS;
}

/* Nobody's drives are under torque who sits, lies, hangs in a harness, or stands still: only a person's who
 * is on their feet and moves. Who walks already has other rules for standing still. */
static bool is_ready(const struct supervisor *supervisor, const struct conditions_view *view,
                     bool standstill)
{
    if (body_of(view->params->body)->ankle_is_held) {
        return true;
    }
    return checks_upright(view->checks) && (!standstill || supervisor->state == SUPERVISOR_WALKING);
}

static bool both_enabled(const struct controller_input *input)
{
    return input->sea[SIDE_LEFT].state == DRIVE_ENABLED &&
           input->sea[SIDE_RIGHT].state == DRIVE_ENABLED;
}

uint16_t conditions_find(const struct supervisor *supervisor, const struct conditions_view *view,
                         enum supervisor_fault fault)
{
    const struct controller_input *input = view->input;
    const bool slack = checks_springs_slack(view->params, input);
    const bool standstill = checks_standstill(view->checks);
    const bool stepping = is_stepping(view, standstill);
    unsigned bits = 0;
    bits |= fault != SUPERVISOR_FAULT_NONE ? SUPERVISOR_IF_FAULT : 0u;
    /* A node that reports an error need not be waited for. */
    bits |= input->nodes_operational || input->node_error ? SUPERVISOR_IF_NODES : 0u;
    bits |= fault == SUPERVISOR_FAULT_NONE && slack && is_at_rest(supervisor, view)
                ? SUPERVISOR_IF_PLAUSIBLE
                : 0u;
    bits |= view->walk_wanted && is_ready(supervisor, view, standstill)
                ? SUPERVISOR_IF_WALK_REQUESTED
                : 0u;
    bits |= view->motion_requested ? SUPERVISOR_IF_MOTION_REQUESTED : 0u;
    bits |= both_enabled(input) ? SUPERVISOR_IF_ENABLED : 0u;
    bits |= stepping ? SUPERVISOR_IF_STEPPING : 0u;
    bits |= stepping && is_steady(view) ? SUPERVISOR_IF_STEADY : 0u;
    bits |= is_regular(view) ? SUPERVISOR_IF_REGULAR : 0u;
    bits |= slack && references_back(supervisor, view) ? SUPERVISOR_IF_UNLOADED : 0u;
    bits |= is_overdue(supervisor, view) ? SUPERVISOR_IF_TIMEOUT : 0u;
    bits |= input->reset_requested ? SUPERVISOR_IF_RESET : 0u;
    bits |= standstill ? SUPERVISOR_IF_STANDSTILL : 0u;
    return (uint16_t)bits;
}
