/* The apex state from two estimates: the model observer's and the samples' own.
 *
 * The least-squares fit around the apex knows nothing of the walker. It is never wrong by
 * much, but noisy. The model's estimate has about a tenth of its noise. It is off when the
 * walker is not the one of the parameters (length, slope, unequal legs), then by nearly the
 * same from step to step.
 *
 * So the mean difference of the two is learned, per leg, and subtracted from the model's
 * estimate. The rest of this step's difference is compared with what the measured noise of
 * the sensors explains. While the two agree, the result is the model's estimate. As they
 * disagree, it becomes a mean of both, down to the fit alone. model_weight is the model's
 * part in it; it rises again over some steps.
 */
#ifndef CONTROLLER_ESTIMATOR_APEX_FUSION_H
#define CONTROLLER_ESTIMATOR_APEX_FUSION_H

#include "controller/signals.h"

#define apex_fusion_init REAL_SYMBOL(apex_fusion_init)
#define apex_fusion_decide REAL_SYMBOL(apex_fusion_decide)

enum { APEX_VALUES = 3 }; /* stance rate, swing angle, swing rate */

struct apex_fusion {
    real bias[SIDE_COUNT][APEX_VALUES];     /* mean of model minus fit, per stance leg */
    real scatter2[SIDE_COUNT][APEX_VALUES]; /* mean square of what differs from it */
    uint32_t learned[SIDE_COUNT];           /* steps behind the bias */
    real model_weight;                      /* 0..1, follows the agreement */
};

void apex_fusion_init(struct apex_fusion *fusion);

/* Of an angle sample, mean squares. */
struct apex_noise {
    real white_rad2;
    real slow_rad2; /* that which stays for some ten samples; not below 0 */
};

/* One apex of leg `side`: the fit's estimate, the model's (NULL = it has none), the
 * sensors' noise as measured and the fit's half width in ticks. Returns the
 * estimate to use; its confidence is the model's weight. Constant cost. */
struct apex_estimate apex_fusion_decide(struct apex_fusion *fusion, enum side side,
                                        const struct apex_estimate *fit,
                                        const struct apex_estimate *model,
                                        const struct apex_noise *noise, uint32_t window_ticks);

#endif
