/* The reflexes of a leg: what stimulates its muscles, after Geyer & Herr (2010), equations 1 to 14.
 *
 * In stance the leg behaves as a spring would (positive force feedback of soleus, gastrocnemius and vasti) and holds the
 * trunk upright (hamstrings, glutei, hip flexors by trunk lean and load). In swing the hip flexors bring it forward and
 * the hamstrings end that. Every signal is late by what a nerve takes: 5 ms at the hip, 10 at the knee, 20 at the ankle.
 */
#ifndef SIM_HOST_REFLEX_REFLEXES_H
#define SIM_HOST_REFLEX_REFLEXES_H

#include <stdbool.h>

#include "sim_host/reflex/muscles.h"

/* X(name, published, unit, meaning). Forces are by their muscle's largest, lengths by its optimal one, loads by body
 * weight. */
#define REFLEX_GAINS(X)                                                                   \
    X(sol_force, 1.2, "1", "soleus, stance: by its own force")                            \
    X(ta_length, 1.1, "1", "tibialis: by its own length beyond ta_length_off")            \
    X(ta_length_off, 0.71, "1", "length from which the tibialis answers")                 \
    X(ta_sol_force, 0.3, "1", "tibialis, stance: less, by the soleus' force")             \
    X(gas_force, 1.1, "1", "gastrocnemius, stance: by its own force")                     \
    X(vas_force, 1.15, "1", "vasti, stance: by their own force")                          \
    X(vas_knee, 2.0, "1/rad", "vasti: less, by an extending knee beyond vas_knee_off")    \
    X(vas_knee_off, 2.967, "rad", "knee angle from which the vasti are spared")           \
    X(vas_stance, 0.09, "1", "vasti, stance: constant part")                              \
    X(hip_stance, 0.05, "1", "muscles of the hip, stance: constant part")                 \
    X(lean_gain, 1.91, "1/rad", "muscles of the hip, stance: by the trunk's lean")        \
    X(lean_rate_gain, 0.25, "s/rad", "the same, by the lean's rate")                      \
    X(lean_wanted, 0.105, "rad", "lean forward that is held")                             \
    X(glu_share, 0.68, "1", "share of that for the glutei")                               \
    X(load, 1.2, "1", "how a foot's load weighs")                                         \
    X(late_stance, 0.25, "1", "leg behind: hip flexors more, glutei less")                \
    X(swing_lean, 1.15, "1/rad", "hip flexors, swing: by the lean at lift-off")           \
    X(hfl_length, 0.35, "1", "hip flexors, swing: by their length beyond hfl_length_off") \
    X(hfl_length_off, 0.6, "1", "length from which the hip flexors answer")               \
    X(hfl_ham_length, 4.0, "1", "hip flexors, swing: less, by the hamstrings' length")    \
    X(hfl_ham_length_off, 0.85, "1", "length of the hamstrings from which they do")       \
    X(ham_force, 0.65, "1", "hamstrings, swing: by their own force")                      \
    X(glu_force, 0.4, "1", "glutei, swing: by their own force")

#define REFLEX_GAIN_MOST 100.0 /* of any, either way */

#define REFLEX_GAIN_FIELD(name, published, unit, meaning) double name;
struct reflex_gains {
    REFLEX_GAINS(REFLEX_GAIN_FIELD)
};
#undef REFLEX_GAIN_FIELD

#define REFLEX_GAIN_ONE(name, published, unit, meaning) +1
enum { REFLEX_GAIN_COUNT = 0 REFLEX_GAINS(REFLEX_GAIN_ONE) };
#undef REFLEX_GAIN_ONE

enum { REFLEX_DELAY_MAX_MS = 20, REFLEX_RING = REFLEX_DELAY_MAX_MS + 1 };

/* What the nerves report of one leg at one moment. */
struct reflex_sense {
    double force[MUSCLE_COUNT];  /* by the largest */
    double length[MUSCLE_COUNT]; /* by the optimal */
    double knee_rad, knee_rate_rad_s;
    double load; /* on the foot, by body weight */
};

/* The same of the trunk, and of both legs. */
struct reflex_moment {
    struct reflex_sense leg[SIDE_COUNT];
    double lean_rad, lean_rate_rad_s; /* forward */
};

struct reflexes {
    struct reflex_moment ring[REFLEX_RING]; /* a moment a millisecond; the newest is at `newest` */
    int newest;
    bool stands[SIDE_COUNT];      /* the foot carries something */
    bool is_trailing[SIDE_COUNT]; /* both stand, and the other one came down later */
    double lift_off_lean_rad[SIDE_COUNT];
};

void reflex_gains_published(struct reflex_gains *gains);

/* A healthy person's, who has never worn a device: tuned with the softer feet of contact_default() by CMA-ES from the
 * published ones (1,232 walks). What was asked for: no fall in 10 s, 1.25 m/s, less than 1.4 body weights under either
 * foot, little activation, an upright trunk (0.08 rad) and no knee at its end. Joint angles were not asked for. */
void reflex_gains_healthy(struct reflex_gains *gains);

/* As if this moment had lasted for ever. */
void reflexes_init(struct reflexes *reflexes, const struct reflex_moment *moment);

/* The moment one millisecond after the one before. */
void reflexes_sense(struct reflexes *reflexes, const struct reflex_moment *moment);

/* The stimulation of a leg's muscles, each 0.01 .. 1. */
void reflexes_stimulate(const struct reflexes *reflexes, const struct reflex_gains *gains,
                        enum side side, double stimulation[MUSCLE_COUNT]);

#endif
