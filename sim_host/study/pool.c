#include "sim_host/study/pool.h"

#include <pthread.h>
#include <stdlib.h>

#include "sim_host/batch/parallel_for.h"

struct pool {
    const struct pool_jobs *jobs;
    pthread_mutex_t lock; /* of what follows, and of calling collect() */
    unsigned char *done;  /* per job */
    int next;             /* first job that is not collected */
};

/* Hands over what is complete in order. 1: collect() wants no more. */
static int collect_in_order(struct pool *pool)
{
    const struct pool_jobs *jobs = pool->jobs;
    while (pool->next >= 0 && pool->next < jobs->count && pool->done[pool->next]) {
        pool->next = jobs->collect(jobs->context, pool->next) ? pool->next + 1 : -1;
    }
    return pool->next < 0;
}

static int do_job(void *context, size_t piece)
{
    struct pool *pool = context;
    const struct pool_jobs *jobs = pool->jobs;
    const int i = jobs->first + (int)piece;
    int is_stopped = 0;
    jobs->compute(jobs->context, i);
    if (jobs->collect != NULL) {
        pthread_mutex_lock(&pool->lock);
        pool->done[i] = 1;
        is_stopped = collect_in_order(pool);
        pthread_mutex_unlock(&pool->lock);
    }
    return is_stopped;
}

int pool_run(const struct pool_jobs *jobs)
{
    struct pool pool = {.jobs = jobs, .next = jobs->first};
    if (jobs->count <= jobs->first) {
        return 1;
    }
    pool.done = calloc((size_t)jobs->count, 1);
    if (pool.done == NULL) {
        return 0;
    }
    pthread_mutex_init(&pool.lock, NULL);
    const int status =
        parallel_for(jobs->threads, (size_t)(jobs->count - jobs->first), do_job, &pool);
    pthread_mutex_destroy(&pool.lock);
    free(pool.done);
    return status == 0;
}

int pool_processors(void)
{
    return parallel_for_threads(0);
}
