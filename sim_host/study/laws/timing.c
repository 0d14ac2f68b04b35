/* The push-off before, at and after heel strike: what a steady release time does to the gait of a speed, and
 * what the release time as a second input does to the basin. On the map, the subject's own scale at SI units
 * of the paper's walker (box and r0 limits are the paper's). */
#include <stdlib.h>

#include "sim_host/study/laws/laws.h"
#include "sim_host/study/map/laws_timed.h"
#include "sim_host/study/pool.h"

enum { SPEEDS = 3, TIMES = 11, DEFAULT_SAMPLES = 400 };
#define SECOND_INPUT_LIMIT_S 0.02
static const double speeds[SPEEDS] = {0.4, 0.6, 0.8};
static const double times_s[TIMES] = {-0.05, -0.03, -0.02, -0.01, -0.005, 0.0,
                                      0.002, 0.005, 0.01,  0.015, 0.02};

struct entry {
    bool found;
    struct laws_timed_gait gait;
    double basin[3]; /* by enum laws_timed_law */
};

struct timing {
    const struct laws_options *options;
    int samples;
    struct entry entry[SPEEDS][TIMES];
};

/* Follows the gaits from the release at the strike outwards in small steps. */
static bool reach(const struct timing *timing, double speed, double release_s,
                  struct laws_timed_gait *gait)
{
    const struct gait_walker walker = subject_gait_walker(&timing->options->subject);
    gait->r0_m = law_setup_gait(&timing->options->setup, speed, gait->apex);
    const int steps = 1 + (int)((release_s < 0.0 ? -release_s : release_s) / 0.002);
    for (int k = 0; k <= steps; k++) {
        if (laws_timed_gait(&walker, speed, release_s * k / steps, gait) != 0) {
            return false;
        }
    }
    return true;
}

static void compute(void *context, int i)
{
    struct timing *timing = (struct timing *)context;
    const struct gait_walker walker = subject_gait_walker(&timing->options->subject);
    const double speed = speeds[i / TIMES] * laws_speed_unit(timing->options);
    struct entry *entry = &timing->entry[i / TIMES][i % TIMES];
    entry->found = reach(timing, speed, times_s[i % TIMES], &entry->gait);
    for (int law = 0; law < 3 && entry->found; law++) {
        entry->basin[law] =
            laws_timed_basin(&walker, &entry->gait, (enum laws_timed_law)law,
                             (double)timing->options->setup.params.kp_m_s_rad, SECOND_INPUT_LIMIT_S,
                             laws_box_low, laws_box_high, timing->samples, timing->options->seed);
    }
}

static void print(const struct timing *timing, FILE *csv)
{
    const struct person *body = &timing->options->subject.person;
    const double weight_N = (body->torso_mass_kg + 2.0 * body->leg_mass_kg) * body->gravity_m_s2;
    printf(
        "  speed  release   r0 (m)  step (m)  step (s)  J/m     cost of  largest   basin of 3 laws, %%:\n"
        "  rad/s  (ms)                                         transp.  |eigenv.| eq.(16), lqr r0, "
        "lqr r0+time\n");
    for (int i = 0; i < SPEEDS * TIMES; i++) {
        const struct entry *e = &timing->entry[i / TIMES][i % TIMES];
        const struct laws_timed_gait *g = &e->gait;
        if (!e->found) {
            printf("  %.2f   %+6.1f   no steady gait\n", speeds[i / TIMES],
                   1e3 * times_s[i % TIMES]);
            continue;
        }
        printf("  %.2f   %+6.1f   %.4f   %.4f    %.4f    %.4f  %.4f   %7.3f   %6.2f %6.2f %6.2f\n",
               speeds[i / TIMES], 1e3 * g->release_s, g->r0_m, g->step_length_m, g->step_time_s,
               g->energy_J_per_m, g->energy_J_per_m / weight_N, g->eigenvalue[0],
               100.0 * e->basin[0], 100.0 * e->basin[1], 100.0 * e->basin[2]);
        if (csv != NULL) {
            fprintf(csv, "%.2f,%g,%.8g,%.8g,%.8g,%.8g,%.8g,%.8g,%g,%g,%g\n", speeds[i / TIMES],
                    g->release_s, g->r0_m, g->step_length_m, g->step_time_s, g->energy_J_per_m,
                    g->energy_J_per_m / weight_N, g->eigenvalue[0], e->basin[0], e->basin[1],
                    e->basin[2]);
        }
    }
}

int laws_timing(const struct laws_options *options)
{
    bool failed;
    struct output_file file;
    FILE *csv =
        laws_csv(options, "timing",
                 "speed_rad_s,release_s,r0_m,step_length_m,step_time_s,energy_J_per_m,"
                 "cost_of_transport,eigenvalue,basin_proportional,basin_lqr_r0,basin_lqr_both",
                 &file, &failed);
    struct timing *timing = calloc(1, sizeof *timing);
    failed = failed || timing == NULL;
    if (!failed) {
        timing->options = options;
        timing->samples = options->samples > 0 ? options->samples : DEFAULT_SAMPLES;
        const struct pool_jobs jobs = {0,      SPEEDS * TIMES, options->threads,
                                       timing, compute,        laws_count_part};
        failed = pool_run(&jobs) != 1;
        print(timing, csv);
    }
    free(timing);
    return laws_csv_close(options, &file, failed);
}
