#include "sim_host/study/person/tuning_file.h"

#include <errno.h>
#include <inttypes.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "sim_host/cli/output_file.h"

enum { LINE_MAX_BYTES = 1024, NUMBERS_MOST = 2 + 3 * CMA_MOST + CMA_MOST * CMA_MOST };

/* The search's numbers in the order of the file. */
static int numbers_at(struct cma_es *search, double *at[NUMBERS_MOST])
{
    int count = 0;
    at[count++] = &search->sigma;
    at[count++] = &search->best_value;
    for (int i = 0; i < search->count; i++) {
        at[count++] = &search->mean[i];
        at[count++] = &search->path[i];
        at[count++] = &search->best[i];
        for (int j = 0; j < search->count; j++) {
            at[count++] = &search->matrix[i][j];
        }
    }
    return count;
}

static int read_search(FILE *stream, struct cma_es *search)
{
    double *at[NUMBERS_MOST];
    const int count = numbers_at(search, at);
    uint64_t *s = search->rng.s;
    if (fscanf(stream, "%d %" SCNu64 " %" SCNu64 " %" SCNu64 " %" SCNu64, &search->generations,
               &s[0], &s[1], &s[2], &s[3]) != 5) {
        return -1;
    }
    for (int i = 0; i < count; i++) {
        if (fscanf(stream, "%lf", at[i]) != 1) {
            return -1;
        }
    }
    return 0;
}

static bool is_of(FILE *stream, const char *head)
{
    char found[LINE_MAX_BYTES] = "";
    const size_t length = strlen(head);
    return fgets(found, sizeof found, stream) != NULL && strncmp(found, head, length) == 0 &&
           strcmp(found + length, "\n") == 0;
}

int tuning_file_read(const char *path, const char *head, struct cma_es *search, char *message,
                     size_t size)
{
    struct cma_es read = *search;
    FILE *stream = fopen(path, "r");
    int status = -1;
    if (stream == NULL && errno == ENOENT) {
        return 0;
    }
    if (stream == NULL) {
        snprintf(message, size, "%s: %s", path, strerror(errno));
        return -1;
    }
    if (!is_of(stream, head)) {
        snprintf(
            message, size,
            "%s: is of another tuning or none; give another --state, or the options of that one",
            path);
    } else if (read_search(stream, &read) != 0) {
        snprintf(message, size, "%s: is incomplete; remove it to begin anew", path);
    } else {
        *search = read;
        status = 0;
    }
    (void)fclose(stream);
    return status;
}

int tuning_file_write(const char *path, const char *head, const struct cma_es *search,
                      char *message, size_t size)
{
    static struct output_file file;
    struct cma_es written = *search;
    double *at[NUMBERS_MOST];
    const int count = numbers_at(&written, at);
    const uint64_t *s = written.rng.s;
    if (output_file_open(&file, path, message, size) != 0) {
        return -1;
    }
    fprintf(file.stream, "%s\n%d %" PRIu64 " %" PRIu64 " %" PRIu64 " %" PRIu64 "\n", head,
            written.generations, s[0], s[1], s[2], s[3]);
    for (int i = 0; i < count; i++) {
        fprintf(file.stream, "%.17g\n", *at[i]);
    }
    return output_file_commit(&file, message, size);
}
