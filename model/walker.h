/* The walker: its five parameters, their limits, and what the equations derive from them once.
 *
 * A point mass at the hip, two legs with a small mass in the middle of each, a spring below the
 * stance leg. Everything in SI units. The walker moves towards -x: forward walking has a falling
 * stance angle. Angles are measured from the vertical; 0 = upright.
 */
#ifndef MODEL_WALKER_H
#define MODEL_WALKER_H

#include "model/real.h"

struct walker_params {
    real hip_mass_kg;         /* M, torso and all above */
    real leg_mass_kg;         /* m, each leg, half way down */
    real leg_length_m;        /* l */
    real ankle_stiffness_N_m; /* k, along the leg */
    real gravity_m_s2;        /* g */
};

/* Which field is wrong. Values are stable: they appear in logs. */
enum walker_error {
    WALKER_OK = 0,
    WALKER_BAD_HIP_MASS = -1,
    WALKER_BAD_LEG_MASS = -2,
    WALKER_BAD_LEG_LENGTH = -3,
    WALKER_BAD_ANKLE_STIFFNESS = -4,
    WALKER_BAD_GRAVITY = -5,
    WALKER_BAD_MASS_RATIO = -6
};

/* Parameters and their derived constants; read-only after walker_init. */
struct walker {
    struct walker_params params;
    real gravity_per_length_s2; /* g / l */
    real stance_inertia_kg;     /* M + 5m/4: the stance leg's inertia over l^2 */
    real stance_weight_kg;      /* M + 3m/2 */
    real half_leg_mass_kg;      /* m / 2 */
    real time_unit_s;           /* sqrt(l / g) */
    real push_time_s;           /* sqrt(total mass / k): the push-off's time scale */
};

#define walker_init REAL_SYMBOL(walker_init)
#define walker_error_name REAL_SYMBOL(walker_error_name)
#define walker_paper_params REAL_SYMBOL(walker_paper_params)

/* Checks the parameters and derives the constants.
 * Limits (walker.c has the table): M 1e-3..1e4 kg, m 0..1e4 kg and at most M, l 0.01..100 m,
 * k 1e-3..1e8 N/m, g 1e-3..1e3 m/s^2, all finite.
 * The caller owns both structs; on error *walker is left as it was.
 * Returns WALKER_OK, or the first field found outside its limits; WALKER_BAD_MASS_RATIO when m > M.
 * Callable from anywhere; constant cost. */
enum walker_error walker_init(struct walker *walker, const struct walker_params *params);

/* The wrong field in words, with its limits: "leg length l must be 0.01 to 100 m".
 * A static string; never NULL, also for values outside the enum. */
const char *walker_error_name(enum walker_error error);

/* The walker of the paper: M = 1 kg, m = 0.01 kg, l = 1 m, k = 100 N/m; g = 9.80665 m/s^2
 * (its printed digits come out with this value of g only). */
struct walker_params walker_paper_params(void);

#endif
