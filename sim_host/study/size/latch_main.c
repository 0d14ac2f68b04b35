/* afo study latch: the trials, and the table of what each law bears, with and without the latch's mean delay
 * in the device's description. */
#include <argp.h>
#include <stdio.h>
#include <string.h>

#include "sim_host/cli/exit_status.h"
#include "sim_host/cli/experiment.h"
#include "sim_host/cli/option.h"
#include "sim_host/cli/program.h"
#include "sim_host/study/plot.h"
#include "sim_host/study/pool.h"
#include "sim_host/study/size/latch_study.h"

enum { KEY_SPEED = 0x500, KEY_STEPS, KEY_TRIALS, KEY_LAW, KEY_CSV };
enum { LAWS = 4, TIMES = 7, KINDS = 4, TRIALS_MAX = 20 };

static const enum law_mode laws[LAWS] = {LAW_PROPORTIONAL, LAW_DLQR, LAW_DEADBEAT, LAW_PREDICTIVE};
static const char *const law_names[LAWS] = {"proportional", "dlqr", "deadbeat", "predictive"};
/* Odd ones scatter; those behind the first two are declared. */
static const char *const kinds[KINDS] = {"delay", "jitter", "delay, declared", "jitter, declared"};
static const double times_ms[TIMES] = {0.0, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0};

/* A release takes so long at least: the presets' latency. */
#define BASE_S 1e-4

struct study {
    double speed_rad_s;
    uint32_t steps;
    int trials;
    int only; /* law, or -1 */
    const char *csv_path;
    int argc; /* the command line, for the record */
    char **argv;
    struct latch_result result[LAWS][KINDS][TIMES][TRIALS_MAX];
    bool failed;
};

static const struct argp_option option_list[] = {
    {"speed", KEY_SPEED, "RAD_S", 0, "apex speed (default 0.8)", 0},
    {"steps", KEY_STEPS, "N", 0, "steps of a trial (default 200)", 0},
    {"trials", KEY_TRIALS, "N", 0, "seeds of a jitter (default 3)", 0},
    {"law", KEY_LAW, "NAME", 0, "one law alone", 0},
    {"csv", KEY_CSV, "FILE", 0, "every trial", 0},
    {0}};

static error_t take(int key, char *text, struct argp_state *state)
{
    struct study *study = (struct study *)state->input;
    switch (key) {
    case KEY_SPEED:
        study->speed_rad_s = option_number(state, "--speed", text, 0.1, 1.2);
        return 0;
    case KEY_STEPS:
        study->steps = (uint32_t)option_whole(state, "--steps", text, 10, 100000);
        return 0;
    case KEY_TRIALS:
        study->trials = (int)option_whole(state, "--trials", text, 1, TRIALS_MAX);
        return 0;
    case KEY_LAW:
        study->only = option_choice(state, "--law", text, law_names, LAWS, sizeof law_names[0]);
        return 0;
    case KEY_CSV:
        study->csv_path = text;
        return 0;
    case ARGP_KEY_ARG:
        option_refuse_argument(state, text);
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static bool scatters(int kind)
{
    return kind % 2 == 1;
}

static bool is_declared(int kind)
{
    return kind >= 2;
}

/* A constant delay has nothing to do with the seed but the sensors' noise: one trial. */
static int trials_of(const struct study *study, int kind)
{
    return scatters(kind) ? study->trials : 1;
}

static bool is_asked(const struct study *study, int law, int kind, int time, int trial)
{
    return (study->only < 0 || law == study->only) && trial < trials_of(study, kind) &&
           (kind == 0 || time > 0);
}

static void compute(void *context, int i)
{
    struct study *study = (struct study *)context;
    const int trial = i % study->trials, time = i / study->trials % TIMES;
    const int kind = i / study->trials / TIMES % KINDS, law = i / study->trials / TIMES / KINDS;
    if (!is_asked(study, law, kind, time, trial)) {
        return;
    }
    const double time_s = 1e-3 * times_ms[time], mean_s = scatters(kind) ? 0.5 * time_s : time_s;
    const struct latch_trial asked = {.law = laws[law],
                                      .speed_rad_s = study->speed_rad_s,
                                      .delay_s = BASE_S + (scatters(kind) ? 0.0 : time_s),
                                      .jitter_s = scatters(kind) ? time_s : 0.0,
                                      .declared_s = is_declared(kind) ? BASE_S + mean_s : 0.0,
                                      .steps = study->steps,
                                      .seed = 1 + (uint64_t)trial};
    if (latch_trial_run(&asked, &study->result[law][kind][time][trial]) != 0) {
        study->failed = true;
    }
}

/* The trial that walked least. */
static const struct latch_result *worst(const struct study *study, int law, int kind, int time)
{
    const struct latch_result *result = study->result[law][kind][time];
    int least = 0;
    for (int i = 1; i < trials_of(study, kind); i++) {
        least = result[i].walked < result[least].walked ? i : least;
    }
    return &result[least];
}

static const struct latch_result *on_time(const struct study *study, int law)
{
    return &study->result[law][0][0][0];
}

static void cell(const struct study *study, int law, int kind, int time)
{
    char text[24];
    const struct latch_result *result = worst(study, law, kind, time);
    if (!is_asked(study, law, kind, time, 0)) {
        return;
    }
    if (result->walked < study->steps) {
        (void)snprintf(text, sizeof text, "falls after %u", (unsigned)result->walked);
    } else {
        const double change =
            100.0 * (result->speed_rad_s / on_time(study, law)->speed_rad_s - 1.0);
        (void)snprintf(text, sizeof text, "walks, %+.2f %%", change);
    }
    printf("  %-18s", text);
}

/* A walk that has lost more of its speed is no longer the one that was asked for, %. */
#define LOST_PERCENT 10.0

static bool walks_on(const struct study *study, int law, int kind, int time)
{
    const struct latch_result *result = worst(study, law, kind, time);
    const double change = 100.0 * (result->speed_rad_s / on_time(study, law)->speed_rad_s - 1.0);
    return result->walked == study->steps && change > -LOST_PERCENT && change < LOST_PERCENT;
}

/* The largest time up to which every trial walked on. */
static double bears_ms(const struct study *study, int law, int kind)
{
    double most = 0.0;
    for (int time = kind == 0 ? 0 : 1; time < TIMES; time++) {
        if (!walks_on(study, law, kind, time)) {
            break;
        }
        most = times_ms[time];
    }
    return most;
}

static void print(const struct study *study)
{
    printf(
        "\n%u steps at %g rad/s; a jitter's worst of %d trials; change of the speed against no delay\n\n",
        (unsigned)study->steps, study->speed_rad_s, study->trials);
    printf("  %-16s   ms", "");
    for (int law = 0; law < LAWS; law++) {
        if (study->only < 0 || law == study->only) {
            printf("  %-18s", law_names[law]);
        }
    }
    printf("\n");
    for (int kind = 0; kind < KINDS; kind++) {
        for (int time = kind == 0 ? 0 : 1; time < TIMES; time++) {
            printf("  %-16s %4g", kinds[kind], times_ms[time]);
            for (int law = 0; law < LAWS; law++) {
                cell(study, law, kind, time);
            }
            printf("\n");
        }
    }
    printf("\n");
    for (int law = 0; law < LAWS; law++) {
        if (study->only < 0 || law == study->only) {
            printf("  %-14s bears %g ms of delay and %g ms of jitter; %g ms and %g ms where "
                   "latch_delay_s tells the mean\n",
                   law_names[law], bears_ms(study, law, 0), bears_ms(study, law, 1),
                   bears_ms(study, law, 2), bears_ms(study, law, 3));
        }
    }
}

static void write_rows(const struct study *study, FILE *file)
{
    fputs("law,kind,declared,ms,trial,steps_asked,steps_walked,speed_rad_s\n", file);
    for (int law = 0; law < LAWS; law++) {
        for (int kind = 0; kind < KINDS; kind++) {
            for (int time = 0; time < TIMES; time++) {
                for (int trial = 0; trial < study->trials; trial++) {
                    const struct latch_result *result = &study->result[law][kind][time][trial];
                    if (is_asked(study, law, kind, time, trial)) {
                        fprintf(file, "%s,%s,%d,%g,%d,%u,%u,%.6f\n", law_names[law],
                                kinds[kind % 2], is_declared(kind), times_ms[time], trial + 1,
                                (unsigned)study->steps, (unsigned)result->walked,
                                result->speed_rad_s);
                    }
                }
            }
        }
    }
}

static int write_csv(const struct study *study)
{
    char message[OUTPUT_PATH_MAX + 256];
    struct output_file table = {0};
    if (output_file_open(&table, study->csv_path, message, sizeof message) != 0) {
        return program_complain("%s", message);
    }
    write_rows(study, table.stream);
    return experiment_commit_table(&table, study->argc, study->argv, message, sizeof message) != 0
               ? program_complain("%s", message)
               : 0;
}

int latch_main(int argc, char **argv)
{
    static const struct argp parser = {
        option_list,
        take,
        0,
        "What each law bears of a latch that opens late, by a constant time or by one that scatters, and what "
        "where the device's key latch_delay_s tells the mean of that time. The paper's walker walks in closed "
        "loop, through bus, sensors and actuator.\v"
        "Exit status: 0 done, 2 wrong usage, or the laws do not serve this speed.",
        0,
        0,
        0};
    static struct study study;
    study = (struct study){.speed_rad_s = 0.8, .steps = 200, .trials = 3, .only = -1};
    study.argc = argc;
    study.argv = argv;
    plot_option_parse(&parser, argc, argv, &study);
    const int law_count = study.only < 0 ? LAWS : 1;
    const int trials = 2 * (TIMES - 1) * (1 + study.trials) + 1;
    program_announce(8e-3 * study.steps * law_count * trials / pool_processors(),
                     "%d trials of %u steps", law_count * trials, (unsigned)study.steps);
    const struct pool_jobs jobs = {.count = LAWS * KINDS * TIMES * study.trials,
                                   .threads = pool_processors(),
                                   .context = &study,
                                   .compute = compute};
    if (pool_run(&jobs) != 1 || study.failed) {
        program_complain("no memory, or a law does not serve %g rad/s", study.speed_rad_s);
        return EXIT_USAGE;
    }
    print(&study);
    FILE *picture = plot_table("latch");
    if (picture != NULL) {
        write_rows(&study, picture);
    }
    return study.csv_path == NULL || write_csv(&study) == 0 ? EXIT_GOOD : EXIT_USAGE;
}
