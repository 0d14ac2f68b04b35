#include "sim_host/faults/campaign.h"

#include <stdlib.h>
#include <string.h>

#include "sim_host/cli/sim_report.h"
#include "sim_host/log/candump_log.h"

enum { SETTLE_TICKS_MAX = 120000 };

/* Of the speeds that are served. */
#define MOST_SHARE 0.9

struct scene_spec {
    const char *name;
    double speed_rad_s;
    enum sensor_preset_kind sensors;
    unsigned engage_steps;
    uint32_t steps; /* before the state is saved */
};

static const struct scene_spec specs[CAMPAIGN_SCENES] = {
    {"walker 0.45", 0.45, SENSORS_17BIT, 0, 20},
    {"walker 0.6", 0.6, SENSORS_17BIT, 0, 20},
    {"walker 0.8", 0.8, SENSORS_17BIT, 0, 30},
    {"walker 1.0", 1.0, SENSORS_17BIT, 0, 30},
    {"walker 0.45, 14 bit", 0.45, SENSORS_14BIT, 0, 20},
    {"person 0.45, engaged", 0.45, SENSORS_17BIT, 4, 24},
    {"person 0.6, assist level rising", 0.6, SENSORS_17BIT, 4, 9},
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

/* The scene's speed, or the nearest one well within what is served. */
static double speed_of(const struct scene_spec *spec, const struct control_params *params)
{
    real low_rad_s, high_rad_s;
    control_params_speeds(params, &low_rad_s, &high_rad_s);
    const double most = (double)low_rad_s + MOST_SHARE * (double)(high_rad_s - low_rad_s);
    return spec->speed_rad_s < most ? spec->speed_rad_s : most;
}

static int configure(const struct campaign_walker *walker, const struct scene_spec *spec,
                     struct loop_config *config, char *message)
{
    struct subject subject;
    struct control_params params;
    if (subject_read(&subject, walker->person_path, walker->device_path, message) != 0) {
        return -1;
    }
    if (subject.actuators.as_built) {
        person_override(&subject.person, "law", (double)LAW_PREDICTIVE);
    }
    if (subject_control_params(&subject, &params, message) != 0) {
        return -1;
    }
    /* Starts in the steady gait of its speed, so that the walk is steady soon. */
    const double speed_rad_s = speed_of(spec, &params);
    params.start_r0_m = speed_table_inverse(&params.table, (real)speed_rad_s);
    if (loop_configure(config, &subject, &params, speed_rad_s, spec->sensors, 1, message) != 0) {
        return -1;
    }
    if (spec->engage_steps > 0) {
        loop_configure_person(config, spec->engage_steps);
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

static int walk_scene(struct campaign *campaign, const struct campaign_walker *walker,
                      unsigned index)
{
    char message[LOOP_MESSAGE_MAX] = "";
    const struct scene_spec *spec = &specs[index];
    struct loop *loop = &campaign->loop;
    struct injector injector;
    struct loop_config config;
    if (configure(walker, spec, &config, message) != 0 ||
        loop_init(loop, &config, NULL, message) != 0 || !injector_prepare(loop)) {
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

struct campaign *campaign_create(const struct campaign_walker *walker)
{
    struct campaign *campaign = (struct campaign *)calloc(1, sizeof *campaign);
    if (campaign == NULL) {
        fputs("afo faults: out of memory\n", stderr);
        return NULL;
    }
    for (unsigned i = 0; i < CAMPAIGN_SCENES; i++) {
        if (walk_scene(campaign, walker, i) != 0) {
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

/* A foreign node that only collides has changed the bus, but said nothing. */
static bool came_through(const struct injector *injector, const struct campaign_plan *plan)
{
    return plan->count == 2 || !fault_kind_is_foreign(plan->shot[0].kind) ||
           injector_foreign_frames(injector) > 0;
}

/* A single fault that lasts long enough must be noticed in its time; what two do to
 * each other nobody knows, so there only the plant counts. */
static void set_deadline(struct oracle *oracle, const struct injector *injector,
                         const struct campaign_plan *plan)
{
    const struct fault_kind_info *info = &fault_kinds[plan->shot[0].kind];
    if (plan->count == 1 && info->notice_ms > 0 &&
        plan->shot[0].duration_ticks >= TICKS_OF_MS(info->lasting_ms) &&
        oracle->effect_tick != ORACLE_NEVER && oracle->must_notice_tick == ORACLE_NEVER &&
        came_through(injector, plan)) {
        oracle->must_notice_tick = oracle->tick + TICKS_OF_MS(info->notice_ms);
    }
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
        sim_tick_header(ticks, loop);
    }
    const uint32_t end = shots_end(plan);
    for (uint32_t tick = 0; tick < end + CAMPAIGN_TAIL_TICKS && tick < CAMPAIGN_TICKS; tick++) {
        injector_tick(&injector);
        oracle_tick(&oracle, campaign->bus_digest != scene->bus_digest[tick] ||
                                 plant_digest(&loop->nodes.plant) != scene->plant_digest[tick]);
        set_deadline(&oracle, &injector, plan);
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
