/* What an experiment was, beside its table: FILE.json names the whole of it for FILE, so that FILE itself
 * stays a plain table. */
#ifndef SIM_HOST_CLI_EXPERIMENT_H
#define SIM_HOST_CLI_EXPERIMENT_H

#include <stddef.h>

#include "sim_host/cli/json_writer.h"
#include "sim_host/cli/output_file.h"

/* Puts the program, its version and its arguments into an object that is open. */
void experiment_identity(struct json_writer *json, int argc, char *const *argv);

/* Writes TABLE.json: the program, its version, its arguments, and what `tell` puts behind them (NULL: nothing). Returns 0,
 * also where the table is no file of its own (a pipe, /dev/stdout) and nothing is written; or -1 with the reason in
 * message. */
int experiment_write(const struct output_file *table, int argc, char *const *argv,
                     void (*tell)(struct json_writer *json, const void *context),
                     const void *context, char *message, size_t size);

/* Puts the table itself into its place, and TABLE.json with nothing but program and arguments beside it. Returns 0, or -1
 * with the reason in message. */
int experiment_commit_table(struct output_file *table, int argc, char *const *argv, char *message,
                            size_t size);

#endif
