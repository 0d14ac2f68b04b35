/* Chunks among the ranks of mpirun: rank 0 deals out numbers, gathers results and alone writes the file; it computes, too.
 *
 * A rank asks by sending its last result (nothing the first time); the answer is the next chunk's number, or
 * NOTHING_LEFT. Rank 0 looks for messages every 200 us, for a waiting MPI call would take a core. */
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "sim_host/batch/chunks_internal.h"

int chunks_ranks(void)
{
    const char *ranks = getenv("OMPI_COMM_WORLD_SIZE");
    return ranks == NULL ? 1 : (int)strtol(ranks, NULL, 10);
}

#ifdef BATCH_HAVE_MPI

#include <mpi.h>

#define NOTHING_LEFT UINT64_MAX
#define NO_RESULT UINT64_MAX
#define PAUSE_NS 200000
enum tag { TAG_ASK = 1, TAG_DEAL = 2 };

static void pause_a_little(void)
{
    const struct timespec moment = {0, PAUSE_NS};
    nanosleep(&moment, NULL);
}

/* A message's layout: the chunk's number, then its result. */
static void store_message(struct chunks_file *file, const unsigned char *message)
{
    uint64_t chunk;
    memcpy(&chunk, message, sizeof chunk);
    if (chunk != NO_RESULT) {
        chunks_store(file, (size_t)chunk, message + sizeof chunk);
    }
}

/* Serves the other ranks until each has been told that nothing is left. */
static void serve(struct chunks_file *file, int others)
{
    const int room = (int)(sizeof(uint64_t) + file->job->bytes);
    unsigned char *message = malloc((size_t)room);
    while (others > 0 && message != NULL) {
        int is_there = 0;
        MPI_Status from;
        MPI_Iprobe(MPI_ANY_SOURCE, TAG_ASK, MPI_COMM_WORLD, &is_there, &from);
        if (!is_there) {
            pause_a_little();
            continue;
        }
        MPI_Recv(message, room, MPI_BYTE, from.MPI_SOURCE, TAG_ASK, MPI_COMM_WORLD,
                 MPI_STATUS_IGNORE);
        store_message(file, message);
        const size_t next = chunks_deal(file);
        const uint64_t answer = next == CHUNKS_NONE ? NOTHING_LEFT : (uint64_t)next;
        others -= next == CHUNKS_NONE;
        MPI_Send(&answer, 1, MPI_UINT64_T, from.MPI_SOURCE, TAG_DEAL, MPI_COMM_WORLD);
    }
    free(message);
}

static void *work_beside(void *file)
{
    const struct chunks_job *job = ((struct chunks_file *)file)->job;
    chunks_work(file, job->threads > 0 ? job->threads : 1);
    return NULL;
}

static enum chunks_status lead(const struct chunks_job *job, int ranks)
{
    struct chunks_file file;
    pthread_t worker;
    enum chunks_status status = chunks_open(&file, job);
    if (status != CHUNKS_DONE) {
        file.missing_count = 0; /* nothing to deal: the others are sent home */
    }
    const int has_worker = pthread_create(&worker, NULL, work_beside, &file) == 0;
    serve(&file, ranks - 1);
    if (has_worker) {
        pthread_join(worker, NULL);
    }
    if (status == CHUNKS_DONE && (file.has_failed || file.stored < file.missing_count)) {
        status = CHUNKS_STOPPED;
    }
    chunks_close(&file);
    return status;
}

static enum chunks_status help(const struct chunks_job *job)
{
    const size_t room = sizeof(uint64_t) + job->bytes;
    unsigned char *message = malloc(room);
    uint64_t chunk = NO_RESULT;
    if (message == NULL) {
        MPI_Abort(MPI_COMM_WORLD, EXIT_FAILURE);
        return CHUNKS_NO_MEMORY;
    }
    memset(message, 0, room);
    for (;;) {
        MPI_Request answer;
        int has_answer = 0;
        const size_t length = chunk == NO_RESULT ? sizeof chunk : room;
        memcpy(message, &chunk, sizeof chunk);
        MPI_Send(message, (int)length, MPI_BYTE, 0, TAG_ASK, MPI_COMM_WORLD);
        MPI_Irecv(&chunk, 1, MPI_UINT64_T, 0, TAG_DEAL, MPI_COMM_WORLD, &answer);
        while (!has_answer) {
            MPI_Test(&answer, &has_answer, MPI_STATUS_IGNORE);
            if (!has_answer) {
                pause_a_little();
            }
        }
        if (chunk == NOTHING_LEFT) {
            break;
        }
        memset(message, 0, room);
        if (job->compute(job->context, (size_t)chunk, message + sizeof chunk) != 0) {
            chunk = NO_RESULT; /* rank 0 sees that one is missing */
        }
    }
    free(message);
    return CHUNKS_HELPED;
}

static void finish(void)
{
    int is_over = 0;
    MPI_Finalized(&is_over);
    if (!is_over) {
        MPI_Finalize();
    }
}

enum chunks_status chunks_run_ranks(const struct chunks_job *job)
{
    int provided = 0, ranks = 1, rank = 0, is_on = 0;
    MPI_Initialized(&is_on);
    if (!is_on) {
        MPI_Init_thread(NULL, NULL, MPI_THREAD_FUNNELED, &provided);
        atexit(finish);
    }
    MPI_Comm_size(MPI_COMM_WORLD, &ranks);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    return rank == 0 ? lead(job, ranks) : help(job);
}

#else

enum chunks_status chunks_run_ranks(const struct chunks_job *job)
{
    (void)job;
    return CHUNKS_NO_MPI;
}

#endif
