#include "controller/controller.h"

#include "controller/estimator/body_table.h"
#include "controller/supervisor/conditions.h"

int controller_init(struct controller *controller, const struct control_params *params)
{
    const int result = control_params_validate(params);
    *controller = (struct controller){.params = params};
    if (result != CONTROL_PARAMS_OK) {
        return result;
    }
    supervisor_init(&controller->supervisor);
    samples_init(&controller->samples);
    checks_init(&controller->checks);
    step_monitor_init(&controller->step_monitor);
    motion_init(&controller->motion);
    derate_init(&controller->derate);
    step_plan_bear(&controller->plan, controller->derate.share);
    step_law_init(&controller->plan.law, params);
    gait_observer_init(&controller->observer, params);
    return CONTROL_PARAMS_OK;
}

/* ---- sense ------------------------------------------------------------------------ */

/* The sensors' offsets are looked for only while no spring can be under power. */
static void find_offsets(struct controller *controller, const struct controller_input *input,
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

static void subtract_offsets(const struct control_params *params, struct controller_input *values)
{
    values->leg[SIDE_LEFT].leg_angle_rad -= params->angle_zero_left_rad;
    values->leg[SIDE_RIGHT].leg_angle_rad -= params->angle_zero_right_rad;
    values->leg[SIDE_LEFT].ankle_extension_m -= params->ankle_zero_left_m;
    values->leg[SIDE_RIGHT].ankle_extension_m -= params->ankle_zero_right_m;
}

/* *values: the input in the legs' own zeros. */
static void sense(struct controller *controller, const struct controller_input *input,
                  struct controller_input *values, struct controller_output *output)
{
    find_offsets(controller, input, output);
    *values = *input;
    subtract_offsets(controller->params, values);
}

/* ---- screen ----------------------------------------------------------------------- */

/* A compass walker's legs always take turns. A person's may seem not to: then the steps are
 * irregular (step_monitor.h). */
static bool legs_disagree(const struct controller *controller)
{
    return controller->step_monitor.same_side &&
           supervisor_may_assist(controller->supervisor.state) &&
           control_params_test_mode(controller->params) &&
           body_of(controller->params->body)->legs_take_turns;
}

/* What a latch tells did not change in three releases: it is stuck, or its report is. */
static enum supervisor_fault latch_fault(const struct controller *controller)
{
    const struct push_watch *watch = &controller->springs.watch;
    if (!supervisor_may_assist(controller->supervisor.state)) {
        return SUPERVISOR_FAULT_NONE;
    }
    if (push_watch_latch_is_stuck(watch, SIDE_LEFT)) {
        return SUPERVISOR_FAULT_LATCH_LEFT;
    }
    return push_watch_latch_is_stuck(watch, SIDE_RIGHT) ? SUPERVISOR_FAULT_LATCH_RIGHT
                                                        : SUPERVISOR_FAULT_NONE;
}

/* What was found in the walk that is under way; behind a fault somebody may have put it right. */
static bool is_misplaced(const struct controller *controller)
{
    return controller->observer.state.misplaced != 0 &&
           supervisor_may_assist(controller->supervisor.state);
}

/* A drive that is cut off says so, and leaves its state. For MOTION_CUT_TICKS at most that is what is
 * looked for, and no fault; behind the cut it is one. */
static bool is_meant_by_cut(const struct controller *controller, enum supervisor_fault fault)
{
    return controller->supervisor.state == SUPERVISOR_COMMISSIONING && controller->motion.cut &&
           (fault == SUPERVISOR_FAULT_NODE_LOST || fault == SUPERVISOR_FAULT_DRIVE);
}

/* Replaces what is lost or impossible in *values. Returns the first thing that is wrong. */
static enum supervisor_fault screen(struct controller *controller, struct controller_input *values)
{
    samples_screen(&controller->samples, controller->params, values);
    const struct checks_view view = {values, &controller->samples, controller->supervisor.state,
                                     controller->guard.last};
    checks_update(&controller->checks, controller->params, &view);
    enum supervisor_fault fault = checks_find(&controller->checks, controller->params, &view);
    if (fault == SUPERVISOR_FAULT_NONE && legs_disagree(controller)) {
        fault = SUPERVISOR_FAULT_LEGS;
    } else if (fault == SUPERVISOR_FAULT_NONE && is_misplaced(controller)) {
        fault = SUPERVISOR_FAULT_PLACEMENT;
    }
    if (fault == SUPERVISOR_FAULT_NONE) {
        fault = latch_fault(controller);
    }
    return is_meant_by_cut(controller, fault) ? SUPERVISOR_FAULT_NONE : fault;
}

/* ---- supervise -------------------------------------------------------------------- */

/* The device gives no push that it is asked for. Whoever walks in test mode has no other push-off. */
static bool pushes_fail(const struct controller *controller)
{
    return !control_params_test_mode(controller->params) &&
           push_watch_fails(&controller->springs.watch);
}

/* A state was entered: what must be fresh when it begins. */
static void enter_state(struct controller *controller, const struct controller_input *values)
{
    const struct control_params *params = controller->params;
    switch (controller->supervisor.state) {
    case SUPERVISOR_ENGAGING:
        gait_observer_init(&controller->observer, params);
        step_monitor_init(&controller->step_monitor);
        step_plan_begin(&controller->plan, params);
        springs_begin(&controller->springs, params, values);
        command_guard_begin(&controller->guard, params);
        controller->observing = true;
        break;
    case SUPERVISOR_COMMISSIONING:
        springs_begin(&controller->springs, params, values);
        command_guard_begin_motions(&controller->guard, params,
                                    motion_share_allowed(&controller->motion));
        motion_enter(&controller->motion, params, values);
        break;
    case SUPERVISOR_UNLOADING:
        /* In test mode the first spring is loaded at once. It must not happen again by itself
         * when the walker has stopped or fallen: that takes a new request. */
        controller->request_spent = control_params_test_mode(params) || pushes_fail(controller);
        springs_stop(&controller->springs, values);
        break;
    case SUPERVISOR_FAULT:
        controller->request_spent = true; /* a reset alone starts nothing (ISO 13850, 4.1.4) */
        break;
    default:
        break;
    }
}

/* A person's pushes get smaller before they end. The bench has no other push-off. */
static bool may_fade(const struct controller *controller)
{
    return controller->supervisor.state == SUPERVISOR_WALKING &&
           !control_params_test_mode(controller->params) &&
           controller->plan.assist_level > REAL(0.0);
}

static void supervise(struct controller *controller, const struct controller_input *values,
                      enum supervisor_fault fault)
{
    if (!values->walk_requested) {
        controller->request_spent = false;
    }
    /* Nothing begins by itself when the drives have rested. */
    if (controller->derate.withdrawn) {
        controller->request_spent = true;
    }
    const bool requested = values->walk_requested && !controller->request_spent;
    wearer_update(&controller->wearer, values->wearer_pressed, requested,
                  controller->supervisor.state, may_fade(controller));
    const struct conditions_view view = {
        .params = controller->params,
        .input = values,
        .checks = &controller->checks,
        .step_monitor = &controller->step_monitor,
        .sea = controller->springs.sea,
        .motion_requested = motion_watch(&controller->motion, values) && !requested &&
                            !controller->derate.withdrawn,
        .walk_wanted = requested && wearer_allows(&controller->wearer),
        .pushes_fail = pushes_fail(controller),
    };
    const enum supervisor_state from = controller->supervisor.state;
    const uint16_t conditions = conditions_find(&controller->supervisor, &view, fault);
    if (supervisor_update(&controller->supervisor, values->tick, conditions, fault)) {
        enter_state(controller, values);
        if (from == SUPERVISOR_COMMISSIONING) {
            motion_forget(&controller->motion,
                          controller->supervisor.latched != SUPERVISOR_FAULT_NONE);
        }
        /* Whoever asked and did not set off in time asks anew. */
        if (from == SUPERVISOR_ENGAGING && (conditions & SUPERVISOR_IF_TIMEOUT) != 0 &&
            controller->supervisor.state == SUPERVISOR_UNLOADING) {
            controller->request_spent = true;
        }
    }
}

/* ---- estimate --------------------------------------------------------------------- */

/* While assisting a steady step that has ended raises the assist level. */
static void estimate(struct controller *controller, const struct controller_input *values)
{
    struct step_monitor *steps = &controller->step_monitor;
    const enum supervisor_state state = controller->supervisor.state;
    if (controller->observing) {
        gait_observer_update(&controller->observer, controller->params, values);
    }
    if (supervisor_may_assist(state) &&
        step_monitor_update(steps, &controller->observer.state, values->tick)) {
        const real share = wearer_end_step(&controller->wearer);
        if (share < REAL(1.0)) {
            step_plan_fade(&controller->plan, share);
        } else if (state == SUPERVISOR_WALKING && steps->steady > 0) {
            step_plan_raise_assist(&controller->plan, controller->params);
        }
    }
}

/* ---- decide, actuate, guard ------------------------------------------------------- */

static struct step_decision decide(struct controller *controller,
                                   const struct controller_input *values)
{
    if (!supervisor_may_assist(controller->supervisor.state)) {
        return (struct step_decision){0};
    }
    return step_plan_update(&controller->plan, controller->params, &controller->observer.state,
                            values->desired_speed_rad_s, &controller->last_step);
}

/* Both motors at zero, or one of them where commissioning has it. */
static void commission(struct controller *controller, const struct controller_input *values,
                       struct controller_output *output)
{
    struct motion *motion = &controller->motion;
    const real share = motion_share_allowed(motion);
    motion_update(motion, controller->params, values);
    if (motion_share_allowed(motion) != share) {
        command_guard_begin_motions(&controller->guard, controller->params,
                                    motion_share_allowed(motion));
    }
    for (int side = 0; side < SIDE_COUNT; side++) {
        springs_place(&controller->springs, (enum side)side, motion->reference_m[side]);
        output->sea[side] =
            (struct sea_request){.precompression_m = motion->reference_m[side],
                                 .enable = true,
                                 .latch_armed = motion->armed && motion->side == (enum side)side};
    }
    output->cut_off = motion->cut;
}

/* What was prescribed and not given is prescribed smaller. */
static void follow(struct controller *controller, const struct controller_input *values,
                   const struct step_decision *decision)
{
    const enum push_outcome outcome =
        springs_follow(&controller->springs, decision, values, &controller->observer.state,
                       !controller->step_monitor.seen);
    if (outcome == PUSH_LATCH_OPEN || outcome == PUSH_NOT_LOADED || outcome == PUSH_DRAGS) {
        step_plan_lower_assist(&controller->plan, controller->params);
    }
}

static void actuate(struct controller *controller, const struct controller_input *values,
                    const struct step_decision *decision, struct sea_request request[SIDE_COUNT])
{
    const enum supervisor_state state = controller->supervisor.state;
    const struct gait_state *gait = &controller->observer.state;
    if (supervisor_may_assist(state)) {
        follow(controller, values, decision);
    }
    if (supervisor_may_enable(state)) {
        springs_command(&controller->springs, controller->params, values, state, gait, request);
    }
}

static void guard(struct controller *controller, struct sea_request request[SIDE_COUNT])
{
    const bool powered = supervisor_may_enable(controller->supervisor.state);
    command_guard_limit(&controller->guard, powered, request);
    /*@ assert no_torque: powered ||
          (!request[SIDE_LEFT].enable && !request[SIDE_LEFT].latch_armed &&
           !request[SIDE_RIGHT].enable && !request[SIDE_RIGHT].latch_armed); */
}

bool controller_bear(struct controller *controller, const struct derate_limits *limit,
                     const struct derate_reading *reading, uint32_t tick)
{
    const bool is_new = derate_update(&controller->derate, limit, reading, tick);
    step_plan_bear(&controller->plan, controller->derate.share);
    return is_new;
}

void controller_update(struct controller *controller, const struct controller_input *input,
                       struct controller_output *output)
{
    struct controller_input values;
    *output = (struct controller_output){0};

    sense(controller, input, &values, output);
    const enum supervisor_fault fault = screen(controller, &values);
    supervise(controller, &values, fault);
    estimate(controller, &values);
    const struct step_decision decision = decide(controller, &values);
    if (controller->supervisor.state == SUPERVISOR_COMMISSIONING) {
        commission(controller, &values, output);
    } else {
        actuate(controller, &values, &decision, output->sea);
    }
    guard(controller, output->sea);

    output->state = controller->supervisor.state;
    output->fault = controller->supervisor.latched;
    output->new_step = decision.new_step;
}

enum wearer_cue controller_cue(const struct controller *controller)
{
    const enum supervisor_state state = controller->supervisor.state;
    if (controller->wearer.fade_steps > 0) {
        return WEARER_CUE_FADES;
    }
    if (!wearer_allows(&controller->wearer)) {
        return WEARER_CUE_PAUSED;
    }
    if (state != SUPERVISOR_WALKING) {
        return WEARER_CUE_NONE;
    }
    return controller->plan.assist_level > REAL(0.0) ? WEARER_CUE_ASSISTS : WEARER_CUE_SOON;
}
