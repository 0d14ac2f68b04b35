/* Gait sensitivity norm (Hobbelen, Wisse 2007): how much one disturbance moves a gait indicator over all
 * the steps that follow. Disturbance: one foothold higher or lower, the ground level again behind it.
 * Indicators: step time and apex speed. norm = sqrt(sum over steps of (change / disturbance)^2), from both
 * signs, small enough to be linear; the time-domain form of the H2 norm. */
#include <math.h>

#include "sim_host/study/laws/laws.h"

enum { SETTLE = 60, RESPONSE = 80, INDICATORS = 2 };
#define RISE 1e-4 /* leg lengths */
static const double speeds[] = {0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0};

/* Indicators of RESPONSE steps after a foothold raised by `rise` at the first. Returns false on a fall. */
static bool respond(const struct law_setup *setup, double speed_rad_s, double rise,
                    double indicator[RESPONSE][INDICATORS])
{
    struct laws_walk walk;
    double gait[3];
    const double r0_m = law_setup_gait(setup, speed_rad_s, gait);
    laws_walk_start(setup, &walk, gait, r0_m, speed_rad_s);
    for (int k = 0; k < SETTLE + RESPONSE; k++) {
        if (laws_walk_step(setup, &walk, speed_rad_s, NULL, 0.0, k == SETTLE ? rise : 0.0) != 0) {
            return false;
        }
        if (k >= SETTLE) {
            indicator[k - SETTLE][0] = walk.stride.apex_to_strike_s + walk.stride.double_support_s +
                                       walk.stride.lift_off_to_apex_s;
            indicator[k - SETTLE][1] = -walk.apex[0];
        }
    }
    return true;
}

static bool norms(const struct law_setup *setup, double speed_rad_s, double norm[INDICATORS])
{
    static double up[RESPONSE][INDICATORS], down[RESPONSE][INDICATORS];
    if (!respond(setup, speed_rad_s, RISE, up) || !respond(setup, speed_rad_s, -RISE, down)) {
        return false;
    }
    for (int i = 0; i < INDICATORS; i++) {
        double sum = 0.0;
        for (int k = 0; k < RESPONSE; k++) {
            const double slope = (up[k][i] - down[k][i]) / (2.0 * RISE);
            sum += slope * slope;
        }
        norm[i] = sqrt(sum);
    }
    return true;
}

int laws_sensitivity(const struct laws_options *options)
{
    bool failed;
    struct output_file file;
    FILE *csv =
        laws_csv(options, "sensitivity",
                 "law,speed_rad_s,step_time_s_per_leg,apex_speed_rad_s_per_leg", &file, &failed);
    printf(
        "  norm of step time (s) and apex speed (rad/s) per leg length of one step of the ground\n");
    for (int e = 0; e < LAW_CASES && !failed; e++) {
        if (!options->law_case[e] || e == LAW_CASE_RAMP) {
            continue;
        }
        struct law_setup setup = law_case_setup(options, (enum law_case)e);
        setup.accuracy = LAWS_FINE;
        printf("  %-13s", law_case_names[e]);
        for (unsigned i = 0; i < sizeof speeds / sizeof speeds[0]; i++) {
            double norm[INDICATORS];
            if (!norms(&setup, speeds[i] * laws_speed_unit(options), norm)) {
                printf("  %.1f: fell      ", speeds[i]);
                continue;
            }
            printf("  %.1f: %5.2f %5.2f", speeds[i], norm[0], norm[1]);
            if (csv != NULL) {
                fprintf(csv, "%s,%.1f,%.6g,%.6g\n", law_case_names[e], speeds[i], norm[0], norm[1]);
            }
        }
        printf("\n");
    }
    return laws_csv_close(options, &file, failed);
}
