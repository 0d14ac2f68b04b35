#include "sim_host/faults/people_internal.h"

#include <dirent.h>
#include <stdlib.h>
#include <string.h>

#include "sim_host/cli/recording_options.h"
#include "sim_host/log/candump_log.h"

/* Scenes are cut to this; its end is a sudden stop. */
static const double SCENE_S = 20.0, REFLEX_S = 40.0;
/* A walk under way: so many pushes, or this share of the scene. */
enum { SAVED_PUSHES = 10, BEFORE_FALL_TICKS = 2500 };
static const double SAVED_SHARE = 0.55;
static const double BEFORE_STOP_S = 0.8;
/* Recordings whose contacts are not true to the millisecond, and those that are no walking. */
static const char *const coarse[] = {"circuit"};
static const char *const running[] = {"run_"};

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

static struct people_campaign *create(const char *person, const char *const *devices)
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
    return campaign;
}

struct people_campaign *people_campaign_create(const char *person, const char *const *devices,
                                               const char *data)
{
    struct people_campaign *campaign = create(person, devices);
    if (campaign != NULL && read_data(campaign, data) != 0) {
        people_campaign_destroy(campaign);
        return NULL;
    }
    return campaign;
}

struct people_campaign *people_campaign_create_reflex(const char *person,
                                                      const char *const *devices)
{
    struct people_campaign *campaign = create(person, devices);
    if (campaign != NULL) {
        campaign->by_reflexes = true;
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
    return campaign->by_reflexes ? PEOPLE_REFLEX_SCENES : campaign->sources;
}

void people_campaign_name(const struct people_campaign *campaign,
                          const struct people_scene_plan *plan, char *name, size_t size)
{
    if (plan->source == PEOPLE_REFLEX) {
        snprintf(name, size, "by reflexes, %.2f of the prescribed r0", plan->dose);
    } else if (plan->source == PEOPLE_MADE) {
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
    if (campaign->by_reflexes) {
        *copy = (struct copy_truth){.walks = true, .stands_s = COPY_NEVER};
        return true;
    }
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
    recording.path = campaign->by_reflexes ? NULL : "";
    recording.by_reflexes = campaign->by_reflexes;
    params.start_r0_m *= campaign->by_reflexes ? (real)plan->dose : REAL(1.0);
    recording.switches = plan->switches;
    if (loop_configure(&campaign->config, subject, &params, speed_rad_s, plan->sensors, plan->seed,
                       message) != 0 ||
        recording_options_apply(&recording, &campaign->config, message) != 0) {
        return false;
    }
    campaign->config.plant.recording = campaign->by_reflexes ? NULL : &campaign->walk;
    return true;
}

static void know_truth(struct people_campaign *campaign, const struct copy_truth *copy)
{
    const struct people_scene_plan *plan = &campaign->plan;
    const struct source *source = plan->source < 0 ? NULL : &campaign->source[plan->source];
    const double spring_N_per_m = subject_spring_N_per_m(&campaign->subject[plan->device]);
    const double r0_m = (double)campaign->config.params.start_r0_m;
    campaign->truth =
        (struct person_truth){.walks = copy->walks && (source == NULL || source->walks),
                              .exact = source == NULL || source->exact,
                              .stands_s = copy->stands_s,
                              .sample_s = campaign->by_reflexes ? campaign->config.plant.tick_s
                                                                : campaign->walk.samples[1].time_s,
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

bool people_scene_power_on(struct people_campaign *campaign, char *message)
{
    struct loop *loop = &campaign->loop;
    if (loop_init(loop, &campaign->config, NULL, message) != 0) {
        return false;
    }
    sim_bus_set_tap(&loop->bus, tap, campaign);
    return injector_prepare(loop);
}

bool people_scene_enter(struct people_campaign *campaign, const struct people_scene_plan *plan)
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
    campaign->scene_is_walked = campaign->alone_is_walked = false;
    campaign->scene_is_good = make_walk(campaign, &copy) && configure(campaign, message);
    if (message[0] != '\0') {
        fprintf(stderr, "afo faults: %s\n", message);
    }
    if (campaign->scene_is_good) {
        know_truth(campaign, &copy);
    }
    return campaign->scene_is_good;
}

double people_scene_lasts_s(const struct people_campaign *campaign)
{
    const struct recording *walk = &campaign->walk;
    return campaign->by_reflexes ? REFLEX_S : walk->samples[walk->count - 1].time_s;
}

uint32_t people_scene_tick_at(const struct people_campaign *campaign, double time_s)
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

/* Walks to this tick, or until there were so many pushes, or the person lies. */
static void walk_to(struct loop *loop, uint32_t last, unsigned pushes)
{
    struct injector injector;
    injector_begin(&injector, loop, NULL, 0);
    for (unsigned count = 0; loop->tick < last && count < pushes &&
                             plant_fault(&loop->nodes.plant) == WALK_FAULT_NONE;) {
        injector_tick(&injector);
        count += count_releases(&loop->nodes.plant);
    }
}

static bool walk_from_power_on(struct people_campaign *campaign, uint32_t last, unsigned pushes)
{
    char message[LOOP_MESSAGE_MAX] = "";
    campaign->log = NULL;
    if (!people_scene_power_on(campaign, message)) {
        fprintf(stderr, "afo faults: %s\n", message);
        return false;
    }
    walk_to(&campaign->loop, last, pushes);
    return true;
}

/* Walks until the walk is under way, and saves that. Who fell before that is saved a while before. */
bool people_scene_walk(struct people_campaign *campaign)
{
    struct loop *loop = &campaign->loop;
    const double stop_s = campaign->changes_s - BEFORE_STOP_S;
    const bool stops = campaign->changes_s < COPY_NEVER && stop_s > 0.0;
    const uint32_t last = people_scene_tick_at(
        campaign, stops ? stop_s : SAVED_SHARE * people_scene_lasts_s(campaign));
    if (campaign->scene_is_walked) {
        memcpy(loop, &campaign->saved, sizeof *loop);
        return true;
    }
    if (!walk_from_power_on(campaign, last, stops ? UINT32_MAX : SAVED_PUSHES)) {
        return false;
    }
    if (plant_fault(&loop->nodes.plant) != WALK_FAULT_NONE &&
        !walk_from_power_on(
            campaign, loop->tick > BEFORE_FALL_TICKS ? (uint32_t)loop->tick - BEFORE_FALL_TICKS : 0,
            UINT32_MAX)) {
        return false;
    }
    memcpy(&campaign->saved, loop, sizeof *loop);
    campaign->scene_is_walked = true;
    return true;
}

bool people_scene_walk_alone(struct people_campaign *campaign)
{
    struct loop *loop = &campaign->loop;
    if (!campaign->alone_is_walked) {
        campaign->config.plant.unworn = true;
        const bool walked =
            walk_from_power_on(campaign, (uint32_t)campaign->saved.tick, UINT32_MAX);
        campaign->config.plant.unworn = false;
        if (!walked) {
            return false;
        }
        memcpy(&campaign->alone, loop, sizeof *loop);
        campaign->alone_is_walked = true;
    }
    memcpy(loop, &campaign->alone, sizeof *loop);
    return true;
}
