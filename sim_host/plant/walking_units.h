/* Walking in the units of gait analysis: closed forms of what every laboratory reports. Plain doubles, SI units.
 *
 * Each result is NaN where a divisor is 0, so that nothing looks measured that is not. Cost of each: some ns.
 */
#ifndef SIM_HOST_PLANT_WALKING_UNITS_H
#define SIM_HOST_PLANT_WALKING_UNITS_H

/* Walking speed, m/s: way of a step over its time, both from heel strike to heel strike. */
double walking_speed_m_s(double step_length_m, double step_time_s);

/* From foot to foot on level ground, m, of two legs of one length: its angles from the vertical, positive where the foot
 * is ahead of the hip, as the landing foot comes down. */
double walking_step_length_m(double leg_length_m, double landing_rad, double other_rad);

/* Steps of both feet a minute. */
double walking_cadence_per_min(double step_time_s);

/* How unlike two legs are, percent: 0 where they are alike, positive where the left value is the larger.
 * SI = 100 (L - R) / ((L + R) / 2), Robinson, Herzog, Nigg, J Manipulative Physiol Ther 10:172 (1987). */
double walking_symmetry_percent(double left, double right);

/* Work a step takes, per weight and way; no unit. c = E / (m g d), Collins, Ruina, Tedrake, Wisse, Science 307:1082
 * (2005). With the push-off's work alone it is the mechanical cost of transport. */
double walking_cost_of_transport(double work_J, double mass_kg, double gravity_m_s2,
                                 double step_length_m);

/* Extrapolated centre of mass, m: XcoM = x + v / sqrt(g / l), Hof, Gazendam, Sinke, J Biomech 38:1 (2005). x, v of the
 * centre of mass along the way, forward positive; l the pendulum's length. */
double walking_xcom_m(double com_m, double com_m_s, double leg_length_m, double gravity_m_s2);

/* The compass in single support, its stance toe pinned at 0 and its ankle locked. Angles from the vertical and their
 * rates in rad and rad/s, as model/walker.h has them: forward walking has a negative stance rate. */
struct walking_pose {
    double hip_mass_kg, leg_mass_kg, leg_length_m, gravity_m_s2;
    double stance_rad, swing_rad, stance_rad_s, swing_rad_s;
};

/* Margin of stability along the way, m: how far the toe that lands lies ahead of the XcoM. Asked for just before a heel
 * strike. Negative: the walker rolls on beyond the new foot unless something brakes it, which is steady walking. */
double walking_margin_m(const struct walking_pose *pose);

#endif
