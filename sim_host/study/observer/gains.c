#include "sim_host/study/observer/gains.h"

#include <math.h>
#include <string.h>

#include "controller/estimator/observer_gains.h"
#include "model/tick.h"
#include "sim_host/cli/option.h"
#include "sim_host/study/observer/commands.h"
#include "sim_host/study/plot.h"

#define PAPER_RATE_S 3.131557120667717 /* sqrt(g / l) of the paper's walker, 1/s */

/* The lift-off state of the paper's walker from 0.4 to 1.0 rad/s, as the observer itself
 * leaves it: angles within a count of a 14-bit encoder or so, rates within 0.02 rad/s
 * (a wrong toe distance, impact and ankle rate together). The acceleration errors are
 * what is chosen: they make the filters forget within about 0.15 s, half of what the
 * noise alone would ask for, so that a walker that differs from its parameters pulls
 * the estimate by a quarter of what it would otherwise (afo study observe shows both). */
struct gain_assumptions gain_assumptions_default(void)
{
    const double count_rad = 2.0 * 3.14159265358979323846 / 16384.0;
    return (struct gain_assumptions){
        .noise_rad = count_rad * sqrt(1.0 + 1.0 / 12.0),
        .sample_s = TICK_PERIOD_US / 1e6,
        .start_angle_rad = 1e-3,
        .start_rate_rad_s = 0.02,
        .stance_density = 1.2e-6,
        .swing_density = 1.2e-6,
    };
}

/* P' = A P + P A^T + Q - P C^T C P / r for A = ((0, 1), (spring, 0)), C = (1, 0). */
static void riccati(const double p[3], double spring, double q, double r, double rates[3])
{
    rates[0] = 2.0 * p[1] - p[0] * p[0] / r;
    rates[1] = p[2] + spring * p[0] - p[0] * p[1] / r;
    rates[2] = 2.0 * spring * p[1] + q - p[1] * p[1] / r;
}

static void advance(double p[3], double spring, double q, double r, double h)
{
    double k[4][3], at[3];
    const double part[4] = {0.0, 0.5, 0.5, 1.0}, weight[4] = {1.0, 2.0, 2.0, 1.0};
    for (int stage = 0; stage < 4; stage++) {
        for (int i = 0; i < 3; i++) {
            at[i] = p[i] + (stage > 0 ? part[stage] * h * k[stage - 1][i] : 0.0);
        }
        riccati(at, spring, q, r, k[stage]);
    }
    for (int stage = 0; stage < 4; stage++) {
        for (int i = 0; i < 3; i++) {
            p[i] += h * weight[stage] * k[stage][i] / 6.0;
        }
    }
}

void gain_schedule(const struct gain_assumptions *assumptions, double spring, double density,
                   const double *since, int count, double (*gain)[2])
{
    const double w = PAPER_RATE_S;
    const double r = assumptions->noise_rad * assumptions->noise_rad * assumptions->sample_s * w;
    const double q = density / (w * w * w);
    const double rate = assumptions->start_rate_rad_s / w;
    double p[3] = {assumptions->start_angle_rad * assumptions->start_angle_rad, 0.0, rate * rate};
    double now = 0.0;
    for (int i = 0; i < count; i++) {
        const int steps = (int)ceil((since[i] - now) / 1e-5);
        for (int n = 0; n < steps; n++) {
            advance(p, spring, q, r, (since[i] - now) / steps);
        }
        now = since[i];
        gain[i][0] = p[0] / r;
        gain[i][1] = p[1] / r;
    }
}

static error_t parse_option(int key, char *text, struct argp_state *state)
{
    if (key == ARGP_KEY_ARG) {
        option_refuse_argument(state, text);
    }
    return key == ARGP_KEY_ARG ? 0 : ARGP_ERR_UNKNOWN;
}

int command_observer_gains(int argc, char **argv)
{
    static const struct argp parser = {
        0,
        parse_option,
        0,
        "Solves for the model observer's gains and prints them as C, for "
        "controller/estimator/observer_gains.c.\v"
        "Exit status: 0 printed, 2 wrong usage or output not writable.",
        0,
        0,
        0};
    plot_option_parse(&parser, argc, argv, NULL);
    const struct gain_assumptions a = gain_assumptions_default();
    double since[OBSERVER_GAIN_KNOTS], stance[OBSERVER_GAIN_KNOTS][2],
        swing[OBSERVER_GAIN_KNOTS][2];
    since[0] = 0.0;
    for (int i = 1; i < OBSERVER_GAIN_KNOTS; i++) {
        since[i] = 0.01 * pow(2.0, 0.5 * (i - 1));
    }
    gain_schedule(&a, 1.0, a.stance_density, since, OBSERVER_GAIN_KNOTS, stance);
    gain_schedule(&a, -2.0, a.swing_density, since, OBSERVER_GAIN_KNOTS, swing);
    printf("/* Made by `afo study observer-gains`; do not edit.\n"
           " * Noise %.3g rad a sample of %g s; at lift-off %.3g rad and %.3g rad/s; error of the\n"
           " * model's acceleration %.3g (stance) and %.3g rad^2/s^3 (swing). */\n"
           "#include \"controller/estimator/observer_gains.h\"\n\n"
           "const struct observer_gain observer_gains[OBSERVER_GAIN_KNOTS] = {\n",
           a.noise_rad, a.sample_s, a.start_angle_rad, a.start_rate_rad_s, a.stance_density,
           a.swing_density);
    for (int i = 0; i < OBSERVER_GAIN_KNOTS; i++) {
        printf("    {REAL(%.6f), {REAL(%.6f), REAL(%.6f)}, {REAL(%.6f), REAL(%.6f)}},\n", since[i],
               stance[i][0], stance[i][1], swing[i][0], swing[i][1]);
    }
    printf("};\n");
    FILE *picture = plot_table("observer-gains");
    if (picture != NULL) {
        fputs("since_lift_off,stance_angle,stance_rate,swing_angle,swing_rate\n", picture);
    }
    for (int i = 0; i < OBSERVER_GAIN_KNOTS && picture != NULL; i++) {
        fprintf(picture, "%.9g,%.9g,%.9g,%.9g,%.9g\n", since[i], stance[i][0], stance[i][1],
                swing[i][0], swing[i][1]);
    }
    return 0;
}
