/* A muscle and its tendon, after Geyer & Herr (2010), IEEE Trans. Neural Syst. Rehabil. Eng. 18(3), 263-273.
 *
 * A contractile element that gives  A Fmax f_l(l) f_v(v),  with a parallel spring that engages beyond its optimal
 * length and a buffer that engages when it collapses, in series with a tendon:
 *     f_l = exp(c |(l - lo) / (lo w)|^3)         c = ln 0.05, w = 0.56
 *     f_v = (vm - v) / (vm + K v)                 shortening; N + (N - 1)(vm + v) / (7.56 K v - vm) lengthening
 *     tendon: Fmax (e / 0.04)^2 for its strain e > 0;   parallel spring: Fmax ((l - lo) / (lo w))^2, times f_v
 *     buffer: Fmax ((lo - w lo - l) / (lo w / 2))^2
 * with vm < 0 the largest speed of shortening, K = 5, N = 1.5. The activation A follows the stimulation with 10 ms.
 * The element's state is its length; its speed is what makes its force the tendon's.
 *
 * Pure functions, constant cost, only + - * / and exponential.h: the same bits on every machine.
 */
#ifndef SIM_HOST_REFLEX_MUSCLE_H
#define SIM_HOST_REFLEX_MUSCLE_H

struct muscle {
    double force_max_N;
    double speed_max_per_s; /* lo a second, > 0 */
    double optimal_m, slack_m;
};

struct muscle_state {
    double activation; /* 0.01 .. 1 */
    double length_m;   /* of the contractile element */
    double force_N;    /* the tendon's, at the last step */
    double speed_m_s;  /* of the contractile element, then */
};

/* At rest where muscle and tendon together are total_m long: the length at which its force is the tendon's. */
void muscle_settle(const struct muscle *muscle, double total_m, double activation,
                   struct muscle_state *state);

/* One step (explicit Euler; step_s up to 0.5 ms). stimulation is held within 0.01 .. 1. Returns the tendon's force
 * before the step, N >= 0. */
double muscle_step(const struct muscle *muscle, double total_m, double stimulation, double step_s,
                   struct muscle_state *state);

/* The parts of the force, for whoever draws or tests them; fractions of force_max_N. */
double muscle_force_of_length(const struct muscle *muscle, double length_m);
double muscle_force_of_speed(const struct muscle *muscle, double speed_m_s);
double muscle_speed_of_force(const struct muscle *muscle, double fraction); /* its inverse, m/s */
double muscle_tendon_force_N(const struct muscle *muscle, double tendon_m);

#endif
