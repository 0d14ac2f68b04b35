#include "sim_host/faults/oracle.h"

static const double LOADED_RATIO = 0.05;
static const double FULL_RATIO = 0.01;
static const double RATE_RATIO = 1.3;
static const double FORCE_RATIO = 1.02;

enum { ENABLED_MS = 100, SETTLED_MS = 500 };

const char *oracle_unsafe_name(int bit)
{
    static const char *const names[UNSAFE_BITS] = {
        "release", "loaded", "loaded after a fall", "force", "stroke", "rate", "enabled", "step"};
    return bit >= 0 && bit < UNSAFE_BITS ? names[bit] : "?";
}

void oracle_begin(struct oracle *oracle, struct loop *loop)
{
    const struct plant *plant = &loop->nodes.plant;
    *oracle = (struct oracle){.loop = loop,
                              .person = plant->config.kind != PLANT_WALKER,
                              .effect_tick = ORACLE_NEVER,
                              .noticed_tick = ORACLE_NEVER,
                              .unloaded_tick = ORACLE_NEVER,
                              .must_notice_tick = ORACLE_NEVER,
                              .fault_tick = ORACLE_NEVER,
                              .down_tick = ORACLE_NEVER,
                              .unsafe_tick = ORACLE_NEVER,
                              .r0_m = (double)loop->rig.task.controller.last_step.r0_m,
                              .r0_number = loop->rig.task.controller.last_step.number,
                              .double_support = plant->walk.phase == WALK_DOUBLE,
                              .trailing = plant->walk.stance};
}

static void blame(struct oracle *oracle, enum oracle_unsafe what)
{
    if (oracle->unsafe == 0) {
        oracle->unsafe_tick = oracle->tick;
    }
    oracle->unsafe |= (unsigned)what;
}

static double spring_force_N(const struct oracle *oracle, int side)
{
    struct sea_output output;
    plant_sea_output(&oracle->loop->nodes.plant, (enum side)side, &output);
    return output.spring_force_N;
}

/* The plant's events in their order say in which support a spring was released. */
static void follow_events(struct oracle *oracle)
{
    struct walk_event event;
    struct plant *plant = &oracle->loop->nodes.plant;
    while (plant_next_event(plant, &event)) {
        switch (event.kind) {
        case WALK_EVENT_HEEL_STRIKE:
            oracle->double_support = true;
            oracle->trailing = event.side == SIDE_LEFT ? SIDE_RIGHT : SIDE_LEFT;
            break;
        case WALK_EVENT_LIFT_OFF:
        case WALK_EVENT_FAULT:
            oracle->double_support = false;
            break;
        case WALK_EVENT_RELEASE: {
            const double slack_m = 0.001 * plant->config.walk.body.leg_length_m;
            if ((!oracle->double_support || event.side != oracle->trailing) &&
                event.value > slack_m) {
                blame(oracle, UNSAFE_RELEASE);
            }
            break;
        }
        default:
            break;
        }
    }
}

static bool is_noticed(const struct oracle *oracle)
{
    const enum supervisor_state state = oracle->loop->rig.task.output.state;
    if (!supervisor_may_assist(state)) {
        return true;
    }
    for (int side = 0; side < SIDE_COUNT; side++) {
        const struct drive_node *drive = &oracle->loop->nodes.drive[side];
        if (drive->state != DRIVE_OPERATION_ENABLED || drive->unloading) {
            return true;
        }
    }
    return false;
}

/* A spring that is still loaded when it must not be. The walk may have begun anew by
 * then (a withdrawal without a fault): only the time around the limit counts. */
static void check_loaded(struct oracle *oracle)
{
    bool slack = true;
    for (int side = 0; side < SIDE_COUNT; side++) {
        const struct sea_params *sea = &oracle->loop->config.plant.sea[side];
        const double floor_N = FULL_RATIO * sea->spring_N_per_m * sea->stroke_max_m;
        const double part_N = LOADED_RATIO * oracle->noticed_force_N[side];
        slack = slack && spring_force_N(oracle, side) <= (part_N > floor_N ? part_N : floor_N);
    }
    const bool known = oracle->noticed_tick != ORACLE_NEVER;
    if (slack && known && oracle->unloaded_tick == ORACLE_NEVER) {
        oracle->unloaded_tick = oracle->tick;
    }
    const uint32_t from = known && oracle->noticed_tick < oracle->must_notice_tick
                              ? oracle->noticed_tick
                              : oracle->must_notice_tick;
    if (from != ORACLE_NEVER && oracle->tick == from + TICKS_OF_MS(ORACLE_UNLOAD_MS) && !slack &&
        oracle->unloaded_tick == ORACLE_NEVER) {
        blame(oracle, UNSAFE_LOADED);
    }
    const struct control_params *params = &oracle->loop->config.params;
    const uint32_t stop_ms = (uint32_t)(1000.0f * params->step_timeout_s) + 150 + ORACLE_UNLOAD_MS;
    if (!slack && oracle->down_tick != ORACLE_NEVER &&
        oracle->tick > oracle->down_tick + TICKS_OF_MS(stop_ms)) {
        blame(oracle, UNSAFE_FALLEN);
    }
}

static void check_mechanics(struct oracle *oracle, int side)
{
    const struct plant *plant = &oracle->loop->nodes.plant;
    const struct sea_params *sea = &oracle->loop->config.plant.sea[side];
    struct sea_output output;
    plant_sea_output(plant, (enum side)side, &output);
    if (output.ankle_force_N > FORCE_RATIO * sea->spring_N_per_m * sea->stroke_max_m) {
        blame(oracle, UNSAFE_FORCE);
    }
    if (output.position_m > sea->end_stop_max_m + 1e-9 ||
        output.position_m < sea->end_stop_min_m - 1e-9) {
        blame(oracle, UNSAFE_STROKE);
    }
    const double speed = output.speed_m_s < 0.0 ? -output.speed_m_s : output.speed_m_s;
    if (speed > RATE_RATIO * sea->speed_limit_m_s) {
        blame(oracle, UNSAFE_RATE);
    }
}

static void check_commands(struct oracle *oracle, int side)
{
    const struct control_task *task = &oracle->loop->rig.task;
    const struct control_params *params = &oracle->loop->config.params;
    const struct sea_request *request = &task->output.sea[side];
    const struct drive_node *drive = &oracle->loop->nodes.drive[side];
    const double now_m = (double)request->precompression_m;
    /* Towards more load; a stop may begin at a motor that has fallen behind. Two ticks may
     * fall into one period of the plant after a late one. */
    const double jump_m = now_m - oracle->before_m[side];
    if (request->enable && oracle->was_enabled[side] &&
        jump_m > 2.5e-3 * (double)params->sea_speed_max_m_s + 1e-6) {
        blame(oracle, UNSAFE_STEP);
    }
    oracle->before_m[side] = now_m;
    oracle->was_enabled[side] = request->enable;
    const bool follows = drive->state == DRIVE_OPERATION_ENABLED && !drive->unloading;
    const bool armed = oracle->loop->nodes.plant.sea[side].command.latch_armed;
    if (oracle->fault_tick != ORACLE_NEVER && task->output.state == SUPERVISOR_FAULT &&
        oracle->tick > oracle->fault_tick + ENABLED_MS && (follows || armed)) {
        blame(oracle, UNSAFE_ENABLED);
    }
}

static void check_step(struct oracle *oracle)
{
    const struct step_record *step = &oracle->loop->rig.task.controller.last_step;
    const struct control_params *params = &oracle->loop->config.params;
    if (step->number == oracle->r0_number) {
        return;
    }
    const double change_m = (double)step->r0_m - oracle->r0_m;
    const double size_m = change_m < 0.0 ? -change_m : change_m;
    if (oracle->r0_number > 0 && step->number == oracle->r0_number + 1 &&
        size_m > 1.001 * (double)params->r0_change_max_m) {
        blame(oracle, UNSAFE_STEP);
    }
    oracle->r0_number = step->number;
    oracle->r0_m = (double)step->r0_m;
}

void oracle_tick(struct oracle *oracle, bool differs)
{
    const struct control_task *task = &oracle->loop->rig.task;
    oracle->tick++;
    if (differs && oracle->effect_tick == ORACLE_NEVER) {
        oracle->effect_tick = oracle->tick;
    }
    if (oracle->effect_tick != ORACLE_NEVER && oracle->noticed_tick == ORACLE_NEVER &&
        is_noticed(oracle)) {
        oracle->noticed_tick = oracle->tick;
        for (int side = 0; side < SIDE_COUNT; side++) {
            oracle->noticed_force_N[side] = spring_force_N(oracle, side);
        }
    }
    if (task->output.state == SUPERVISOR_FAULT && oracle->fault_tick == ORACLE_NEVER) {
        oracle->fault_tick = oracle->tick;
    }
    if (oracle->fault == SUPERVISOR_FAULT_NONE) {
        oracle->fault = task->output.fault;
    }
    if (plant_fault(&oracle->loop->nodes.plant) != WALK_FAULT_NONE &&
        oracle->down_tick == ORACLE_NEVER) {
        oracle->down_tick = oracle->tick;
        oracle->walk_fault = plant_fault(&oracle->loop->nodes.plant);
    }
    if (!oracle->person) {
        follow_events(oracle);
        check_loaded(oracle);
    }
    for (int side = 0; side < SIDE_COUNT; side++) {
        check_mechanics(oracle, side);
        check_commands(oracle, side);
    }
    check_step(oracle);
}

bool oracle_is_settled(const struct oracle *oracle)
{
    return oracle->fault_tick != ORACLE_NEVER && oracle->unloaded_tick != ORACLE_NEVER &&
           oracle->tick > oracle->fault_tick + SETTLED_MS &&
           oracle->tick > oracle->unloaded_tick + SETTLED_MS;
}
