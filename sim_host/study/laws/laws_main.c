#include "sim_host/study/laws/laws_main.h"

#include <argp.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "sim_host/cli/option.h"
#include "sim_host/cli/program.h"
#include "sim_host/study/laws/laws.h"
#include "sim_host/study/plot.h"
#include "sim_host/study/pool.h"
#include "sim_host/text/nearest.h"

enum {
    KEY_LAW = 0x500,
    KEY_CHAIN,
    KEY_SENSORS,
    KEY_SAMPLES,
    KEY_THREADS,
    KEY_SEED,
    KEY_OUT,
    KEY_TERRAIN_SPEED,
    KEY_PERSON,
    KEY_DEVICE,
    KEY_SUBJECT
};

static const struct {
    const char *name;
    laws_study *run;
    bool in_all;    /* quick enough for "all" */
    bool has_chain; /* knows --chain; "push" is never without */
    const char *summary;
} studies[] = {
    {"jumps", laws_jumps, true, true,
     "steps to settle after every jump of the command, 0.2 to 1.0 rad/s"},
    {"limits", laws_limits, false, false,
     "the share of the box of apex states that any law can walk on from"},
    {"basin", laws_basin, true, false,
     "share of a box of apex states from which the gait is reached"},
    {"ground", laws_ground, false, true, "uneven ground: mean steps to failure"},
    {"ground-limit", laws_ground_limit, false, false, "uneven ground: how far any law can get"},
    {"sensitivity", laws_sensitivity, true, false, "gait sensitivity norm to a step of the ground"},
    {"slope", laws_slope, true, true, "slopes of -4 to 4 degrees"},
    {"mismatch", laws_mismatch, true, true, "body and spring 10 % off what the law believes"},
    {"push", laws_push, false, true, "largest impulse on the torso survived, at eight phases"},
    {"timing", laws_timing, false, false, "the push-off before, at and after heel strike"},
    {"energy", laws_energy, true, true, "spring energy per metre, steady and with noisy sensing"},
};
#define STUDIES (sizeof studies / sizeof studies[0])

static const struct argp_option option_list[] = {
    {"law", KEY_LAW, "NAME", 0, "only this one of proportional, ramp, dlqr, deadbeat, predictive",
     0},
    {"chain", KEY_CHAIN, 0, 0, "through bus, sensors, observer and SEA, not on the map", 0},
    {"sensors", KEY_SENSORS, "PRESET", 0, "with --chain: ideal, 17bit or 14bit (14bit)", 0},
    {"samples", KEY_SAMPLES, "N", 0, "as many samples (each study has its default)", 0},
    {"threads", KEY_THREADS, "N", 0, "use so many threads (all processors)", 0},
    {"terrain-speed", KEY_TERRAIN_SPEED, "RAD_S", 0,
     "what the predictive law may want on uneven ground; 0: nothing above the command (0.8)", 0},
    {"seed", KEY_SEED, "N", 0, "of all random numbers (1)", 0},
    {"out", KEY_OUT, "DIRECTORY", 0, "write laws-STUDY.csv there, too", 0},
    {"person", KEY_PERSON, "FILE", 0, "person file (INI; default: the paper's walker)", 0},
    {"device", KEY_DEVICE, "FILE", 0, "device file (INI; default: the virtual device)", 0},
    {"subject", KEY_SUBJECT, "FILE", OPTION_HIDDEN, 0, 0},
    {0}};

struct input {
    struct laws_options options;
    const char *study;
    double terrain_speed_rad_s; /* below 0: not said */
};

static void set_only_case(struct laws_options *options, const char *name, struct argp_state *state)
{
    bool found = false;
    for (int i = 0; i < LAW_CASES; i++) {
        options->law_case[i] = strcmp(name, law_case_names[i]) == 0;
        found = found || options->law_case[i];
    }
    if (!found) {
        argp_error(state, "--law: \"%s\" is none of proportional, ramp, dlqr, deadbeat, predictive",
                   name);
    }
}

static void set_sensors(struct laws_options *options, const char *text, struct argp_state *state)
{
    if (!sensor_preset_from_name(text, &options->sensors)) {
        argp_error(state, "--sensors: \"%s\" is none of ideal, 17bit, 14bit", text);
    }
}

static error_t parse_option(int key, char *text, struct argp_state *state)
{
    struct input *input = (struct input *)state->input;
    struct laws_options *options = &input->options;
    char message[SUBJECT_MESSAGE_MAX];
    switch (key) {
    case KEY_LAW:
        set_only_case(options, text, state);
        return 0;
    case KEY_CHAIN:
        options->chain = true;
        return 0;
    case KEY_SENSORS:
        set_sensors(options, text, state);
        return 0;
    case KEY_SAMPLES:
        options->samples = (int)option_whole(state, "--samples", text, 1, 100000000);
        return 0;
    case KEY_THREADS:
        options->threads = (int)option_whole(state, "--threads", text, 1, 256);
        return 0;
    case KEY_TERRAIN_SPEED:
        input->terrain_speed_rad_s = option_number(state, "--terrain-speed", text, 0.0, 20.0);
        return 0;
    case KEY_SEED:
        options->seed = option_whole(state, "--seed", text, 0, UINT64_MAX);
        return 0;
    case KEY_OUT:
        options->out_directory = text;
        return 0;
    case KEY_SUBJECT:
        option_refuse_subject(state, text);
        return 0;
    case KEY_PERSON:
        if (person_read(&options->subject.person, text, message) != 0) {
            argp_failure(state, 2, 0, "%s", message);
        }
        return 0;
    case KEY_DEVICE:
        if (device_file_read(&options->subject.device, text, message) != 0) {
            argp_failure(state, 2, 0, "%s", message);
        }
        return 0;
    case ARGP_KEY_ARG:
        if (input->study != NULL) {
            argp_error(state, "one study at a time, or all");
        }
        input->study = text;
        return 0;
    case ARGP_KEY_NO_ARGS:
        argp_error(state,
                   "which study? "
                   "jumps, limits, basin, ground, ground-limit, sensitivity, slope, mismatch, "
                   "push, energy, timing, or all for the quick ones");
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

int laws_main(int argc, char **argv)
{
    static const char doc[] = /* argp wraps at column 79, and what it wraps begins at column 0 */
        "Compares the laws that choose the push-off. STUDY is one of:\v"
        "  jumps        steps to settle after every jump of the command, 0.2 to 1 rad/s\n"
        "  limits       the share of the box that any law can walk on from, two bounds\n"
        "  basin        share of a box of apex states from which the gait is reached\n"
        "  ground       uneven ground: mean steps to failure\n"
        "  ground-limit uneven ground: how far any law can get\n"
        "  sensitivity  gait sensitivity norm to a step of the ground\n"
        "  slope        slopes of -4 to 4 degrees\n"
        "  mismatch     body and spring 10 % off what the law believes\n"
        "  push         largest impulse survived, at eight phases (always the chain)\n"
        "  energy       spring energy per metre, steady and with noisy sensing\n"
        "  timing       the push-off before, at and after heel strike\n"
        "  all          the quick ones, one after the other";
    const struct argp parser = {option_list, parse_option, "STUDY", doc, NULL, NULL, NULL};
    struct input input = {
        .options = {.sensors = SENSORS_14BIT, .threads = pool_processors(), .seed = 1},
        .terrain_speed_rad_s = -1.0};
    for (int i = 0; i < LAW_CASES; i++) {
        input.options.law_case[i] = true;
    }
    input.options.argc = argc;
    input.options.argv = argv;
    subject_default(&input.options.subject);
    plot_option_parse(&parser, argc, argv, &input);
    char message[SUBJECT_MESSAGE_MAX];
    if (law_setup_init(&input.options.setup, &input.options.subject, LAW_PREDICTIVE, message) !=
        0) {
        fprintf(stderr, "afo study laws: %s\n", message);
        return 2;
    }
    if (input.terrain_speed_rad_s >= 0.0) {
        input.options.setup.params.terrain_speed_rad_s = (real)input.terrain_speed_rad_s;
    }
    if (input.options.out_directory != NULL &&
        access(input.options.out_directory, W_OK | X_OK) != 0) {
        fprintf(stderr, "afo study laws: cannot write into %s: %s\n", input.options.out_directory,
                strerror(errno));
        return 2;
    }

    const bool all = strcmp(input.study, "all") == 0;
    if (all && plot_is_asked()) {
        program_complain("--plot draws one study: name one of them, not all");
        return 2;
    }
    bool found = false;
    int status = 0;
    if (input.terrain_speed_rad_s >= 0.0 && !input.options.law_case[LAW_CASE_PREDICTIVE]) {
        fprintf(stderr,
                "afo study laws: --terrain-speed does nothing without the predictive law\n");
        return 2;
    }
    for (size_t i = 0; i < STUDIES && status == 0; i++) {
        if (strcmp(input.study, studies[i].name) == 0 && input.options.chain &&
            !studies[i].has_chain) {
            fprintf(stderr, "afo study laws: --chain does nothing: %s is a study on the map\n",
                    input.study);
            return 2;
        }
        if ((all && studies[i].in_all) || strcmp(input.study, studies[i].name) == 0) {
            found = true;
            printf("%s: %s\n", studies[i].name, studies[i].summary);
            fflush(stdout);
            laws_progress_begin();
            status = studies[i].run(&input.options) == 0 ? 0 : 1;
            laws_progress_end();
            printf("\n");
        }
    }
    if (!found) {
        const char *best = nearest_name(input.study, studies, STUDIES, sizeof studies[0]);
        program_complain("no study \"%s\"%s%s; see --help", input.study,
                         best != NULL ? "; nearest: " : "", best != NULL ? best : "");
        return 2;
    }
    return status;
}
