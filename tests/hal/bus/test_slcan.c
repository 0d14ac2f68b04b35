/* The codec against lines as the LAWICEL manual and the Linux kernel's slcan
 * driver write them down, and against itself for every kind of frame. */
#include "hal/bus/slcan.h"

#include <stddef.h>
#include <string.h>

#include "tests/support/assert_close.h"

/* A message without the padding at its end. */
enum { MESSAGE_BYTES = offsetof(struct can_msg, data) + CAN_FRAME_DATA_MAX };

static enum slcan_event feed(struct slcan_decoder *decoder, const char *text)
{
    enum slcan_event event = SLCAN_NOTHING;

    for (; *text != '\0'; text++) {
        event = slcan_decode(decoder, *text);
    }
    return event;
}

START_TEST(examples_of_the_manual_are_understood)
{
    /* LAWICEL CANUSB manual, commands t, T, r: "t10021133", "T0000010021133", "r1002". */
    struct slcan_decoder decoder;

    slcan_decoder_init(&decoder);
    ck_assert_int_eq(feed(&decoder, "t10021133\r"), SLCAN_FRAME);
    ck_assert_uint_eq(decoder.message.id, 0x100);
    ck_assert_uint_eq(decoder.message.length, 2);
    ck_assert_uint_eq(decoder.message.flags, 0);
    ck_assert_uint_eq(decoder.message.data[0], 0x11);
    ck_assert_uint_eq(decoder.message.data[1], 0x33);

    ck_assert_int_eq(feed(&decoder, "T0000010021133\r"), SLCAN_FRAME);
    ck_assert_uint_eq(decoder.message.id, 0x100);
    ck_assert_uint_eq(decoder.message.flags, CAN_FRAME_EXTENDED);

    ck_assert_int_eq(feed(&decoder, "r1002\r"), SLCAN_FRAME);
    ck_assert_uint_eq(decoder.message.length, 2);
    ck_assert_uint_eq(decoder.message.flags, CAN_FRAME_REMOTE);

    /* Linux kernel, drivers/net/can/slcan: "t1230", "t4563112233", "T12ABCDEF2AA55", "r1230". */
    ck_assert_int_eq(feed(&decoder, "t1230\r"), SLCAN_FRAME);
    ck_assert_uint_eq(decoder.message.id, 0x123);
    ck_assert_uint_eq(decoder.message.length, 0);
    ck_assert_int_eq(feed(&decoder, "t4563112233\r"), SLCAN_FRAME);
    ck_assert_uint_eq(decoder.message.id, 0x456);
    ck_assert_uint_eq(decoder.message.data[2], 0x33);
    ck_assert_int_eq(feed(&decoder, "T12ABCDEF2AA55\r"), SLCAN_FRAME);
    ck_assert_uint_eq(decoder.message.id, 0x12ABCDEF);
    ck_assert_uint_eq(decoder.message.data[0], 0xAA);

    /* Adapters that write hex digits small are understood too. */
    ck_assert_int_eq(feed(&decoder, "T12abcdef2af50\r"), SLCAN_FRAME);
    ck_assert_uint_eq(decoder.message.id, 0x12ABCDEF);
    ck_assert_uint_eq(decoder.message.data[0], 0xAF);
    ck_assert_int_eq(feed(&decoder, "t1g00\r"), SLCAN_MALFORMED); /* behind f there is none */
    decoder.malformed = UINT32_MAX;
    ck_assert_int_eq(feed(&decoder, "t1g00\r"), SLCAN_MALFORMED);
    ck_assert_uint_eq(decoder.malformed, UINT32_MAX);
}
END_TEST

static void assert_line(const struct can_msg *message, const char *want)
{
    char line[SLCAN_LINE_MAX];
    size_t length = slcan_encode(message, line);

    ck_assert_uint_eq(length, strlen(want));
    ck_assert_mem_eq(line, want, length);
}

START_TEST(frames_are_written_as_the_manual_does)
{
    struct can_msg standard = {0x100, 2, 0, {0x11, 0x33}};
    struct can_msg extended = {0x12ABCDEF, 2, CAN_FRAME_EXTENDED, {0xAA, 0x55}};
    struct can_msg remote = {0x100, 2, CAN_FRAME_REMOTE, {0}};
    struct can_msg full = {0x7FF, 8, CAN_FRAME_OWN, {0, 1, 2, 3, 0xFC, 0xFD, 0xFE, 0xFF}};

    assert_line(&standard, "t10021133\r");
    assert_line(&extended, "T12ABCDEF2AA55\r");
    assert_line(&remote, "r1002\r");
    assert_line(&full, "t7FF800010203FCFDFEFF\r");
}
END_TEST

START_TEST(what_is_no_frame_is_not_written)
{
    char line[SLCAN_LINE_MAX];
    struct can_msg too_long = {0x100, 9, 0, {0}};
    struct can_msg wide = {0x800, 0, 0, {0}};
    struct can_msg wider = {0x20000000, 0, CAN_FRAME_EXTENDED, {0}};
    struct can_msg error = {0, 0, CAN_FRAME_ERROR, {0}};

    ck_assert_uint_eq(slcan_encode(&too_long, line), 0);
    ck_assert_uint_eq(slcan_encode(&wide, line), 0);
    ck_assert_uint_eq(slcan_encode(&wider, line), 0);
    ck_assert_uint_eq(slcan_encode(&error, line), 0);
}
END_TEST

START_TEST(every_length_and_kind_comes_back)
{
    struct slcan_decoder decoder;
    char line[SLCAN_LINE_MAX];

    slcan_decoder_init(&decoder);
    for (uint8_t length = 0; length <= 8; length++) {
        for (unsigned kind = 0; kind < 4; kind++) {
            struct can_msg message = {
                (kind & 1) ? 0x1FFFFFFFU : 0x5A5U, length, (uint8_t)kind, {0}};
            for (uint8_t i = 0; i < length && !(kind & CAN_FRAME_REMOTE); i++) {
                message.data[i] = (uint8_t)(0x9E + 37 * i);
            }
            size_t used = slcan_encode(&message, line);
            ck_assert_uint_gt(used, 0);
            enum slcan_event event = SLCAN_NOTHING;
            for (size_t i = 0; i < used; i++) {
                ck_assert_int_eq(event, SLCAN_NOTHING);
                event = slcan_decode(&decoder, line[i]);
            }
            ck_assert_int_eq(event, SLCAN_FRAME);
            ck_assert_mem_eq(&decoder.message, &message, MESSAGE_BYTES);
        }
    }
    ck_assert_uint_eq(decoder.malformed, 0);
}
END_TEST

START_TEST(answers_are_told_apart)
{
    struct slcan_decoder decoder;

    slcan_decoder_init(&decoder);
    ck_assert_int_eq(feed(&decoder, "z\r"), SLCAN_ACKNOWLEDGED);
    ck_assert_int_eq(feed(&decoder, "Z\r"), SLCAN_ACKNOWLEDGED);
    ck_assert_int_eq(feed(&decoder, "\r"), SLCAN_DONE);
    ck_assert_int_eq(feed(&decoder, "\a"), SLCAN_REFUSED);
    ck_assert_int_eq(feed(&decoder, "V1013\r"), SLCAN_OTHER);
    ck_assert_str_eq(decoder.line, "V1013");
    ck_assert_int_eq(feed(&decoder, "t10\a"), SLCAN_REFUSED); /* a bell ends any line */
    ck_assert_int_eq(feed(&decoder, "t1000\r"), SLCAN_FRAME);
    ck_assert_uint_eq(decoder.malformed, 0);
}
END_TEST

/* An adapter that was told Z1 puts four digits of milliseconds behind a received frame (LAWICEL manual,
 * command Z; Seeed_Arduino_CAN's README: two bytes, up to 60000 ms). */
START_TEST(time_stamps_are_no_data)
{
    struct slcan_decoder decoder;

    slcan_decoder_init(&decoder);
    ck_assert_int_eq(feed(&decoder, "t100211334D67\r"), SLCAN_FRAME);
    ck_assert_uint_eq(decoder.message.length, 2);
    ck_assert_uint_eq(decoder.message.data[1], 0x33);
    ck_assert_uint_eq(decoder.message.data[2], 0);
    ck_assert_int_eq(feed(&decoder, "T1ABCDEF08112233445566778800FA\r"), SLCAN_FRAME);
    ck_assert_uint_eq(decoder.message.id, 0x1ABCDEF0);
    ck_assert_uint_eq(decoder.message.data[7], 0x88);
    ck_assert_int_eq(feed(&decoder, "t1230EA5F\r"), SLCAN_FRAME);
    ck_assert_uint_eq(decoder.message.length, 0);
    ck_assert_int_eq(feed(&decoder, "r10021133\r"), SLCAN_FRAME); /* of a remote frame */
    ck_assert_uint_eq(decoder.message.flags, CAN_FRAME_REMOTE);
    ck_assert_uint_eq(decoder.message.length, 2);
    ck_assert_uint_eq(decoder.malformed, 0);
    ck_assert_int_eq(feed(&decoder, "t100211334D6\r"), SLCAN_MALFORMED);
    ck_assert_int_eq(feed(&decoder, "t100211334D6G\r"), SLCAN_MALFORMED);
}
END_TEST

/* Adapters that end lines with CR and LF: the LF is not the beginning of the next line. */
START_TEST(a_line_feed_behind_the_line_end_is_nothing)
{
    struct slcan_decoder decoder;

    slcan_decoder_init(&decoder);
    ck_assert_int_eq(feed(&decoder, "t10021133\r"), SLCAN_FRAME);
    ck_assert_int_eq(feed(&decoder, "\nz\r"), SLCAN_ACKNOWLEDGED);
    ck_assert_int_eq(feed(&decoder, "\nt1FF12A\r"), SLCAN_FRAME);
    ck_assert_uint_eq(decoder.message.id, 0x1FF);
    ck_assert_int_eq(feed(&decoder, "\n\r"), SLCAN_DONE);
    ck_assert_int_eq(feed(&decoder, "\n\a"), SLCAN_REFUSED);
    ck_assert_int_eq(feed(&decoder, "\nV1013\r"), SLCAN_OTHER);
    ck_assert_str_eq(decoder.line, "V1013");
    ck_assert_uint_eq(decoder.malformed, 0);
    ck_assert_int_eq(feed(&decoder, "t1\n00\r"), SLCAN_MALFORMED); /* inside a line it is wrong */
}
END_TEST

/* Z with a digit is the command for time stamps, no acknowledgement. */
START_TEST(the_command_for_time_stamps_is_one)
{
    struct slcan_decoder decoder;

    slcan_decoder_init(&decoder);
    ck_assert_int_eq(feed(&decoder, "Z0\r"), SLCAN_OTHER);
    ck_assert_str_eq(decoder.line, "Z0");
    ck_assert_int_eq(feed(&decoder, "Z9\r"), SLCAN_OTHER);
    ck_assert_int_eq(feed(&decoder, "Z/\r"), SLCAN_MALFORMED); /* the signs before 0 and behind 9 */
    ck_assert_int_eq(feed(&decoder, "Z:\r"), SLCAN_MALFORMED);
    ck_assert_int_eq(feed(&decoder, "ZA\r"), SLCAN_MALFORMED);
    ck_assert_int_eq(feed(&decoder, "z0\r"), SLCAN_MALFORMED);
    ck_assert_int_eq(feed(&decoder, "Z00\r"), SLCAN_MALFORMED);
}
END_TEST

START_TEST(malformed_lines_are_counted_and_the_next_line_is_read)
{
    static const char *const lines[] = {"t\r",
                                        "t10\r",
                                        "t100\r",
                                        "t1009112233445566778899\r",
                                        "t8000\r",
                                        "t1001\r",
                                        "t10011\r",
                                        "t1001112\r",
                                        "tG000\r",
                                        "t100G\r",
                                        "t1001GG\r",
                                        "T2000000000\r",
                                        "T0000010\r",
                                        "r100211\r",
                                        "z1\r",
                                        "t100 0\r",
                                        "t10081122334455667788AABBCCDDEEFF00112233445566\r"};
    struct slcan_decoder decoder;

    slcan_decoder_init(&decoder);
    for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++) {
        ck_assert_msg(feed(&decoder, lines[i]) == SLCAN_MALFORMED, "line %zu", i);
        ck_assert_uint_eq(decoder.malformed, i + 1);
        ck_assert_int_eq(feed(&decoder, "t1FF12A\r"), SLCAN_FRAME);
        ck_assert_uint_eq(decoder.message.id, 0x1FF);
        ck_assert_uint_eq(decoder.message.data[0], 0x2A);
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("slcan");
    TCase *tcase = tcase_create("slcan");

    tcase_add_test(tcase, examples_of_the_manual_are_understood);
    tcase_add_test(tcase, frames_are_written_as_the_manual_does);
    tcase_add_test(tcase, what_is_no_frame_is_not_written);
    tcase_add_test(tcase, every_length_and_kind_comes_back);
    tcase_add_test(tcase, answers_are_told_apart);
    tcase_add_test(tcase, time_stamps_are_no_data);
    tcase_add_test(tcase, a_line_feed_behind_the_line_end_is_nothing);
    tcase_add_test(tcase, the_command_for_time_stamps_is_one);
    tcase_add_test(tcase, malformed_lines_are_counted_and_the_next_line_is_read);
    suite_add_tcase(suite, tcase);
    return run_suite(suite);
}
