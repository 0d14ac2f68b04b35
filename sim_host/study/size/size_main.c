#include "sim_host/study/size/size_main.h"

#include <argp.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "sim_host/cli/exit_status.h"
#include "sim_host/cli/option.h"
#include "sim_host/cli/program.h"
#include "sim_host/cli/walk_options.h"
#include "sim_host/study/size/size_report.h"

enum { KEY_PERSON = 0x600, KEY_CADENCE, KEY_R0, KEY_LEG, KEY_CHIRP, KEY_SEED };
enum { ROWS_MAX = 64 };

struct options {
    struct walk_options walk;
    double from, to, step; /* steps a minute */
    enum side leg;
    unsigned long long seed;
    bool chirp, json;
};

static const struct argp_option option_list[] = {
    {"person", KEY_PERSON, "FILE", 0, "who wears it: mass and prescription (a person file)", 0},
    {"r0", KEY_R0, "M", 0, "precompression of the push-off (default: the person's)", 0},
    {"cadence", KEY_CADENCE, "A..B", 0, "steps a minute, in tens (default 80..130)", 0},
    {"leg", KEY_LEG, "SIDE", 0, "left (default) or right", 0},
    {"chirp", KEY_CHIRP, 0, 0, "also how the drive follows, and what the ankle feels", 0},
    {"seed", KEY_SEED, "N", 0, "of the latch's jitter (default 1)", 0},
    {"json", 'j', 0, 0, "one JSON object on standard output instead of the tables", 0},
    {0}};

/* strtod would take the first dot of "80..130" for a decimal point. */
static bool read_number(const char *text, size_t length, double *number)
{
    char copy[32], *end = NULL;
    if (length == 0 || length >= sizeof copy) {
        return false;
    }
    memcpy(copy, text, length);
    copy[length] = '\0';
    *number = strtod(copy, &end);
    return *end == '\0';
}

static void take_cadence(struct argp_state *state, struct options *options, const char *text)
{
    const char *dots = strstr(text, "..");
    const size_t first = dots != NULL ? (size_t)(dots - text) : strlen(text);
    const char *second = dots != NULL ? dots + 2 : text;
    if (!read_number(text, first, &options->from) ||
        !read_number(second, strlen(second), &options->to) || !(options->from >= 20.0) ||
        !(options->to <= 200.0) || !(options->from <= options->to)) {
        argp_error(state, "--cadence: \"%s\" is not A or A..B with 20 <= A <= B <= 200 steps/min",
                   text);
    }
}

static error_t take(int key, char *text, struct argp_state *state)
{
    static const char *const sides[] = {"left", "right"};
    struct options *options = (struct options *)state->input;
    switch (key) {
    case KEY_PERSON:
        options->walk.person_path = text;
        return 0;
    case KEY_R0:
        options->walk.start_r0_m = option_number(state, "--r0", text, 0.0001, 0.6);
        return 0;
    case KEY_CADENCE:
        take_cadence(state, options, text);
        return 0;
    case KEY_LEG:
        options->leg = (enum side)option_choice(state, "--leg", text, sides, 2, sizeof sides[0]);
        return 0;
    case KEY_CHIRP:
        options->chirp = true;
        return 0;
    case KEY_SEED:
        options->seed = option_whole(state, "--seed", text, 0, UINT64_MAX);
        return 0;
    case 'j':
        options->json = true;
        return 0;
    case ARGP_KEY_ARG:
        if (options->walk.device_path != NULL) {
            argp_error(state, "one device at a time, found also \"%s\"", text);
        }
        options->walk.device_path = text;
        return 0;
    case ARGP_KEY_END:
        if (options->walk.device_path == NULL) {
            argp_error(state, "which device? afo size sim_host/devices/exo50.ini --person FILE");
        }
        if (options->walk.person_path == NULL) {
            argp_error(state, "who wears it? --person FILE");
        }
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

int size_main(int argc, char **argv)
{
    static const struct argp parser = {
        option_list,
        take,
        "DEVICE",
        "What a device's actuator has to bear in walking, over cadence: current, voltage, heat after an "
        "hour, mass; and what limits it.\v"
        "The ankle moves along a textbook's mean curve. Exit status: 0 every push-off is given within all "
        "limits, 1 not at every cadence, 2 wrong usage, or a device that cannot be built.",
        0,
        0,
        0};
    struct options options = {.from = 80.0, .to = 130.0, .step = 10.0, .seed = 1};
    struct size_setup setup;
    struct subject subject;
    struct size_row rows[ROWS_MAX];
    char message[SUBJECT_MESSAGE_MAX];
    double speed_rad_s;
    walk_options_init(&options.walk);
    option_parse(&parser, argc, argv, &options);
    options.walk.person = true;
    if (walk_options_resolve(&options.walk, &subject, &setup.params, &speed_rad_s, message) != 0) {
        program_complain("%s", message);
        return EXIT_USAGE;
    }
    if (!subject.actuators.as_built) {
        program_complain("%s: there is no section [plant], [left.plant] or [right.plant]: what the "
                         "actuator is made of is not told",
                         options.walk.device_path);
        return EXIT_USAGE;
    }
    setup.config = subject.actuators.config[options.leg];
    setup.seed = options.seed;
    int count = 0;
    bool all_hold = true;
    while (count < ROWS_MAX && options.from + count * options.step <= options.to + 1e-9) {
        size_walk(&setup, options.from + count * options.step, &rows[count]);
        all_hold = all_hold && size_holds(&setup, &rows[count]);
        count++;
    }
    const struct size_result result = {
        options.walk.device_path, subject.person.name, &setup, rows, count, options.chirp};
    if (options.json) {
        size_report_json(stdout, &result);
    } else {
        size_report_text(stdout, &result);
    }
    return program_output_done() == 0 ? (all_hold ? EXIT_GOOD : EXIT_BAD) : EXIT_USAGE;
}
