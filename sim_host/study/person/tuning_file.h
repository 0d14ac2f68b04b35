/* The state of a tuning as a file: a line that says of which tuning, and the search's numbers. */
#ifndef SIM_HOST_STUDY_PERSON_TUNING_FILE_H
#define SIM_HOST_STUDY_PERSON_TUNING_FILE_H

#include <stddef.h>

#include "sim_host/study/person/cma_es.h"

/* Takes the search from the file; no such file: nothing happens. head: the line, without its end. Returns 0, or -1 with
 * the reason in message (size bytes): not such a file, incomplete, or with another line. */
int tuning_file_read(const char *path, const char *head, struct cma_es *search, char *message,
                     size_t size);

/* Writes it, whole or not at all. Returns 0 or -1 with the reason. */
int tuning_file_write(const char *path, const char *head, const struct cma_es *search,
                      char *message, size_t size);

#endif
