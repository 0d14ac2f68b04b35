/* The ankle of an adult in level walking, over one stride: for sizing an actuator where no recording is
 * at hand.
 *
 * A smooth curve through the landmarks that textbooks of gait agree on (Perry, Burnfield: Gait Analysis,
 * 2010; Winter: The Biomechanics and Motor Control of Human Gait, 1991), in whole degrees: neutral at heel
 * strike, 5 degrees of plantarflexion as the foot comes down, 10 of dorsiflexion before the other heel
 * strikes at half of the stride, 19 of plantarflexion at toe-off (62 %), neutral again in swing. The curve
 * is the same at every cadence; only its time is scaled.
 */
#ifndef SIM_HOST_STUDY_SIZE_ANKLE_CURVE_H
#define SIM_HOST_STUDY_SIZE_ANKLE_CURVE_H

#define ANKLE_CURVE_TOE_OFF 0.62
#define ANKLE_CURVE_OTHER_STRIKE 0.5

/* Plantarflexion at a share of the stride since the own heel strike (any number: its fraction
 * counts), rad. */
double ankle_curve_rad(double share);

#endif
