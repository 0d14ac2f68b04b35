#include "sim_host/study/person/person_options.h"

#include "sim_host/cli/option.h"

enum { KEY_PERSON = 0x700, KEY_DEVICE, KEY_R0, KEY_STEP };

static const double steps_s[] = {0.0005, 0.00025, 0.000125};
static const char *const step_names[] = {"0.5", "0.25", "0.125"};
enum { STEPS = sizeof steps_s / sizeof steps_s[0], STEP_DEFAULT = 1 };

static const struct argp_option option_list[] = {
    {"person", KEY_PERSON, "FILE", 0, "who walks (INI)", 0},
    {"device", KEY_DEVICE, "FILE", 0, "worn meanwhile (INI); none by default", 0},
    {"r0", KEY_R0, "M", 0, "with --device: the prescribed precompression", 0},
    {"step-ms", KEY_STEP, "MS", 0, "of the muscles, without a device: 0.5, 0.25 or 0.125 (0.25)",
     0},
    {0}};

static void check(const struct person_options *options, struct argp_state *state)
{
    if (options->person == NULL) {
        argp_error(state, "whom? give --person FILE");
    }
    if (options->r0_m > 0.0 && options->device == NULL) {
        argp_error(state, "--r0 is a device's: give --device FILE");
    }
    if (options->step_s > 0.0 && options->device != NULL) {
        argp_error(
            state,
            "--step-ms is of a walk without --device: with one its drives' period is the step");
    }
}

static error_t take(int key, char *text, struct argp_state *state)
{
    struct person_options *options = (struct person_options *)state->input;
    switch (key) {
    case KEY_PERSON:
        options->person = text;
        return 0;
    case KEY_DEVICE:
        options->device = text;
        return 0;
    case KEY_R0:
        options->r0_m = option_number(state, "--r0", text, 1e-4, 0.6);
        return 0;
    case KEY_STEP:
        options->step_s = steps_s[option_choice(state, "--step-ms", text, step_names, STEPS,
                                                sizeof step_names[0])];
        return 0;
    case ARGP_KEY_END:
        check(options, state);
        options->step_s = options->step_s > 0.0 ? options->step_s : steps_s[STEP_DEFAULT];
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

const struct argp person_options_parser = {option_list, take, 0, 0, 0, 0, 0};
