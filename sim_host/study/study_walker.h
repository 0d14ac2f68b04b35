/* A walker of the studies as model/ wants it, and the steps that serve where 1e-6 of the next apex is enough. */
#ifndef SIM_HOST_STUDY_STUDY_WALKER_H
#define SIM_HOST_STUDY_STUDY_WALKER_H

#include "model/stride.h"
#include "sim_host/gait/gait_curve.h"

/* Step of the coarse settings, sqrt(l/g): 1e-6 of the next apex. */
#define STUDY_COARSE_UNITS 0.08

/* Fills *walker, and *settings with fixed steps of step_units sqrt(l/g) and patience for ten of these units a phase.
 * Returns 0, or -1 when a parameter is out of range. */
int study_walker(const struct gait_walker *from, double step_units, struct walker *walker,
                 struct stride_settings *settings);

/* sqrt(g l), m/s: what rates of the ankle are measured in. */
double study_rate_unit_m_s(const struct gait_walker *walker);

#endif
