#include "sim_host/cli/recording_options.h"

#include <stdio.h>
#include <string.h>

#include "sim_host/cli/option.h"

/* A person's other foot lands as early as 0.17 s after the apex, so the fit around
 * it ends sooner than on the paper's walker. */
#define PERSON_APEX_WINDOW_S REAL(0.03)

/* A person walks without the device, too: it joins in after so many steady steps (unless
 * told otherwise), and again after they have stopped. */
#define PERSON_ENGAGE_STEPS REAL(4.0)

/* The largest precompression, over the prescribed one: 1.1 times its energy. */
#define PERSON_R0_MOST_RATIO REAL(1.0488)

/* Of the virtual drives' statusword: the contact at the latch. */
enum { CONTACT_BIT = 8 };

/* Of the seed: the switches' biases. */
enum { FOOT_SWITCH_STREAM = 0xB1A5 };

static const char roles[] =
    "time, thigh_l, thigh_r, shank_l, shank_r, ankle_l, ankle_r, contact_l, contact_r";

static char *column_of(struct recording_format *format, const char *role, size_t length)
{
    const struct {
        const char *role;
        char *column;
    } table[] = {
        {"time", format->time_column},
        {"thigh_l", format->thigh_column[SIDE_LEFT]},
        {"thigh_r", format->thigh_column[SIDE_RIGHT]},
        {"shank_l", format->shank_column[SIDE_LEFT]},
        {"shank_r", format->shank_column[SIDE_RIGHT]},
        {"ankle_l", format->ankle_column[SIDE_LEFT]},
        {"ankle_r", format->ankle_column[SIDE_RIGHT]},
        {"contact_l", format->contact_column[SIDE_LEFT]},
        {"contact_r", format->contact_column[SIDE_RIGHT]},
    };
    for (size_t i = 0; i < sizeof table / sizeof table[0]; i++) {
        if (strlen(table[i].role) == length && strncmp(table[i].role, role, length) == 0) {
            return table[i].column;
        }
    }
    return NULL;
}

static bool take_column(struct recording_format *format, const char *text)
{
    const char *equals = strchr(text, '=');
    if (equals == NULL || strlen(equals + 1) >= RECORDING_NAME_MAX) {
        return false;
    }
    char *column = column_of(format, text, (size_t)(equals - text));
    if (column == NULL) {
        return false;
    }
    memcpy(column, equals + 1, strlen(equals + 1) + 1);
    return true;
}

enum {
    KEY_RECORDING = 0x900,
    KEY_PLANT,
    KEY_WITHOUT_DEVICE,
    KEY_COLUMN,
    KEY_RATE,
    KEY_ANGLES,
    KEY_SWITCHES,
    KEY_SWITCH_FAULT,
    KEY_SWITCH_FAULT_S,
    KEY_LATCH_FAULT,
    KEY_LATCH_FAULT_S,
    KEY_FIT
};

static const struct argp_option option_list[] = {
    {0, 0, 0, 0, "A person:", 2},
    {"plant", KEY_PLANT, "KIND", 0,
     "who wears the device: walker (default), or reflex, a person whose muscles answer to it", 0},
    {"without-device", KEY_WITHOUT_DEVICE, 0, 0,
     "with --plant reflex: the device does all it would do, and the person feels nothing of it: the pair of the "
     "walk with it",
     0},
    {"recording", KEY_RECORDING, "FILE.csv", 0, "recorded walking in the walker's place", 0},
    {"column", KEY_COLUMN, "ROLE=NAME", 0,
     "a column of the recording: time, thigh_l, contact_r, ...; no name: not there", 0},
    {"rate", KEY_RATE, "HZ", 0, "samples a second of a recording without times (default 200)", 0},
    {"angles", KEY_ANGLES, "UNIT", 0, "of the recording's angles: deg (default) or rad", 0},
    {"switches", KEY_SWITCHES, "PRESET", 0,
     "foot switches, simulated from the recorded contact: none, seeded (default: each edge late by "
     "0 to 40 ms), exact, 10ms, 20ms or 40ms",
     0},
    {"switch-fault", KEY_SWITCH_FAULT, "NAME", 0,
     "of both switches: well, stuck-up, stuck-down, missing, chatter or false", 0},
    {"switch-fault-s", KEY_SWITCH_FAULT_S, "S", 0, "it begins so late (default 10)", 0},
    {"latch-fault", KEY_LATCH_FAULT, "NAME", 0,
     "of both latches: well, opens, stays-open or stays-closed", 0},
    {"latch-fault-s", KEY_LATCH_FAULT_S, "S", 0, "it begins so late (default 10)", 0},
    {"fit", KEY_FIT, "FILE.ini", 0,
     "a fitting run: learn the bias of each leg's detection from the switches, and write the person's "
     "file with it",
     0},
    {0}};

static const double FAULT_S = 10.0;
static const double REFLEX_LEAST_KG = 10.0;
static const char *const latch_fault_names[PLANT_LATCH_FAULT_COUNT] = {
    "well", "opens", "stays-open", "stays-closed"};

static void check_together(struct argp_state *state, const struct recording_options *options)
{
    if (options->path != NULL && options->by_reflexes) {
        argp_error(state, "--recording and --plant reflex exclude each other: there is one wearer");
    }
    if (options->without_device && !options->by_reflexes) {
        argp_error(state, "--without-device needs --plant reflex: nobody else feels a device");
    }
    if (options->path == NULL && options->format_given) {
        argp_error(state, "--column, --rate and --angles describe the recording of --recording");
    }
    if (options->fit_path != NULL &&
        (options->path == NULL || options->switches == FOOT_SWITCH_NONE)) {
        argp_error(state, "--fit needs --recording, and foot switches");
    }
    if (!recording_options_person(options) && options->switches_given) {
        argp_error(state, "--switches and the faults of switches and latches are of the person of "
                          "--recording or --plant reflex");
    }
}

static error_t take(int key, char *text, struct argp_state *state)
{
    static const char *const units[] = {"deg", "rad"};
    static const char *const plants[] = {"walker", "reflex"};
    struct recording_options *options = (struct recording_options *)state->input;
    options->format_given =
        options->format_given || key == KEY_COLUMN || key == KEY_RATE || key == KEY_ANGLES;
    options->switches_given =
        options->switches_given || (key >= KEY_SWITCHES && key <= KEY_LATCH_FAULT_S);
    switch (key) {
    case KEY_RECORDING:
        options->path = text;
        return 0;
    case KEY_PLANT:
        options->by_reflexes =
            option_choice(state, "--plant", text, plants, 2, sizeof plants[0]) == 1;
        return 0;
    case KEY_WITHOUT_DEVICE:
        options->without_device = true;
        return 0;
    case KEY_COLUMN:
        if (!take_column(&options->format, text)) {
            argp_error(state, "--column: \"%s\" is not ROLE=NAME with one of the roles %s", text,
                       roles);
        }
        return 0;
    case KEY_RATE:
        options->format.sample_rate_hz = option_number(state, "--rate", text, 20.0, 5000.0);
        return 0;
    case KEY_ANGLES:
        if (option_choice(state, "--angles", text, units, 2, sizeof units[0]) == 1) {
            options->format.angle_unit_rad = 1.0;
        }
        return 0;
    case KEY_SWITCHES:
        options->switches = (enum foot_switch_preset_kind)option_choice(
            state, "--switches", text, foot_switch_preset_names, FOOT_SWITCH_PRESET_COUNT,
            sizeof foot_switch_preset_names[0]);
        return 0;
    case KEY_SWITCH_FAULT:
        options->switch_fault = (enum foot_switch_fault)option_choice(
            state, "--switch-fault", text, foot_switch_fault_names, FOOT_SWITCH_FAULT_COUNT,
            sizeof foot_switch_fault_names[0]);
        return 0;
    case KEY_SWITCH_FAULT_S:
        options->switch_fault_s = option_number(state, "--switch-fault-s", text, 0.0, 1e6);
        return 0;
    case KEY_LATCH_FAULT:
        options->latch_fault = (enum plant_latch_fault)option_choice(
            state, "--latch-fault", text, latch_fault_names, PLANT_LATCH_FAULT_COUNT,
            sizeof latch_fault_names[0]);
        return 0;
    case KEY_LATCH_FAULT_S:
        options->latch_fault_s = option_number(state, "--latch-fault-s", text, 0.0, 1e6);
        return 0;
    case KEY_FIT:
        options->fit_path = text;
        return 0;
    case ARGP_KEY_END:
        check_together(state, options);
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

const struct argp recording_options_parser = {option_list, take, 0, 0, 0, 0, 0};

void recording_options_init(struct recording_options *options)
{
    *options = (struct recording_options){
        .switches = FOOT_SWITCH_SEEDED, .switch_fault_s = FAULT_S, .latch_fault_s = FAULT_S};
    recording_format_default(&options->format);
}

/* With switches the node opens on the window and the contact; without, on the window alone. */
static void apply_switches(const struct recording_options *options, struct loop_config *config)
{
    struct plant_config *plant = &config->plant;
    const bool present = options->switches != FOOT_SWITCH_NONE;
    for (int side = 0; side < SIDE_COUNT; side++) {
        struct foot_switch_params *foot = &plant->foot_switch[side];
        foot_switch_preset(options->switches, plant->seed, FOOT_SWITCH_STREAM + (uint64_t)side,
                           foot);
        foot->fault = options->switch_fault;
        foot->fault_from_s =
            options->switch_fault_s + (double)plant->recording_start_tick * plant->tick_s;
        plant->sea[side].release_on = present ? SEA_RELEASE_CONTACT : SEA_RELEASE_COMMAND;
        if (config->subject.device.description.leg[side].contact_bit == 0) {
            config->subject.device.description.leg[side].contact_bit = present ? CONTACT_BIT : 0;
        }
    }
    plant->latch_fault = options->latch_fault;
    plant->latch_fault_s =
        options->latch_fault_s + (double)plant->recording_start_tick * plant->tick_s;
    config->params.foot_switches = present ? REAL(1.0) : REAL(0.0);
}

int recording_options_apply(const struct recording_options *options, struct loop_config *config,
                            char *message)
{
    struct control_params *params = &config->params;
    if (options->by_reflexes) {
        const double mass_kg = (double)params->torso_mass_kg + 2.0 * (double)params->leg_mass_kg;
        if (mass_kg < REFLEX_LEAST_KG) {
            snprintf(
                message, LOOP_MESSAGE_MAX,
                "--plant reflex: %s weighs %g kg; name a person of %g kg or more with --person, "
                "such as sim_host/persons/adult70.ini, and a device with --device",
                config->subject.person.name, mass_kg, REFLEX_LEAST_KG);
            return -1;
        }
        config->plant.kind = PLANT_REFLEX_PERSON;
        config->plant.unworn = options->without_device;
        reflex_person_default(mass_kg, (double)params->leg_length_m, &config->plant.reflex);
        person_muscles_apply(&config->subject.person.muscles, &config->plant.reflex);
    } else if (strlen(options->path) >= PLANT_PATH_MAX) {
        snprintf(message, LOOP_MESSAGE_MAX, "the path of the recording is too long");
        return -1;
    } else {
        config->plant.kind = PLANT_RECORDED_PERSON;
        snprintf(config->plant.recording_path, PLANT_PATH_MAX, "%s", options->path);
    }
    config->plant.recording_format = options->format;
    params->body = (real)BODY_PERSON;
    params->apex_window_s = PERSON_APEX_WINDOW_S;
    if (params->engage_steps == REAL(0.0)) {
        params->engage_steps = PERSON_ENGAGE_STEPS;
    }
    if (!options->open_loop) {
        params->law = (real)LAW_PERSON;
        /* A person's ceiling follows from what is prescribed. */
        params->r0_max_m = PERSON_R0_MOST_RATIO * params->start_r0_m;
        if (params->r0_ceiling_m > REAL(0.0) && params->r0_max_m > params->r0_ceiling_m) {
            params->r0_max_m = params->r0_ceiling_m;
        }
        params->r0_ceiling_m = params->r0_max_m;
        params->open_loop_r0_m = params->start_r0_m;
    }
    apply_switches(options, config);
    return 0;
}

int recording_options_play(const char *path, bool open_loop, struct loop_config *config,
                           char *message)
{
    struct recording_options options;

    if (path == NULL) {
        return 0;
    }
    recording_options_init(&options);
    options.path = path;
    options.open_loop = open_loop;
    return recording_options_apply(&options, config, message);
}
