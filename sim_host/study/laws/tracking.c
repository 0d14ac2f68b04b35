/* Holding a speed where the world is not as believed: slopes, a wrong body, noisy sensing; and what it costs.
 * One walk each, at three speeds; reported is the mean speed of the last steps against the command. */
#include <math.h>
#include <stdlib.h>

#include "sim_host/study/laws/session.h"

enum { SPEEDS = 3, CASES_MAX = 24, STEPS = 200, LAST = 50 };
static const double speeds[SPEEDS] = {0.4, 0.6, 0.8};

struct tracking_case {
    char label[24];
    struct subject truth;
    double slope_rad, noise_rms;
};

struct tracking_result {
    bool fell;
    int steps, fallbacks;
    double speed_share, spread, energy_J_per_m, cost_of_transport;
};

struct tracking {
    const struct laws_options *options;
    int cases;
    struct tracking_case item[CASES_MAX];
    struct tracking_result result[LAW_CASES][CASES_MAX][SPEEDS];
};

static void evaluate(const struct tracking *tracking, const struct tracking_case *item,
                     double speed, const struct session_result *walk, struct tracking_result *r)
{
    const int first = walk->steps > LAST ? walk->steps - LAST : 0;
    double energy_J = 0.0, way_m = 0.0, least = 1e9, most = 0.0;
    r->fell = walk->fell;
    const double spring_N_per_m = subject_spring_N_per_m(&item->truth);
    r->steps = walk->steps;
    r->fallbacks = walk->fallbacks;
    for (int k = first; k < walk->steps; k++) {
        const struct session_step *step = &walk->step[k];
        least = step->speed_rad_s < least ? step->speed_rad_s : least;
        most = step->speed_rad_s > most ? step->speed_rad_s : most;
        energy_J += 0.5 * spring_N_per_m * step->r0_m * step->r0_m;
        way_m += step->step_length_m;
    }
    const double weight_N =
        (item->truth.person.torso_mass_kg + 2.0 * item->truth.person.leg_mass_kg) *
        tracking->options->subject.person.gravity_m_s2;
    r->speed_share = session_mean_speed(walk, LAST) / speed;
    r->spread = (most - least) / speed;
    r->energy_J_per_m = way_m > 0.0 ? energy_J / way_m : 0.0;
    r->cost_of_transport = r->energy_J_per_m / weight_N;
}

static struct session_config session_of(const struct tracking *tracking, int e,
                                        const struct tracking_case *item, int v)
{
    const double speed = speeds[v] * laws_speed_unit(tracking->options);
    return (struct session_config){.law_case = (enum law_case)e,
                                   .truth = &item->truth,
                                   .from_rad_s = speed,
                                   .to_rad_s = speed,
                                   .steps = STEPS,
                                   .slope_rad = item->slope_rad,
                                   .slope_ramp_rad = 0.001, /* 0.06 degrees a step */
                                   .noise_rms = item->noise_rms,
                                   .seed = tracking->options->seed};
}

/* All cases and speeds under one law. */
static int walk_all(struct tracking *tracking, int e)
{
    struct session_config config[CASES_MAX * SPEEDS];
    struct session_result result[CASES_MAX * SPEEDS];
    const int count = tracking->cases * SPEEDS;
    for (int i = 0; i < count; i++) {
        config[i] = session_of(tracking, e, &tracking->item[i / SPEEDS], i % SPEEDS);
    }
    if (session_records(config, count, result) != 0) {
        return -1;
    }
    const int status = session_run(tracking->options, config, count, result);
    for (int i = 0; i < count && status == 0; i++) {
        evaluate(tracking, &tracking->item[i / SPEEDS], config[i].to_rad_s, &result[i],
                 &tracking->result[e][i / SPEEDS][i % SPEEDS]);
    }
    session_records_free(result);
    return status;
}

static void print(const struct tracking *tracking, int e, const char *what, bool energy, FILE *csv)
{
    printf("  %s, %s (mean speed over command; spread; - = fell)\n", law_case_names[e], what);
    for (int c = 0; c < tracking->cases; c++) {
        printf("    %-14s", tracking->item[c].label);
        for (int v = 0; v < SPEEDS; v++) {
            const struct tracking_result *r = &tracking->result[e][c][v];
            if (r->fell) {
                printf("  %.1f: - at %-12d", speeds[v], r->steps + 1);
            } else {
                printf("  %.1f: %6.4f %6.4f%s", speeds[v], r->speed_share, r->spread,
                       r->fallbacks > 0 ? "*" : " ");
            }
            if (energy && !r->fell) {
                printf(" %.4g J/m, cost of transport %.4f", r->energy_J_per_m,
                       r->cost_of_transport);
            }
            if (csv != NULL) {
                fprintf(csv, "%s,%s,%.1f,%d,%d,%.6g,%.6g,%d,%.6g,%.6g\n", law_case_names[e],
                        tracking->item[c].label, speeds[v], r->fell, r->steps, r->speed_share,
                        r->spread, r->fallbacks, r->energy_J_per_m, r->cost_of_transport);
            }
        }
        printf("\n");
    }
}

static int run(struct tracking *tracking, const char *study, const char *what, bool energy)
{
    bool failed;
    struct output_file file;
    FILE *csv = laws_csv(tracking->options, study,
                         "law,case,speed_rad_s,fell,steps,speed_share,spread,fallbacks,"
                         "energy_J_per_m,cost_of_transport",
                         &file, &failed);
    for (int e = 0; e < LAW_CASES && !failed; e++) {
        if (tracking->options->law_case[e] && e != LAW_CASE_RAMP) {
            failed = walk_all(tracking, e) != 0;
            if (!failed) {
                print(tracking, e, what, energy, csv);
            }
        }
    }
    return laws_csv_close(tracking->options, &file, failed);
}

static struct tracking *make(const struct laws_options *options)
{
    struct tracking *tracking = calloc(1, sizeof *tracking);
    if (tracking == NULL) {
        fprintf(stderr, "afo study laws: out of memory\n");
        return NULL;
    }
    tracking->options = options;
    return tracking;
}

static struct tracking_case *add(struct tracking *tracking)
{
    struct tracking_case *item = &tracking->item[tracking->cases++];
    item->truth = tracking->options->subject;
    return item;
}

int laws_slope(const struct laws_options *options)
{
    struct tracking *tracking = make(options);
    if (tracking == NULL) {
        return -1;
    }
    for (int half = -8; half <= 8; half++) {
        struct tracking_case *item = add(tracking);
        item->slope_rad = 0.5 * half * 0.017453292519943295;
        snprintf(item->label, sizeof item->label, "%+.1f deg", 0.5 * half);
    }
    const int status = run(tracking, "slope", "slopes, uphill positive", false);
    free(tracking);
    return status;
}

static void scale_springs(struct subject *truth, double factor)
{
    const double spring_N_per_m = factor * subject_spring_N_per_m(truth);
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        device_file_set(&truth->device, (enum side)leg, DEVICE_LEG_spring_N_per_m, spring_N_per_m);
    }
}

int laws_mismatch(const struct laws_options *options)
{
    static const char *const names[] = {"M", "m", "l", "k"};
    struct tracking *tracking = make(options);
    if (tracking == NULL) {
        return -1;
    }
    for (int i = 0; i < 8; i++) {
        struct tracking_case *item = add(tracking);
        const double factor = i % 2 == 0 ? 0.9 : 1.1;
        struct person *person = &item->truth.person;
        double *const field[] = {&person->torso_mass_kg, &person->leg_mass_kg,
                                 &person->leg_length_m};
        if (i / 2 < 3) {
            *field[i / 2] *= factor;
        } else {
            scale_springs(&item->truth, factor);
        }
        snprintf(item->label, sizeof item->label, "%s %+.0f %%", names[i / 2],
                 100.0 * (factor - 1.0));
    }
    const int status = run(tracking, "mismatch", "the walker's true parameters differ", false);
    free(tracking);
    return status;
}

int laws_energy(const struct laws_options *options)
{
    static const double noise[] = {0.0, 0.001, 0.003, 0.01};
    struct tracking *tracking = make(options);
    if (tracking == NULL) {
        return -1;
    }
    for (int i = 0; i < (options->chain ? 1 : 4); i++) {
        struct tracking_case *item = add(tracking);
        item->noise_rms = noise[i];
        snprintf(item->label, sizeof item->label, "noise %.1f %%", 100.0 * noise[i]);
    }
    const int status = run(tracking, "energy", "spring energy per metre", true);
    free(tracking);
    return status;
}
