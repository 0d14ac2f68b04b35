/* `afo study observe`: how well the controller knows the gait, and what its errors cost the law. */
#include <argp.h>
#include <math.h>
#include <stdio.h>

#include "sim_host/cli/experiment.h"
#include "sim_host/cli/output_file.h"
#include "sim_host/cli/walk_options.h"
#include "sim_host/study/noisy_map.h"
#include "sim_host/study/observer/commands.h"
#include "sim_host/study/observer/mismatch.h"
#include "sim_host/study/observer/observe_case.h"
#include "sim_host/study/observer/observed_walk.h"
#include "sim_host/study/plot.h"

enum { SETTLE_STEPS = 100, MAP_STRIDES = 2000 };

struct options {
    int steps;
    bool full, mismatch;
    const char *csv_path;
};

static const struct argp_option table[] = {
    {"steps", 'n', "N", 0, "steps a walk that count (100)", 0},
    {"full", 'f', 0, 0, "every combination, not the middle ones alone", 0},
    {"mismatch", 'm', 0, 0, "walkers and grounds that differ from the controller's parameters", 0},
    {"csv", 'c', "FILE", 0, "the table's numbers, one line a walk (scripts/plot-observe)", 0},
    {0}};

static error_t parse(int key, char *text, struct argp_state *state)
{
    struct options *options = (struct options *)state->input;
    switch (key) {
    case 'n':
        options->steps = (int)option_whole(state, "--steps", text, 10, 100000);
        return 0;
    case 'f':
        options->full = true;
        return 0;
    case 'm':
        options->mismatch = true;
        return 0;
    case 'c':
        options->csv_path = text;
        return 0;
    case ARGP_KEY_ARG:
        argp_error(state, "unexpected argument \"%s\"", text);
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

/* Also two fields of the CSV line, spread and strides to the fall, one of them empty.
 * "spread %" of the law on the ideal map when told speeds with this error, or after how
 * many strides it falls. */
static void print_cost(double speed_rad_s, const struct speed_errors *errors, FILE *csv)
{
    struct noisy_walk walk;
    const double scatter = sqrt(fmax(0.0, errors->rms * errors->rms - errors->mean * errors->mean));
    if (errors->count == 0 ||
        noisy_map_walk(speed_rad_s, 0.042, scatter, MAP_STRIDES, 1, &walk) != 0) {
        printf(" %11s", "-");
        fputs(",,", csv);
    } else if (walk.fell) {
        printf("  falls%5d", walk.walked);
        fprintf(csv, ",,%d", walk.walked);
    } else {
        printf(" %10.3f%%", 100.0 * walk.spread);
        fprintf(csv, ",%.6g,", walk.spread);
    }
}

static void print_header(void)
{
    printf(
        "Closed loop, eq. (16), the paper's walker over bus, nodes and SEA; the controller's apex\n"
        "speed against the plant's. \"plain\": the difference of the two samples around the\n"
        "crossing; \"butterw.\": of the same through a second-order 10 Hz low-pass. Delays: mean\n"
        "time from the event until the controller reports it. Law: RMS spread of the apex speed\n"
        "on the ideal return map with this scatter of the measured speed, over %d steps, or\n"
        "the steps until it falls.\n\n",
        MAP_STRIDES);
    printf("                               observer          plain  butterw.   swing at apex"
           "      delay, ms             law: spread of the speed\n"
           "  sensor noise late speed   rms %%  worst %%    rms %%     rms %%    mrad   mrad/s"
           "  apex strike l-off   loop %%    observer       plain    butterw.\n");
}

static int print_case(const struct observe_case *want, const char *name, int steps, FILE *csv)
{
    struct loop_config config;
    struct observed_walk w;
    char message[LOOP_MESSAGE_MAX];
    /* The walk reaches its speed by a ramp of 0.005 rad/s a step from 0.407. */
    const int settle = SETTLE_STEPS + (int)(fabs(want->speed_rad_s - 0.407) / 0.005);
    if (observe_case_configure(want, &config, message) != 0 ||
        observed_walk_run(&config, settle + steps, settle, &w, message) != 0) {
        fprintf(stderr, "afo study observe: %s\n", message);
        return 1;
    }
    printf("  %-6s %5.2f %4.1f  %4.2f ", name, want->noise_counts, 1e3 * want->latency_s,
           want->speed_rad_s);
    fprintf(csv, "%s,%g,%g,%g,%d", name, want->noise_counts, want->latency_s, want->speed_rad_s,
            w.fell ? w.steps : 0);
    if (w.observer.count == 0) {
        printf(" fell after %d steps: %s\n", w.steps, w.fault);
        fputs(",,,,,,,,,,,,,,,,\n", csv);
        return 0;
    }
    fprintf(csv, ",%.6g,%.6g,%.6g,%.6g,%.6g,%.6g,%.6g,%.6g,%.6g,%.6g", w.observer.rms,
            w.observer.worst, w.plain.rms, w.filtered.rms, w.swing_angle_rms_rad,
            w.swing_rate_rms_rad_s, w.event[GAIT_APEX].delay_s, w.event[GAIT_HEEL_STRIKE].delay_s,
            w.event[GAIT_LIFT_OFF].delay_s, w.speed_spread);
    printf(" %7.4f %8.3f %8.2f %9.3f  %6.3f  %7.3f  %5.1f %6.1f %5.1f  ", 100.0 * w.observer.rms,
           100.0 * w.observer.worst, 100.0 * w.plain.rms, 100.0 * w.filtered.rms,
           1e3 * w.swing_angle_rms_rad, 1e3 * w.swing_rate_rms_rad_s,
           1e3 * w.event[GAIT_APEX].delay_s, 1e3 * w.event[GAIT_HEEL_STRIKE].delay_s,
           1e3 * w.event[GAIT_LIFT_OFF].delay_s);
    if (w.fell) {
        printf("fell %3d", w.steps);
    } else {
        printf("%6.3f%% ", 100.0 * w.speed_spread);
    }
    print_cost(want->speed_rad_s, &w.observer, csv);
    print_cost(want->speed_rad_s, &w.plain, csv);
    print_cost(want->speed_rad_s, &w.filtered, csv);
    printf("\n");
    fputs("\n", csv);
    fflush(stdout);
    return 0;
}

/* Every combination that is asked for. csv: takes the same numbers. */
static int print_table(const struct options *options, FILE *csv)
{
    static const struct {
        enum sensor_preset_kind kind;
        const char *name;
    } sensors[] = {{SENSORS_17BIT, "17 bit"}, {SENSORS_14BIT, "14 bit"}, {SENSORS_12BIT, "12 bit"}};
    static const double noises[] = {0.25, 1.0, 2.0}, latencies[] = {0.0, 0.002, 0.005},
                        speeds[] = {0.45, 0.8, 1.0};
    print_header();
    fputs(
        "sensor,noise_counts,latency_s,speed_rad_s,fell_after,observer_rms,observer_worst,plain_rms,"
        "butterworth_rms,swing_angle_rad,swing_rate_rad_s,apex_delay_s,strike_delay_s,"
        "lift_off_delay_s,loop_spread,observer_spread,observer_falls,plain_spread,plain_falls,"
        "butterworth_spread,butterworth_falls\n",
        csv);
    for (int i = 0; i < 81; i++) {
        const int s = i / 27, n = i / 9 % 3, l = i / 3 % 3, v = i % 3;
        const int off_middle = (n != 1) + (l != 1) + (v != 1);
        const struct observe_case want = {speeds[v], sensors[s].kind, noises[n], latencies[l],
                                          1,         LAW_PROPORTIONAL};
        if ((options->full || off_middle <= 1) &&
            print_case(&want, sensors[s].name, options->steps, csv) != 0) {
            return 1;
        }
    }
    return 0;
}

int command_observe(int argc, char **argv)
{
    static const struct argp parser = {
        table,
        parse,
        0,
        "Walks in closed loop and compares what the controller knew of the gait with the truth, "
        "over resolution, noise, latency and speed.",
        0,
        0,
        0};
    struct options options = {.steps = 100, .csv_path = "/dev/null"};
    struct output_file csv = {0};
    char message[OUTPUT_PATH_MAX + 256];
    plot_option_parse(&parser, argc, argv, &options);
    if (options.mismatch) {
        return mismatch_run(options.steps, SETTLE_STEPS);
    }
    if (output_file_open(&csv, options.csv_path, message, sizeof message) != 0) {
        fprintf(stderr, "afo study observe: %s\n", message);
        return 1;
    }
    FILE *picture = plot_table("observe");
    const int status = print_table(&options, picture != NULL ? picture : csv.stream);
    plot_copy_table(csv.stream);
    if (status != 0 || experiment_commit_table(&csv, argc, argv, message, sizeof message) != 0) {
        output_file_discard(&csv);
        fprintf(stderr, "afo study observe: no CSV file was written\n");
        return 1;
    }
    return 0;
}
