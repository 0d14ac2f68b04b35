#include "sim_host/cli/walk_options.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "sim_host/persons/law_name.h"

enum {
    KEY_SPEED = 0x400,
    KEY_OPEN_LOOP,
    KEY_R0,
    KEY_START_R0,
    KEY_KP,
    KEY_LAW,
    KEY_PERSON,
    KEY_DEVICE,
    KEY_SUBJECT
};

static const struct argp_option option_list[] = {
    {0, 0, 0, 0, "Who walks, and how:", 1},
    {"speed", KEY_SPEED, "SPEED", 0,
     "forward apex speed to walk at, rad/s, or walking speed with its unit: 0.57m/s (default: the prescribed one, "
     "else that of the start gait)",
     0},
    {"kp", KEY_KP, "GAIN", 0,
     "gain of eq. (16) in m per rad/s (default: 0.042 scaled to the walker, or the walker's own where that does "
     "not hold its gaits)",
     0},
    {"law", KEY_LAW, "NAME", 0,
     "law of the push-off (default: the prescribed one)" LAW_NAMES_TEXT
     " (open-loop: by --open-loop --r0 M instead)",
     0},
    {"open-loop", KEY_OPEN_LOOP, 0, 0,
     "no law: constant precompression --r0, reached by a slow ramp", 0},
    {"r0", KEY_R0, "M", 0, "precompression of --open-loop, metres", 0},
    {"start-r0", KEY_START_R0, "M", 0, "start from the steady gait of this precompression, metres",
     0},
    {"person", KEY_PERSON, "FILE", 0, "person file (INI; default: the paper's walker)", 0},
    {"device", KEY_DEVICE, "FILE", 0, "device file (INI; default: the virtual device)", 0},
    {"subject", KEY_SUBJECT, "FILE", OPTION_HIDDEN, 0, 0},
    {0}};

bool walk_options_speed_given(const struct walk_options *options)
{
    return options->speed.apex_rad_s > 0.0 || options->speed.walking_m_s > 0.0;
}

static void check_together(struct argp_state *state, const struct walk_options *options)
{
    if (options->open_loop && options->r0_m <= 0.0) {
        argp_error(state, "--open-loop needs --r0 M");
    }
    if (options->r0_m > 0.0 && !options->open_loop) {
        argp_error(state, "--r0 is the constant of --open-loop; with the law use --speed");
    }
    if (options->open_loop && walk_options_speed_given(options)) {
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
    if (strcmp(text, law_name_of(LAW_OPEN_LOOP)) == 0) {
        argp_error(state, "--law: open-loop is asked for by --open-loop --r0 M");
    }
    options->law_given = true;
    options->law = laws[option_choice(state, "--law", text, laws, count, sizeof laws[0])].law;
}

static error_t take(int key, char *text, struct argp_state *state)
{
    struct walk_options *options = (struct walk_options *)state->input;
    switch (key) {
    case KEY_SPEED:
        speed_option_take(&options->speed, text, state);
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
        option_refuse_subject(state, text);
        break;
    case KEY_PERSON:
        options->person_path = text;
        break;
    case KEY_DEVICE:
        options->device_path = text;
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

static int check_speed(const char *what, const struct control_params *params, double speed,
                       char *message)
{
    real low_rad_s, high_rad_s;
    control_params_speeds(params, &low_rad_s, &high_rad_s);
    if ((real)speed >= low_rad_s && (real)speed <= high_rad_s) { /* as the node would be told it */
        return 0;
    }
    snprintf(message, SUBJECT_MESSAGE_MAX,
             "%s %g is out of range: this law serves this walker from %.4g to %.4g rad/s", what,
             speed, (double)low_rad_s, (double)high_rad_s);
    return -1;
}

/* Puts the files before a message about their numbers. */
static void name_files(const struct walk_options *options, char *message)
{
    char reason[SUBJECT_MESSAGE_MAX];
    const char *person = options->person_path, *device = options->device_path;
    if (person != NULL || device != NULL) {
        snprintf(reason, sizeof reason, "%s", message);
        snprintf(message, SUBJECT_MESSAGE_MAX, "%.180s%s%.180s: %.370s",
                 person != NULL ? person : "", person != NULL && device != NULL ? " with " : "",
                 device != NULL ? device : "", reason);
    }
}

int walk_options_resolve(const struct walk_options *options, struct subject *subject,
                         struct control_params *params, double *desired_speed_rad_s, char *message)
{
    struct person *person = &subject->person;
    if (subject_read(subject, options->person_path, options->device_path, message) != 0) {
        return -1;
    }
    subject->is_person = options->person;
    if (options->kp >= 0.0) {
        person_override(person, "kp_m_s_rad", options->kp);
    }
    if (options->start_r0_m > 0.0) {
        person_override(person, "start_r0_m", options->start_r0_m);
    }
    if (options->law_given) {
        person_override(person, "law", (double)options->law);
    }
    if (options->open_loop) {
        person_override(person, "law", (double)LAW_OPEN_LOOP);
        person_override(person, "open_loop_r0_m", options->r0_m);
    }
    if (subject_control_params(subject, params, message) != 0) {
        name_files(options, message);
        return -1;
    }
    if (options->kp >= 0.0 && law_of(params->law)->has_own_gains) {
        snprintf(message, SUBJECT_MESSAGE_MAX,
                 "--kp does nothing with the law %s: its gains are the branch's",
                 law_name_of((enum law_mode)params->law));
        return -1;
    }
    *desired_speed_rad_s = (double)speed_table_speed(&params->table, params->start_r0_m);
    if (options->speed.walking_m_s > 0.0) {
        return speed_option_apex(subject, params, options->speed.walking_m_s, desired_speed_rad_s,
                                 message);
    }
    if (options->speed.apex_rad_s > 0.0) {
        *desired_speed_rad_s = options->speed.apex_rad_s;
        return check_speed("--speed", params, options->speed.apex_rad_s, message);
    }
    if (person->speed_rad_s > 0.0 && !options->open_loop) {
        *desired_speed_rad_s = person->speed_rad_s;
        if (check_speed("the prescribed speed_rad_s", params, person->speed_rad_s, message) != 0) {
            name_files(options, message);
            return -1;
        }
    }
    return 0;
}
