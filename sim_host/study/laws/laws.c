#include "sim_host/study/laws/laws.h"

#include <string.h>

#include "sim_host/cli/experiment.h"
#include "sim_host/cli/progress.h"
#include "sim_host/study/plot.h"

const char *const law_case_names[LAW_CASES] = {"proportional", "ramp", "dlqr", "deadbeat",
                                               "predictive"};
static const enum law_mode law_of_case[LAW_CASES] = {LAW_PROPORTIONAL, LAW_PROPORTIONAL, LAW_DLQR,
                                                     LAW_DEADBEAT, LAW_PREDICTIVE};

struct law_setup law_case_setup(const struct laws_options *options, enum law_case law_case)
{
    struct law_setup setup = options->setup;
    setup.params.law = (real)law_of_case[law_case];
    if (law_case == LAW_CASE_RAMP) {
        setup.params.speed_ramp_rad_s = (real)(0.005 * laws_speed_unit(options)); /* as flown */
    }
    return setup;
}

const double laws_box_low[3] = {-1.45, -0.5, 0.2}, laws_box_high[3] = {-0.05, 0.2, 5.2};

void laws_draw_apex(const struct laws_options *options, struct rng *rng, double apex[3])
{
    const double unit = laws_speed_unit(options);
    for (int k = 0; k < 3; k++) {
        apex[k] = laws_box_low[k] + (laws_box_high[k] - laws_box_low[k]) * rng_uniform(rng);
        apex[k] *= k == 1 ? 1.0 : unit;
    }
}

double laws_speed_unit(const struct laws_options *options)
{
    return __builtin_sqrt(options->subject.person.gravity_m_s2 / 9.80665 /
                          options->subject.person.leg_length_m);
}

/* Of the running study. Nobody knows how many parts it will have: a walk may end early. */
static struct progress progress;
static uint64_t parts_done;

void laws_progress_begin(void)
{
    parts_done = 0;
    progress_begin(&progress, "parts done", 0, false);
}

void laws_progress_end(void)
{
    progress_end(&progress);
}

int laws_count_part(void *context, int i)
{
    (void)context;
    (void)i;
    progress_tell(&progress, ++parts_done);
    return 1;
}

/* The table of --plot. The file is filled from it in the end. NULL: no picture is asked for. */
static FILE *begin_table(const char *study, const char *header)
{
    static char name[64];
    (void)snprintf(name, sizeof name, "laws %s", study);
    FILE *table = plot_table(name);
    if (table != NULL) {
        (void)fprintf(table, "%s\n", header);
    }
    return table;
}

FILE *laws_csv(const struct laws_options *options, const char *study, const char *header,
               struct output_file *file, bool *failed)
{
    char path[OUTPUT_PATH_MAX], message[OUTPUT_PATH_MAX + 128];
    *failed = false;
    file->stream = NULL;
    FILE *const table = begin_table(study, header);
    if (options->out_directory == NULL) {
        return table;
    }
    (void)snprintf(path, sizeof path, "%s/laws-%s%s.csv", options->out_directory, study,
                   options->chain ? "-chain" : "");
    if (output_file_open(file, path, message, sizeof message) != 0) {
        fprintf(stderr, "afo study laws: %s\n", message);
        *failed = true;
        return NULL;
    }
    if (table != NULL) {
        return table;
    }
    (void)fprintf(file->stream, "%s\n", header); /* errors are found when it is committed */
    return file->stream;
}

int laws_csv_close(const struct laws_options *options, struct output_file *file, bool failed)
{
    char message[OUTPUT_PATH_MAX + 128];
    if (failed) {
        output_file_discard(file);
        return -1;
    }
    if (file->stream != NULL) {
        plot_copy_table(file->stream);
    }
    if (file->stream != NULL &&
        experiment_commit_table(file, options->argc, options->argv, message, sizeof message) != 0) {
        fprintf(stderr, "afo study laws: %s\n", message);
        return -1;
    }
    return 0;
}

struct viability_range laws_viability_range(const struct laws_options *options, int fineness,
                                            int pushes)
{
    const struct control_params *params = &options->setup.params;
    return (struct viability_range){.legs_low_rad = 0.03,
                                    .legs_high_rad = 2.4,
                                    .rate_low = 0.0,
                                    .rate_high = 0.6,
                                    .r0_low_m = (double)params->r0_min_m,
                                    .r0_high_m = (double)params->r0_max_m,
                                    .legs = 100 * fineness,
                                    .rates = 60 * fineness,
                                    .pushes = pushes};
}
