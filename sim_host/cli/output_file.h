/* An output file that appears whole or not at all.
 *
 * Written beside its place under a temporary name and renamed when committed, so
 * that a run which fails or is interrupted leaves no file that passes for a whole one,
 * and keeps the old one. Devices and pipes (/dev/stdout) are written directly.
 */
#ifndef SIM_HOST_CLI_OUTPUT_FILE_H
#define SIM_HOST_CLI_OUTPUT_FILE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

enum { OUTPUT_PATH_MAX = 4096, OUTPUT_SUFFIX_MAX = 32 };

struct output_file {
    FILE *stream; /* NULL when not open */
    bool direct;
    char path[OUTPUT_PATH_MAX];
    char temporary[OUTPUT_PATH_MAX + OUTPUT_SUFFIX_MAX];
};

/* Opens for writing. Returns 0, or -1 with path and reason in message. */
int output_file_open(struct output_file *file, const char *path, char *message, size_t size);

/* Completes the file: flush, check every error since opening, rename. Returns 0,
 * or -1 with the reason in message; then the temporary file is gone. */
int output_file_commit(struct output_file *file, char *message, size_t size);

/* The same for a run that was broken off: what it has written becomes PATH.part, in the place of
 * an older one, and PATH stays as it was. A device or a pipe has got it already. */
int output_file_keep_part(struct output_file *file, char *message, size_t size);

/* Throws away what was written; nothing happens on a file that is not open. */
void output_file_discard(struct output_file *file);

#endif
