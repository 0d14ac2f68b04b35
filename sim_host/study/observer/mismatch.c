#include "sim_host/study/observer/mismatch.h"

#include <stdio.h>

#include "sim_host/study/observer/observe_case.h"
#include "sim_host/study/observer/observed_walk.h"
#include "sim_host/study/plot.h"

#define MISMATCH_SPEED_RAD_S 0.6
/* Metres of ground, for a leg of 1 m. */
#define UNEQUAL_LEGS_M 0.01
#define ROUGHNESS_M 0.001
#define SLOPE_RAD 0.034906585039886591 /* 2 degrees */

enum { ALTERNATING = 4000 };

enum what {
    NOTHING,
    LENGTH_SHORT,
    LENGTH_LONG,
    TORSO_LIGHT,
    TORSO_HEAVY,
    LEGS_LIGHT,
    LEGS_HEAVY,
    SPRING_SOFT,
    SPRING_STIFF,
    LEGS_UNEQUAL,
    UPHILL,
    DOWNHILL,
    UNEVEN,
    OFFSET_BOTH,
    OFFSET_OPPOSITE,
    WANDER,
    DROPS,
    CASES
};

static const char *const names[CASES] = {
    "as the parameters say",        "controller's l 10 % short",  "controller's l 10 % long",
    "controller's M 10 % light",    "controller's M 10 % heavy",  "controller's m 10 % light",
    "controller's m 10 % heavy",    "controller's k 10 % soft",   "controller's k 10 % stiff",
    "one leg 1 % longer",           "2 degrees uphill",           "2 degrees downhill",
    "ground uneven, 1 mm RMS",      "both sensors off by 5 mrad", "sensors off by 5 and -5 mrad",
    "0.5 mrad of noise below 5 Hz", "5 % of the samples lost"};

/* A leg that is longer stands, so to say, in a hollow: the ground under it lower by the
 * difference, under the other not. */
static const double *alternating_ground(void)
{
    static double heights_m[ALTERNATING];
    for (int i = 0; i < ALTERNATING; i++) {
        heights_m[i] = i % 2 == 0 ? UNEQUAL_LEGS_M : 0.0;
    }
    return heights_m;
}

static void change(enum what what, struct loop_config *config)
{
    struct control_params *params = &config->params;
    struct sensor_params *left = &config->plant.sensors[SIDE_LEFT];
    struct sensor_params *right = &config->plant.sensors[SIDE_RIGHT];
    switch (what) {
    case LENGTH_SHORT:
    case LENGTH_LONG:
        params->leg_length_m *= what == LENGTH_LONG ? REAL(1.1) : REAL(0.9);
        break;
    case TORSO_LIGHT:
    case TORSO_HEAVY:
        params->torso_mass_kg *= what == TORSO_HEAVY ? REAL(1.1) : REAL(0.9);
        break;
    case LEGS_LIGHT:
    case LEGS_HEAVY:
        params->leg_mass_kg *= what == LEGS_HEAVY ? REAL(1.1) : REAL(0.9);
        break;
    case SPRING_SOFT:
    case SPRING_STIFF:
        params->spring_stiffness_n_m *= what == SPRING_STIFF ? REAL(1.1) : REAL(0.9);
        break;
    case LEGS_UNEQUAL:
        config->plant.heights_m = alternating_ground();
        config->plant.heights_count = ALTERNATING;
        break;
    case UPHILL:
    case DOWNHILL:
        config->plant.walk.slope_rad = what == UPHILL ? SLOPE_RAD : -SLOPE_RAD;
        break;
    case UNEVEN:
        config->plant.roughness_m = ROUGHNESS_M;
        break;
    case OFFSET_BOTH:
    case OFFSET_OPPOSITE:
        left->angle_offset_rad = 0.005;
        right->angle_offset_rad = what == OFFSET_BOTH ? 0.005 : -0.005;
        break;
    case WANDER:
        left->angle_coloured_rad = right->angle_coloured_rad = 5e-4;
        left->angle_coloured_hz = right->angle_coloured_hz = 5.0;
        break;
    case DROPS:
        left->drop_probability = right->drop_probability = 0.05;
        break;
    default:
        break;
    }
}

static int run_all(enum law_mode law, int steps, int settle, FILE *picture)
{
    const int settled = settle + (int)((MISMATCH_SPEED_RAD_S - 0.407) / 0.005);
    char message[LOOP_MESSAGE_MAX];
    printf("Closed loop, %s, to %.2f rad/s, 17-bit sensors, one count of noise, 2 ms late; the\n"
           "walker, ground or sensors differ from what the controller is told.\n\n"
           "                                      apex speed, observer    swing at apex   model's"
           "   apexes          true speed\n"
           "                                    rms %%  mean %%  worst %%    mrad  mrad/s     share"
           "  false missed    mean  spread\n",
           law == LAW_PROPORTIONAL ? "eq. (16)" : "predictive law", MISMATCH_SPEED_RAD_S);
    for (int what = NOTHING; what < CASES; what++) {
        const struct observe_case want = {MISMATCH_SPEED_RAD_S, SENSORS_17BIT, 1.0, 0.002, 1, law};
        struct loop_config config;
        struct observed_walk w;
        if (observe_case_configure(&want, &config, message) != 0) {
            fprintf(stderr, "afo study observe: %s\n", message);
            return 1;
        }
        change((enum what)what, &config);
        if (observed_walk_run(&config, settled + steps, settled, &w, message) != 0) {
            fprintf(stderr, "afo study observe: %s: %s\n", names[what], message);
            return 1;
        }
        printf("  %-30s ", names[what]);
        if (w.observer.count == 0) {
            /* Before it fell there was nothing settled to measure: measure all there was. */
            printf("  fell after %d steps (%s)", w.steps, w.fault);
            if (observed_walk_run(&config, w.steps + 1, 3, &w, message) == 0 &&
                w.observer.count > 0) {
                printf("; until then rms %.4f %%, worst %.3f %%", 100.0 * w.observer.rms,
                       100.0 * w.observer.worst);
            }
            printf("\n");
            if (picture != NULL) {
                fprintf(picture, "%s,%s,,\n", names[what],
                        law == LAW_PROPORTIONAL ? "eq. (16)" : "predictive");
            }
            continue;
        }
        printf(" %8.4f %+7.4f %8.3f  %6.3f %7.3f   %5.2f   %4d %5d  %8.4f %6.3f%%%s\n",
               100.0 * w.observer.rms, 100.0 * w.observer.mean, 100.0 * w.observer.worst,
               1e3 * w.swing_angle_rms_rad, 1e3 * w.swing_rate_rms_rad_s, w.confidence,
               w.false_apexes, w.event[GAIT_APEX].missed, w.mean_speed_rad_s,
               100.0 * w.speed_spread, w.fell ? "  fell" : "");
        fflush(stdout);
        if (picture != NULL) {
            fprintf(picture, "%s,%s,%.9g,%.9g\n", names[what],
                    law == LAW_PROPORTIONAL ? "eq. (16)" : "predictive", 100.0 * w.observer.rms,
                    100.0 * w.speed_spread);
        }
    }
    return 0;
}

int mismatch_run(int steps, int settle)
{
    FILE *picture = plot_table("observe-mismatch");
    if (picture != NULL) {
        fputs("what,law,rms_percent,spread_percent\n", picture);
    }
    const int status = run_all(LAW_PROPORTIONAL, steps, settle, picture);
    printf("\n");
    return status != 0 ? status : run_all(LAW_PREDICTIVE, steps, settle, picture);
}
