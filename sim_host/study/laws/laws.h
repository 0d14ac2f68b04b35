/* What the studies of afo study laws share: the laws beside each other, in numbers.
 *
 * Each study prints a table for people and, with --out DIR, writes the same numbers to DIR/laws-STUDY.csv
 * (scripts/plot-laws draws them). No result depends on the number of threads.
 */
#ifndef SIM_HOST_STUDY_LAWS_LAWS_H
#define SIM_HOST_STUDY_LAWS_LAWS_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "sim_host/cli/output_file.h"
#include "sim_host/plant/sensors.h"
#include "sim_host/random/rng.h"
#include "sim_host/study/laws/setup.h"
#include "sim_host/study/map/viability_kernel.h"

/* The laws compared. "ramp" is eq. (16) with the command ramped as flown, the others take the command at
 * once. */
enum law_case {
    LAW_CASE_PROPORTIONAL = 0,
    LAW_CASE_RAMP = 1,
    LAW_CASE_DLQR = 2,
    LAW_CASE_DEADBEAT = 3,
    LAW_CASE_PREDICTIVE = 4,
    LAW_CASES = 5
};
extern const char *const law_case_names[LAW_CASES];

struct laws_options {
    bool law_case[LAW_CASES]; /* which ones to run */
    bool chain;               /* through bus, sensors and SEA instead of the map */
    enum sensor_preset_kind sensors;
    int samples; /* 0: the study's own default */
    int threads;
    uint64_t seed;
    const char *out_directory; /* NULL: none */
    int argc;                  /* the command line, for the record */
    char **argv;
    struct subject subject;
    struct law_setup setup; /* of the subject, with eq. (16) */
};

/* A study: returns 0, or -1 after saying what is wrong on standard error. */
typedef int laws_study(const struct laws_options *options);
laws_study laws_jumps, laws_limits, laws_basin, laws_ground, laws_sensitivity, laws_slope,
    laws_mismatch, laws_push, laws_energy, laws_timing, laws_ground_limit;

/* Box of apex states that basins are shares of, in the paper's units: stance rate, swing angle, swing rate. */
extern const double laws_box_low[3], laws_box_high[3];

/* A state of the box for this subject, drawn evenly. */
void laws_draw_apex(const struct laws_options *options, struct rng *rng, double apex[3]);

/* The grid of all states that viability_kernel.h is asked on, finer with fineness (1: 100 x 60 states). */
struct viability_range laws_viability_range(const struct laws_options *options, int fineness,
                                            int pushes);

/* The setup of a law_case for the subject. */
struct law_setup law_case_setup(const struct laws_options *options, enum law_case law_case);

/* For pools whose results stay where they were computed. */
int laws_count_part(void *context, int i);

/* Around a study: shows how many of its parts are done. */
void laws_progress_begin(void);
void laws_progress_end(void);

/* rad/s of this subject for one of the paper's walker: sqrt(g/l) over the paper's. */
double laws_speed_unit(const struct laws_options *options);

/* Where the rows of DIR/laws-STUDY.csv go, and those of --plot; NULL without both. Its header line is there. It comes into being when it is closed: a
 * study that is broken off leaves the old one. *failed tells of an error (said). */
FILE *laws_csv(const struct laws_options *options, const char *study, const char *header,
               struct output_file *file, bool *failed);
/* Commits it, or throws it away when the study failed. Returns 0, or -1 when either went wrong. */
int laws_csv_close(const struct laws_options *options, struct output_file *file, bool failed);

#endif
