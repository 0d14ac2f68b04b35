/* What an experiment was, beside its table: FILE.json names the whole of it for FILE, so that FILE itself
 * stays a plain table. */
#ifndef SIM_HOST_CLI_EXPERIMENT_H
#define SIM_HOST_CLI_EXPERIMENT_H

#include <stddef.h>

#include "sim_host/cli/json_writer.h"
#include "sim_host/cli/output_file.h"

struct experiment {
    struct output_file
        file; /* not open where the table is no file of its own (a pipe, /dev/stdout) */
    struct json_writer json;
};

/* Begins TABLE.json with the program, its version, its arguments. Returns 0, or -1 with the reason in
 * message; where the table is no regular file nothing is written, and experiment->file.stream is NULL. */
int experiment_begin(struct experiment *experiment, const struct output_file *table, int argc,
                     char *const *argv, char *message, size_t size);

/* Puts the program, its version and its arguments into an object that is open. */
void experiment_identity(struct json_writer *json, int argc, char *const *argv);

/* The same for a table of which nothing else is to be told than the program and its arguments; and the table itself is
 * put into its place before. Returns 0, or -1 with the reason in message. */
int experiment_commit_table(struct output_file *table, int argc, char *const *argv, char *message,
                            size_t size);

/* Ends the object and puts the file in its place. Returns 0, or -1 with the reason in message. */
int experiment_commit(struct experiment *experiment, char *message, size_t size);

#endif
