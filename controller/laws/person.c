#include "controller/laws/law_table.h"
#include "controller/laws/step_law.h"

/* The energy of a push goes with the square of the precompression: so at most 1.08 of what is prescribed. The
 * drive's tracking takes up to 0.02 more. */
#define R0_MOST_RATIO REAL(1.04)

/* The mean over all steps so far, then over about the last PERSON_MEAN_STEPS; this
 * step is compared with the mean before it. */
static real step(struct step_law *law, const struct control_params *params, const struct apex *apex,
                 real desired_rad_s)
{
    const real measured_rad_s = -apex->stance_rate_rad_s;
    (void)desired_rad_s;
    if (law->mean_rad_s == REAL(0.0)) { /* the first apex that was a number */
        law->mean_rad_s = measured_rad_s;
    }
    law->command_rad_s = law->mean_rad_s;
    const uint32_t over = law->steps < PERSON_MEAN_STEPS ? law->steps : PERSON_MEAN_STEPS;
    law->mean_rad_s += (measured_rad_s - law->mean_rad_s) / (real)over;
    const real asked_m =
        params->start_r0_m - params->kp_m_s_rad * (law->command_rad_s - measured_rad_s);
    const real most_m = R0_MOST_RATIO * params->start_r0_m;
    return asked_m < most_m ? asked_m : most_m;
}

const struct law LAW_ROW(person) = {.step = step};
