#include "sim_host/study/pool.h"

#include <pthread.h>
#include <sched.h>
#include <stdlib.h>

#define MOST_THREADS 256

struct pool {
    const struct pool_jobs *jobs;
    pthread_mutex_t lock;
    pthread_cond_t finished;
    unsigned char *done; /* per job */
    int next;
    int stop;
};

static void *work(void *argument)
{
    struct pool *pool = argument;
    pthread_mutex_lock(&pool->lock);
    while (!pool->stop && pool->next < pool->jobs->count) {
        const int i = pool->next++;
        pthread_mutex_unlock(&pool->lock);
        pool->jobs->compute(pool->jobs->context, i);
        pthread_mutex_lock(&pool->lock);
        pool->done[i] = 1;
        pthread_cond_signal(&pool->finished);
    }
    pthread_mutex_unlock(&pool->lock);
    return NULL;
}

static int take_in_order(struct pool *pool)
{
    const struct pool_jobs *jobs = pool->jobs;
    for (int i = jobs->first; i < jobs->count; i++) {
        pthread_mutex_lock(&pool->lock);
        while (!pool->done[i]) {
            pthread_cond_wait(&pool->finished, &pool->lock);
        }
        pthread_mutex_unlock(&pool->lock);
        if (!jobs->take(jobs->context, i)) {
            pthread_mutex_lock(&pool->lock);
            pool->stop = 1;
            pthread_mutex_unlock(&pool->lock);
            return 0;
        }
    }
    return 1;
}

int pool_run(const struct pool_jobs *jobs)
{
    pthread_t threads[MOST_THREADS];
    struct pool pool = {.jobs = jobs, .next = jobs->first};
    const int wanted = jobs->threads < MOST_THREADS ? jobs->threads : MOST_THREADS;
    int made = 0;
    if (jobs->count <= jobs->first) {
        return 1;
    }
    pool.done = calloc((size_t)jobs->count, 1);
    if (pool.done == NULL) {
        return 0;
    }
    pthread_mutex_init(&pool.lock, NULL);
    pthread_cond_init(&pool.finished, NULL);
    while (made < wanted && pthread_create(&threads[made], NULL, work, &pool) == 0) {
        made++;
    }
    const int complete = made > 0 && take_in_order(&pool);
    for (int i = 0; i < made; i++) {
        pthread_join(threads[i], NULL);
    }
    pthread_cond_destroy(&pool.finished);
    pthread_mutex_destroy(&pool.lock);
    free(pool.done);
    return complete;
}

int pool_processors(void)
{
    cpu_set_t set;
    CPU_ZERO(&set);
    const int count = sched_getaffinity(0, sizeof set, &set) == 0 ? CPU_COUNT(&set) : 1;
    return count > 1 ? count : 1;
}
