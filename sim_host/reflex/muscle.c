#include "sim_host/reflex/muscle.h"

#include "sim_host/reflex/exponential.h"

#define WIDTH 0.56
#define LN_RESIDUE (-2.995732273553991) /* ln 0.05: what is left of the force one width beside lo */
#define CURVATURE 5.0                   /* K */
#define ECCENTRIC 1.5                   /* N */
#define TENDON_STRAIN 0.04
#define ACTIVATION_S 0.01
#define LEAST 0.01
#define ECCENTRIC_MOST 1.45 /* a fraction of f_v near N has no bounded speed */

static double clamped(double value, double low, double high)
{
    return value < low ? low : value > high ? high : value;
}

double muscle_force_of_length(const struct muscle *muscle, double length_m)
{
    double offset = (length_m - muscle->optimal_m) / (muscle->optimal_m * WIDTH);
    offset = offset < 0.0 ? -offset : offset;
    return exponential(LN_RESIDUE * offset * offset * offset);
}

double muscle_force_of_speed(const struct muscle *muscle, double speed_m_s)
{
    const double most = -muscle->speed_max_per_s, speed = speed_m_s / muscle->optimal_m;
    if (speed <= most) {
        return 0.0;
    }
    return speed < 0.0
               ? (most - speed) / (most + CURVATURE * speed)
               : ECCENTRIC + (ECCENTRIC - 1.0) * (most + speed) / (7.56 * CURVATURE * speed - most);
}

double muscle_speed_of_force(const struct muscle *muscle, double fraction)
{
    const double most = -muscle->speed_max_per_s;
    const double part = clamped(fraction, 0.0, ECCENTRIC_MOST);
    const double speed =
        part < 1.0
            ? most * (1.0 - part) / (1.0 + CURVATURE * part)
            : most * (part - 1.0) / (7.56 * CURVATURE * (part - ECCENTRIC) - (ECCENTRIC - 1.0));
    return speed * muscle->optimal_m;
}

double muscle_tendon_force_N(const struct muscle *muscle, double tendon_m)
{
    const double strain = (tendon_m - muscle->slack_m) / (muscle->slack_m * TENDON_STRAIN);
    return strain > 0.0 ? muscle->force_max_N * strain * strain : 0.0;
}

static double parallel_N(const struct muscle *muscle, double length_m)
{
    const double strain = (length_m - muscle->optimal_m) / (muscle->optimal_m * WIDTH);
    return strain > 0.0 ? muscle->force_max_N * strain * strain : 0.0;
}

static double buffer_N(const struct muscle *muscle, double length_m)
{
    const double strain =
        (muscle->optimal_m * (1.0 - WIDTH) - length_m) / (0.5 * WIDTH * muscle->optimal_m);
    return strain > 0.0 ? muscle->force_max_N * strain * strain : 0.0;
}

/* f_v that makes the element's force the tendon's. */
static double wanted_of_speed(const struct muscle *muscle, const struct muscle_state *state,
                              double tendon_N)
{
    const double active =
        state->activation * muscle->force_max_N * muscle_force_of_length(muscle, state->length_m) +
        parallel_N(muscle, state->length_m);
    return (tendon_N + buffer_N(muscle, state->length_m)) / active;
}

void muscle_settle(const struct muscle *muscle, double total_m, double activation,
                   struct muscle_state *state)
{
    *state = (struct muscle_state){.activation = clamped(activation, LEAST, 1.0)};
    double low = 0.2 * muscle->optimal_m, high = 1.8 * muscle->optimal_m;
    for (int i = 0; i < 60; i++) {
        state->length_m = 0.5 * (low + high);
        const double tendon_N = muscle_tendon_force_N(muscle, total_m - state->length_m);
        if (wanted_of_speed(muscle, state, tendon_N) > 1.0) { /* the tendon is the stronger one */
            low = state->length_m;
        } else {
            high = state->length_m;
        }
    }
    state->force_N = muscle_tendon_force_N(muscle, total_m - state->length_m);
}

double muscle_step(const struct muscle *muscle, double total_m, double stimulation, double step_s,
                   struct muscle_state *state)
{
    const double tendon_N = muscle_tendon_force_N(muscle, total_m - state->length_m);
    state->force_N = tendon_N;
    state->speed_m_s = muscle_speed_of_force(muscle, wanted_of_speed(muscle, state, tendon_N));
    state->length_m += step_s * state->speed_m_s;
    state->activation +=
        step_s / ACTIVATION_S * (clamped(stimulation, LEAST, 1.0) - state->activation);
    return tendon_N;
}
