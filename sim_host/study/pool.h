/* Runs the independent jobs of a study on all cores (parallel_for.h), and collects their results in order.
 *
 * So output is the same for any number of threads. */
#ifndef SIM_HOST_STUDY_POOL_H
#define SIM_HOST_STUDY_POOL_H

struct pool_jobs {
    int first, count; /* jobs first .. count-1 */
    int threads;      /* >= 1 */
    void *context;
    /* Computes job i. Runs on any thread. It must depend on i and the read-only parts of the context alone. */
    void (*compute)(void *context, int i);
    /* Collects the result of job i. Called in the order of i, never twice at a time, from any thread; other
     * threads may wait meanwhile, so keep it short. Returns 0 to stop. NULL: results stay where they are. */
    int (*collect)(void *context, int i);
};

/* Returns 1 when all jobs were done and collected, 0 when collect() stopped or there was no memory. A thread
 * that cannot be started is done without. */
int pool_run(const struct pool_jobs *jobs);

/* The number of processors this process may use, at least 1. */
int pool_processors(void);

#endif
