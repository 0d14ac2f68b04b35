#include "controller/controller.h"

/* A leg's angle cannot lie beyond this, whatever the wearer does. */
#define LEG_ANGLE_LIMIT_RAD REAL_PI
/* The ankle's range in leg lengths: beyond it the reading is wrong. */
#define EXTENSION_MIN_SHARE REAL(-0.02)
#define EXTENSION_MAX_SHARE REAL(0.5)
/* Below this rate of both legs, in radians a tick, the wearer stands still. */
#define STANDSTILL_RAD REAL(0.00005)

int controller_init(struct controller *controller, const struct control_params *params)
{
    const int verdict = control_params_validate(params);
    *controller = (struct controller){.params = params};
    if (verdict != CONTROL_PARAMS_OK) {
        return verdict;
    }
    supervisor_init(&controller->supervisor);
    step_law_init(&controller->law, params);
    gait_observer_init(&controller->observer, params);
    return CONTROL_PARAMS_OK;
}

static uint32_t ticks_of(real seconds)
{
    return (uint32_t)(seconds * (real)CONTROL_RATE_HZ + REAL(0.5));
}

static bool leg_in_range(const struct controller *controller, const struct leg_measurement *leg)
{
    const real extension = leg->ankle_extension_m;
    const real length = controller->params->leg_length_m;
    return real_abs(leg->leg_angle_rad) <= LEG_ANGLE_LIMIT_RAD &&
           extension >= EXTENSION_MIN_SHARE * length && extension <= EXTENSION_MAX_SHARE * length;
}

/* The first thing that is wrong now, most serious first. */
static enum supervisor_fault find_fault(const struct controller *controller,
                                        const struct controller_input *input)
{
    const struct control_params *params = controller->params;
    const bool powered = supervisor_may_enable(controller->supervisor.state);
    const uint32_t age_max = ticks_of(params->sensor_age_max_s);

    if (input->emergency_stop) {
        return SUPERVISOR_FAULT_EMERGENCY_STOP;
    }
    if (!input->nodes_operational) {
        return SUPERVISOR_FAULT_NODE_LOST;
    }
    for (int side = 0; side < SIDE_COUNT; side++) {
        const struct leg_measurement *leg = &input->leg[side];
        const struct sea_measurement *sea = &input->sea[side];
        if (leg->age_ticks > age_max) {
            return SUPERVISOR_FAULT_SENSOR_STALE;
        }
        if (sea->age_ticks > age_max) {
            return SUPERVISOR_FAULT_DRIVE_STALE;
        }
        if (!leg_in_range(controller, leg) || !real_is_finite(sea->precompression_m) ||
            !real_is_finite(input->desired_speed_rad_s)) {
            return SUPERVISOR_FAULT_SENSOR_RANGE;
        }
        const bool dropped = controller->supervisor.state == SUPERVISOR_WALKING &&
                             sea->state != DRIVE_ENABLED;
        if (sea->state == DRIVE_FAULT || dropped) {
            return SUPERVISOR_FAULT_DRIVE;
        }
        if (powered && real_abs(leg->leg_angle_rad) > params->fall_angle_rad) {
            return SUPERVISOR_FAULT_FALL;
        }
    }
    return SUPERVISOR_FAULT_NONE;
}

static bool springs_slack(const struct controller *controller, const struct controller_input *input)
{
    for (int side = 0; side < SIDE_COUNT; side++) {
        if (!(real_abs(input->sea[side].precompression_m) <= controller->params->sea_tolerance_m)) {
            return false;
        }
    }
    return true;
}

static uint16_t conditions_of(const struct controller *controller,
                              const struct controller_input *input, enum supervisor_fault fault)
{
    const struct supervisor *supervisor = &controller->supervisor;
    const uint32_t in_state = input->tick - supervisor->since_tick;
    const bool slack = springs_slack(controller, input);
    const bool still = real_abs(controller->held_rate_rad[SIDE_LEFT]) < STANDSTILL_RAD &&
                       real_abs(controller->held_rate_rad[SIDE_RIGHT]) < STANDSTILL_RAD;
    unsigned bits = 0;
    bits |= fault != SUPERVISOR_FAULT_NONE ? SUPERVISOR_IF_FAULT : 0u;
    bits |= input->nodes_operational ? SUPERVISOR_IF_NODES : 0u;
    bits |= fault == SUPERVISOR_FAULT_NONE && slack ? SUPERVISOR_IF_PLAUSIBLE : 0u;
    bits |= input->walk_requested ? SUPERVISOR_IF_WALK_REQUESTED : 0u;
    bits |= input->sea[SIDE_LEFT].state == DRIVE_ENABLED &&
                    input->sea[SIDE_RIGHT].state == DRIVE_ENABLED
                ? SUPERVISOR_IF_ENABLED
                : 0u;
    bits |= controller->apex_seen && input->tick - controller->last_apex_tick <=
                                         ticks_of(controller->params->step_timeout_s)
                ? SUPERVISOR_IF_STEPPING
                : 0u;
    bits |= slack ? SUPERVISOR_IF_UNLOADED : 0u;
    bits |= in_state >= ticks_of(controller->params->unload_timeout_s) ? SUPERVISOR_IF_TIMEOUT : 0u;
    bits |= input->reset_requested ? SUPERVISOR_IF_RESET : 0u;
    bits |= still ? SUPERVISOR_IF_STANDSTILL : 0u;
    return (uint16_t)bits;
}

/* Bridges a lost sample by going on at the last rate, so that one missing frame
 * does not look like a leg that stopped. */
static void hold_samples(struct controller *controller, struct controller_input *input)
{
    for (int side = 0; side < SIDE_COUNT; side++) {
        struct leg_measurement *leg = &input->leg[side];
        const real held = controller->held_angle_rad[side];
        if (leg->age_ticks == 0 && real_is_finite(leg->leg_angle_rad)) {
            controller->held_rate_rad[side] = leg->leg_angle_rad - held;
            controller->held_angle_rad[side] = leg->leg_angle_rad;
        } else {
            controller->held_angle_rad[side] = held + controller->held_rate_rad[side];
            leg->leg_angle_rad = controller->held_angle_rad[side];
        }
    }
}

/* A state was entered: what must be fresh when it begins. */
static void enter_state(struct controller *controller, const struct controller_input *input)
{
    const struct control_params *params = controller->params;
    switch (controller->supervisor.state) {
    case SUPERVISOR_ENGAGING:
        step_law_init(&controller->law, params);
        gait_observer_init(&controller->observer, params);
        controller->apex_seen = false;
        controller->step_pending = false;
        controller->observing = true;
        for (int side = 0; side < SIDE_COUNT; side++) {
            sea_reference_init(&controller->sea[side], input->sea[side].precompression_m);
        }
        break;
    case SUPERVISOR_UNLOADING:
        sea_reference_unload(&controller->sea[SIDE_LEFT]);
        sea_reference_unload(&controller->sea[SIDE_RIGHT]);
        break;
    default:
        break;
    }
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
        step_law_finish(&controller->law); /* an apex without a push-off between: cannot be helped */
        (void)step_law_update(&controller->law, controller->params, &gait->apex,
                              input->desired_speed_rad_s);
        controller->apex_seen = true;
        controller->last_apex_tick = input->tick;
        controller->pending_step =
            (struct step_record){.number = controller->law.steps,
                                 .tick = apex->tick,
                                 .side = apex->side,
                                 .measured_speed_rad_s = apex->speed_rad_s,
                                 .commanded_speed_rad_s = controller->law.command_rad_s};
        controller->step_pending = true;
    } else if (!controller->law.is_final) {
        if (strike->happened) {
            step_law_finish(&controller->law);
        } else if (step_law_work(&controller->law, controller->params)) {
            /* Not final yet: on the way there already, but not armed. */
            sea_reference_load(&controller->sea[controller->pending_step.side],
                               controller->law.r0_m);
        }
    }
    if (controller->step_pending && controller->law.is_final) {
        controller->step_pending = false;
        controller->last_step = controller->pending_step;
        controller->last_step.r0_m = controller->law.r0_m;
        output->new_step = true;
        sea_reference_trim(&controller->sea[controller->last_step.side], controller->law.r0_m);
    }
    if (strike->happened) {
        sea_reference_load(&controller->sea[strike->side], controller->law.r0_m);
    }
    if (lift_off->happened) {
        sea_reference_unload(&controller->sea[lift_off->side]);
    }
    /* The first stance begins without a heel strike. */
    struct sea_reference *stance = &controller->sea[gait->stance];
    if (!controller->apex_seen && gait->phase == PHASE_SINGLE_SUPPORT &&
        stance->phase == SEA_UNLOADED) {
        sea_reference_load(stance, controller->law.r0_m);
    }
}

/* No push before the other foot can carry the wearer: a person's ankle can extend in
 * midstance, too, and an armed latch would take that for the push-off. */
static bool may_release(const struct controller *controller, enum side side)
{
    const struct gait_state *gait = &controller->observer.state;
    return gait->strike_near && gait->stance == side;
}

void controller_update(struct controller *controller, const struct controller_input *input,
                       struct controller_output *output)
{
    struct controller_input values = *input;
    *output = (struct controller_output){0};

    const enum supervisor_fault fault = find_fault(controller, input);
    hold_samples(controller, &values);
    if (supervisor_update(&controller->supervisor, values.tick,
                          conditions_of(controller, &values, fault), fault)) {
        enter_state(controller, &values);
    }
    const enum supervisor_state state = controller->supervisor.state;
    if (controller->observing) {
        gait_observer_update(&controller->observer, controller->params, &values);
    }
    if (supervisor_may_assist(state)) {
        follow_gait(controller, &values, output);
    }
    for (int side = 0; side < SIDE_COUNT; side++) {
        if (supervisor_may_enable(state)) {
            output->sea[side] = sea_reference_update(&controller->sea[side], controller->params,
                                                     values.sea[side].precompression_m);
            output->sea[side].enable = true;
            if (!may_release(controller, (enum side)side)) {
                output->sea[side].latch_armed = false;
            }
        }
    }
    output->state = state;
    output->fault = controller->supervisor.latched;
}
