#include "sim_host/faults/people_internal.h"

#include "sim_host/cli/sim_report.h"
#include "sim_host/faults/oracle.h"

/* A run ends so long behind its last fault's end, or behind the scene's. */
enum { TAIL_TICKS = 2500, LAST_TICKS = 1200, SETTLED_MS = 1100 };
/* A fall by reflexes takes its time, and what lies is looked at for a while. */
enum { REFLEX_TAIL_TICKS = 4000, LYING_TICKS = 1500 };

/* ---- one run -------------------------------------------------------------------------------- */

const char *people_fall_name(enum people_fall fall)
{
    static const char *const names[PEOPLE_FALLS] = {"none", "the person's own", "the device's",
                                                    "the fault's"};
    return (unsigned)fall < PEOPLE_FALLS ? names[fall] : "?";
}

static bool is_assisting(const struct loop *loop)
{
    return loop->rig.task.output.state == SUPERVISOR_WALKING;
}

/* The device has left its assistance, or a drive has by itself, or a fault is told. */
static bool has_noticed(const struct loop *loop, bool assisted)
{
    if (loop->rig.task.output.fault != SUPERVISOR_FAULT_NONE) {
        return true;
    }
    if (!assisted) {
        return false;
    }
    for (int side = 0; side < SIDE_COUNT; side++) {
        const struct drive_node *drive = &loop->nodes.drive[side];
        if (drive->state != DRIVE_OPERATION_ENABLED || drive->unloading) {
            return true;
        }
    }
    return !supervisor_may_assist(loop->rig.task.output.state);
}

/* What the faults themselves give to a push's energy, at most. */
static double energy_of(const struct people_plan *plan, double r0_m)
{
    double factor = 1.0;
    for (unsigned i = 0; i < plan->count; i++) {
        const struct fault_shot *shot = &plan->shot[i];
        const double s = shot->magnitude;
        const double off = 1.0 + (s < 0.0 ? -s : s) / r0_m;
        if (shot->kind == FAULT_SPRING_STIFF) {
            factor *= s;
        } else if (shot->kind == FAULT_MOTOR_SCALE && s < 1.0) {
            factor /= s * s;
        } else if (shot->kind == FAULT_ENCODER_OFFSET) {
            factor *= off * off;
        }
    }
    return factor;
}

static bool has_false_contact(const struct people_plan *plan)
{
    for (unsigned i = 0; i < plan->count; i++) {
        const enum fault_kind kind = plan->shot[i].kind;
        if (kind == FAULT_FOOT_FALSE || kind == FAULT_FOOT_CHATTER ||
            kind == FAULT_FOOT_STUCK_DOWN || kind == FAULT_LEGS_SWAPPED) {
            return true;
        }
    }
    return false;
}

static uint32_t shots_end(const struct people_plan *plan)
{
    uint32_t end = 0;
    for (unsigned i = 0; i < plan->count; i++) {
        const uint32_t last = plan->shot[i].start_tick + plan->shot[i].duration_ticks;
        end = last > end ? last : end;
    }
    return end;
}

static uint32_t run_ticks(const struct people_campaign *campaign, const struct people_plan *plan)
{
    const uint32_t scene_end =
        people_scene_tick_at(campaign, people_scene_lasts_s(campaign)) + LAST_TICKS;
    const uint32_t now = (uint32_t)campaign->loop.tick;
    const uint32_t left = scene_end > now ? scene_end - now : 1;
    const uint32_t end = shots_end(plan) + (campaign->by_reflexes ? REFLEX_TAIL_TICKS : TAIL_TICKS);
    const bool stands = fault_kinds[plan->shot[0].kind].group == FAULT_GROUP_PERSON;
    return end < left || stands ? end : left;
}

/* A fault is latched, both drives are without torque and the springs slack: nothing happens any more. */
static bool is_settled(const struct loop *loop, const struct person_judge *judge)
{
    if (loop->rig.task.output.state != SUPERVISOR_FAULT ||
        judge->noticed_tick == PERSON_JUDGE_NEVER ||
        judge->tick < judge->noticed_tick + TICKS_OF_MS(SETTLED_MS)) {
        return false;
    }
    for (int side = 0; side < SIDE_COUNT; side++) {
        struct sea_output output;
        plant_sea_output(&loop->nodes.plant, (enum side)side, &output);
        if (loop->nodes.plant.sea[side].command.mode != SEA_TORQUE_OFF || !output.unloaded) {
            return false;
        }
    }
    return true;
}

/* What is at hand after the begin: a loop as after power-on, or in a walk under way. */
static bool begin(struct people_campaign *campaign, const struct people_plan *plan)
{
    char message[LOOP_MESSAGE_MAX] = "";
    return people_scene_enter(campaign, &plan->scene) &&
           (plan->from_power_on ? people_scene_power_on(campaign, message)
                                : people_scene_walk(campaign));
}

/* The same without the device. */
static bool begin_alone(struct people_campaign *campaign, const struct people_plan *plan)
{
    char message[LOOP_MESSAGE_MAX] = "";
    if (!plan->from_power_on) {
        return people_scene_walk_alone(campaign);
    }
    campaign->config.plant.unworn = true;
    const bool good = people_scene_power_on(campaign, message);
    campaign->config.plant.unworn = false;
    return good;
}

/* Whether the loop at hand falls within so many ticks, if of the plan's faults those that befall the person come. */
static bool falls(struct people_campaign *campaign, const struct people_plan *plan, uint32_t ticks)
{
    struct loop *loop = &campaign->loop;
    struct fault_shot shot[INJECTOR_SHOTS];
    struct injector injector;
    unsigned count = 0;
    for (unsigned i = 0; i < plan->count; i++) {
        if (people_plan_befalls(plan->shot[i].kind)) {
            shot[count++] = plan->shot[i];
        }
    }
    injector_begin(&injector, loop, shot, count);
    while (injector.tick < ticks && plant_fault(&loop->nodes.plant) == WALK_FAULT_NONE) {
        injector_tick(&injector);
    }
    return plant_fault(&loop->nodes.plant) != WALK_FAULT_NONE;
}

/* Whose fall it was, of a run that fell after so many ticks. A pair may fall as much later as a run looks on. */
static enum people_fall whose_fall(struct people_campaign *campaign, const struct people_plan *plan,
                                   uint32_t fell_tick)
{
    const uint32_t ticks = fell_tick + LYING_TICKS;
    campaign->log = NULL;
    if (begin_alone(campaign, plan) && falls(campaign, plan, ticks)) {
        return PEOPLE_FELL_ALONE;
    }
    return begin(campaign, plan) && falls(campaign, plan, ticks) ? PEOPLE_FELL_WEARING
                                                                 : PEOPLE_FELL_BY_FAULT;
}

/* Whether nothing new can come of it after this tick. */
static bool is_over(const struct people_campaign *campaign, const struct people_plan *plan,
                    const struct person_judge *judge)
{
    if (campaign->by_reflexes) {
        return judge->fell_tick != PERSON_JUDGE_NEVER &&
               judge->tick > judge->fell_tick + LYING_TICKS;
    }
    return judge->tick > shots_end(plan) && is_settled(&campaign->loop, judge);
}

static void walk_run(struct people_campaign *campaign, const struct people_plan *plan, FILE *ticks,
                     struct person_judge *judge, struct oracle *oracle,
                     struct people_result *result)
{
    struct loop *loop = &campaign->loop;
    struct injector injector;
    injector_begin(&injector, loop, plan->shot, plan->count);
    const uint32_t end = run_ticks(campaign, plan);
    for (uint32_t tick = 0; tick < end && !is_over(campaign, plan, judge); tick++) {
        injector_tick(&injector);
        result->assisted = result->assisted || is_assisting(loop);
        const bool begun = injector.tick > plan->shot[0].start_tick;
        oracle_tick(oracle, begun);
        person_judge_tick(judge, begun && has_noticed(loop, result->assisted));
        if (ticks != NULL) {
            sim_tick_line(ticks, loop, -1, 0.0);
        }
    }
}

bool people_campaign_run(struct people_campaign *campaign, const struct people_plan *plan,
                         FILE *log, FILE *ticks, struct people_result *result)
{
    struct loop *loop = &campaign->loop;
    struct oracle oracle;
    struct person_judge judge;
    *result = (struct people_result){.plan = *plan,
                                     .noticed_tick = PERSON_JUDGE_NEVER,
                                     .first_push_tick = PERSON_JUDGE_NEVER,
                                     .unsafe_tick = PERSON_JUDGE_NEVER};
    if (!begin(campaign, plan)) {
        return false;
    }
    struct person_truth truth = campaign->truth;
    truth.fault_energy = energy_of(plan, (double)campaign->config.params.start_r0_m);
    truth.false_contact = has_false_contact(plan);
    campaign->log = log;
    oracle_begin(&oracle, loop);
    person_judge_begin(&judge, loop, &truth);
    if (ticks != NULL) {
        sim_tick_header(ticks, loop);
    }
    walk_run(campaign, plan, ticks, &judge, &oracle, result);
    campaign->log = NULL;
    result->noticed_tick = judge.noticed_tick;
    result->first_push_tick = judge.first_push_tick;
    result->unsafe_tick =
        judge.unsafe_tick < oracle.unsafe_tick ? judge.unsafe_tick : oracle.unsafe_tick;
    result->pushes = judge.pushes;
    result->fault = loop->rig.task.output.fault;
    result->unsafe = judge.unsafe;
    result->unsafe_device = oracle.unsafe;
    result->late = plan->from_power_on && people_plan_must_notice(plan->shot[0].kind) &&
                   judge.first_push_tick != PERSON_JUDGE_NEVER &&
                   judge.noticed_tick >= judge.first_push_tick;
    if (campaign->by_reflexes && judge.fell_tick != PERSON_JUDGE_NEVER) {
        result->fall = whose_fall(campaign, plan, judge.fell_tick);
    }
    return true;
}
