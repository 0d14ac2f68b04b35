#include "controller/controller.h"

/* A command may rise by so much of what the reference's speed limit allows in a tick. */
#define SLEW_RATIO REAL(1.25)
/* And no command is further than so much of the leg's length beyond the largest r0. */
#define COMMAND_LIMIT_RATIO REAL(0.1)
/* A wearer's steps have stopped when none came for so many times the last one. */
enum { LATE_STEPS = 2 };
/* Least time in STANDBY. */
enum { REST_TICKS = TICKS_OF_MS(50) };
/* Unloading lasts so long at least: from full stroke it takes less than 0.3 s. */
enum { UNLOAD_LEAST_TICKS = TICKS_OF_MS(200) };
/* The self test may take so many times as long as unloading: a drive that has just
 * come back may still be unloading by itself. */
enum { SELF_TEST_PATIENCE = 5 };

int controller_init(struct controller *controller, const struct control_params *params)
{
    const int verdict = control_params_validate(params);
    *controller = (struct controller){.params = params};
    if (verdict != CONTROL_PARAMS_OK) {
        return verdict;
    }
    supervisor_init(&controller->supervisor);
    checks_init(&controller->checks);
    step_monitor_init(&controller->step_monitor);
    step_law_init(&controller->law, params);
    gait_observer_init(&controller->observer, params);
    return CONTROL_PARAMS_OK;
}

/* A walker on the bench: held by a hand, without a push-off of its own. */
static bool test_mode(const struct controller *controller)
{
    return controller->params->engage_steps == REAL(0.0);
}

static bool is_stepping(const struct controller *controller, uint32_t tick)
{
    const struct step_monitor *steps = &controller->step_monitor;
    uint32_t patience = ticks_from_seconds(controller->params->step_timeout_s);
    const uint32_t late = LATE_STEPS * steps->step_ticks[0];
    if (!test_mode(controller) && late > 0 && late < patience) {
        patience = late;
    }
    /* Whoever stands still does not step, however short ago the last step was. */
    return steps->seen && tick - steps->known_tick <= patience &&
           !checks_standstill(&controller->checks);
}

static bool is_steady(const struct controller *controller)
{
    return test_mode(controller)
               ? controller->step_monitor.seen
               : (real)controller->step_monitor.steady >= controller->params->engage_steps;
}

static bool is_overdue(const struct controller *controller, uint32_t tick)
{
    const struct supervisor *supervisor = &controller->supervisor;
    uint32_t limit = ticks_from_seconds(controller->params->unload_timeout_s);
    if (supervisor->state == SUPERVISOR_SELF_TEST) {
        limit *= SELF_TEST_PATIENCE;
    }
    return tick - supervisor->since_tick >= limit;
}

/* Both references are back at zero, and have been asked for long enough: a motor whose
 * encoder stands at zero while it does not stand there itself is given the time to follow. */
static bool references_back(const struct controller *controller, uint32_t tick)
{
    const real tolerance = controller->params->sea_tolerance_m;
    return tick - controller->supervisor.since_tick >= UNLOAD_LEAST_TICKS &&
           real_abs(controller->sea[SIDE_LEFT].position_m) <= tolerance &&
           real_abs(controller->sea[SIDE_RIGHT].position_m) <= tolerance;
}

/* A drive told to switch off has done so before it is asked again: it takes some telegrams,
 * and what it reports meanwhile is of the time before. */
static bool is_at_rest(const struct controller *controller, uint32_t tick)
{
    return controller->supervisor.state != SUPERVISOR_STANDBY ||
           tick - controller->supervisor.since_tick >= REST_TICKS;
}

/* A node that tells of an error need not be waited for. */
static bool has_nodes(const struct controller_input *input)
{
    return input->nodes_operational || input->node_error;
}

static uint16_t conditions_of(const struct controller *controller,
                              const struct controller_input *input, enum supervisor_fault fault)
{
    const bool slack = checks_springs_slack(controller->params, input);
    const bool stepping = is_stepping(controller, input->tick);
    unsigned bits = 0;
    bits |= fault != SUPERVISOR_FAULT_NONE ? SUPERVISOR_IF_FAULT : 0u;
    bits |= has_nodes(input) ? SUPERVISOR_IF_NODES : 0u;
    bits |= fault == SUPERVISOR_FAULT_NONE && slack && is_at_rest(controller, input->tick)
                ? SUPERVISOR_IF_PLAUSIBLE
                : 0u;
    bits |= input->walk_requested && !controller->request_spent ? SUPERVISOR_IF_WALK_REQUESTED : 0u;
    bits |= input->sea[SIDE_LEFT].state == DRIVE_ENABLED &&
                    input->sea[SIDE_RIGHT].state == DRIVE_ENABLED
                ? SUPERVISOR_IF_ENABLED
                : 0u;
    bits |= stepping ? SUPERVISOR_IF_STEPPING : 0u;
    bits |= stepping && is_steady(controller) ? SUPERVISOR_IF_STEADY : 0u;
    bits |= test_mode(controller) || controller->step_monitor.unsteady < STEP_MONITOR_IRREGULAR
                ? SUPERVISOR_IF_REGULAR
                : 0u;
    bits |= slack && references_back(controller, input->tick) ? SUPERVISOR_IF_UNLOADED : 0u;
    bits |= is_overdue(controller, input->tick) ? SUPERVISOR_IF_TIMEOUT : 0u;
    bits |= input->reset_requested ? SUPERVISOR_IF_RESET : 0u;
    bits |= checks_standstill(&controller->checks) ? SUPERVISOR_IF_STANDSTILL : 0u;
    return (uint16_t)bits;
}

/* A state was entered: what must be fresh when it begins. */
static void enter_state(struct controller *controller, const struct controller_input *input)
{
    const struct control_params *params = controller->params;
    switch (controller->supervisor.state) {
    case SUPERVISOR_ENGAGING:
        controller->stop = sea_reference_stop_limits(params);
        controller->change_max_m = params->r0_change_max_m;
        controller->slew_limit_m = SLEW_RATIO * params->sea_speed_max_m_s * CONTROL_PERIOD_S;
        controller->command_limit_m = params->r0_max_m + COMMAND_LIMIT_RATIO * params->leg_length_m;
        step_law_init(&controller->law, params);
        gait_observer_init(&controller->observer, params);
        step_monitor_init(&controller->step_monitor);
        controller->assist_level = test_mode(controller) ? REAL(1.0) : REAL(0.0);
        controller->step_pending = false;
        controller->observing = true;
        for (int side = 0; side < SIDE_COUNT; side++) {
            sea_reference_init(&controller->sea[side], input->sea[side].precompression_m);
        }
        break;
    case SUPERVISOR_UNLOADING:
        /* On the bench the first spring is loaded at once: never again by itself, behind
         * somebody who has stopped or lies there. */
        controller->request_spent = test_mode(controller);
        for (int side = 0; side < SIDE_COUNT; side++) {
            sea_reference_stop(&controller->sea[side], &controller->stop,
                               input->sea[side].precompression_m);
        }
        break;
    case SUPERVISOR_FAULT:
        controller->request_spent = true; /* a reset alone starts nothing (ISO 13850, 4.1.4) */
        break;
    default:
        break;
    }
}

/* A step has ended: while the steps stay steady the assist_level rises. */
static void ramp_assist_level(struct controller *controller)
{
    if (!test_mode(controller) && controller->supervisor.state == SUPERVISOR_WALKING &&
        controller->step_monitor.steady > 0) {
        const real assist_level =
            controller->assist_level + REAL(1.0) / controller->params->engage_ramp_steps;
        controller->assist_level = assist_level < REAL(1.0) ? assist_level : REAL(1.0);
    }
}

/* Loads towards the law's precompression as far as the assist_level goes; nothing before. */
static void begin_loading(struct controller *controller, enum side side)
{
    if (controller->assist_level > REAL(0.0)) {
        const bool given = controller->law.steps > 0 && controller->law.is_final;
        sea_reference_begin_loading(&controller->sea[side],
                                    given ? controller->last_step.r0_m
                                          : controller->assist_level * controller->law.r0_m);
    }
}

/* The step's precompression is decided. The law keeps to its limits; like the last gate, this
 * does so without the parameters. */
static void finish_step(struct controller *controller)
{
    const real before_m = controller->last_step.r0_m, limit_m = controller->change_max_m;
    const uint32_t number = controller->last_step.number;
    real r0_m = controller->assist_level * controller->law.r0_m;
    if (number > 0 && controller->pending_step.number > number) { /* of the same walk */
        r0_m = real_clamp(r0_m, before_m - limit_m, before_m + limit_m);
    }
    controller->step_pending = false;
    controller->last_step = controller->pending_step;
    controller->last_step.r0_m = r0_m;
    controller->last_step.commanded_speed_rad_s = controller->law.target_speed_rad_s;
    controller->last_step.used_fallback = controller->law.used_fallback;
}

/* The step's events drive the springs: loading at the own heel strike, the law at
 * the apex, unloading at lift-off. */
static void follow_gait(struct controller *controller, const struct controller_input *input,
                        struct controller_output *output)
{
    const struct gait_state *gait = &controller->observer.state;
    const struct gait_event *apex = &gait->event[GAIT_APEX];
    const struct gait_event *strike = &gait->event[GAIT_HEEL_STRIKE];
    const struct gait_event *lift_off = &gait->event[GAIT_LIFT_OFF];

    if (apex->happened) {
        step_law_finish(
            &controller->law); /* an apex without a push-off between: cannot be helped */
        (void)step_law_update(&controller->law, controller->params, &gait->apex,
                              input->desired_speed_rad_s);
        controller->pending_step = (struct step_record){.number = controller->law.steps,
                                                        .tick = apex->tick,
                                                        .side = apex->side,
                                                        .measured_speed_rad_s = apex->speed_rad_s};
        controller->step_pending = true;
    } else if (!controller->law.is_final) {
        if (strike->happened) {
            step_law_finish(&controller->law);
        } else if (step_law_work(&controller->law, controller->params)) {
            /* Not final yet: on the way there already, but not armed. */
            begin_loading(controller, controller->pending_step.side);
        }
    }
    if (controller->step_pending && controller->law.is_final) {
        finish_step(controller);
        output->new_step = true;
        sea_reference_set_target(&controller->sea[controller->last_step.side],
                                 controller->last_step.r0_m);
    }
    if (strike->happened) {
        begin_loading(controller, strike->side);
    }
    if (lift_off->happened) {
        sea_reference_unload(&controller->sea[lift_off->side]);
    }
    /* The first stance begins without a heel strike. */
    const struct sea_reference *stance = &controller->sea[gait->stance];
    if (!controller->step_monitor.seen && gait->phase == PHASE_SINGLE_SUPPORT &&
        stance->phase == SEA_UNLOADED) {
        begin_loading(controller, gait->stance);
    }
}

/* No push before the other foot can carry the wearer: a person's ankle can extend in
 * midstance, too, and an armed latch would take that for the push-off. */
static bool may_release(const struct controller *controller, enum side side)
{
    const struct gait_state *gait = &controller->observer.state;
    return gait->strike_near && gait->stance == side;
}

/* A compass' legs take turns, however irregularly it walks; a person's that seem not to
 * are irregular (step_monitor.h). */
static bool legs_disagree(const struct controller *controller)
{
    return supervisor_may_assist(controller->supervisor.state) && test_mode(controller) &&
           controller->params->body == (real)BODY_COMPASS && controller->step_monitor.same_side;
}

/* Nothing that is not a number, nothing beyond the stroke, and no step leaves the
 * controller. By construction it cannot; this is the last gate, and its limits are numbers of
 * its own: the parameters may have been changed by a failing memory until that is noticed. */
static bool guard(const struct controller *controller, const struct sea_request *before,
                  struct sea_request *request)
{
    if (before->enable &&
        request->precompression_m > before->precompression_m + controller->slew_limit_m) {
        request->precompression_m = before->precompression_m + controller->slew_limit_m;
    }
    if (request->precompression_m >= -controller->command_limit_m &&
        request->precompression_m <= controller->command_limit_m) {
        return true;
    }
    *request = (struct sea_request){REAL(0.0), false, false};
    return false;
}

/* What both drives are told in this tick. */
static void command_drives(struct controller *controller, const struct controller_input *input,
                           struct controller_output *output)
{
    const bool enable = supervisor_may_enable(controller->supervisor.state);
    for (int side = 0; side < SIDE_COUNT; side++) {
        struct sea_request *request = &output->sea[side];
        if (enable) {
            *request = sea_reference_update(&controller->sea[side], controller->params,
                                            input->sea[side].precompression_m);
            /* A drive that is not heard while it is to unload does it by itself. */
            const bool silent = controller->supervisor.state == SUPERVISOR_UNLOADING &&
                                input->sea[side].age_ticks >
                                    ticks_from_seconds(controller->params->sensor_age_max_s);
            request->enable = guard(controller, &controller->request[side], request) && !silent;
            request->latch_armed = request->latch_armed && may_release(controller, (enum side)side);
        }
        controller->request[side] = *request;
    }
}

/* The sensors' offsets are looked for only while no spring can be under power. */
static void find_zero(struct controller *controller, const struct controller_input *input,
                      struct controller_output *output)
{
    struct zeroing *zeroing = &controller->zeroing;
    if (supervisor_may_enable(controller->supervisor.state)) {
        zeroing_stop(zeroing);
    } else if (input->zero_requested) {
        zeroing_start(zeroing);
    }
    const bool running = zeroing->state == ZEROING_RUNNING;
    zeroing_update(zeroing, input->leg);
    output->zeroing = zeroing->state;
    output->new_zero = running && zeroing->state == ZEROING_DONE;
}

static void take_zero_off(const struct control_params *params, struct controller_input *values)
{
    values->leg[SIDE_LEFT].leg_angle_rad -= params->angle_zero_left_rad;
    values->leg[SIDE_RIGHT].leg_angle_rad -= params->angle_zero_right_rad;
    values->leg[SIDE_LEFT].ankle_extension_m -= params->ankle_zero_left_m;
    values->leg[SIDE_RIGHT].ankle_extension_m -= params->ankle_zero_right_m;
}

void controller_update(struct controller *controller, const struct controller_input *input,
                       struct controller_output *output)
{
    struct controller_input values = *input;
    *output = (struct controller_output){0};

    if (!values.walk_requested) {
        controller->request_spent = false;
    }
    find_zero(controller, input, output);
    take_zero_off(controller->params, &values);

    const struct controller_input raw = values; /* in the legs' own zeros, not screened yet */
    checks_screen(&controller->checks, controller->params, &values);
    const struct checks_context context = {controller->supervisor.state, controller->request};
    enum supervisor_fault fault =
        checks_find(&controller->checks, controller->params, &raw, &values, &context);
    if (fault == SUPERVISOR_FAULT_NONE && legs_disagree(controller)) {
        fault = SUPERVISOR_FAULT_LEGS;
    }
    if (controller->supervisor.state == SUPERVISOR_INIT && !has_nodes(&values)) {
        controller->supervisor.since_tick = values.tick; /* its time begins with the nodes */
    }
    if (supervisor_update(&controller->supervisor, values.tick,
                          conditions_of(controller, &values, fault), fault)) {
        enter_state(controller, &values);
    }
    const enum supervisor_state state = controller->supervisor.state;
    if (controller->observing) {
        gait_observer_update(&controller->observer, controller->params, &values);
    }
    if (supervisor_may_assist(state)) {
        if (step_monitor_update(&controller->step_monitor, &controller->observer.state,
                                values.tick)) {
            ramp_assist_level(controller);
        }
        follow_gait(controller, &values, output);
    }
    command_drives(controller, &values, output);
    output->state = state;
    output->fault = controller->supervisor.latched;
}
