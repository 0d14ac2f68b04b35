/* Command-line options that say who walks, how fast and by which law: the same for
 * every program that runs the control task.
 */
#ifndef SIM_HOST_CLI_WALK_OPTIONS_H
#define SIM_HOST_CLI_WALK_OPTIONS_H

#include <argp.h>
#include <stdbool.h>

#include "sim_host/cli/option.h"
#include "sim_host/cli/speed_option.h"
#include "sim_host/subjects/subject.h"

struct walk_options {
    struct speed_option speed;
    bool open_loop;
    double r0_m;       /* 0 = not given */
    double start_r0_m; /* 0 = not given */
    double kp;         /* < 0 = not given */
    bool law_given;
    enum law_mode law;
    const char *person_path; /* NULL = the paper's walker */
    const char *device_path; /* NULL = the virtual device */
    bool person;             /* a recorded person walks, and no compass: set by the command */
};

/* Child parser: its input is a struct walk_options, set up by walk_options_init. */
extern const struct argp walk_options_parser;

void walk_options_init(struct walk_options *options);

/* Whether --speed was given, in whatever unit. */
bool walk_options_speed_given(const struct walk_options *options);

/* The files and options to what the control task needs: the subject, its
 * parameters, the speed to walk at. Returns 0, or -1 with the reason in message
 * (SUBJECT_MESSAGE_MAX bytes). */
int walk_options_resolve(const struct walk_options *options, struct subject *subject,
                         struct control_params *params, double *desired_speed_rad_s, char *message);

#endif
