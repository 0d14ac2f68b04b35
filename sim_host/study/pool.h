/* Runs independent jobs on all cores and hands their results over in order, so that output is the same
 * for any number of threads. */
#ifndef SIM_HOST_STUDY_POOL_H
#define SIM_HOST_STUDY_POOL_H

struct pool_jobs {
    int first, count; /* jobs first .. count-1 */
    int threads;      /* >= 1 */
    void *context;
    /* Computes job i; runs on any thread; must depend on i and the read-only parts of the context alone. */
    void (*compute)(void *context, int i);
    /* Takes the result of job i; called on the caller's thread, in order. Return 0 to stop. */
    int (*take)(void *context, int i);
};

/* Returns 1 when all jobs were taken, 0 when stopped or threads could not be made. */
int pool_run(const struct pool_jobs *jobs);

/* The number of processors this process may use, at least 1. */
int pool_processors(void);

#endif
