#include "sim_host/cli/speed_option.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "sim_host/cli/option.h"
#include "sim_host/plant/walking_units.h"

enum { HALVINGS = 30, TEXT_MAX = 32 };

void speed_option_take(struct speed_option *speed, const char *text, struct argp_state *state)
{
    char number[TEXT_MAX];
    char *end;
    (void)strtod(text, &end);
    const size_t length = (size_t)(end - text);
    while (*end == ' ') {
        end++;
    }
    const bool metres = strcmp(end, "m/s") == 0;
    if (length == 0 || length >= sizeof number ||
        (*end != '\0' && !metres && strcmp(end, "rad/s") != 0)) {
        argp_error(state,
                   "--speed: \"%s\" is no speed; expected an apex speed such as 0.8 (rad/s), or a "
                   "walking speed such as 0.57m/s",
                   text);
        return;
    }
    memcpy(number, text, length);
    number[length] = '\0';
    const double value = option_number(state, "--speed", number, 1e-3, 20.0);
    *speed = (struct speed_option){.apex_rad_s = metres ? 0.0 : value,
                                   .walking_m_s = metres ? value : 0.0};
}

/* Walking speed of the steady gait with this apex speed; below 0 where there is none. */
static double walking_at(const struct subject *subject, const struct control_params *params,
                         double apex_rad_s)
{
    struct gait_point gait;
    const double r0_m = (double)speed_table_inverse(&params->table, (real)apex_rad_s);
    if (subject_gait(subject, r0_m, &gait) != GAIT_CURVE_OK) {
        return -1.0;
    }
    return walking_speed_m_s(gait.step_length_m, gait.apex_to_strike_s + gait.double_support_s +
                                                     gait.lift_off_to_apex_s);
}

int speed_option_apex(const struct subject *subject, const struct control_params *params,
                      double walking_m_s, double *apex_rad_s, char *message)
{
    real low_rad_s, high_rad_s;
    control_params_speeds(params, &low_rad_s, &high_rad_s);
    double low = (double)low_rad_s, high = (double)high_rad_s;
    const double least_m_s = walking_at(subject, params, low);
    const double most_m_s = walking_at(subject, params, high);
    if (least_m_s < 0.0 || most_m_s < 0.0) {
        snprintf(message, SUBJECT_MESSAGE_MAX,
                 "--speed %g m/s: this walker has no curve of steady gaits to find it on; give the "
                 "apex speed in rad/s",
                 walking_m_s);
        return -1;
    }
    if (walking_m_s < least_m_s || walking_m_s > most_m_s) {
        snprintf(message, SUBJECT_MESSAGE_MAX,
                 "--speed %g m/s: no gait of this walker and law is so %s; they walk from %.3f to "
                 "%.3f m/s (%.4g to %.4g rad/s at the apex)",
                 walking_m_s, walking_m_s < least_m_s ? "slow" : "fast", least_m_s, most_m_s, low,
                 high);
        return -1;
    }
    for (int i = 0; i < HALVINGS; i++) {
        const double middle = 0.5 * (low + high);
        const double at_m_s = walking_at(subject, params, middle);
        if (at_m_s < walking_m_s) { /* a gap of the curve counts as slow */
            low = middle;
        } else {
            high = middle;
        }
    }
    *apex_rad_s = 0.5 * (low + high);
    return 0;
}
