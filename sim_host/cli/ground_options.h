/* Command-line options for what the ground and other people do to the walker. */
#ifndef SIM_HOST_CLI_GROUND_OPTIONS_H
#define SIM_HOST_CLI_GROUND_OPTIONS_H

#include <argp.h>
#include <stdbool.h>

#include "sim_host/loop/loop.h"

struct ground_options {
    double slope_deg;  /* > 0 uphill; reached from level ground, GROUND_SLOPE_PER_STEP_DEG a step */
    double terrain_mm; /* standard deviation of the footholds' heights above the slope line */
    double push_Ns;    /* on the torso, > 0 forward; 0 = none */
    double
        push_s; /* when, seconds as plant_walked_s() counts them; none before the walker is let go */
    double push_for_s; /* spread evenly over so long; 0: within a tick */
};

/* Child parser: its input is a struct ground_options, all zero at first. */
extern const struct argp ground_options_parser;

#define GROUND_SLOPE_PER_STEP_DEG 0.05

/* Whether any of them does something. */
bool ground_options_given(const struct ground_options *options);

/* Terrain into the plant's configuration. */
void ground_options_apply(const struct ground_options *options, struct loop_config *config);

/* Slope of the present step, and the push when its time has come; call once a tick, before loop_tick().
 * *push_ticks is 0 at first, and counts the ticks that were pushed in. */
void ground_options_tick(const struct ground_options *options, struct loop *loop,
                         uint32_t *push_ticks);

#endif
