/* What the files of a session share; not for its users. */
#ifndef SIM_HOST_STUDY_LAWS_SESSION_INTERNAL_H
#define SIM_HOST_STUDY_LAWS_SESSION_INTERNAL_H

#include "sim_host/random/rng.h"
#include "sim_host/study/laws/session.h"

/* Ground between two footholds, drawn per step: an incline, or the foothold's height. */
struct session_ground {
    struct rng rng;
    double step_share; /* steady step length over leg length */
};

/* Starts the draws of this config's seed. */
void session_ground_init(struct session_ground *ground, const struct law_setup *setup,
                         const struct session_config *config);

/* The next foothold above the one before, leg lengths, drawn. */
double session_ground_rise(struct session_ground *ground, const struct session_config *config);

/* The slope of step number `step`, from 0 on: config's, or on the ramp to it. */
double session_slope_rad(const struct session_config *config, int step);

/* session_run() on the map, and one of its walks through the chain. Return 0, or -1 after a message. */
int session_run_map(const struct laws_options *options, const struct session_config *configs,
                    int count, struct session_result *results);
int session_run_chain(const struct laws_options *options, const struct session_config *config,
                      struct session_result *result);

#endif
