/* What the commands of afo study share: their table, options and messages. */
#ifndef SIM_HOST_STUDY_PAPER_COMMAND_H
#define SIM_HOST_STUDY_PAPER_COMMAND_H

#include <argp.h>

#include "sim_host/cli/exit_status.h"
#include "sim_host/gait/branch.h"
#include "sim_host/study/report.h"

/* The same values under the studies' own names: a gait was found, or not. */
enum { EXIT_FOUND = EXIT_GOOD, EXIT_NOT_FOUND = EXIT_BAD };

/* Runs one command; argv[0] is its whole name. Returns the exit status. */
typedef int command_function(int argc, char **argv);
command_function command_fixed_point, command_continue, command_doublings, command_bifurcation,
    command_basin, command_gain, command_map, command_noise;

/* Parses with the common options added; `options` of the command are its own struct, which begins with a
 * struct common. Exits with status 2 on an error, 0 on --help. */
void command_parse(const struct argp_option *table, argp_parser_t parser, const char *doc, int argc,
                   char **argv, void *options);

/* The common options' defaults. */
struct common command_defaults(void);

/* A number or a list of `count` numbers separated by commas; a usage error if it is anything else. */
double command_number(const char *text, const char *option, const struct argp_state *state);
void command_numbers(const char *text, const char *option, int count, double *values,
                     const struct argp_state *state);
/* The same for a list of 1 to `most`. Returns how many. */
int command_list(const char *text, const char *option, int most, double *values,
                 const struct argp_state *state);
/* A whole number within [low, high]. */
int command_integer(const char *text, const char *option, int low, int high,
                    const struct argp_state *state);
enum branch command_branch(const char *text, const struct argp_state *state);

/* The options --r0 ('r') and --kp ('K') of the commands that have them; r0 NULL: only --kp. For a parser's end. */
error_t command_law(int key, const char *argument, double *r0, double *kp,
                    const struct argp_state *state);

/* Puts a problem together and finds its period-1 gait on the branch (x). With kp the reference gait, too.
 * Prints what is wrong, where and what to try; returns 0 then and sets *status. */
int command_gait(const struct common *common, enum branch branch, double r0, double kp,
                 struct problem *problem, double x[3], int *status);

/* "fault: fallen" and such, with what to try. */
void command_explain(const char *what, enum orbit_status status, const struct orbit *orbit);

/* 1 when the walker's parameters are good; else says which is not. */
int command_check_walker(const struct common *common);

#endif
