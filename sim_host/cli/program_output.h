/* A command's optional output files: what cannot be opened or kept is complained of. */
#ifndef SIM_HOST_CLI_PROGRAM_OUTPUT_H
#define SIM_HOST_CLI_PROGRAM_OUTPUT_H

#include "sim_host/cli/experiment.h"
#include "sim_host/cli/output_file.h"

/* Opens path for writing; with no path (NULL), a file that is not open. Returns 0, or -1 when it has
 * complained. */
int program_open_output(struct output_file *file, const char *path);

/* Keeps what was written; nothing for a file that is not open. Returns 0, or -1 when it has complained. */
int program_commit_output(struct output_file *file);

/* The same for a table, and FILE.json beside it (experiment_write()). */
int program_commit_table(struct output_file *table, int argc, char *const *argv,
                         void (*tell)(struct json_writer *json, const void *context),
                         const void *context);

#endif
