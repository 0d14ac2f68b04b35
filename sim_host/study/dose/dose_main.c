#include <argp.h>
#include <stdlib.h>
#include <string.h>

#include "firmware/version.h"
#include "sim_host/cli/exit_status.h"
#include "sim_host/cli/option.h"
#include "sim_host/cli/program.h"
#include "sim_host/cli/program_output.h"
#include "sim_host/faults/work.h"
#include "sim_host/study/dose/dose_study.h"
#include "sim_host/study/plot.h"

enum {
    KEY_PERSON = 0x500,
    KEY_DEVICE,
    KEY_R0,
    KEY_LATE,
    KEY_SEEDS,
    KEY_STEPS,
    KEY_PUSH_STEP,
    KEY_JOBS,
    KEY_OUT,
    KEY_CSV,
    KEY_MARKDOWN
};

static const struct argp_option option_list[] = {
    {"person", KEY_PERSON, "FILE", 0, "who walks, by reflexes; up to 8 times", 0},
    {"device", KEY_DEVICE, "FILE", 0, "with what on", 0},
    {"r0", KEY_R0, "M,M,...", 0,
     "precompressions, m, rising (default 0.01,0.02,0.035,0.05); without the device always walks, too",
     0},
    {"late-ms", KEY_LATE, "MS,MS,...", 0,
     "the latches open so late, 0 to 49 (default 0); earlier than the other foot's strike they do not open",
     0},
    {"seeds", KEY_SEEDS, "N", 0, "seeds 1 to N of all noise, the same with and without (default 1)",
     0},
    {"steps", KEY_STEPS, "N", 0, "steps of a walk; the second half is measured (default 40)", 0},
    {"push-step", KEY_PUSH_STEP, "N", 0,
     "the largest force that is survived is known to so many newtons, 1 to 100; 0: it is not asked for (default 10)",
     0},
    {"jobs", KEY_JOBS, "N", 0, "processes (default 1)", 0},
    {"out", KEY_OUT, "DIR", 0, "keep the walks there; those that are there are not walked again",
     0},
    {"csv", KEY_CSV, "FILE", 0, "one line a walk; FILE.json says what it is", 0},
    {"markdown", KEY_MARKDOWN, 0, 0, "tables in place of sentences", 0},
    {"json", 'j', 0, 0, "one JSON object on standard output in place of sentences", 0},
    {0}};

#define WALK_STEP_S 0.04 /* of one processor, a step */
#define PUSHES_S 4.0     /* and all pushes of a walk */

/* Rising numbers between the limits. */
static uint32_t take_list(struct argp_state *state, const char *option, const char *text,
                          double least, double most, double values[DOSE_VALUES_MAX])
{
    uint32_t count = 0;
    for (const char *at = text;;) {
        char *end;
        const double value = strtod(at, &end);
        const bool rises = count == 0 || value > values[count - 1];
        if (end == at || (*end != ',' && *end != '\0') || count == DOSE_VALUES_MAX || !rises ||
            !(value >= least && value <= most)) {
            argp_error(
                state,
                "%s: \"%s\": expected up to %d rising numbers from %g to %g, as in 0.01,0.02",
                option, text, (int)DOSE_VALUES_MAX, least, most);
        }
        values[count++] = value;
        if (*end == '\0') {
            return count;
        }
        at = end + 1;
    }
}

static void take_person(struct argp_state *state, struct dose_study *study, const char *path)
{
    if (study->persons == DOSE_PERSONS_MAX) {
        argp_error(state, "--person: %d persons at most", (int)DOSE_PERSONS_MAX);
    }
    study->person[study->persons++] = path;
}

static error_t take(int key, char *text, struct argp_state *state)
{
    struct dose_study *study = (struct dose_study *)state->input;
    switch (key) {
    case KEY_PERSON:
        take_person(state, study, text);
        return 0;
    case KEY_DEVICE:
        study->device = text;
        return 0;
    case KEY_R0:
        study->r0s = take_list(state, "--r0", text, 1e-4, 0.2, study->r0_m);
        return 0;
    case KEY_LATE:
        study->lates = take_list(state, "--late-ms", text, 0.0, 49.0, study->late_s);
        for (uint32_t i = 0; i < study->lates; i++) {
            study->late_s[i] *= 0.001;
        }
        return 0;
    case KEY_SEEDS:
        study->seeds = (uint32_t)option_whole(state, "--seeds", text, 1, DOSE_SEEDS_MAX);
        return 0;
    case KEY_STEPS:
        study->steps = (uint32_t)option_whole(state, "--steps", text, 4, 10000);
        return 0;
    case KEY_PUSH_STEP:
        study->push_step_N = (double)option_whole(state, "--push-step", text, 0, 100);
        return 0;
    case KEY_JOBS:
        study->jobs = (uint32_t)option_whole(state, "--jobs", text, 1, WORK_JOBS_MAX);
        return 0;
    case KEY_OUT:
        study->out = text;
        return 0;
    case KEY_CSV:
        study->csv_path = text;
        return 0;
    case KEY_MARKDOWN:
        study->markdown = true;
        return 0;
    case 'j':
        study->json = true;
        return 0;
    case ARGP_KEY_ARG:
        option_refuse_argument(state, text);
        return 0;
    case ARGP_KEY_END:
        if (study->persons == 0 || study->device == NULL) {
            argp_error(
                state,
                "name who walks with --person FILE, and with what with --device FILE, such as "
                "sim_host/persons/adult70.ini and sim_host/devices/virtual-adult.ini");
        }
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

/* ---- the walks, by processes ----------------------------------------------------------- */

static bool wants(void *context, uint32_t index)
{
    (void)context;
    (void)index;
    return true;
}

static bool begin(void *context)
{
    (void)context;
    return true;
}

static void make(void *context, uint32_t index, FILE *file)
{
    const struct dose_study *study = (const struct dose_study *)context;
    char message[DOSE_MESSAGE_MAX] = "";
    struct dose_trial trial;
    struct dose_result result;
    dose_study_trial(study, index, &trial);
    if (dose_trial_run(&trial, &result, message) != 0) {
        program_complain("%s", message);
        return;
    }
    fprintf(file, "%u %d %u", index, result.fell, result.steps);
#define WRITE(name, unit, what) fprintf(file, " %.17g", result.name);
    DOSE_MEASURES(WRITE)
#undef WRITE
    fputs(" .\n", file); /* a line that was cut has no such end */
}

static bool take_line(void *context, const char *line, uint32_t *index)
{
    struct dose_study *study = (struct dose_study *)context;
    struct dose_result result = {0};
    char *at;
    const unsigned long number = strtoul(line, &at, 10);
    result.fell = strtoul(at, &at, 10) != 0;
    result.steps = (uint32_t)strtoul(at, &at, 10);
#define READ(name, unit, what) result.name = strtod(at, &at);
    DOSE_MEASURES(READ)
#undef READ
    if (strcmp(at, " .\n") != 0 || number >= dose_study_walks(study)) {
        return false;
    }
    *index = (uint32_t)number;
    study->result[number] = result;
    return true;
}

/* FNV-1a: walks of other files, settings or programs are other walks, and have files of another name. */
static uint32_t mixed(uint32_t hash, const void *bytes, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        hash = (hash ^ ((const unsigned char *)bytes)[i]) * UINT32_C(16777619);
    }
    return hash;
}

static uint32_t mixed_file(uint32_t hash, const char *path)
{
    char block[4096];
    FILE *file = fopen(path, "r");
    for (size_t count; file != NULL && (count = fread(block, 1, sizeof block, file)) > 0;) {
        hash = mixed(hash, block, count);
    }
    if (file != NULL) {
        fclose(file);
    }
    return hash;
}

static uint32_t identity_of(const struct dose_study *study)
{
    const uint32_t build = (uint32_t)version_build_id();
    uint32_t hash = mixed_file(mixed(UINT32_C(2166136261), &build, sizeof build), study->device);
    for (uint32_t i = 0; i < study->persons; i++) {
        hash = mixed_file(hash, study->person[i]);
    }
    hash = mixed(hash, study->r0_m, study->r0s * sizeof study->r0_m[0]);
    hash = mixed(hash, study->late_s, study->lates * sizeof study->late_s[0]);
    hash = mixed(hash, &study->persons, sizeof study->persons);
    hash = mixed(hash, &study->lates, sizeof study->lates);
    hash = mixed(hash, &study->seeds, sizeof study->seeds);
    hash = mixed(hash, &study->steps, sizeof study->steps);
    return mixed(hash, &study->push_step_N, sizeof study->push_step_N);
}

/* A walk that cannot begin is told before processes are begun. */
static int check(const struct dose_study *study)
{
    for (uint32_t person = 0; person < study->persons; person++) {
        for (uint32_t cell = 0; cell <= study->lates * study->r0s; cell++) {
            char message[DOSE_MESSAGE_MAX] = "";
            struct dose_trial trial;
            struct dose_result result;
            dose_study_trial(study, dose_study_number(study, person, 0) + cell, &trial);
            trial.steps = 0;
            trial.push_step_N = 0.0;
            if (dose_trial_run(&trial, &result, message) != 0) {
                return program_complain("%s", message);
            }
        }
    }
    return 0;
}

static int report(struct dose_study *study, struct output_file *csv)
{
    if (csv->stream != NULL) {
        dose_report_csv(csv->stream, study);
    }
    FILE *picture = plot_table("dose");
    if (picture != NULL) {
        dose_report_plot(picture, study);
    }
    (study->json       ? dose_report_json
     : study->markdown ? dose_report_markdown
                       : dose_report_text)(stdout, study);
    return program_commit_table(csv, study->argc, study->argv, NULL, NULL) == 0 ? EXIT_GOOD
                                                                                : EXIT_USAGE;
}

int dose_main(int argc, char **argv)
{
    static const struct argp parser = {
        option_list,
        take,
        0,
        "What a push-off does to a person who walks by reflexes: own work of ankle and hip a metre, activation, speed, "
        "cadence and the largest push survived, over the dose and the delay, in pairs with the same walk without the "
        "device. It tells what this model does, and nothing about people.\v"
        "Exit status: 0 done, 2 wrong usage, or a walk that cannot begin.",
        0,
        0,
        0};
    struct dose_study study = {.r0_m = {0.01, 0.02, 0.035, 0.05},
                               .r0s = 4,
                               .lates = 1,
                               .seeds = 1,
                               .steps = 40,
                               .jobs = 1,
                               .push_step_N = 10.0,
                               .argc = argc,
                               .argv = argv};
    plot_option_parse(&parser, argc, argv, &study);
    const double pushes_s = study.push_step_N > 0.0 ? PUSHES_S : 0.0;
    struct work work = {.runs = dose_study_walks(&study),
                        .jobs = study.jobs,
                        .chunk = 1,
                        .out = study.out,
                        .run_s = WALK_STEP_S * study.steps + pushes_s,
                        .context = &study,
                        .wants = wants,
                        .begin = begin,
                        .make = make,
                        .take = take_line};
    snprintf(work.prefix, sizeof work.prefix, "dose-%08x", (unsigned)identity_of(&study));
    static struct output_file csv;
    if (program_open_output(&csv, study.csv_path) != 0) { /* said before the walks */
        return plot_finish(EXIT_USAGE);
    }
    study.result = (struct dose_result *)calloc(work.runs, sizeof *study.result);
    int status = study.result == NULL || check(&study) != 0 ? EXIT_USAGE : work_do(&work);
    status = status == EXIT_GOOD ? report(&study, &csv) : status;
    output_file_discard(&csv);
    free(study.result);
    return plot_finish(status);
}
