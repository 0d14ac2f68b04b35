/* The stream of frames to another process: it carries every frame, and whoever reads it changes nothing. */
#include <check.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "hal/bus/bytes.h"
#include "hal/bus/frame_table.h"
#include "sim_host/log/black_box_log.h"
#include "sim_host/loop/frame_stream.h"

enum { TICKS = 1500 };

static struct loop_config config;
static struct loop loop, other;
static struct frame_stream stream;
static int ends[2];

static void set_up(void)
{
    struct subject subject;
    struct control_params params;
    char message[LOOP_MESSAGE_MAX] = "";
    subject_default(&subject);
    ck_assert_int_eq(subject_control_params(&subject, &params, message), 0);
    ck_assert_int_eq(loop_configure(&config, &subject, &params, 0.5, SENSORS_17BIT, 1, message), 0);
    ck_assert_int_eq(loop_init(&loop, &config, NULL, message), 0);
    ck_assert_int_eq(socketpair(AF_UNIX, SOCK_STREAM, 0, ends), 0);
    frame_stream_init(&stream, ends[0]);
    ck_assert(frame_stream_attach(&stream, &loop));
}

static void tear_down(void)
{
    close(ends[0]);
    close(ends[1]);
    loop_free(&loop);
}

struct count {
    uint64_t frames, sum;
};

static void tally(void *context, const struct sim_bus_event *event)
{
    struct count *count = (struct count *)context;
    if (event->kind == SIM_BUS_FRAME) {
        count->frames++;
        count->sum = count->sum * 31u + event->message.id + event->time_ns;
        for (int i = 0; i < event->message.length; i++) {
            count->sum = count->sum * 31u + event->message.data[i];
        }
    }
}

/* What the same walk is without anybody who looks. */
static struct count alone(unsigned ticks)
{
    struct count count = {0, 0};
    char message[LOOP_MESSAGE_MAX];
    ck_assert_int_eq(loop_init(&other, &config, NULL, message), 0);
    sim_bus_set_tap(&other.bus, tally, &count);
    for (unsigned i = 0; i < ticks; i++) {
        loop_tick(&other);
    }
    loop_free(&other);
    return count;
}

/* All records that are there now; returns how many. */
static unsigned take(struct frame_record *records, unsigned most)
{
    unsigned bytes = 0;
    ssize_t got;
    while (bytes < most * sizeof *records &&
           (got = recv(ends[1], (uint8_t *)records + bytes, most * sizeof *records - bytes,
                       MSG_DONTWAIT)) > 0) {
        bytes += (unsigned)got;
    }
    return bytes / (unsigned)sizeof *records;
}

START_TEST(every_frame_comes_out_as_it_was)
{
    static struct frame_record records[4096];
    struct count count = {0, 0};
    const struct count expected = alone(TICKS);
    unsigned begins = 0;
    for (unsigned i = 0; i < TICKS; i++) {
        loop_tick(&loop);
        frame_stream_serve(&stream);
        const unsigned n = take(records, 4096);
        for (unsigned k = 0; k < n; k++) {
            begins += records[k].id == FRAME_STREAM_BEGIN ? 1 : 0;
            count.frames += records[k].id <= CAN_ID_STANDARD_MAX ? 1 : 0;
        }
    }
    ck_assert_uint_eq(begins, 1);
    ck_assert_uint_eq(count.frames, expected.frames);
}
END_TEST

START_TEST(a_reader_that_never_reads_changes_nothing)
{
    struct count count = {0, 0};
    const struct count expected = alone(TICKS);
    stream.next_tap = tally;
    stream.next_context = &count;
    for (unsigned i = 0; i < TICKS; i++) {
        loop_tick(&loop);
        frame_stream_serve(&stream);
    }
    ck_assert_uint_eq(count.frames, expected.frames);
    ck_assert_uint_eq(count.sum, expected.sum);
    ck_assert(!stream.is_gone);
    ck_assert_uint_gt(stream.head - stream.tail, 0);
}
END_TEST

START_TEST(a_reader_that_hangs_up_changes_nothing)
{
    struct count count = {0, 0};
    const struct count expected = alone(TICKS);
    stream.next_tap = tally;
    stream.next_context = &count;
    for (unsigned i = 0; i < TICKS; i++) {
        loop_tick(&loop);
        frame_stream_serve(&stream);
        if (i == TICKS / 2) {
            close(ends[1]);
            ends[1] = -1;
        }
    }
    ck_assert_uint_eq(count.sum, expected.sum);
    ck_assert(stream.is_gone);
}
END_TEST

START_TEST(rubbish_does_not_reach_the_bus)
{
    struct count count = {0, 0};
    const struct count expected = alone(TICKS);
    static const uint32_t ids[] = {0x000, 0x080, 0x201,      0x301, 0x601,
                                   0x710, 0x7FF, 0xFFFFFFFF, 0x610};
    stream.next_tap = tally;
    stream.next_context = &count;
    for (unsigned i = 0; i < TICKS; i++) {
        struct frame_record record = {.id = ids[i % 9],
                                      .length = (uint8_t)(ids[i % 9] == 0x610 ? 7 : 8)};
        memset(record.data, (int)i, sizeof record.data);
        if (record.id == 0x601) {
            record.data[0] = 0x23; /* a drive's object is written by nobody but the controller */
        }
        ck_assert_int_eq(send(ends[1], &record, sizeof record, 0), 24);
        loop_tick(&loop);
        frame_stream_serve(&stream);
    }
    ck_assert_uint_eq(count.sum, expected.sum);
    ck_assert_uint_eq(stream.refused, TICKS);
}
END_TEST

/* 0x1000 of the left drive: what it is. */
START_TEST(a_nodes_object_is_read)
{
    static struct frame_record records[4096];
    const struct frame_record request = {.id = 0x601, .length = 8, .data = {0x40, 0x00, 0x10}};
    unsigned answers = 0;
    for (unsigned i = 0; i < 1400; i++) {
        if (i == 1200) { /* the controller's own set-up is over */
            ck_assert_int_eq(send(ends[1], &request, sizeof request, 0), 24);
        }
        loop_tick(&loop);
        frame_stream_serve(&stream);
        const unsigned n = take(records, 4096);
        for (unsigned k = 0; k < n; k++) {
            const bool is_type =
                records[k].id == 0x581 && records[k].data[1] == 0x00 && records[k].data[2] == 0x10;
            answers += i >= 1200 && is_type && bytes_get_u32(records[k].data + 4) % 65536 == 402;
        }
    }
    ck_assert_uint_ge(answers, 1);
    ck_assert_uint_eq(stream.refused, 0);
}
END_TEST

/* A read of the build id (0x2030:02), as canopen asks it, in two parts. */
START_TEST(an_sdo_request_is_answered_on_the_stream)
{
    static struct frame_record records[4096];
    struct frame_record request = {
        .id = FRAME_SDO_REQUEST_CONTROLLER, .length = 8, .data = {0x40, 0x30, 0x20, 0x02}};
    unsigned answers = 0;
    for (unsigned i = 0; i < 200; i++) {
        if (i == 100) {
            ck_assert_int_eq(send(ends[1], &request, 10, 0), 10);
        } else if (i == 110) {
            ck_assert_int_eq(send(ends[1], (const uint8_t *)&request + 10, 14, 0), 14);
        }
        loop_tick(&loop);
        frame_stream_serve(&stream);
        const unsigned n = take(records, 4096);
        for (unsigned k = 0; k < n; k++) {
            if (records[k].id == FRAME_SDO_ANSWER_CONTROLLER) {
                ck_assert_uint_gt(i, 109);
                ck_assert_uint_eq(records[k].data[0] >> 5, 2);
                answers++;
            }
        }
    }
    ck_assert_uint_eq(answers, 1);
}
END_TEST

START_TEST(a_snapshot_comes_when_it_is_asked_for)
{
    static struct frame_record records[8192];
    const struct frame_record request = {.id = FRAME_STREAM_SNAPSHOT};
    uint32_t size = 0, bytes = 0;
    for (unsigned i = 0; i < 300; i++) {
        if (i == 250) {
            ck_assert_int_eq(send(ends[1], &request, sizeof request, 0), sizeof request);
        }
        loop_tick(&loop);
        frame_stream_serve(&stream);
        const unsigned n = take(records, 8192);
        for (unsigned k = 0; k < n; k++) {
            const uint32_t id = records[k].id & CAN_ID_EXTENDED_MAX;
            if (records[k].id >> 31 == 1 && id == BLACK_BOX_ID_BEGIN) {
                size = bytes_get_u32(records[k].data + 4);
            } else if (records[k].id >> 31 == 1 && id >= BLACK_BOX_ID_DATA) {
                bytes += records[k].length;
            }
        }
    }
    ck_assert_uint_gt(size, 1000);
    ck_assert_uint_eq(bytes, size);
}
END_TEST

START_TEST(what_the_ring_does_not_take_is_counted_and_told)
{
    static struct frame_record records[4096];
    stream.head = (uint64_t)FRAME_STREAM_RECORDS * sizeof(struct frame_record);
    stream.tail = 0; /* full */
    for (unsigned i = 0; i < 100; i++) {
        loop_tick(&loop);
    }
    ck_assert_uint_gt(stream.lost, 0);
    const uint32_t lost = stream.lost;
    stream.tail = stream.head; /* it was read */
    loop_tick(&loop);
    frame_stream_serve(&stream);
    const unsigned n = take(records, 4096);
    ck_assert_uint_gt(n, 0);
    ck_assert_uint_eq(records[0].id, FRAME_STREAM_LOST);
    ck_assert_uint_eq(bytes_get_u32(records[0].data), lost);
    ck_assert_uint_eq(stream.lost, 0);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("frame_stream");
    TCase *test = tcase_create("all");
    tcase_add_checked_fixture(test, set_up, tear_down);
    tcase_add_test(test, a_nodes_object_is_read);
    tcase_add_test(test, every_frame_comes_out_as_it_was);
    tcase_add_test(test, a_reader_that_never_reads_changes_nothing);
    tcase_add_test(test, a_reader_that_hangs_up_changes_nothing);
    tcase_add_test(test, rubbish_does_not_reach_the_bus);
    tcase_add_test(test, an_sdo_request_is_answered_on_the_stream);
    tcase_add_test(test, a_snapshot_comes_when_it_is_asked_for);
    tcase_add_test(test, what_the_ring_does_not_take_is_counted_and_told);
    suite_add_tcase(suite, test);
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    const int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
