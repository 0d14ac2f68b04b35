/* --speed: the law's apex speed in rad/s, or a walking speed in m/s. */
#ifndef SIM_HOST_CLI_SPEED_OPTION_H
#define SIM_HOST_CLI_SPEED_OPTION_H

#include <argp.h>

#include "sim_host/subjects/subject.h"

struct speed_option {
    double apex_rad_s;  /* 0: not given so */
    double walking_m_s; /* 0: not given so */
};

/* "0.8", "0.8rad/s" or "0.57m/s"; anything else is a usage error. */
void speed_option_take(struct speed_option *speed, const char *text, struct argp_state *state);

/* The apex speed of the steady gait that walks at walking_m_s, by bisection over the speeds that the law serves:
 * walking speed rises with apex speed along the branch. Returns 0, or -1 with the range that this walker has in
 * message (SUBJECT_MESSAGE_MAX bytes). Cost: some 32 gaits, each by following the branch to it. */
int speed_option_apex(const struct subject *subject, const struct control_params *params,
                      double walking_m_s, double *apex_rad_s, char *message);

#endif
