#include "sim_host/batch/chunks.h"

#include "sim_host/batch/chunks_internal.h"

uint64_t chunks_key(uint64_t key, const void *bytes, size_t count)
{
    const unsigned char *byte = bytes;
    for (size_t i = 0; i < count; i++) {
        key = (key ^ byte[i]) * 1099511628211u;
    }
    return key;
}

enum chunks_status chunks_run(const struct chunks_job *job)
{
    struct chunks_file file;
    if (chunks_ranks() > 1) {
        return chunks_run_ranks(job);
    }
    enum chunks_status status = chunks_open(&file, job);
    if (status == CHUNKS_DONE) {
        chunks_work(&file, job->threads);
        status = file.has_failed ? CHUNKS_STOPPED : CHUNKS_DONE;
    }
    chunks_close(&file);
    return status;
}

const char *chunks_status_name(enum chunks_status status)
{
    switch (status) {
    case CHUNKS_DONE:
        return "done";
    case CHUNKS_HELPED:
        return "helped rank 0";
    case CHUNKS_OTHER_FILE:
        return "the file holds other work: remove it, or name another";
    case CHUNKS_NO_FILE:
        return "the file cannot be made or written";
    case CHUNKS_STOPPED:
        return "stopped on the way; run again to go on from what the file has";
    case CHUNKS_NO_MEMORY:
        return "out of memory";
    case CHUNKS_NO_MPI:
        return "started by mpirun, but this program is without MPI: take build/afo-mpi, which is built where libopenmpi-dev is installed";
    }
    return "unknown status";
}
