#include "controller/estimator/apex_fusion.h"

#include <stddef.h>

/* Standard errors of a cubic's value and slope at the centre of 2 w + 1 samples, with the
 * noise as unit: 1.5 / sqrt(2 w) and 2.5 sqrt(3) / (w sqrt(2 w)) a sample (Savitzky &
 * Golay's weights, summed; w large). */
#define VALUE_ERROR REAL(1.5)
#define SLOPE_ERROR REAL(4.33)

/* Slow noise averages as if one sample in so many counted; and whatever the noise, the
 * fit is not taken to be worse than this ratio of the speed. */
#define SLOW_SAMPLES REAL(40.0)
#define SLOPE_MOST_RATIO REAL(0.025)

/* The mean difference begins at 0, with the weight of so many steps. */
#define BIAS_PRIOR_STEPS 8u
#define BIAS_MEAN_STEPS 48u

/* Agreement: within so many standard errors of the fit, plus what a learned
 * difference may change from step to step, as ratios of it and of the value. */
#define ERRORS_ALLOWED REAL(3.5)
#define CHANGE_RATIO REAL(0.1)
#define VALUE_RATIO REAL(0.001)

#define BIAS_MOST_RATIO REAL(0.04)

#define WEIGHT_RISE REAL(0.25)

void apex_fusion_init(struct apex_fusion *fusion)
{
    *fusion = (struct apex_fusion){.model_weight = REAL(1.0)};
}

/* The part of a learned mean that is not its own scatter: none within two standard
 * errors, all of it far beyond. */
static real significant(real bias, real error)
{
    const real square = bias * bias, scatter = REAL(4.0) * error * error;
    return square > scatter ? bias * (REAL(1.0) - scatter / square) : REAL(0.0);
}

static void values_of(const struct apex_estimate *estimate, real value[APEX_VALUES])
{
    value[0] = estimate->stance_rate_rad_s;
    value[1] = estimate->swing_angle_rad;
    value[2] = estimate->swing_rate_rad_s;
}

/* 1 within the tolerance, 0 beyond twice of it, falling between. */
static real agreement(real off, real tolerance)
{
    return real_clamp(REAL(2.0) - real_abs(off) / tolerance, REAL(0.0), REAL(1.0));
}

struct apex_estimate apex_fusion_decide(struct apex_fusion *fusion, enum side side,
                                        const struct apex_estimate *fit,
                                        const struct apex_estimate *model,
                                        const struct apex_noise *noise, uint32_t window_ticks)
{
    struct apex_estimate from_fit = *fit;
    from_fit.confidence = REAL(0.0);
    if (model == NULL) {
        fusion->model_weight = REAL(0.0);
        return from_fit;
    }
    const real window_s = (real)window_ticks * CONTROL_PERIOD_S;
    const real root = real_sqrt(REAL(2.0) * (real)window_ticks);
    const real noise_rad =
        real_sqrt(noise->white_rad2 +
                  SLOW_SAMPLES * (noise->slow_rad2 > REAL(0.0) ? noise->slow_rad2 : REAL(0.0)));
    const real white_slope_error = SLOPE_ERROR * noise_rad / (window_s * root);
    const real slope_most = SLOPE_MOST_RATIO * real_abs(fit->stance_rate_rad_s);
    const real slope_error = white_slope_error < slope_most ? white_slope_error : slope_most;
    /* The swing angle is read at the crossing, whose own error counts by the swing's rate. */
    const real angle_error = VALUE_ERROR * noise_rad / root;
    const real relative = real_abs(fit->swing_rate_rad_s / fit->stance_rate_rad_s);
    const real error[APEX_VALUES] = {slope_error, angle_error * (REAL(1.0) + relative),
                                     slope_error};
    const uint32_t steps = fusion->learned[side];
    const real gain =
        REAL(1.0) / (real)(BIAS_PRIOR_STEPS + (steps < BIAS_MEAN_STEPS ? steps : BIAS_MEAN_STEPS));
    real of_fit[APEX_VALUES], of_model[APEX_VALUES], mixed[APEX_VALUES];
    real agreed = REAL(1.0);
    values_of(fit, of_fit);
    values_of(model, of_model);
    for (int i = 0; i < APEX_VALUES; i++) {
        real *bias = &fusion->bias[side][i];
        const real off = of_model[i] - of_fit[i] - *bias;
        const real tolerance = ERRORS_ALLOWED * error[i] + CHANGE_RATIO * real_abs(*bias) +
                               VALUE_RATIO * real_abs(of_fit[0]);
        const real here = agreement(off, tolerance);
        agreed = here < agreed ? here : agreed;
        real *scatter2 = &fusion->scatter2[side][i];
        if (steps == 0) {
            *scatter2 = error[i] * error[i];
        }
        of_model[i] -= significant(*bias, real_sqrt(REAL(0.5) * gain * *scatter2));
        *scatter2 += gain * (off * off - *scatter2);
        *bias += gain * off;
    }
    /* A difference so large means a model of another body, even if it is steady. */
    const real plausible = agreement(fusion->bias[side][0], BIAS_MOST_RATIO * real_abs(of_fit[0]));
    agreed = plausible < agreed ? plausible : agreed;
    fusion->learned[side] = steps < BIAS_MEAN_STEPS ? steps + 1 : steps;
    const real risen = fusion->model_weight + WEIGHT_RISE;
    fusion->model_weight = agreed < risen ? agreed : risen;
    for (int i = 0; i < APEX_VALUES; i++) {
        mixed[i] = of_fit[i] + fusion->model_weight * (of_model[i] - of_fit[i]);
    }
    return (struct apex_estimate){mixed[0], mixed[1], mixed[2], fusion->model_weight};
}
