#include "sim_host/batch/pool.h"

#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>

#define POOL_MAX_THREADS 256

struct pool {
    pool_piece_fn *piece;
    void *context;
    size_t pieces;
    atomic_size_t next;
    atomic_int stopped; /* a piece's non-zero value */
};

int pool_threads(int threads)
{
    if (threads <= 0) {
        cpu_set_t mine;
        CPU_ZERO(&mine);
        threads = sched_getaffinity(0, sizeof mine, &mine) == 0 ? CPU_COUNT(&mine) : 1;
    }
    return threads > POOL_MAX_THREADS ? POOL_MAX_THREADS : threads;
}

static void *work(void *argument)
{
    struct pool *pool = argument;
    while (atomic_load(&pool->stopped) == 0) {
        const size_t piece = atomic_fetch_add(&pool->next, 1);
        if (piece >= pool->pieces) {
            break;
        }
        const int result = pool->piece(pool->context, piece);
        int none = 0;
        if (result != 0) {
            atomic_compare_exchange_strong(&pool->stopped, &none, result);
        }
    }
    return NULL;
}

int pool_run(int threads, size_t pieces, pool_piece_fn *piece, void *context)
{
    struct pool pool = {.piece = piece, .context = context, .pieces = pieces};
    pthread_t helper[POOL_MAX_THREADS];
    int helpers = 0;
    atomic_init(&pool.next, 0);
    atomic_init(&pool.stopped, 0);
    const int wanted = pool_threads(threads) - 1;
    while (helpers < wanted && (size_t)helpers + 1 < pieces &&
           pthread_create(&helper[helpers], NULL, work, &pool) == 0) {
        helpers++;
    }
    work(&pool);
    for (int i = 0; i < helpers; i++) {
        pthread_join(helper[i], NULL);
    }
    return atomic_load(&pool.stopped);
}
