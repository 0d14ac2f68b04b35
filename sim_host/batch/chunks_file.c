/* The file of results: what it has, what is missing, and the threads that compute that. */
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "sim_host/batch/chunks_internal.h"
#include "sim_host/batch/parallel_for.h"

/* Between two lines of progress, seconds: a terminal's is replaced, a log's stays. */
#define TERMINAL_S 0.5
#define LOG_S 30.0

static const char magic[8] = {'A', 'F', 'O', 'C', 'H', 'N', 'K', '1'};

/* CRC-32 (IEEE 802.3), never 0: that means not done. */
static uint32_t checksum(const void *bytes, size_t count)
{
    const unsigned char *byte = bytes;
    uint32_t crc = 0xFFFFFFFFu;
    for (size_t i = 0; i < count; i++) {
        crc ^= byte[i];
        for (int bit = 0; bit < 8; bit++) {
            crc = (crc >> 1) ^ ((crc & 1u) != 0 ? 0xEDB88320u : 0u);
        }
    }
    const uint32_t sum = crc ^ 0xFFFFFFFFu;
    return sum == 0u ? 1u : sum;
}

static off_t place_of_mark(size_t chunk)
{
    return (off_t)(sizeof(struct chunks_heading) + chunk * sizeof(uint32_t));
}

static off_t place_of_result(const struct chunks_job *job, size_t chunk)
{
    return place_of_mark(job->count) + (off_t)(chunk * job->bytes);
}

static int read_all(int handle, void *to, size_t count, off_t at)
{
    char *byte = to;
    while (count > 0) {
        const ssize_t got = pread(handle, byte, count, at);
        if (got <= 0 && !(got < 0 && errno == EINTR)) {
            return 0;
        }
        const size_t step = got > 0 ? (size_t)got : 0;
        byte += step;
        count -= step;
        at += (off_t)step;
    }
    return 1;
}

static int write_all(int handle, const void *from, size_t count, off_t at)
{
    const char *byte = from;
    while (count > 0) {
        const ssize_t put = pwrite(handle, byte, count, at);
        if (put <= 0 && !(put < 0 && errno == EINTR)) {
            return 0;
        }
        const size_t step = put > 0 ? (size_t)put : 0;
        byte += step;
        count -= step;
        at += (off_t)step;
    }
    return 1;
}

/* 1 when the file holds chunk's whole result. */
static int has_chunk(const struct chunks_job *job, int handle, size_t chunk, void *result)
{
    uint32_t mark = 0;
    return read_all(handle, &mark, sizeof mark, place_of_mark(chunk)) && mark != 0 &&
           read_all(handle, result, job->bytes, place_of_result(job, chunk)) &&
           mark == checksum(result, job->bytes);
}

int chunks_read(const struct chunks_job *job, size_t chunk, void *result)
{
    const int handle = open(job->path, O_RDONLY | O_CLOEXEC);
    const int is_there = handle >= 0 && has_chunk(job, handle, chunk, result);
    if (handle >= 0) {
        close(handle);
    }
    return is_there;
}

static enum chunks_status check_heading(struct chunks_file *file)
{
    const struct chunks_job *job = file->job;
    struct chunks_heading heading, want = {{0}, job->key, job->count, job->bytes};
    memcpy(want.magic, magic, sizeof magic);
    const off_t length = lseek(file->handle, 0, SEEK_END);
    if (length < (off_t)sizeof heading) {
        const int is_made = ftruncate(file->handle, place_of_result(job, job->count)) == 0 &&
                            write_all(file->handle, &want, sizeof want, 0);
        return is_made ? CHUNKS_DONE : CHUNKS_NO_FILE;
    }
    if (!read_all(file->handle, &heading, sizeof heading, 0)) {
        return CHUNKS_NO_FILE;
    }
    return memcmp(&heading, &want, sizeof want) == 0 && length == place_of_result(job, job->count)
               ? CHUNKS_DONE
               : CHUNKS_OTHER_FILE;
}

static double now_s(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

enum chunks_status chunks_open(struct chunks_file *file, const struct chunks_job *job)
{
    *file = (struct chunks_file){.job = job, .started_s = now_s()};
    pthread_mutex_init(&file->lock, NULL);
    file->handle = open(job->path, O_RDWR | O_CREAT | O_CLOEXEC, 0644);
    if (file->handle < 0) {
        return CHUNKS_NO_FILE;
    }
    const enum chunks_status status = check_heading(file);
    void *result = malloc(job->bytes);
    file->missing = malloc(job->count * sizeof *file->missing);
    if (status != CHUNKS_DONE || result == NULL || file->missing == NULL) {
        free(result);
        return status != CHUNKS_DONE ? status : CHUNKS_NO_MEMORY;
    }
    for (size_t i = 0; i < job->count; i++) {
        if (!has_chunk(job, file->handle, i, result)) {
            file->missing[file->missing_count++] = i;
        }
    }
    free(result);
    return CHUNKS_DONE;
}

void chunks_close(struct chunks_file *file)
{
    if (file->handle >= 0) {
        close(file->handle);
    }
    free(file->missing);
    pthread_mutex_destroy(&file->lock);
}

size_t chunks_deal(struct chunks_file *file)
{
    pthread_mutex_lock(&file->lock);
    const size_t chunk = file->dealt < file->missing_count && !file->has_failed
                             ? file->missing[file->dealt++]
                             : CHUNKS_NONE;
    pthread_mutex_unlock(&file->lock);
    return chunk;
}

void chunks_fail(struct chunks_file *file)
{
    pthread_mutex_lock(&file->lock);
    file->has_failed = 1;
    pthread_mutex_unlock(&file->lock);
}

static void show(struct chunks_file *file)
{
    const double now = now_s(), spent = now - file->started_s;
    const size_t left = file->missing_count - file->stored;
    const int is_terminal = isatty(STDERR_FILENO);
    const double since = file->shown_s > 0.0 ? file->shown_s : file->started_s;
    if (file->job->is_progress_shown &&
        (now - since > (is_terminal ? TERMINAL_S : LOG_S) || (left == 0 && is_terminal))) {
        file->shown_s = now;
        fprintf(stderr, "%s%zu of %zu chunks, %.2f a second, %.0f s left%s",
                is_terminal ? "\r" : "", file->job->count - left, file->job->count,
                (double)file->stored / spent, spent * (double)left / (double)file->stored,
                !is_terminal || left == 0 ? "\n" : "   ");
    }
}

void chunks_store(struct chunks_file *file, size_t chunk, const void *result)
{
    const struct chunks_job *job = file->job;
    const uint32_t mark = checksum(result, job->bytes);
    const int is_good = write_all(file->handle, result, job->bytes, place_of_result(job, chunk)) &&
                        write_all(file->handle, &mark, sizeof mark, place_of_mark(chunk));
    pthread_mutex_lock(&file->lock);
    file->stored++;
    file->has_failed |= !is_good;
    show(file);
    pthread_mutex_unlock(&file->lock);
}

/* One thread's work: a piece that goes on until nothing is left. */
static int work(void *context, size_t thread)
{
    struct chunks_file *file = context;
    (void)thread;
    void *result = malloc(file->job->bytes);
    if (result == NULL) {
        chunks_fail(file);
        return 1;
    }
    for (size_t chunk = chunks_deal(file); chunk != CHUNKS_NONE; chunk = chunks_deal(file)) {
        memset(result, 0, file->job->bytes);
        if (file->job->compute(file->job->context, chunk, result) != 0) {
            chunks_fail(file);
        } else {
            chunks_store(file, chunk, result);
        }
    }
    free(result);
    return 0;
}

void chunks_work(struct chunks_file *file, int threads)
{
    parallel_for(threads, (size_t)parallel_for_threads(threads), work, file);
}
