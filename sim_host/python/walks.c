/* A walk through the whole chain, a piece at a time, for Python. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "firmware/version.h"
#include "sim_host/cli/ground_options.h"
#include "sim_host/cli/host_report.h"
#include "sim_host/cli/sensing_options.h"
#include "sim_host/loop/walk_watch.h"
#include "sim_host/loop/walking.h"
#include "sim_host/persons/law_name.h"
#include "sim_host/plant/walking_units.h"
#include "sim_host/python/own_law.h"

enum { STEPS_MOST = 10000000, LAST_FRAMES_TICKS = 3, SPARE_ROWS = 2 };

struct afo_walk {
    struct own_law law;
    struct ground_options ground;
    struct loop_config config;
    struct loop loop;
    struct walk_record record;
    struct walk_watch watch;
    bool pushed;
    bool fell;
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
    if (!check_numbers(s, text) || take_law(s, &options, text) != 0 ||
        check_open_loop(s, &options, text) != 0) {
        return -1;
    }
    if (s->sensors != NULL && !sensor_preset_from_name(s->sensors, &sensing.preset)) {
        snprintf(text, AFO_TEXT, "sensors \"%.80s\" are none of ideal, 17bit, 14bit, 12bit",
                 s->sensors);
        return -1;
    }
    if (sensing_options_configure(&sensing, &options, NULL, &walk->config, text) != 0) {
        return -1;
    }
    walk->ground = (struct ground_options){s->slope_deg, s->terrain_mm, s->push_Ns, s->push_s};
    ground_options_apply(&walk->ground, &walk->config);
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
    if (status == 0 && !walk_record_init(&walk->record, settings->steps + SPARE_ROWS, 0.0)) {
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
    walk_watch_init(&walk->watch, settings->steps, false);
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

static void write_tick(const struct loop *loop, int event, struct afo_tick *row)
{
    struct plant_truth truth;
    struct sea_output motor[SIDE_COUNT];
    plant_truth(&loop->nodes.plant, &truth);
    plant_sea_output(&loop->nodes.plant, SIDE_LEFT, &motor[SIDE_LEFT]);
    plant_sea_output(&loop->nodes.plant, SIDE_RIGHT, &motor[SIDE_RIGHT]);
    *row = (struct afo_tick){
        .tick = truth.tick,
        .time_s = truth.time_s,
        .theta_left_rad = truth.leg_angle_rad[SIDE_LEFT],
        .theta_right_rad = truth.leg_angle_rad[SIDE_RIGHT],
        .rate_left_rad_s = truth.leg_rate_rad_s[SIDE_LEFT],
        .rate_right_rad_s = truth.leg_rate_rad_s[SIDE_RIGHT],
        .ankle_left_m = truth.ankle_m[SIDE_LEFT],
        .ankle_right_m = truth.ankle_m[SIDE_RIGHT],
        .motor_left_m = motor[SIDE_LEFT].position_m,
        .motor_right_m = motor[SIDE_RIGHT].position_m,
        .hip_x_m = truth.hip_m[0],
        .hip_y_m = truth.hip_m[1],
        .stance = (int32_t)truth.stance,
        .phase = (int32_t)truth.phase,
        .event = event,
        .supervisor = (int32_t)loop->rig.task.output.state,
    };
}

static void tick(struct afo_walk *walk, struct afo_tick *rows, uint32_t *taken)
{
    ground_options_tick(&walk->ground, &walk->loop, &walk->pushed);
    loop_tick(&walk->loop);
    const int event = walk_record_take(&walk->record, &walk->loop);
    if (rows != NULL) {
        write_tick(&walk->loop, event, &rows[*taken]);
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
    const double none = (double)NAN;
    for (uint32_t i = 0; i < walk->record.count && i < room; i++) {
        const struct walk_row *row = &walk->record.rows[i];
        const double length_m = row->step_length_m > 0.0 ? row->step_length_m : none;
        rows[i] = (struct afo_step){
            .step = row->number,
            .side = (int32_t)row->side,
            .time_s = row->time_s,
            .apex_speed_rad_s = row->apex_speed_rad_s,
            .measured_speed_rad_s = row->measured ? row->measured_speed_rad_s : none,
            .target_speed_rad_s =
                row->measured ? row->command_rad_s : walk->config.desired_speed_rad_s,
            .r0_m = row->measured ? row->r0_m : none,
            .step_time_s = i > 0 ? row->time_s - walk->record.rows[i - 1].time_s : none,
            .step_length_m = length_m,
            .heel_strike_s = row->heel_strike_s,
            .toe_off_s = row->toe_off_s,
            .walking_speed_m_s = walking_speed_m_s(length_m, walking_step_time_s(&walk->record, i)),
            .push_off_J = row->push_off_J,
            .margin_of_stability_m = row->margin_m,
            .used_fallback = row->measured ? row->used_fallback : -1,
        };
    }
    return walk->record.count;
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
