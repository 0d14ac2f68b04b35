#include "sim_host/plant/walking_units.h"

#include <math.h>

#include "model/trig.h"

static double over(double a, double b)
{
    return b != 0.0 ? a / b : (double)NAN;
}

double walking_speed_m_s(double step_length_m, double step_time_s)
{
    return over(step_length_m, step_time_s);
}

double walking_step_length_m(double leg_length_m, double landing_rad, double other_rad)
{
    double landing_sin, other_sin, cosine;
    trig_sincos_f64(landing_rad, &landing_sin, &cosine);
    trig_sincos_f64(other_rad, &other_sin, &cosine);
    return leg_length_m * (landing_sin - other_sin);
}

double walking_cadence_per_min(double step_time_s)
{
    return over(60.0, step_time_s);
}

double walking_symmetry_percent(double left, double right)
{
    return over(100.0 * (left - right), 0.5 * (left + right));
}

double walking_cost_of_transport(double work_J, double mass_kg, double gravity_m_s2,
                                 double step_length_m)
{
    return over(work_J, mass_kg * gravity_m_s2 * step_length_m);
}

double walking_xcom_m(double com_m, double com_m_s, double leg_length_m, double gravity_m_s2)
{
    return com_m + com_m_s * sqrt(over(leg_length_m, gravity_m_s2));
}

/* Forward is -x of the model, so every sine changes its sign. */
double walking_margin_m(const struct walking_pose *pose)
{
    const double l = pose->leg_length_m, m = pose->leg_mass_kg;
    const double total_kg = pose->hip_mass_kg + 2.0 * m;
    double stance_sin, stance_cos, swing_sin, swing_cos;
    trig_sincos_f64(pose->stance_rad, &stance_sin, &stance_cos);
    trig_sincos_f64(pose->swing_rad, &swing_sin, &swing_cos);
    const double hip_m = -l * stance_sin;
    const double hip_m_s = -l * stance_cos * pose->stance_rad_s;
    const double swing_m = 0.5 * l * swing_sin; /* its mass, ahead of the hip */
    const double swing_m_s = 0.5 * l * swing_cos * pose->swing_rad_s;
    const double com_m =
        (pose->hip_mass_kg * hip_m + m * 0.5 * hip_m + m * (hip_m + swing_m)) / total_kg;
    const double com_m_s =
        (pose->hip_mass_kg * hip_m_s + m * 0.5 * hip_m_s + m * (hip_m_s + swing_m_s)) / total_kg;
    const double toe_m = hip_m + l * swing_sin;
    return toe_m - walking_xcom_m(com_m, com_m_s, l, pose->gravity_m_s2);
}
