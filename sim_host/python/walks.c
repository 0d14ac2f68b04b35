/* A walk through the whole chain, a piece at a time, for Python. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "firmware/version.h"
#include "sim_host/cli/ground_options.h"
#include "sim_host/cli/host_report.h"
#include "sim_host/cli/recording_options.h"
#include "sim_host/cli/sensing_options.h"
#include "sim_host/loop/walk_watch.h"
#include "sim_host/loop/walking.h"
#include "sim_host/persons/law_name.h"
#include "sim_host/plant/walking_units.h"
#include "sim_host/python/own_law.h"

enum { STEPS_MOST = 10000000, RECORDED_STEPS_MOST = 100000, LAST_FRAMES_TICKS = 3, SPARE_ROWS = 2 };

struct afo_walk {
    struct own_law law;
    struct ground_options ground;
    struct loop_config config;
    struct loop loop;
    struct walk_record record;
    struct walk_watch watch;
    uint32_t push_ticks;
    bool fell;
    bool is_person;
};

const char *afo_version(void)
{
    return version_text();
}

/* ---- opening ------------------------------------------------------------------------- */

static int is_within(double value, double low, double high, const char *name, const char *unit,
                     char *text)
{
    if (value >= low && value <= high) {
        return 1;
    }
    snprintf(text, AFO_TEXT, "%s = %g %s is out of range, allowed is %g to %g %s", name, value,
             unit, low, high, unit);
    return 0;
}

static int check_numbers(const struct afo_walk_settings *s, char *text)
{
    return (s->speed_rad_s == 0.0 ||
            is_within(s->speed_rad_s, 1e-3, 20.0, "speed", "rad/s", text)) &&
           (s->walking_m_s == 0.0 || is_within(s->walking_m_s, 1e-3, 20.0, "speed", "m/s", text)) &&
           (s->r0_m == 0.0 || is_within(s->r0_m, 1e-4, 0.6, "r0", "m", text)) &&
           (s->start_r0_m == 0.0 || is_within(s->start_r0_m, 1e-4, 0.6, "start_r0", "m", text)) &&
           (s->kp < 0.0 || is_within(s->kp, 0.0, 1.0, "kp", "m per rad/s", text)) &&
           is_within(s->steps, 1, STEPS_MOST, "steps", "", text) &&
           is_within(s->slope_deg, -20.0, 20.0, "slope_deg", "deg", text) &&
           is_within(s->terrain_mm, 0.0, 100.0, "terrain_mm", "mm", text) &&
           is_within(s->push_Ns, -1e4, 1e4, "push", "N s", text) &&
           is_within(s->push_s, 0.0, 1e6, "time of the push", "s", text);
}

static int take_law(const struct afo_walk_settings *s, struct walk_options *options, char *text)
{
    if (s->own_law != NULL) {
        options->law_given = true;
        options->law = LAW_PROPORTIONAL; /* until the parameters are made: it has eq. (16)'s */
        return 0;
    }
    if (s->law == NULL) {
        return 0;
    }
    if (law_from_name(s->law, &options->law) != 0) {
        law_name_refuse(s->law, text, AFO_TEXT);
        return -1;
    }
    options->open_loop = options->law == LAW_OPEN_LOOP;
    options->law_given = !options->open_loop;
    return 0;
}

static int check_open_loop(const struct afo_walk_settings *s, const struct walk_options *options,
                           char *text)
{
    if (options->open_loop != (s->r0_m > 0.0)) {
        snprintf(text, AFO_TEXT,
                 options->open_loop
                     ? "the law open-loop needs r0, its constant precompression in m"
                     : "r0 is the constant of the law open-loop; with another law say speed");
        return -1;
    }
    if (options->open_loop && (s->speed_rad_s > 0.0 || s->walking_m_s > 0.0 || s->kp >= 0.0)) {
        snprintf(text, AFO_TEXT,
                 "the law open-loop has neither speed nor kp: it keeps r0 constant");
        return -1;
    }
    return 0;
}

/* What is the walker's alone, and what a person's. */
static int check_person(const struct afo_walk_settings *s, const struct walk_options *options,
                        char *text)
{
    const char *wrong = NULL;
    if (s->recording != NULL && s->by_reflexes) {
        wrong = "recording and plant = reflex are two persons: name one of them";
    } else if (!options->person && s->switches != NULL) {
        wrong = "switches are under the feet of the person of recording or plant = reflex";
    } else if (options->person && (s->speed_rad_s > 0.0 || s->walking_m_s > 0.0)) {
        wrong =
            "speed is the walker's: the person of recording or plant = reflex chooses their own";
    } else if (s->recording != NULL &&
               (s->slope_deg != 0.0 || s->terrain_mm > 0.0 || s->push_Ns != 0.0)) {
        wrong = "slope_deg, terrain_mm and push act on a body that answers, and a recorded person "
                "walks as they did: use plant = reflex or the walker";
    } else if (options->person && s->own_law == NULL && options->law_given &&
               options->law != LAW_PERSON) {
        wrong = "the law of a person is \"person\", \"open-loop\" or a function; the others know a "
                "walker's gaits";
    }
    if (wrong != NULL) {
        snprintf(text, AFO_TEXT, "%s", wrong);
    }
    return wrong == NULL ? 0 : -1;
}

/* The person of a recording, or of reflexes, in the walker's place. */
static int put_person(const struct afo_walk_settings *s, const struct walk_options *walk,
                      struct loop_config *config, char *text)
{
    struct recording_options options;
    recording_options_init(&options);
    options.path = s->recording;
    options.by_reflexes = s->by_reflexes != 0;
    options.open_loop = walk->open_loop;
    for (int i = 0; s->switches != NULL && i < FOOT_SWITCH_PRESET_COUNT; i++) {
        if (strcmp(s->switches, foot_switch_preset_names[i]) == 0) {
            options.switches = (enum foot_switch_preset_kind)i;
            options.switches_given = true;
        }
    }
    if (s->switches != NULL && !options.switches_given) {
        snprintf(text, AFO_TEXT,
                 "switches \"%.80s\" are none of none, seeded, exact, 10ms, 20ms, 40ms",
                 s->switches);
        return -1;
    }
    return recording_options_apply(&options, config, text);
}

static int configure(const struct afo_walk_settings *s, struct afo_walk *walk, char *text)
{
    struct sensing_options sensing;
    struct walk_options options;
    sensing_options_init(&sensing);
    walk_options_init(&options);
    sensing.seed = s->seed;
    options.person_path = s->person;
    options.device_path = s->device;
    options.speed = (struct speed_option){s->speed_rad_s, s->walking_m_s};
    options.r0_m = s->r0_m;
    options.start_r0_m = s->start_r0_m;
    options.kp = s->kp;
    options.person = s->recording != NULL || s->by_reflexes != 0;
    if (!check_numbers(s, text) || take_law(s, &options, text) != 0 ||
        check_open_loop(s, &options, text) != 0 || check_person(s, &options, text) != 0) {
        return -1;
    }
    if (s->sensors != NULL && !sensor_preset_from_name(s->sensors, &sensing.preset)) {
        snprintf(text, AFO_TEXT, "sensors \"%.80s\" are none of ideal, 17bit, 14bit, 12bit",
                 s->sensors);
        return -1;
    }
    walk->is_person = options.person;
    if (sensing_options_configure(&sensing, &options, NULL, &walk->config, text) != 0) {
        return -1;
    }
    walk->ground = (struct ground_options){s->slope_deg, s->terrain_mm, s->push_Ns, s->push_s, 0.0};
    ground_options_apply(&walk->ground, &walk->config);
    if (options.person && put_person(s, &options, &walk->config, text) != 0) {
        return -1;
    }
    if (s->own_law != NULL) {
        walk->law = (struct own_law){s->own_law, s->context, 0};
        walk->config.params.law = (real)OWN_LAW_NUMBER;
    }
    return 0;
}

struct afo_walk *afo_walk_open(const struct afo_walk_settings *settings, char *text)
{
    char message[LOOP_MESSAGE_MAX] = "";
    struct afo_walk *walk = calloc(1, sizeof *walk);
    if (walk == NULL) {
        snprintf(text, AFO_TEXT, "out of memory");
        return NULL;
    }
    int status = configure(settings, walk, message);
    const bool is_recorded = settings->recording != NULL;
    const uint32_t rows = is_recorded && settings->steps > RECORDED_STEPS_MOST
                              ? RECORDED_STEPS_MOST
                              : settings->steps + SPARE_ROWS;
    const double origin_s =
        (double)walk->config.plant.recording_start_tick * walk->config.plant.tick_s;
    if (status == 0 && !walk_record_init(&walk->record, rows, walk->is_person ? origin_s : 0.0)) {
        snprintf(message, sizeof message, "out of memory: ask for fewer steps than %u",
                 settings->steps);
        status = -1;
    }
    if (status == 0) {
        own_law_use(&walk->law);
        status = loop_init(&walk->loop, &walk->config, NULL, message);
        own_law_use(NULL);
        if (status != 0) {
            walk_record_free(&walk->record);
        }
    }
    if (status != 0) {
        snprintf(text, AFO_TEXT, "%s", message);
        free(walk);
        return NULL;
    }
    if (is_recorded) {
        walk->record.gait.origin_s -= walk->loop.nodes.plant.recording.start_s;
    }
    walk_watch_init(&walk->watch, settings->steps, is_recorded);
    return walk;
}

void afo_walk_close(struct afo_walk *walk)
{
    if (walk != NULL) {
        walk_record_free(&walk->record);
        loop_free(&walk->loop);
        free(walk);
    }
}

/* ---- walking ------------------------------------------------------------------------- */

static void write_tick(const struct afo_walk *walk, int event, struct afo_tick *row)
{
    const double none = (double)NAN;
    const struct loop *loop = &walk->loop;
    struct plant_truth truth;
    struct sea_output motor[SIDE_COUNT];
    plant_truth(&loop->nodes.plant, &truth);
    plant_sea_output(&loop->nodes.plant, SIDE_LEFT, &motor[SIDE_LEFT]);
    plant_sea_output(&loop->nodes.plant, SIDE_RIGHT, &motor[SIDE_RIGHT]);
    const bool is_there = truth.has_place;
    const bool stands = !truth.is_person || truth.phase != WALK_HELD;
    *row = (struct afo_tick){
        .tick = truth.tick,
        .time_s = truth.time_s - walk->record.gait.origin_s,
        .theta_left_rad = truth.leg_angle_rad[SIDE_LEFT],
        .theta_right_rad = truth.leg_angle_rad[SIDE_RIGHT],
        .rate_left_rad_s = truth.leg_rate_rad_s[SIDE_LEFT],
        .rate_right_rad_s = truth.leg_rate_rad_s[SIDE_RIGHT],
        .ankle_left_m = truth.ankle_m[SIDE_LEFT],
        .ankle_right_m = truth.ankle_m[SIDE_RIGHT],
        .motor_left_m = motor[SIDE_LEFT].position_m,
        .motor_right_m = motor[SIDE_RIGHT].position_m,
        .hip_x_m = is_there ? truth.hip_m[0] : none,
        .hip_y_m = is_there ? truth.hip_m[1] : none,
        .toe_left_x_m = is_there ? truth.toe_m[SIDE_LEFT][0] : none,
        .toe_left_y_m = is_there ? truth.toe_m[SIDE_LEFT][1] : none,
        .toe_right_x_m = is_there ? truth.toe_m[SIDE_RIGHT][0] : none,
        .toe_right_y_m = is_there ? truth.toe_m[SIDE_RIGHT][1] : none,
        .ground_left_x_N = is_there ? truth.ground_force_N[SIDE_LEFT][0] : none,
        .ground_left_y_N = is_there ? truth.ground_force_N[SIDE_LEFT][1] : none,
        .ground_right_x_N = is_there ? truth.ground_force_N[SIDE_RIGHT][0] : none,
        .ground_right_y_N = is_there ? truth.ground_force_N[SIDE_RIGHT][1] : none,
        .stance = stands ? (int32_t)truth.stance : -1,
        .phase = stands ? (int32_t)truth.phase : -1,
        .event = event,
        .supervisor = (int32_t)loop->rig.task.output.state,
    };
}

static void tick(struct afo_walk *walk, struct afo_tick *rows, uint32_t *taken)
{
    ground_options_tick(&walk->ground, &walk->loop, &walk->push_ticks);
    loop_tick(&walk->loop);
    const int event = walk_record_take(&walk->record, &walk->loop);
    if (rows != NULL) {
        write_tick(walk, event, &rows[*taken]);
    }
    (*taken)++;
}

/* The last step's record may still wait for its turn on the bus; these ticks are in no row. */
static int finish(struct afo_walk *walk)
{
    for (int i = 0; i < LAST_FRAMES_TICKS; i++) {
        loop_tick(&walk->loop);
        (void)walk_record_take(&walk->record, &walk->loop);
    }
    return AFO_WALK_DONE;
}

static void name_controller_fault(const struct afo_walk *walk, char *text)
{
    const enum supervisor_fault fault = walk->loop.rig.task.output.fault;
    const size_t used = strlen(text);
    if (fault != SUPERVISOR_FAULT_NONE) {
        snprintf(text + used, AFO_TEXT - used, "; controller: %s", supervisor_fault_name(fault));
    }
}

static int judge(struct afo_walk *walk, char *text)
{
    const enum walk_end end = walk_watch_tick(&walk->watch, &walk->record, &walk->loop);
    if (walk->law.failed) {
        snprintf(text, AFO_TEXT, "the law gave no finite precompression at step %u",
                 walk->loop.rig.task.controller.last_step.number);
        return AFO_WALK_ENDED;
    }
    if (end == WALK_GOES_ON) {
        return AFO_WALK_GOES_ON;
    }
    if (end == WALK_FELL) {
        walk->fell = true;
        snprintf(text, AFO_TEXT, "%s", walk_fault_name(plant_fault(&walk->loop.nodes.plant)));
    } else if (end == WALK_STALLED) {
        snprintf(text, AFO_TEXT, "no %s step within %d s",
                 walk->watch.seen == 0 ? "first" : "further", walk_watch_limit_s(&walk->watch));
    } else {
        return finish(walk);
    }
    name_controller_fault(walk, text);
    return AFO_WALK_ENDED;
}

int afo_walk_advance(struct afo_walk *walk, uint32_t ticks, struct afo_tick *rows, uint32_t *taken,
                     char *text)
{
    int state = AFO_WALK_GOES_ON;
    own_law_use(walk->law.call != NULL ? &walk->law : NULL);
    *taken = 0;
    while (state == AFO_WALK_GOES_ON && *taken < ticks) {
        tick(walk, rows, taken);
        state = judge(walk, text);
    }
    own_law_use(NULL);
    return state;
}

/* ---- what was walked ------------------------------------------------------------------ */

int afo_walk_fell(const struct afo_walk *walk)
{
    return walk->fell;
}

double afo_walk_speed(const struct afo_walk *walk)
{
    return walk->config.desired_speed_rad_s;
}

uint32_t afo_walk_steps(const struct afo_walk *walk, struct afo_step *rows, uint32_t room)
{
    const double none = (double)NAN, origin_s = walk->record.gait.origin_s;
    for (uint32_t i = 0; i < walk->record.count && i < room; i++) {
        const struct walk_row *row = &walk->record.rows[i];
        const double length_m = row->step_length_m > 0.0 ? row->step_length_m : none;
        rows[i] = (struct afo_step){
            .step = row->number,
            .side = (int32_t)row->side,
            .time_s = row->time_s - origin_s,
            .apex_speed_rad_s = row->apex_speed_rad_s,
            .measured_speed_rad_s = row->measured ? row->measured_speed_rad_s : none,
            .target_speed_rad_s =
                row->measured ? row->command_rad_s : walk->config.desired_speed_rad_s,
            .r0_m = row->measured ? row->r0_m : none,
            .step_time_s = i > 0 ? row->time_s - walk->record.rows[i - 1].time_s : none,
            .step_length_m = length_m,
            .heel_strike_s = row->heel_strike_s - origin_s,
            .toe_off_s = row->toe_off_s - origin_s,
            .walking_speed_m_s = walking_speed_m_s(length_m, walking_step_time_s(&walk->record, i)),
            .push_off_J = row->push_off_J,
            .margin_of_stability_m = row->margin_m,
            .used_fallback = row->measured ? row->used_fallback : -1,
        };
    }
    return walk->record.count;
}

/* Appends the moments of both sides to rows, as far as there is room; returns how many there are. */
static uint32_t list_events(const struct gait_moments moments[SIDE_COUNT], int32_t kind,
                            struct afo_event *rows, uint32_t room, uint32_t count)
{
    for (int side = 0; side < SIDE_COUNT; side++) {
        for (size_t i = 0; i < moments[side].count; i++, count++) {
            if (count < room) {
                rows[count] = (struct afo_event){side, kind, moments[side].at[i].event_s};
            }
        }
    }
    return count;
}

uint32_t afo_walk_events(const struct afo_walk *walk, struct afo_event *rows, uint32_t room)
{
    const struct gait_record *gait = &walk->record.gait;
    const uint32_t strikes = list_events(gait->true_strike, WALK_EVENT_HEEL_STRIKE, rows, room, 0);
    return list_events(gait->true_toe_off, WALK_EVENT_TOE_OFF, rows, room, strikes);
}

uint32_t afo_walk_found(const struct afo_walk *walk, struct afo_event *rows, uint32_t room)
{
    const struct gait_record *gait = &walk->record.gait;
    struct gait_moments strike[SIDE_COUNT], toe_off[SIDE_COUNT];
    for (int side = 0; side < SIDE_COUNT; side++) {
        strike[side] = gait->seen[side][GAIT_HEEL_STRIKE];
        toe_off[side] = gait->seen[side][GAIT_LIFT_OFF];
    }
    const uint32_t strikes = list_events(strike, WALK_EVENT_HEEL_STRIKE, rows, room, 0);
    return list_events(toe_off, WALK_EVENT_TOE_OFF, rows, room, strikes);
}

const char *afo_event_name(int event)
{
    static const char *const names[] = {"apex",   "heel_strike", "release", "lift_off", "fault",
                                        "let_go", "take_hold",   "toe_off", "reclosed"};
    return event >= 0 && event < (int)(sizeof names / sizeof names[0]) ? names[event] : "";
}

const char *afo_supervisor_name(int state)
{
    return host_report_state_name((enum supervisor_state)state);
}
