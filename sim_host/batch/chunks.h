/* Long work in chunks, done by threads or by the ranks of mpirun, with all results in one file.
 *
 * A chunk's result is a fixed number of bytes that depends on its number alone, and has its fixed place in the
 * file. The finished file is the same, byte for byte, for any number of threads and ranks and after any
 * interruption. A run that was interrupted goes on from its file. Each chunk carries a checksum: what a crash
 * left half written is computed again.
 * File: struct chunks_heading, one uint32_t per chunk (CRC-32 of its bytes; 0: not done), the results.
 */
#ifndef SIM_HOST_BATCH_CHUNKS_H
#define SIM_HOST_BATCH_CHUNKS_H

#include <stddef.h>
#include <stdint.h>

struct chunks_heading {
    char magic[8];
    uint64_t key, count, bytes;
};

/* Computes one chunk into result (zeroed before). Called from several threads at once. 0: good; else the run stops. */
typedef int chunks_compute_fn(void *context, size_t chunk, void *result);

struct chunks_job {
    const char *path; /* of the file; made or resumed */
    uint64_t key; /* of everything the results depend on: a file with another key is not touched */
    size_t count; /* chunks, > 0 */
    size_t bytes; /* of one chunk's result, > 0 */
    chunks_compute_fn *compute;
    void *context;
    int threads; /* per process; 0: all cores, under mpirun one */
    int is_progress_shown; /* on stderr: done, rate, time left; a line now and then where that is no terminal */
};

enum chunks_status {
    CHUNKS_DONE = 0,
    CHUNKS_HELPED = 1, /* this is a rank other than 0: its work is over, rank 0 has the results */
    CHUNKS_OTHER_FILE = -1, /* the file belongs to other work: remove it or name another */
    CHUNKS_NO_FILE = -2,    /* it cannot be made or written: errno says why */
    CHUNKS_STOPPED = -3,    /* compute gave up; what was done is in the file */
    CHUNKS_NO_MEMORY = -4,
    CHUNKS_NO_MPI = -5 /* started by mpirun, but built without MPI */
};

/* Runs what the file does not have yet. Under mpirun all ranks call it alike, from
 * their main threads. Blocks until all is done. */
enum chunks_status chunks_run(const struct chunks_job *job);

/* Reads chunk i of a finished file into result. 1 when it is there and whole. */
int chunks_read(const struct chunks_job *job, size_t chunk, void *result);

const char *chunks_status_name(enum chunks_status status);

/* FNV-1a over bytes, for keys: start with CHUNKS_KEY_START, go on with what it returns. */
#define CHUNKS_KEY_START 14695981039346656037u
uint64_t chunks_key(uint64_t key, const void *bytes, size_t count);

#endif
