#include "sim_host/study/person/objective.h"

#include <math.h>

/* ---- measures ------------------------------------------------------------------------------------------------- */

static double speed(const struct gait_summary *summary, enum side side)
{
    (void)side;
    return summary->speed_m_s;
}

static double step_time(const struct gait_summary *summary, enum side side)
{
    (void)side;
    return summary->step_time_s;
}

static double step_spread(const struct gait_summary *summary, enum side side)
{
    (void)side;
    return summary->step_time_sd_s;
}

static double peak(const struct gait_summary *summary, enum side side)
{
    (void)side;
    return summary->peak_weights;
}

static double torque_rate(const struct gait_summary *summary, enum side side)
{
    (void)side;
    return summary->torque_rate_Nm_kg_s;
}

static double effort(const struct gait_summary *summary, enum side side)
{
    (void)side;
    return summary->activation;
}

/* The largest (sign 1) or smallest (-1) angle of a joint between two shares of the stride, in percent. */
static double extreme(const struct gait_summary *summary, enum side side, enum joint joint,
                      double sign, int from, int until)
{
    const double *curve = summary->curve[side][CURVE_ANGLE + (int)joint];
    double most = -(double)INFINITY;
    for (int i = from / 2; i <= until / 2; i++) {
        most = fmax(most, sign * curve[i]);
    }
    return sign * most;
}

static double hip_flexion(const struct gait_summary *summary, enum side side)
{
    return extreme(summary, side, JOINT_HIP, 1.0, 70, 100);
}

static double hip_extension(const struct gait_summary *summary, enum side side)
{
    return extreme(summary, side, JOINT_HIP, -1.0, 30, 70);
}

static double knee_at_strike(const struct gait_summary *summary, enum side side)
{
    return summary->curve[side][CURVE_ANGLE + JOINT_KNEE][0];
}

static double knee_loading(const struct gait_summary *summary, enum side side)
{
    return extreme(summary, side, JOINT_KNEE, 1.0, 6, 26);
}

static double knee_swing(const struct gait_summary *summary, enum side side)
{
    return extreme(summary, side, JOINT_KNEE, 1.0, 50, 90);
}

static double ankle_stance(const struct gait_summary *summary, enum side side)
{
    return extreme(summary, side, JOINT_ANKLE, 1.0, 20, 54);
}

static double ankle_push_off(const struct gait_summary *summary, enum side side)
{
    return extreme(summary, side, JOINT_ANKLE, -1.0, 50, 74);
}

static double ankle_swing(const struct gait_summary *summary, enum side side)
{
    return summary->curve[side][CURVE_ANGLE + JOINT_ANKLE][42];
}

/* ---- the objective -------------------------------------------------------------------------------------------- */

const struct objective_term objective_terms[OBJECTIVE_TERMS] = {
    {"speed", "m/s", 1.22, 1.28, 0.03, 2.0, speed, false},
    {"step time", "s", 0.56, 0.61, 0.02, 2.0, step_time, false},
    {"spread of step times", "s", 0.0, 0.02, 0.02, 1.0, step_spread, false},
    {"peak load", "body weights", 1.0, 1.35, 0.1, 2.0, peak, false},
    {"torque rate, RMS", "N m/kg/s", 0.0, 5.0, 5.0, 1.0, torque_rate, false},
    {"mean square activation", "1", 0.0, 0.0, 0.1, 1.0, effort, false},
    {"hip, most flexion in swing", "deg", 20.0, 35.0, 5.0, 0.5, hip_flexion, true},
    {"hip, most extension", "deg", -20.0, -5.0, 5.0, 0.5, hip_extension, true},
    {"knee at heel strike", "deg", 0.0, 10.0, 5.0, 0.5, knee_at_strike, true},
    {"knee, most in loading", "deg", 10.0, 22.0, 5.0, 0.5, knee_loading, true},
    {"knee, most in swing", "deg", 55.0, 67.0, 5.0, 0.5, knee_swing, true},
    {"ankle, most in stance", "deg", 5.0, 15.0, 5.0, 0.5, ankle_stance, true},
    {"ankle, least at push-off", "deg", -25.0, -12.0, 5.0, 0.5, ankle_push_off, true},
    {"ankle at 84 % of the stride", "deg", -5.0, 5.0, 5.0, 0.5, ankle_swing, true},
};

static double cost(const struct objective_term *term, double value)
{
    const double outside = fmax(0.0, fmax(term->low - value, value - term->high)) / term->unit;
    return term->weight * outside * outside;
}

double objective_share(const struct objective_term *term, const struct gait_summary *summary)
{
    if (!term->of_a_leg) {
        return cost(term, term->measure(summary, SIDE_LEFT));
    }
    return 0.5 * (cost(term, term->measure(summary, SIDE_LEFT)) +
                  cost(term, term->measure(summary, SIDE_RIGHT)));
}

double objective_of(const struct gait_summary *summary, double until_s)
{
    double sum = 0.0;
    if (summary->fell || !summary->has_curve[SIDE_LEFT] || !summary->has_curve[SIDE_RIGHT]) {
        const double walked = summary->fell ? fmin(summary->walked_s / until_s, 1.0) : 0.0;
        return OBJECTIVE_FALL * (2.0 - walked);
    }
    for (int i = 0; i < OBJECTIVE_TERMS; i++) {
        sum += objective_share(&objective_terms[i], summary);
    }
    return sum / (1.0 + sum / OBJECTIVE_FALL);
}
