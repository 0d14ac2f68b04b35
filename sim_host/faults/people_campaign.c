#include "sim_host/faults/people_campaign.h"

#include <dirent.h>
#include <stdlib.h>
#include <string.h>

#include "sim_host/cli/recording_options.h"
#include "sim_host/cli/sim_report.h"
#include "sim_host/faults/oracle.h"
#include "sim_host/log/candump_log.h"

/* Scenes are cut to this; its end is a sudden stop. */
static const double SCENE_S = 20.0;
/* A walk under way: so many pushes, or this share of the scene. */
enum { SAVED_PUSHES = 10 };
static const double SAVED_SHARE = 0.55;
static const double BEFORE_STOP_S = 0.8;
/* A run ends so long behind its last fault's end, or behind the scene's. */
enum { TAIL_TICKS = 2500, LAST_TICKS = 1200, SETTLED_MS = 1100 };

/* Recordings whose contacts are not true to the millisecond, and those that are no walking. */
static const char *const coarse[] = {"circuit"};
static const char *const running[] = {"run_"};

struct source {
    char name[PEOPLE_NAME_MAX];
    struct recording recording;
    bool exact, walks;
};

struct people_campaign {
    struct loop loop;  /* snapshots hold pointers into it: it never moves */
    struct loop saved; /* of the scene below */
    struct subject subject[PEOPLE_DEVICES];
    unsigned sources;
    struct source source[PEOPLE_RECORDINGS_MAX];
    /* The scene that is at hand. */
    bool has_scene, scene_is_good, scene_is_walked;
    struct people_scene_plan plan;
    struct loop_config config;
    struct recording walk;
    struct person_truth truth;
    double changes_s; /* of the recording: the person stops, or something else begins */
    FILE *log;
};

/* ---- sources ----------------------------------------------------------------------------- */

static bool begins_with_one_of(const char *name, const char *const *starts, unsigned count)
{
    for (unsigned i = 0; i < count; i++) {
        if (strncmp(name, starts[i], strlen(starts[i])) == 0) {
            return true;
        }
    }
    return false;
}

static int read_source(struct people_campaign *campaign, const char *folder, const char *file)
{
    char path[PLANT_PATH_MAX], why[RECORDING_ERROR_MAX];
    struct recording_format format;
    struct source *source = &campaign->source[campaign->sources];
    if (campaign->sources == PEOPLE_RECORDINGS_MAX) {
        fprintf(stderr, "afo faults: %s: more than %d recordings\n", folder, PEOPLE_RECORDINGS_MAX);
        return -1;
    }
    recording_format_default(&format);
    snprintf(path, sizeof path, "%s/%s", folder, file);
    if (recording_load(&source->recording, path, &format, why) != RECORDING_OK) {
        fprintf(stderr, "afo faults: %s\n", why);
        return -1;
    }
    snprintf(source->name, sizeof source->name, "%.*s", (int)(strlen(file) - strlen(".csv")), file);
    source->exact = !begins_with_one_of(file, coarse, sizeof coarse / sizeof coarse[0]);
    source->walks = !begins_with_one_of(file, running, sizeof running / sizeof running[0]);
    campaign->sources++;
    return 0;
}

static int is_recording(const struct dirent *entry)
{
    const size_t length = strlen(entry->d_name);
    return length > 4 && strcmp(entry->d_name + length - 4, ".csv") == 0;
}

static int read_folder(struct people_campaign *campaign, const char *folder)
{
    struct dirent **entries;
    const int count = scandir(folder, &entries, is_recording, alphasort);
    int status = 0;
    for (int i = 0; i < count; i++) {
        status = status == 0 ? read_source(campaign, folder, entries[i]->d_name) : status;
        free(entries[i]);
    }
    if (count >= 0) {
        free(entries);
    }
    return status;
}

static int read_data(struct people_campaign *campaign, const char *data)
{
    char people[PLANT_PATH_MAX];
    if (data == NULL || data[0] == '\0') {
        return 0;
    }
    snprintf(people, sizeof people, "%s/people", data);
    if (read_folder(campaign, data) != 0 || read_folder(campaign, people) != 0) {
        return -1;
    }
    if (campaign->sources == 0) {
        fprintf(stderr, "afo faults: no recording in %s or %s\n", data, people);
        return -1;
    }
    return 0;
}

struct people_campaign *people_campaign_create(const char *person, const char *const *devices,
                                               const char *data)
{
    char message[SUBJECT_MESSAGE_MAX];
    struct people_campaign *campaign = (struct people_campaign *)calloc(1, sizeof *campaign);
    if (campaign == NULL) {
        fputs("afo faults: out of memory\n", stderr);
        return NULL;
    }
    for (unsigned i = 0; i < PEOPLE_DEVICES; i++) {
        if (subject_read(&campaign->subject[i], person, devices[i], message) != 0) {
            fprintf(stderr, "afo faults: %s (call it at the top of the source tree)\n", message);
            people_campaign_destroy(campaign);
            return NULL;
        }
        campaign->subject[i].is_person = true;
    }
    if (read_data(campaign, data) != 0) {
        people_campaign_destroy(campaign);
        return NULL;
    }
    return campaign;
}

static void leave_scene(struct people_campaign *campaign)
{
    recording_free(&campaign->walk);
    campaign->has_scene = false;
}

void people_campaign_destroy(struct people_campaign *campaign)
{
    if (campaign == NULL) {
        return;
    }
    leave_scene(campaign);
    for (unsigned i = 0; i < campaign->sources; i++) {
        recording_free(&campaign->source[i].recording);
    }
    free(campaign);
}

unsigned people_campaign_recordings(const struct people_campaign *campaign)
{
    return campaign->sources;
}

void people_campaign_name(const struct people_campaign *campaign,
                          const struct people_scene_plan *plan, char *name, size_t size)
{
    if (plan->source == PEOPLE_MADE) {
        snprintf(name, size, "made, stride %.2f s, size %.2f, asymmetry %.2f, %s",
                 plan->made.stride_s, plan->made.size, plan->made.asymmetry,
                 copy_kinds[plan->copy].name);
    } else {
        snprintf(name, size, "%s/%s", campaign->source[plan->source].name,
                 copy_kinds[plan->copy].name);
    }
}

/* ---- scenes ------------------------------------------------------------------------------- */

/* The part of the source that is walked, and what is made of it. */
static bool make_walk(struct people_campaign *campaign, struct copy_truth *copy)
{
    const struct people_scene_plan *plan = &campaign->plan;
    struct recording whole = {0}, window = {0};
    struct recording_format format;
    recording_format_default(&format);
    const struct recording *source = &whole;
    if (plan->source == PEOPLE_MADE) {
        if (made_person_record(&whole, &plan->made, &format) != RECORDING_OK) {
            return false;
        }
    } else {
        source = &campaign->source[plan->source].recording;
    }
    const double spare_s = source->samples[source->count - 1].time_s - SCENE_S;
    const double from_s = spare_s > 0.0 ? plan->phase * spare_s : 0.0;
    bool good = changed_copy_window(&window, source, from_s, SCENE_S) == RECORDING_OK &&
                changed_copy_make(&campaign->walk, &window, plan->copy, plan->phase, &format,
                                  copy) == RECORDING_OK;
    recording_free(&window);
    recording_free(&whole);
    return good && campaign->walk.count >= 10;
}

static bool configure(struct people_campaign *campaign, char *message)
{
    const struct people_scene_plan *plan = &campaign->plan;
    const struct subject *subject = &campaign->subject[plan->device];
    struct control_params params;
    struct recording_options recording;
    double speed_rad_s;
    if (subject_control_params(subject, &params, message) != 0) {
        return false;
    }
    speed_rad_s = (double)speed_table_speed(&params.table, params.start_r0_m);
    recording_options_init(&recording);
    recording.path = "";
    recording.switches = plan->switches;
    if (loop_configure(&campaign->config, subject, &params, speed_rad_s, plan->sensors, plan->seed,
                       message) != 0 ||
        recording_options_apply(&recording, &campaign->config, message) != 0) {
        return false;
    }
    campaign->config.plant.recording = &campaign->walk;
    return true;
}

static void know_truth(struct people_campaign *campaign, const struct copy_truth *copy)
{
    const struct people_scene_plan *plan = &campaign->plan;
    const struct source *source =
        plan->source == PEOPLE_MADE ? NULL : &campaign->source[plan->source];
    const double spring_N_per_m = subject_spring_N_per_m(&campaign->subject[plan->device]);
    const double r0_m = (double)campaign->config.params.start_r0_m;
    campaign->truth =
        (struct person_truth){.walks = copy->walks && (source == NULL || source->walks),
                              .exact = source == NULL || source->exact,
                              .stands_s = copy->stands_s,
                              .sample_s = campaign->walk.samples[1].time_s,
                              .prescribed_J = 0.5 * spring_N_per_m * r0_m * r0_m,
                              .fault_energy = 1.0};
    campaign->changes_s = copy->stands_s;
}

static void tap(void *context, const struct sim_bus_event *event)
{
    struct people_campaign *campaign = (struct people_campaign *)context;
    if (campaign->log != NULL && event->kind == SIM_BUS_FRAME) {
        (void)candump_write(campaign->log, event->time_ns / 1000u, "can0", &event->message);
    }
}

static bool power_on(struct people_campaign *campaign, char *message)
{
    struct loop *loop = &campaign->loop;
    if (loop_init(loop, &campaign->config, NULL, message) != 0) {
        return false;
    }
    sim_bus_set_tap(&loop->bus, tap, campaign);
    return injector_prepare(loop);
}

static bool enter_scene(struct people_campaign *campaign, const struct people_scene_plan *plan)
{
    char message[LOOP_MESSAGE_MAX] = "";
    struct copy_truth copy;
    if (campaign->has_scene && campaign->plan.block == plan->block &&
        campaign->plan.seed == plan->seed) {
        return campaign->scene_is_good;
    }
    leave_scene(campaign);
    campaign->plan = *plan;
    campaign->has_scene = true;
    campaign->scene_is_walked = false;
    campaign->scene_is_good = make_walk(campaign, &copy) && configure(campaign, message);
    if (message[0] != '\0') {
        fprintf(stderr, "afo faults: %s\n", message);
    }
    if (campaign->scene_is_good) {
        know_truth(campaign, &copy);
    }
    return campaign->scene_is_good;
}

static double recorded_s(const struct people_campaign *campaign)
{
    const struct recording *walk = &campaign->walk;
    return walk->samples[walk->count - 1].time_s;
}

static uint32_t tick_at(const struct people_campaign *campaign, double time_s)
{
    const struct plant_config *plant = &campaign->config.plant;
    return (uint32_t)plant->recording_start_tick + (uint32_t)(time_s / plant->tick_s);
}

static unsigned count_releases(struct plant *plant)
{
    struct walk_event event;
    unsigned count = 0;
    while (plant_next_event(plant, &event)) {
        count += event.kind == WALK_EVENT_RELEASE ? 1 : 0;
    }
    return count;
}

/* Walks until the walk is under way, and saves that. */
static bool walk_scene(struct people_campaign *campaign)
{
    char message[LOOP_MESSAGE_MAX] = "";
    struct injector injector;
    struct loop *loop = &campaign->loop;
    const double stop_s = campaign->changes_s - BEFORE_STOP_S;
    const bool stops = campaign->changes_s < COPY_NEVER && stop_s > 0.0;
    const uint32_t last = tick_at(campaign, stops ? stop_s : SAVED_SHARE * recorded_s(campaign));
    unsigned pushes = 0;
    campaign->log = NULL;
    if (campaign->scene_is_walked) {
        memcpy(loop, &campaign->saved, sizeof *loop);
        return true;
    }
    if (!power_on(campaign, message)) {
        fprintf(stderr, "afo faults: %s\n", message);
        return false;
    }
    injector_begin(&injector, loop, NULL, 0);
    while (loop->tick < last && (stops || pushes < SAVED_PUSHES)) {
        injector_tick(&injector);
        pushes += count_releases(&loop->nodes.plant);
    }
    memcpy(&campaign->saved, loop, sizeof *loop);
    campaign->scene_is_walked = true;
    return true;
}

/* ---- one run -------------------------------------------------------------------------------- */

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
    const uint32_t scene_end = tick_at(campaign, recorded_s(campaign)) + LAST_TICKS;
    const uint32_t now = (uint32_t)campaign->loop.tick;
    const uint32_t left = scene_end > now ? scene_end - now : 1;
    const uint32_t end = shots_end(plan) + TAIL_TICKS;
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

bool people_campaign_run(struct people_campaign *campaign, const struct people_plan *plan,
                         FILE *log, FILE *ticks, struct people_result *result)
{
    char message[LOOP_MESSAGE_MAX] = "";
    struct loop *loop = &campaign->loop;
    struct injector injector;
    struct oracle oracle;
    struct person_judge judge;
    *result = (struct people_result){.plan = *plan,
                                     .noticed_tick = PERSON_JUDGE_NEVER,
                                     .first_push_tick = PERSON_JUDGE_NEVER,
                                     .unsafe_tick = PERSON_JUDGE_NEVER};
    if (!enter_scene(campaign, &plan->scene) ||
        !(plan->from_power_on ? power_on(campaign, message) : walk_scene(campaign))) {
        return false;
    }
    struct person_truth truth = campaign->truth;
    truth.fault_energy = energy_of(plan, (double)campaign->config.params.start_r0_m);
    truth.false_contact = has_false_contact(plan);
    campaign->log = log;
    injector_begin(&injector, loop, plan->shot, plan->count);
    oracle_begin(&oracle, loop);
    person_judge_begin(&judge, loop, &truth);
    if (ticks != NULL) {
        sim_tick_header(ticks);
    }
    const uint32_t end = run_ticks(campaign, plan);
    const uint32_t over = shots_end(plan);
    for (uint32_t tick = 0; tick < end && !(tick > over && is_settled(loop, &judge)); tick++) {
        injector_tick(&injector);
        result->assisted = result->assisted || is_assisting(loop);
        const bool begun = injector.tick > plan->shot[0].start_tick;
        oracle_tick(&oracle, begun);
        person_judge_tick(&judge, begun && has_noticed(loop, result->assisted));
        if (ticks != NULL) {
            sim_tick_line(ticks, loop, -1, 0.0);
        }
    }
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
    return true;
}
