/* What an adapter says to the commands that open it, and to frames: which answer belongs to which. */
#include "hal/bus/slcan_channel.h"

#include <string.h>

#include "tests/support/assert_close.h"

static struct slcan_channel channel;

static void setup(void)
{
    slcan_channel_init(&channel);
}

static enum slcan_event hears(const char *text)
{
    enum slcan_event event = SLCAN_NOTHING;
    for (; *text != '\0'; text++) {
        event = slcan_channel_receive(&channel, *text);
    }
    return event;
}

/* Closed before it is set up, time stamps off (LAWICEL: only while closed), 1 Mbit/s, then open. */
START_TEST(the_channel_is_opened_without_time_stamps)
{
    ck_assert_str_eq(slcan_open_commands, "\rC\rS8\rZ0\rO\r");
}
END_TEST

START_TEST(frames_are_acknowledged_in_their_order)
{
    ck_assert(slcan_channel_sent(&channel, 0x080));
    ck_assert(slcan_channel_sent(&channel, 0x201));
    ck_assert_int_eq(hears("z\r"), SLCAN_ACKNOWLEDGED);
    ck_assert_uint_eq(channel.answered_id, 0x080);
    ck_assert_int_eq(hears("\nZ\r"), SLCAN_ACKNOWLEDGED);
    ck_assert_uint_eq(channel.answered_id, 0x201);
    ck_assert_int_eq(hears("z\r"), SLCAN_NOTHING); /* of nothing that was sent */
}
END_TEST

/* A bell to Z0, or to C while it is closed, is none to the SYNC that was sent meanwhile. */
START_TEST(a_refused_command_is_no_refused_frame)
{
    ck_assert(slcan_channel_sent(&channel, 0x080));
    ck_assert_int_eq(hears("\a"), SLCAN_DONE);
    ck_assert_int_eq(hears("\r"), SLCAN_DONE);
    ck_assert_int_eq(hears("\a"), SLCAN_DONE);
    ck_assert_int_eq(hears("\r"), SLCAN_DONE);
    ck_assert_int_eq(hears("z\r"), SLCAN_ACKNOWLEDGED);
    ck_assert_uint_eq(channel.answered_id, 0x080);
    ck_assert_uint_eq(channel.commands_refused, 2);
    ck_assert(slcan_channel_sent(&channel, 0x201));
    ck_assert(slcan_channel_sent(&channel, 0x080));
    ck_assert_int_eq(hears("\a"), SLCAN_REFUSED); /* now all commands are answered */
    ck_assert_uint_eq(channel.answered_id, 0x201);
    ck_assert_int_eq(hears("z\r"), SLCAN_ACKNOWLEDGED);
    ck_assert_uint_eq(channel.answered_id, 0x080);
}
END_TEST

/* Adapters that answer no commands: the first acknowledgement shows it, and bells are frames' again. */
START_TEST(an_adapter_may_answer_no_commands)
{
    ck_assert(slcan_channel_sent(&channel, 0x080));
    ck_assert_int_eq(hears("z\r"), SLCAN_ACKNOWLEDGED);
    ck_assert(slcan_channel_sent(&channel, 0x201));
    ck_assert_int_eq(hears("\a"), SLCAN_REFUSED);
    ck_assert_uint_eq(channel.answered_id, 0x201);
}
END_TEST

START_TEST(so_many_may_wait)
{
    for (uint16_t i = 0; i < SLCAN_PENDING_MAX; i++) {
        ck_assert(slcan_channel_sent(&channel, i));
    }
    ck_assert(!slcan_channel_sent(&channel, 0x7FF));
    ck_assert_int_eq(hears("z\r"), SLCAN_ACKNOWLEDGED);
    ck_assert_uint_eq(channel.answered_id, 0);
    ck_assert(slcan_channel_sent(&channel, 0x7FF));
}
END_TEST

START_TEST(received_frames_pass)
{
    ck_assert_int_eq(hears("t1FF12A\r"), SLCAN_FRAME);
    ck_assert_uint_eq(channel.decoder.message.id, 0x1FF);
    ck_assert_int_eq(hears("t1FF1G\r"), SLCAN_MALFORMED);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("slcan_channel");
    TCase *tcase = tcase_create("all");
    tcase_add_checked_fixture(tcase, setup, NULL);
    tcase_add_test(tcase, the_channel_is_opened_without_time_stamps);
    tcase_add_test(tcase, frames_are_acknowledged_in_their_order);
    tcase_add_test(tcase, a_refused_command_is_no_refused_frame);
    tcase_add_test(tcase, an_adapter_may_answer_no_commands);
    tcase_add_test(tcase, so_many_may_wait);
    tcase_add_test(tcase, received_frames_pass);
    suite_add_tcase(suite, tcase);
    return run_suite(suite);
}
