/* The tools' SDO client on a bus where another client speaks with the same server: every answer to a
 * start names its object (CiA 301 clause 7.2.4.3, the multiplexor), and only its own counts. */
#include "sim_host/log/sdo_upload.h"

#include <check.h>
#include <string.h>

#include "hal/bus/bytes.h"
#include "tests/support/assert_close.h"
#include "tests/support/fake_bus.h"

enum { NODE = 16, ANSWER = 0x590, REQUEST = 0x610, SCRIPT_MAX = 16, DISTURBED = -4 };

/* What comes, one frame a wait: a value of 0 length lets a wait pass. */
struct script {
    struct can_msg frame[SCRIPT_MAX];
    unsigned count, next;
};

static struct fake_bus fake;
static struct can_bus bus;
static struct script script;
static struct sdo_upload upload;
static uint8_t bytes[32];
static size_t length;

static bool wait(void *context, unsigned waits)
{
    (void)context;
    if (script.next < script.count) {
        fake_bus_put(&fake, &script.frame[script.next++]);
    }
    return waits < 2 * SCRIPT_MAX;
}

static void comes(uint8_t command, uint16_t index, uint8_t sub, uint32_t data)
{
    struct can_msg *message = &script.frame[script.count++];
    *message = (struct can_msg){.id = ANSWER, .length = 8, .data = {command}};
    bytes_put_u16(message->data + 1, index);
    message->data[3] = sub;
    bytes_put_u32(message->data + 4, data);
}

static void comes_segment(uint8_t command, const char *text)
{
    struct can_msg *message = &script.frame[script.count++];
    *message = (struct can_msg){.id = ANSWER, .length = 8, .data = {command}};
    memcpy(message->data + 1, text, 7);
}

static void setup(void)
{
    fake_bus_init(&fake);
    bus = fake_bus_interface(&fake);
    memset(&script, 0, sizeof script);
    memset(bytes, 0, sizeof bytes);
    upload = (struct sdo_upload){.bus = &bus, .node = NODE, .wait = wait};
}

static enum sdo_upload_result read_2030(void)
{
    return sdo_upload(&upload, 0x2030, 2, bytes, sizeof bytes, &length);
}

START_TEST(answers_to_somebody_else_are_not_its_own)
{
    comes(0x43, 0x2031, 2, 0x11111111); /* another object, */
    comes(0x43, 0x2030, 3, 0x22222222); /* another sub-index, */
    comes(0x60, 0x2000, 2, 0);          /* something was written, */
    comes(0x80, 0x2000, 1, 0x06090031); /* and refused */
    comes(0x43, 0x2030, 2, 0x33333333);
    ck_assert_int_eq(read_2030(), SDO_UPLOAD_DONE);
    ck_assert_uint_eq(length, 4);
    ck_assert_uint_eq(bytes_get_u32(bytes), 0x33333333);
}
END_TEST

START_TEST(the_servers_refusal_of_this_object_counts)
{
    comes(0x80, 0x2031, 2, 0x06020000);
    comes(0x80, 0x2030, 2, 0x06090011);
    ck_assert_int_eq(read_2030(), SDO_UPLOAD_ABORTED);
    ck_assert_uint_eq(upload.abort_code, 0x06090011);
}
END_TEST

START_TEST(a_write_is_confirmed_for_its_object_only)
{
    comes(0x60, 0x2000, 3, 0);
    comes(0x4F, 0x2000, 2, 1);
    comes(0x80, 0x2000, 3, 0x08000022);
    ck_assert_int_eq(sdo_write(&upload, 0x2000, 2, 1, 1), SDO_UPLOAD_SILENT);
    comes(0x60, 0x2000, 2, 0);
    ck_assert_int_eq(sdo_write(&upload, 0x2000, 2, 1, 1), SDO_UPLOAD_DONE);
}
END_TEST

/* An answer that is older than the question is none. */
START_TEST(what_waited_before_the_question_is_old)
{
    comes(0x43, 0x2030, 2, 0x11111111);
    (void)wait(NULL, 0);
    comes(0x43, 0x2030, 2, 0x22222222);
    ck_assert_int_eq(read_2030(), SDO_UPLOAD_DONE);
    ck_assert_uint_eq(bytes_get_u32(bytes), 0x22222222);
}
END_TEST

START_TEST(segments_are_put_together)
{
    comes(0x41, 0x2030, 2, 10);
    comes_segment(0x00, "abcdefg");
    comes_segment(0x19, "hij\0\0\0");
    ck_assert_int_eq(read_2030(), SDO_UPLOAD_DONE);
    ck_assert_uint_eq(length, 10);
    ck_assert_mem_eq(bytes, "abcdefghij", 10);
}
END_TEST

/* Segments name no object: who started another transfer has ended this one, and its segments would be
 * taken for ours. */
START_TEST(another_client_in_the_middle_is_told)
{
    comes(0x41, 0x2030, 2, 14);
    comes_segment(0x00, "abcdefg");
    if (_i == 0) {
        comes(0x41, 0x2040, 3, 100);
    } else if (_i == 1) {
        comes(0x80, 0x2040, 3, 0x05040001);
    } else {
        comes_segment(0x00, "ABCDEFG"); /* the toggle bit is not the one asked for */
    }
    comes_segment(0x11, "hijklmn");
    ck_assert_int_eq((int)read_2030(), DISTURBED);
}
END_TEST

/* CiA 301: a transfer that the client ends is aborted, or the server waits on. */
START_TEST(what_is_given_up_is_aborted)
{
    comes(0x41, 0x2030, 2, 14);
    comes_segment(0x00, "abcdefg");
    comes_segment(0x00, "ABCDEFG");
    (void)read_2030();
    const struct can_msg *last = fake_bus_last(&fake, REQUEST);
    ck_assert_uint_eq(last->data[0], 0x80);
    ck_assert_uint_eq(bytes_get_u16(last->data + 1), 0x2030);
    ck_assert_uint_eq(last->data[3], 2);
    ck_assert_uint_eq(bytes_get_u32(last->data + 4), 0x05030000);
    comes(0x41, 0x2030, 2, sizeof bytes + 1);
    ck_assert_int_eq(read_2030(), SDO_UPLOAD_TOO_LARGE);
    ck_assert_uint_eq(bytes_get_u32(fake_bus_last(&fake, REQUEST)->data + 4), 0x05040005);
}
END_TEST

/* The length that was announced is the length that comes. */
START_TEST(less_than_was_announced_is_not_all)
{
    comes(0x41, 0x2030, 2, 14);
    comes_segment(0x01, "abcdefg");
    ck_assert_int_ne(read_2030(), SDO_UPLOAD_DONE);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("sdo_upload");
    TCase *tcase = tcase_create("all");
    tcase_add_checked_fixture(tcase, setup, NULL);
    tcase_add_test(tcase, answers_to_somebody_else_are_not_its_own);
    tcase_add_test(tcase, the_servers_refusal_of_this_object_counts);
    tcase_add_test(tcase, a_write_is_confirmed_for_its_object_only);
    tcase_add_test(tcase, what_waited_before_the_question_is_old);
    tcase_add_test(tcase, segments_are_put_together);
    tcase_add_loop_test(tcase, another_client_in_the_middle_is_told, 0, 3);
    tcase_add_test(tcase, what_is_given_up_is_aborted);
    tcase_add_test(tcase, less_than_was_announced_is_not_all);
    suite_add_tcase(suite, tcase);
    return run_suite(suite);
}
