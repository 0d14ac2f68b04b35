/* Chunked work: the same file from any number of threads, after an interruption and after damage. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "sim_host/batch/chunks.h"
#include "tests/support/assert_close.h"

#define COUNT 37
#define BYTES 501

static char path[2][64];

struct filler {
    size_t stop_at; /* this chunk fails */
    int calls[COUNT];
};

static int fill(void *context, size_t chunk, void *result)
{
    struct filler *filler = context;
    unsigned char *byte = result;
    if (chunk == filler->stop_at) {
        return 1;
    }
    filler->calls[chunk]++;
    for (size_t i = 0; i < BYTES; i++) {
        byte[i] = (unsigned char)(chunk * 31 + i * i);
    }
    return 0;
}

static struct chunks_job job_of(struct filler *filler, const char *file, int threads)
{
    const struct chunks_job job = {.path = file,
                                   .key = chunks_key(CHUNKS_KEY_START, "test", 4),
                                   .count = COUNT,
                                   .bytes = BYTES,
                                   .compute = fill,
                                   .context = filler,
                                   .threads = threads};
    return job;
}

static size_t contents(const char *file, unsigned char *bytes, size_t room)
{
    FILE *stream = fopen(file, "rb");
    ck_assert_ptr_nonnull(stream);
    const size_t count = fread(bytes, 1, room, stream);
    fclose(stream);
    return count;
}

static void assert_same_files(void)
{
    static unsigned char a[COUNT * (BYTES + 4) + 100], b[sizeof a];
    const size_t count = contents(path[0], a, sizeof a);
    ck_assert_uint_eq(count, sizeof(struct chunks_heading) + COUNT * (BYTES + 4));
    ck_assert_uint_eq(contents(path[1], b, sizeof b), count);
    ck_assert_mem_eq(a, b, count);
}

static void set_up(void)
{
    for (int i = 0; i < 2; i++) {
        strcpy(path[i], "/tmp/chunks-test-XXXXXX");
        const int handle = mkstemp(path[i]);
        ck_assert_int_ge(handle, 0);
        close(handle);
    }
}

static void tear_down(void)
{
    unlink(path[0]);
    unlink(path[1]);
}

START_TEST(threads_and_interruptions_leave_no_trace)
{
    struct filler whole = {.stop_at = COUNT}, broken = {.stop_at = 17}, rest = {.stop_at = COUNT};
    struct chunks_job job = job_of(&whole, path[0], 1);
    ck_assert_int_eq(chunks_run(&job), CHUNKS_DONE);
    job = job_of(&broken, path[1], 3);
    ck_assert_int_eq(chunks_run(&job), CHUNKS_STOPPED);
    job = job_of(&rest, path[1], 2);
    ck_assert_int_eq(chunks_run(&job), CHUNKS_DONE);
    assert_same_files();
    for (int i = 0; i < COUNT; i++) {
        ck_assert_int_eq(whole.calls[i], 1);
        ck_assert_int_eq(broken.calls[i] + rest.calls[i], 1);
    }
}
END_TEST

START_TEST(damage_is_found_and_repaired)
{
    struct filler first = {.stop_at = COUNT}, again = {.stop_at = COUNT};
    unsigned char result[BYTES];
    struct chunks_job job = job_of(&first, path[0], 1);
    ck_assert_int_eq(chunks_run(&job), CHUNKS_DONE);
    job.path = path[1];
    ck_assert_int_eq(chunks_run(&job), CHUNKS_DONE);
    FILE *stream = fopen(path[1], "rb+");
    ck_assert_ptr_nonnull(stream);
    fseek(stream, (long)(sizeof(struct chunks_heading) + COUNT * 4 + 5 * BYTES + 3), SEEK_SET);
    fputc('?', stream);
    fclose(stream);
    job = job_of(&again, path[1], 1);
    ck_assert_int_eq(chunks_read(&job, 5, result), 0);
    ck_assert_int_eq(chunks_read(&job, 6, result), 1);
    ck_assert_int_eq(chunks_run(&job), CHUNKS_DONE);
    ck_assert_int_eq(again.calls[5], 1);
    ck_assert_int_eq(again.calls[6], 0);
    assert_same_files();
}
END_TEST

START_TEST(a_file_of_other_work_is_not_touched)
{
    struct filler filler = {.stop_at = COUNT};
    struct chunks_job job = job_of(&filler, path[0], 1);
    ck_assert_int_eq(chunks_run(&job), CHUNKS_DONE);
    job.path = path[1];
    ck_assert_int_eq(chunks_run(&job), CHUNKS_DONE);
    job.key++;
    ck_assert_int_eq(chunks_run(&job), CHUNKS_OTHER_FILE);
    assert_same_files();
    job.path = "/nowhere/at/all";
    ck_assert_int_eq(chunks_run(&job), CHUNKS_NO_FILE);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("chunks");
    TCase *tests = tcase_create("chunks");
    suite_add_tcase(suite, tests);
    tcase_add_checked_fixture(tests, set_up, tear_down);
    tcase_add_test(tests, threads_and_interruptions_leave_no_trace);
    tcase_add_test(tests, damage_is_found_and_repaired);
    tcase_add_test(tests, a_file_of_other_work_is_not_touched);
    return run_suite(suite);
}
