#include "sim_host/faults/campaign.h"

#include <stdlib.h>
#include <string.h>

#include "sim_host/cli/sim_report.h"
#include "sim_host/log/candump_log.h"

enum { SETTLE_TICKS_MAX = 120000 };

struct scene_spec {
    const char *name;
    double speed_rad_s;
    enum sensor_preset_kind sensors;
    unsigned engage_steps;
    uint32_t steps; /* before the state is saved */
};

static const struct scene_spec specs[CAMPAIGN_SCENES] = {
    {"bench 0.45", 0.45, SENSORS_17BIT, 0, 20},
    {"bench 0.6", 0.6, SENSORS_17BIT, 0, 20},
    {"bench 0.8", 0.8, SENSORS_17BIT, 0, 30},
    {"bench 1.0", 1.0, SENSORS_17BIT, 0, 30},
    {"bench 0.45, 14 bit", 0.45, SENSORS_14BIT, 0, 20},
    {"wearer 0.45, engaged", 0.45, SENSORS_17BIT, 4, 24},
    {"wearer 0.6, share rising", 0.6, SENSORS_17BIT, 4, 9},
};

struct scene {
    struct loop saved;
    uint64_t bus_digest[CAMPAIGN_TICKS];
    uint64_t plant_digest[CAMPAIGN_TICKS];
};

struct campaign {
    struct loop loop; /* snapshots hold pointers into it: it never moves */
    uint64_t bus_digest;
    FILE *log;
    struct scene scene[CAMPAIGN_SCENES];
};

const char *campaign_scene_name(unsigned scene)
{
    return scene < CAMPAIGN_SCENES ? specs[scene].name : "?";
}

/* ---- plans ------------------------------------------------------------------------ */

static void plan_shot(uint64_t *state, enum fault_kind kind, struct fault_shot *shot)
{
    const struct fault_kind_info *info = &fault_kinds[kind];
    const double span = (double)(info->longest_ms - info->shortest_ms);
    const double part = injector_random(state); /* cubed: short ones more often than long */
    shot->kind = kind;
    shot->node = (uint8_t)(injector_random(state) * 4.0);
    shot->duration_ticks =
        TICKS_OF_MS(info->shortest_ms + (uint32_t)(span * part * part * part + 0.5));
    shot->magnitude = info->least + (info->greatest - info->least) * injector_random(state);
    shot->seed = (uint64_t)(injector_random(state) * 0x1p53);
}

void campaign_plan(uint64_t seed, uint32_t index, struct campaign_plan *plan)
{
    uint64_t state = seed * UINT64_C(0xD1342543DE82EF95) + index;
    *plan = (struct campaign_plan){.index = index};
    (void)injector_random(&state);
    plan->scene = (uint8_t)(injector_random(&state) * CAMPAIGN_SCENES);
    plan->count = injector_random(&state) < 0.3 ? 2 : 1;
    plan_shot(&state, (enum fault_kind)(index % FAULT_KINDS), &plan->shot[0]);
    plan->shot[0].start_tick = (uint32_t)(injector_random(&state) * CAMPAIGN_PHASE_TICKS);
    if (plan->count == 2) {
        const double second = injector_random(&state) * FAULT_KINDS;
        plan_shot(&state, (enum fault_kind)second, &plan->shot[1]);
        plan->shot[1].start_tick =
            plan->shot[0].start_tick + (uint32_t)(injector_random(&state) * 500.0);
    }
}

/* ---- digests ------------------------------------------------------------------------ */

static uint64_t mixed(uint64_t hash, uint64_t value)
{
    hash = (hash ^ value) * UINT64_C(0x9E3779B97F4A7C15);
    return hash ^ (hash >> 29);
}

static uint64_t mixed_double(uint64_t hash, double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    return mixed(hash, bits);
}

static void tap(void *context, const struct sim_bus_event *event)
{
    struct campaign *campaign = (struct campaign *)context;
    uint64_t data;
    memcpy(&data, event->message.data, sizeof data);
    uint64_t hash = mixed(campaign->bus_digest, event->time_ns);
    hash = mixed(hash, event->message.id << 8 | event->message.length);
    hash = mixed(hash, (uint64_t)event->kind << 8 | (uint64_t)event->fault);
    campaign->bus_digest = mixed(hash, data);
    if (campaign->log != NULL && event->kind == SIM_BUS_FRAME) {
        (void)candump_write(campaign->log, event->time_ns / 1000u, "can0", &event->message);
    }
}

static uint64_t plant_digest(const struct plant *plant)
{
    uint64_t hash = (uint64_t)plant->walk.phase;
    for (int i = 0; i < WALKER3_DOF; i++) {
        hash = mixed_double(hash, plant->walk.state.q[i]);
        hash = mixed_double(hash, plant->walk.state.dq[i]);
    }
    for (int side = 0; side < SIDE_COUNT; side++) {
        hash = mixed_double(hash, plant->sea[side].position_m);
        hash = mixed(hash, (uint64_t)plant->sea[side].latch);
    }
    return hash;
}

/* ---- scenes -------------------------------------------------------------------------- */

static int configure(const struct scene_spec *spec, struct loop_config *config, char *message)
{
    struct subject subject;
    struct control_params params;
    subject_default(&subject);
    if (subject_control_params(&subject, &params, message) != 0) {
        return -1;
    }
    /* Starts in the steady gait of its speed, so that the walk is steady soon. */
    params.start_r0_m = speed_table_inverse(&params.table, (real)spec->speed_rad_s);
    if (loop_configure(config, &subject, &params, spec->speed_rad_s, spec->sensors, 1, message) !=
        0) {
        return -1;
    }
    if (spec->engage_steps > 0) {
        loop_configure_recording(config, spec->engage_steps);
    }
    return 0;
}

static void drain_events(struct plant *plant)
{
    struct walk_event event;
    struct walk_step step;
    while (plant_next_event(plant, &event)) {
    }
    while (plant_next_step(plant, &step)) {
    }
}

static int walk_scene(struct campaign *campaign, unsigned index)
{
    char message[LOOP_MESSAGE_MAX] = "";
    const struct scene_spec *spec = &specs[index];
    struct loop *loop = &campaign->loop;
    struct injector injector;
    struct loop_config config;
    if (configure(spec, &config, message) != 0 || loop_init(loop, &config, NULL, message) != 0 ||
        !injector_prepare(loop)) {
        fprintf(stderr, "afo faults: scene %s: %s\n", spec->name, message);
        return -1;
    }
    injector_begin(&injector, loop, NULL, 0);
    while (loop->tick < SETTLE_TICKS_MAX &&
           loop->rig.task.controller.plan.law.steps < spec->steps) {
        injector_tick(&injector);
    }
    if (loop->rig.task.output.state != SUPERVISOR_WALKING ||
        plant_fault(&loop->nodes.plant) != WALK_FAULT_NONE) {
        fprintf(stderr, "afo faults: scene %s does not walk\n", spec->name);
        return -1;
    }
    drain_events(&loop->nodes.plant);
    sim_bus_set_tap(&loop->bus, tap, campaign);
    struct scene *scene = &campaign->scene[index];
    memcpy(&scene->saved, loop, sizeof *loop);
    campaign->bus_digest = 0;
    for (unsigned tick = 0; tick < CAMPAIGN_TICKS; tick++) {
        injector_tick(&injector);
        scene->bus_digest[tick] = campaign->bus_digest;
        scene->plant_digest[tick] = plant_digest(&loop->nodes.plant);
    }
    if (plant_fault(&loop->nodes.plant) != WALK_FAULT_NONE) {
        fprintf(stderr, "afo faults: scene %s does not walk on\n", spec->name);
        return -1;
    }
    return 0;
}

struct campaign *campaign_create(void)
{
    struct campaign *campaign = (struct campaign *)calloc(1, sizeof *campaign);
    if (campaign == NULL) {
        fputs("afo faults: out of memory\n", stderr);
        return NULL;
    }
    for (unsigned i = 0; i < CAMPAIGN_SCENES; i++) {
        if (walk_scene(campaign, i) != 0) {
            free(campaign);
            return NULL;
        }
    }
    return campaign;
}

void campaign_destroy(struct campaign *campaign)
{
    free(campaign);
}

/* ---- one run -------------------------------------------------------------------------- */

static uint32_t shots_end(const struct campaign_plan *plan)
{
    uint32_t end = 0;
    for (unsigned i = 0; i < plan->count; i++) {
        const uint32_t last = plan->shot[i].start_tick + plan->shot[i].duration_ticks;
        end = last > end ? last : end;
    }
    return end;
}

/* A single fault that lasts long enough must be noticed in its time; what two do to
 * each other nobody knows, so there only the plant counts. */
static void set_deadline(struct oracle *oracle, const struct campaign_plan *plan)
{
    const struct fault_kind_info *info = &fault_kinds[plan->shot[0].kind];
    if (plan->count == 1 && info->notice_ms > 0 &&
        plan->shot[0].duration_ticks >= TICKS_OF_MS(info->lasting_ms) &&
        oracle->effect_tick != ORACLE_NEVER) {
        oracle->must_notice_tick = oracle->effect_tick + TICKS_OF_MS(info->notice_ms);
    }
}

/* A foreign node that only collides has changed the bus, but said nothing. */
static bool came_through(const struct injector *injector, const struct campaign_plan *plan)
{
    return plan->count == 2 || !fault_kind_is_foreign(plan->shot[0].kind) ||
           injector_foreign_frames(injector) > 0;
}

void campaign_run(struct campaign *campaign, const struct campaign_plan *plan, FILE *log,
                  FILE *ticks, struct campaign_result *result)
{
    const struct scene *scene = &campaign->scene[plan->scene];
    struct loop *loop = &campaign->loop;
    struct injector injector;
    struct oracle oracle;
    memcpy(loop, &scene->saved, sizeof *loop);
    campaign->bus_digest = 0;
    campaign->log = log;
    injector_begin(&injector, loop, plan->shot, plan->count);
    oracle_begin(&oracle, loop);
    if (ticks != NULL) {
        sim_tick_header(ticks);
    }
    const uint32_t end = shots_end(plan);
    for (uint32_t tick = 0; tick < end + CAMPAIGN_TAIL_TICKS && tick < CAMPAIGN_TICKS; tick++) {
        injector_tick(&injector);
        oracle_tick(&oracle, campaign->bus_digest != scene->bus_digest[tick] ||
                                 plant_digest(&loop->nodes.plant) != scene->plant_digest[tick]);
        set_deadline(&oracle, plan);
        if (ticks != NULL) {
            sim_tick_line(ticks, loop, -1, 0.0);
        }
        if (tick > end && oracle_is_settled(&oracle)) {
            break;
        }
    }
    campaign->log = NULL;
    *result = (struct campaign_result){.plan = *plan,
                                       .effective = oracle.effect_tick != ORACLE_NEVER &&
                                                    came_through(&injector, plan),
                                       .effect_tick = oracle.effect_tick,
                                       .noticed_tick = oracle.noticed_tick,
                                       .unloaded_tick = oracle.unloaded_tick,
                                       .unsafe_tick = oracle.unsafe_tick,
                                       .fault = oracle.fault,
                                       .walk_fault = oracle.walk_fault,
                                       .unsafe = oracle.unsafe};
    result->late =
        oracle.must_notice_tick != ORACLE_NEVER &&
        (oracle.noticed_tick == ORACLE_NEVER || oracle.noticed_tick > oracle.must_notice_tick);
}

/* ---- results file ----------------------------------------------------------------------- */

void campaign_write(FILE *file, const struct campaign_result *result)
{
    fprintf(file, "%u %d %d %u %u %u %u %d %d %u\n", result->plan.index, result->effective,
            result->late, result->effect_tick, result->noticed_tick, result->unloaded_tick,
            result->unsafe_tick, (int)result->fault, (int)result->walk_fault, result->unsafe);
}

bool campaign_read(const char *line, uint64_t seed, struct campaign_result *result)
{
    enum { FIELDS = 10 }; /* as campaign_write has them */
    long long field[FIELDS];
    for (int i = 0; i < FIELDS; i++) {
        char *end;
        field[i] = strtoll(line, &end, 10);
        if (end == line || field[i] < INT32_MIN || field[i] > (long long)UINT32_MAX) {
            return false;
        }
        line = end;
    }
    if (*line != '\n') {
        return false;
    }
    *result = (struct campaign_result){.effective = field[1] != 0,
                                       .late = field[2] != 0,
                                       .effect_tick = (uint32_t)field[3],
                                       .noticed_tick = (uint32_t)field[4],
                                       .unloaded_tick = (uint32_t)field[5],
                                       .unsafe_tick = (uint32_t)field[6],
                                       .fault = (enum supervisor_fault)field[7],
                                       .walk_fault = (enum walk_fault)field[8],
                                       .unsafe = (unsigned)field[9]};
    campaign_plan(seed, (uint32_t)field[0], &result->plan);
    return true;
}
