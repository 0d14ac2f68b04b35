#include "sim_host/cli/walk_options.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "sim_host/subjects/law_name.h"

enum {
    KEY_SPEED = 0x400,
    KEY_OPEN_LOOP,
    KEY_R0,
    KEY_START_R0,
    KEY_KP,
    KEY_LAW,
    KEY_SUBJECT,
    KEY_ACTUATOR
};

static const struct argp_option option_list[] = {
    {0, 0, 0, 0, "Who walks, and how:", 1},
    {"speed", KEY_SPEED, "RAD_S", 0,
     "forward apex speed to walk at (default: that of the start gait)", 0},
    {"kp", KEY_KP, "GAIN", 0,
     "gain of eq. (16) in m per rad/s (default: 0.042 scaled to the subject, or the subject's own where that does "
     "not hold its gaits)",
     0},
    {"law", KEY_LAW, "NAME", 0,
     "law of the push-off (default: the subject's)" LAW_NAMES_TEXT "; open-loop takes --open-loop",
     0},
    {"open-loop", KEY_OPEN_LOOP, 0, 0,
     "no law: constant precompression --r0, reached by a slow ramp", 0},
    {"r0", KEY_R0, "M", 0, "precompression of --open-loop, metres", 0},
    {"start-r0", KEY_START_R0, "M", 0, "start from the steady gait of this precompression, metres",
     0},
    {"subject", KEY_SUBJECT, "FILE", 0, "subject file (INI; default: the paper's walker)", 0},
    {"actuator", KEY_ACTUATOR, "FILE", 0,
     "actuators as they are built: sections [plant], [left.plant] and [right.plant] of a device file "
     "(default: idealised ones)",
     0},
    {0}};

static void check_together(struct argp_state *state, const struct walk_options *options)
{
    if (options->open_loop && options->r0_m <= 0.0) {
        argp_error(state, "--open-loop needs --r0 M");
    }
    if (options->r0_m > 0.0 && !options->open_loop) {
        argp_error(state, "--r0 is the constant of --open-loop; with the law use --speed");
    }
    if (options->open_loop && options->speed_rad_s > 0.0) {
        argp_error(state, "--speed and --open-loop exclude each other");
    }
    if (options->open_loop && options->law_given) {
        argp_error(state, "--law and --open-loop exclude each other");
    }
    if (options->open_loop && options->kp >= 0.0) {
        argp_error(state, "--kp and --open-loop exclude each other");
    }
}

/* A constant is no law here: it has options of its own. */
static void take_law(struct walk_options *options, const char *text, struct argp_state *state)
{
    struct law_name laws[LAW_NAMES];
    size_t count = 0;
    for (int i = 0; i < LAW_NAMES; i++) {
        if (law_names[i].law != LAW_OPEN_LOOP) {
            laws[count++] = law_names[i];
        }
    }
    options->law_given = true;
    options->law = laws[option_choice(state, "--law", text, laws, count, sizeof laws[0])].law;
}

static error_t take(int key, char *text, struct argp_state *state)
{
    struct walk_options *options = (struct walk_options *)state->input;
    switch (key) {
    case KEY_SPEED:
        options->speed_rad_s = option_number(state, "--speed", text, 1e-3, 20.0);
        break;
    case KEY_OPEN_LOOP:
        options->open_loop = true;
        break;
    case KEY_R0:
        options->r0_m = option_number(state, "--r0", text, 1e-4, 0.6);
        break;
    case KEY_START_R0:
        options->start_r0_m = option_number(state, "--start-r0", text, 1e-4, 0.6);
        break;
    case KEY_KP:
        options->kp = option_number(state, "--kp", text, 0.0, 1.0);
        break;
    case KEY_LAW:
        take_law(options, text, state);
        break;
    case KEY_SUBJECT:
        options->subject_path = text;
        break;
    case KEY_ACTUATOR:
        options->actuator_path = text;
        break;
    case ARGP_KEY_END:
        check_together(state, options);
        break;
    default:
        return ARGP_ERR_UNKNOWN;
    }
    return 0;
}

const struct argp walk_options_parser = {option_list, take, 0, 0, 0, 0, 0};

void walk_options_init(struct walk_options *options)
{
    *options = (struct walk_options){.kp = -1.0};
}

static void override(struct subject *subject, const char *name, double value)
{
    for (int i = 0; i < CONTROL_PARAM_COUNT; i++) {
        if (strcmp(control_param_descriptors[i].name, name) == 0) {
            subject->control_overridden[i] = true;
            subject->control_override[i] = value;
        }
    }
}

static int check_speed(const struct control_params *params, double speed, char *message)
{
    real low_rad_s, high_rad_s;
    control_params_speeds(params, &low_rad_s, &high_rad_s);
    if ((real)speed >= low_rad_s && (real)speed <= high_rad_s) { /* as the node would be told it */
        return 0;
    }
    snprintf(message, SUBJECT_MESSAGE_MAX,
             "--speed %g is out of range: this law serves this subject from %.4g to %.4g rad/s",
             speed, (double)low_rad_s, (double)high_rad_s);
    return -1;
}

/* Puts the subject's file before a message about its numbers. */
static void name_file(const char *path, char *message)
{
    char reason[SUBJECT_MESSAGE_MAX];
    if (path != NULL) {
        snprintf(reason, sizeof reason, "%s", message);
        snprintf(message, SUBJECT_MESSAGE_MAX, "%.300s: %.400s", path, reason);
    }
}

static int take_actuators(const char *path, struct subject *subject, char *message)
{
    struct actuators actuators;
    if (actuators_read(&actuators, path, message) != 0) {
        return -1;
    }
    if (subject_take_actuators(subject, &actuators, message) != 0) {
        name_file(path, message);
        return -1;
    }
    return 0;
}

int walk_options_resolve(const struct walk_options *options, struct subject *subject,
                         struct control_params *params, double *desired_speed_rad_s, char *message)
{
    subject_default(subject);
    if (options->subject_path != NULL &&
        subject_read(subject, options->subject_path, message) != 0) {
        return -1;
    }
    subject->is_person = options->person;
    if (options->actuator_path != NULL &&
        take_actuators(options->actuator_path, subject, message) != 0) {
        return -1;
    }
    if (options->kp >= 0.0) {
        override(subject, "kp_m_s_rad", options->kp);
    }
    if (options->start_r0_m > 0.0) {
        override(subject, "start_r0_m", options->start_r0_m);
    }
    if (options->law_given) {
        override(subject, "law", (double)options->law);
    }
    if (options->open_loop) {
        override(subject, "law", (double)LAW_OPEN_LOOP);
        override(subject, "open_loop_r0_m", options->r0_m);
    }
    if (subject_control_params(subject, params, message) != 0) {
        name_file(options->actuator_path != NULL ? options->actuator_path : options->subject_path,
                  message);
        return -1;
    }
    if (options->kp >= 0.0 && law_of(params->law)->has_own_gains) {
        snprintf(message, SUBJECT_MESSAGE_MAX,
                 "--kp does nothing with the law %s: its gains are the branch's",
                 law_name_of((enum law_mode)params->law));
        return -1;
    }
    *desired_speed_rad_s = (double)speed_table_speed(&params->table, params->start_r0_m);
    if (options->speed_rad_s > 0.0) {
        *desired_speed_rad_s = options->speed_rad_s;
        return check_speed(params, options->speed_rad_s, message);
    }
    return 0;
}
