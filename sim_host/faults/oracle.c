#include "sim_host/faults/oracle.h"

static const double LOADED_SHARE = 0.05;
static const double FULL_SHARE = 0.01;
static const double RATE_SHARE = 1.3;
static const double FORCE_SHARE = 1.02;

enum { ENABLED_MS = 100, SETTLED_MS = 500 };

const char *judge_unsafe_name(int bit)
{
    static const char *const names[UNSAFE_BITS] = {
        "release", "loaded", "loaded after a fall", "force", "stroke", "rate", "enabled", "step"};
    return bit >= 0 && bit < UNSAFE_BITS ? names[bit] : "?";
}

void judge_begin(struct judge *judge, struct loop *loop)
{
    const struct plant *plant = &loop->nodes.plant;
    *judge = (struct judge){.loop = loop,
                            .effect_tick = JUDGE_NEVER,
                            .noticed_tick = JUDGE_NEVER,
                            .unloaded_tick = JUDGE_NEVER,
                            .must_notice_tick = JUDGE_NEVER,
                            .fault_tick = JUDGE_NEVER,
                            .down_tick = JUDGE_NEVER,
                            .unsafe_tick = JUDGE_NEVER,
                            .r0_m = (double)loop->rig.task.controller.last_step.r0_m,
                            .r0_number = loop->rig.task.controller.last_step.number,
                            .double_support = plant->walk.phase == WALK_DOUBLE,
                            .trailing = plant->walk.stance};
}

static void blame(struct judge *judge, enum judge_unsafe what)
{
    if (judge->unsafe == 0) {
        judge->unsafe_tick = judge->tick;
    }
    judge->unsafe |= (unsigned)what;
}

static double spring_force_N(const struct judge *judge, int side)
{
    struct sea_output output;
    plant_sea_output(&judge->loop->nodes.plant, (enum side)side, &output);
    return output.spring_force_N;
}

/* The plant's events in their order say in which support a spring was released. */
static void follow_events(struct judge *judge)
{
    struct walk_event event;
    struct plant *plant = &judge->loop->nodes.plant;
    while (plant_next_event(plant, &event)) {
        switch (event.kind) {
        case WALK_EVENT_HEEL_STRIKE:
            judge->double_support = true;
            judge->trailing = event.side == SIDE_LEFT ? SIDE_RIGHT : SIDE_LEFT;
            break;
        case WALK_EVENT_LIFT_OFF:
        case WALK_EVENT_FAULT:
            judge->double_support = false;
            break;
        case WALK_EVENT_RELEASE: {
            const double slack_m = 0.001 * plant->config.walk.body.leg_length_m;
            if ((!judge->double_support || event.side != judge->trailing) &&
                event.value > slack_m) {
                blame(judge, UNSAFE_RELEASE);
            }
            break;
        }
        default:
            break;
        }
    }
}

static bool is_noticed(const struct judge *judge)
{
    const enum supervisor_state state = judge->loop->rig.task.output.state;
    if (!supervisor_may_assist(state)) {
        return true;
    }
    for (int side = 0; side < SIDE_COUNT; side++) {
        const struct drive_node *drive = &judge->loop->nodes.drive[side];
        if (drive->state != DRIVE_OPERATION_ENABLED || drive->unloading) {
            return true;
        }
    }
    return false;
}

/* A spring that is still loaded when it must not be. The walk may have begun anew by
 * then (a withdrawal without a fault): only the time around the limit counts. */
static void check_loaded(struct judge *judge)
{
    bool slack = true;
    for (int side = 0; side < SIDE_COUNT; side++) {
        const struct sea_params *sea = &judge->loop->config.plant.sea[side];
        const double floor_N = FULL_SHARE * sea->spring_N_per_m * sea->stroke_max_m;
        const double part_N = LOADED_SHARE * judge->noticed_force_N[side];
        slack = slack && spring_force_N(judge, side) <= (part_N > floor_N ? part_N : floor_N);
    }
    const bool known = judge->noticed_tick != JUDGE_NEVER;
    if (slack && known && judge->unloaded_tick == JUDGE_NEVER) {
        judge->unloaded_tick = judge->tick;
    }
    const uint32_t from = known && judge->noticed_tick < judge->must_notice_tick
                              ? judge->noticed_tick
                              : judge->must_notice_tick;
    if (from != JUDGE_NEVER && judge->tick == from + JUDGE_UNLOAD_MS && !slack &&
        judge->unloaded_tick == JUDGE_NEVER) {
        blame(judge, UNSAFE_LOADED);
    }
    const struct control_params *params = &judge->loop->config.params;
    const uint32_t stop_ms = (uint32_t)(1000.0f * params->step_timeout_s) + 150 + JUDGE_UNLOAD_MS;
    if (!slack && judge->down_tick != JUDGE_NEVER && judge->tick > judge->down_tick + stop_ms) {
        blame(judge, UNSAFE_FALLEN);
    }
}

static void check_mechanics(struct judge *judge, int side)
{
    const struct plant *plant = &judge->loop->nodes.plant;
    const struct sea_params *sea = &judge->loop->config.plant.sea[side];
    struct sea_output output;
    plant_sea_output(plant, (enum side)side, &output);
    if (output.ankle_force_N > FORCE_SHARE * sea->spring_N_per_m * sea->stroke_max_m) {
        blame(judge, UNSAFE_FORCE);
    }
    if (output.position_m > sea->end_stop_max_m + 1e-9 ||
        output.position_m < sea->end_stop_min_m - 1e-9) {
        blame(judge, UNSAFE_STROKE);
    }
    const double speed = output.speed_m_s < 0.0 ? -output.speed_m_s : output.speed_m_s;
    if (speed > RATE_SHARE * sea->speed_limit_m_s) {
        blame(judge, UNSAFE_RATE);
    }
}

static void check_commands(struct judge *judge, int side)
{
    const struct control_task *task = &judge->loop->rig.task;
    const struct control_params *params = &judge->loop->config.params;
    const struct sea_request *request = &task->output.sea[side];
    const struct drive_node *drive = &judge->loop->nodes.drive[side];
    const double now_m = (double)request->precompression_m;
    /* Towards more load; a stop may begin at a motor that has fallen behind. Two ticks may
     * fall into one period of the plant after a late one. */
    const double jump_m = now_m - judge->before_m[side];
    if (request->enable && judge->was_enabled[side] &&
        jump_m > 2.5e-3 * (double)params->sea_speed_max_m_s + 1e-6) {
        blame(judge, UNSAFE_STEP);
    }
    judge->before_m[side] = now_m;
    judge->was_enabled[side] = request->enable;
    const bool follows = drive->state == DRIVE_OPERATION_ENABLED && !drive->unloading;
    const bool armed = judge->loop->nodes.plant.sea[side].command.latch_armed;
    if (judge->fault_tick != JUDGE_NEVER && task->output.state == SUPERVISOR_FAULT &&
        judge->tick > judge->fault_tick + ENABLED_MS && (follows || armed)) {
        blame(judge, UNSAFE_ENABLED);
    }
}

static void check_step(struct judge *judge)
{
    const struct step_record *step = &judge->loop->rig.task.controller.last_step;
    const struct control_params *params = &judge->loop->config.params;
    if (step->number == judge->r0_number) {
        return;
    }
    const double change_m = (double)step->r0_m - judge->r0_m;
    const double size_m = change_m < 0.0 ? -change_m : change_m;
    if (judge->r0_number > 0 && step->number == judge->r0_number + 1 &&
        size_m > 1.001 * (double)params->r0_change_max_m) {
        blame(judge, UNSAFE_STEP);
    }
    judge->r0_number = step->number;
    judge->r0_m = (double)step->r0_m;
}

void judge_tick(struct judge *judge, bool differs)
{
    const struct control_task *task = &judge->loop->rig.task;
    judge->tick++;
    if (differs && judge->effect_tick == JUDGE_NEVER) {
        judge->effect_tick = judge->tick;
    }
    if (judge->effect_tick != JUDGE_NEVER && judge->noticed_tick == JUDGE_NEVER &&
        is_noticed(judge)) {
        judge->noticed_tick = judge->tick;
        for (int side = 0; side < SIDE_COUNT; side++) {
            judge->noticed_force_N[side] = spring_force_N(judge, side);
        }
    }
    if (task->output.state == SUPERVISOR_FAULT && judge->fault_tick == JUDGE_NEVER) {
        judge->fault_tick = judge->tick;
    }
    if (judge->fault == SUPERVISOR_FAULT_NONE) {
        judge->fault = task->output.fault;
    }
    if (plant_fault(&judge->loop->nodes.plant) != WALK_FAULT_NONE &&
        judge->down_tick == JUDGE_NEVER) {
        judge->down_tick = judge->tick;
        judge->walk_fault = plant_fault(&judge->loop->nodes.plant);
    }
    follow_events(judge);
    check_loaded(judge);
    for (int side = 0; side < SIDE_COUNT; side++) {
        check_mechanics(judge, side);
        check_commands(judge, side);
    }
    check_step(judge);
}

bool judge_is_settled(const struct judge *judge)
{
    return judge->fault_tick != JUDGE_NEVER && judge->unloaded_tick != JUDGE_NEVER &&
           judge->tick > judge->fault_tick + SETTLED_MS &&
           judge->tick > judge->unloaded_tick + SETTLED_MS;
}
