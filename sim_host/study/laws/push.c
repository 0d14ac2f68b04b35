/* The largest impulse on the torso that the walk survives, forward and backward, at eight phases between
 * two apexes. Always through the whole chain: a push in the middle of a step is no state of the map. */
#include <math.h>
#include <stdlib.h>

#include "sim_host/study/laws/session.h"
#include "sim_host/study/pool.h"

enum { PHASES = 8, DIRECTIONS = 2, SPEEDS = 2, HALVINGS = 8, PUSH_STEP = 8, STEPS = 40 };
#define LEAST 2e-4 /* of total mass times sqrt(g l) */
#define MOST 0.5
static const double speeds[SPEEDS] = {0.4, 0.8};

struct push_study {
    struct laws_options options; /* with the chain */
    double unit_Ns, largest[LAW_CASES][SPEEDS][DIRECTIONS][PHASES];
    bool failed[LAW_CASES];
};

static bool survives(struct push_study *study, int e, int v, double push_Ns, int phase)
{
    struct session_result result = {.step = NULL};
    const double speed = speeds[v] * laws_speed_unit(&study->options);
    const struct session_config config = {.law_case = (enum law_case)e,
                                          .from_rad_s = speed,
                                          .to_rad_s = speed,
                                          .steps = STEPS,
                                          .push_Ns = push_Ns,
                                          .push_phase = (phase + 0.5) / PHASES,
                                          .push_step = PUSH_STEP,
                                          .seed = study->options.seed};
    if (session_run(&study->options, &config, 1, &result) != 0) {
        study->failed[e] = true;
        return false;
    }
    return !result.fell;
}

/* Halves the ratio between a push survived and one not; survival is taken to end once. */
static void compute(void *context, int i)
{
    struct push_study *study = (struct push_study *)context;
    const int e = i / (SPEEDS * DIRECTIONS * PHASES), v = i / (DIRECTIONS * PHASES) % SPEEDS,
              d = i / PHASES % DIRECTIONS, phase = i % PHASES;
    if (!study->options.law_case[e] || e == LAW_CASE_RAMP) {
        return;
    }
    const double sign = d == 0 ? study->unit_Ns : -study->unit_Ns;
    double low = LEAST, high = MOST;
    if (!survives(study, e, v, sign * low, phase)) {
        study->largest[e][v][d][phase] = 0.0;
        return;
    }
    for (int k = 0; k < HALVINGS; k++) {
        const double middle = sqrt(low * high);
        *(survives(study, e, v, sign * middle, phase) ? &low : &high) = middle;
    }
    study->largest[e][v][d][phase] = low;
}

/* What is survived at every phase. */
static double smallest(const double largest[PHASES])
{
    double least = largest[0];
    for (int p = 1; p < PHASES; p++) {
        least = largest[p] < least ? largest[p] : least;
    }
    return least;
}

static void print(const struct push_study *study, int e, FILE *csv)
{
    for (int v = 0; v < SPEEDS; v++) {
        for (int d = 0; d < DIRECTIONS; d++) {
            printf("  %-13s %.1f rad/s %-8s", law_case_names[e], speeds[v],
                   d == 0 ? "forward" : "backward");
            for (int p = 0; p < PHASES; p++) {
                const double largest = study->largest[e][v][d][p];
                printf(" %8.4f", largest);
                if (csv != NULL) {
                    fprintf(csv, "%s,%.1f,%s,%.4f,%.6g,%.6g\n", law_case_names[e], speeds[v],
                            d == 0 ? "forward" : "backward", (p + 0.5) / PHASES, largest,
                            largest * study->unit_Ns);
                }
            }
            printf("\n");
        }
        printf("  %-13s %.1f rad/s the smallest of these: forward %.4f, backward %.4f\n",
               law_case_names[e], speeds[v], smallest(study->largest[e][v][0]),
               smallest(study->largest[e][v][1]));
    }
}

int laws_push(const struct laws_options *options)
{
    bool failed;
    struct output_file file;
    struct push_study *study = calloc(1, sizeof *study);
    if (study == NULL) {
        return -1;
    }
    const struct subject *body = &options->subject;
    study->options = *options;
    study->options.chain = true;
    study->unit_Ns = (body->person.torso_mass_kg + 2.0 * body->person.leg_mass_kg) *
                     sqrt(body->person.gravity_m_s2 * body->person.leg_length_m);
    FILE *csv =
        laws_csv(&study->options, "push",
                 "law,speed_rad_s,direction,phase,share_of_m_sqrt_gl,impulse_Ns", &file, &failed);
    const struct pool_jobs jobs = {0,
                                   LAW_CASES * SPEEDS * DIRECTIONS * PHASES,
                                   options->threads,
                                   study,
                                   compute,
                                   laws_count_part};
    failed = failed || pool_run(&jobs) != 1;
    printf(
        "  in units of total mass times sqrt(g l), %.4g N s here; phases 1/16, 3/16 .. 15/16 from "
        "apex to apex\n",
        study->unit_Ns);
    for (int e = 0; e < LAW_CASES && !failed; e++) {
        if (options->law_case[e] && e != LAW_CASE_RAMP) {
            print(study, e, csv);
        }
        failed = failed || study->failed[e];
    }
    free(study);
    return laws_csv_close(options, &file, failed);
}
