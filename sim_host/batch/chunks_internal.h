/* What the files of chunks.h share: the results file, the queue of what is missing in it, and the run
 * among the ranks of mpirun. Private to sim_host/batch. */
#ifndef SIM_HOST_BATCH_CHUNKS_INTERNAL_H
#define SIM_HOST_BATCH_CHUNKS_INTERNAL_H

#include <pthread.h>

#include "sim_host/batch/chunks.h"

#define CHUNKS_NONE ((size_t)-1)

struct chunks_file {
    const struct chunks_job *job;
    int handle;
    size_t *missing;             /* chunk numbers to do */
    size_t missing_count, dealt; /* dealt: of those, handed out */
    size_t stored;               /* in this run */
    int has_failed;              /* a write failed, or compute gave up */
    double started_s, shown_s;
    pthread_mutex_t lock; /* of all above but job and handle */
};

enum chunks_status chunks_open(struct chunks_file *file, const struct chunks_job *job);
void chunks_close(struct chunks_file *file);

/* The next chunk to do, CHUNKS_NONE when all are dealt or the run has failed. Any thread. */
size_t chunks_deal(struct chunks_file *file);

/* Stores a chunk's result, and shows progress. Any thread. */
void chunks_store(struct chunks_file *file, size_t chunk, const void *result);
void chunks_fail(struct chunks_file *file);

/* The threads of one process work until nothing is left to deal; returns when they are done. */
void chunks_work(struct chunks_file *file, int threads);

/* MPI: whether mpirun started this process together with others; and the run among them. */
int chunks_ranks(void);
enum chunks_status chunks_run_ranks(const struct chunks_job *job);

#endif
