/* How every command reads its options: one parser, one layout of --help, one wording of what is wrong. */
#ifndef SIM_HOST_CLI_OPTION_H
#define SIM_HOST_CLI_OPTION_H

#include <argp.h>
#include <stdbool.h>
#include <stdint.h>

/* argp_parse() with the name of the running command, --help, --usage and --version; ends the process
 * with EXIT_GOOD behind these, with EXIT_USAGE when something is wrong. A long option that does not
 * exist is refused with the nearest one. */
void option_parse(const struct argp *parser, int argc, char **argv, void *input);

/* For parsers: a number within low..high, or a usage error. option: "--speed". */
double option_number(struct argp_state *state, const char *option, const char *text, double low,
                     double high);
uint64_t option_whole(struct argp_state *state, const char *option, const char *text, uint64_t low,
                      uint64_t high);

/* For parsers: which of the `count` names text is, or a usage error with the list and the nearest.
 * names[i * stride_bytes] is the i-th pointer. */
int option_choice(struct argp_state *state, const char *option, const char *text, const void *names,
                  size_t count, size_t stride_bytes);

/* What every command says to --subject FILE, the one file that there was before persons and devices were parted. */
void option_refuse_subject(struct argp_state *state, const char *path);

/* For a parser's end: what a command that takes no arguments says to one. */
void option_refuse_argument(struct argp_state *state, const char *text);

#endif
