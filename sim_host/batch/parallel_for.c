#include "sim_host/batch/parallel_for.h"

#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>

#define PIECES_MAX_THREADS 256

struct pieces {
    piece_fn *piece;
    void *context;
    size_t pieces;
    atomic_size_t next;
    atomic_int stopped; /* a piece's non-zero value */
};

int parallel_for_threads(int threads)
{
    if (threads <= 0) {
        cpu_set_t mine;
        CPU_ZERO(&mine);
        threads = sched_getaffinity(0, sizeof mine, &mine) == 0 ? CPU_COUNT(&mine) : 1;
    }
    return threads > PIECES_MAX_THREADS ? PIECES_MAX_THREADS : threads;
}

static void *work(void *argument)
{
    struct pieces *all = argument;
    while (atomic_load(&all->stopped) == 0) {
        const size_t piece = atomic_fetch_add(&all->next, 1);
        if (piece >= all->pieces) {
            break;
        }
        const int result = all->piece(all->context, piece);
        int none = 0;
        if (result != 0) {
            atomic_compare_exchange_strong(&all->stopped, &none, result);
        }
    }
    return NULL;
}

int parallel_for(int threads, size_t pieces, piece_fn *piece, void *context)
{
    struct pieces all = {.piece = piece, .context = context, .pieces = pieces};
    pthread_t helper[PIECES_MAX_THREADS];
    int helpers = 0;
    atomic_init(&all.next, 0);
    atomic_init(&all.stopped, 0);
    const int wanted = parallel_for_threads(threads) - 1;
    while (helpers < wanted && (size_t)helpers + 1 < pieces &&
           pthread_create(&helper[helpers], NULL, work, &all) == 0) {
        helpers++;
    }
    work(&all);
    for (int i = 0; i < helpers; i++) {
        pthread_join(helper[i], NULL);
    }
    return atomic_load(&all.stopped);
}
