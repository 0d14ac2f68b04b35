/* The SDO client against a server that breaks the rules: byte by byte as CiA 301 clause 7.2.4.3
 * lays frames out, with the abort code that the clause names for each. */
#include <check.h>
#include <signal.h>
#include <string.h>

#include "hal/bus/bytes.h"
#include "hal/canopen/co_defs.h"
#include "hal/canopen/co_sdo_client.h"
#include "tests/support/assert_close.h"
#include "tests/support/fake_bus.h"

enum {
    TOGGLE_NOT_ALTERNATED = 0x05030000,
    UNKNOWN_COMMAND = 0x05040001,
    OUT_OF_MEMORY = 0x05040005
};

static struct fake_bus fake;
static struct can_bus bus;
static struct co_sdo_client client;

static void setup(void)
{
    fake_bus_init(&fake);
    bus = fake_bus_interface(&fake);
    co_sdo_client_init(&client, 5, 1000000);
}

/* What the server says; whether the client took it for its answer. */
static bool say(uint8_t command, uint16_t index, uint8_t sub, uint32_t data)
{
    struct can_msg message = {.id = 0x585, .length = 8, .data = {command}};
    bytes_put_u16(message.data + 1, index);
    message.data[3] = sub;
    bytes_put_u32(message.data + 4, data);
    return co_sdo_client_receive(&client, &message, 0);
}

static void poll(enum co_sdo_result want)
{
    ck_assert_int_eq(co_sdo_client_poll(&client, &bus, 0), want);
}

/* Ended, with this code, and the server is told so for this object. */
static void is_aborted_with(uint32_t code, uint16_t index)
{
    poll(CO_SDO_ABORTED);
    ck_assert_uint_eq(client.abort_code, code);
    const struct can_msg *told = fake_bus_last(&fake, 0x605);
    ck_assert_uint_eq(told->data[0], 0x80);
    ck_assert_uint_eq(bytes_get_u16(told->data + 1), index);
    ck_assert_uint_eq(bytes_get_u32(told->data + 4), code);
}

static void read_segments(void)
{
    co_sdo_client_read(&client, 0x2006, 0, 0);
    poll(CO_SDO_BUSY);
    ck_assert(say(0x41, 0x2006, 0, 20));
    poll(CO_SDO_BUSY);
    ck_assert_uint_eq(fake_bus_last(&fake, 0x605)->data[0], 0x60);
}

static void write_segments(void)
{
    const uint8_t bytes[10] = "abcdefghi";
    co_sdo_client_write(&client, 0x2006, 0, bytes, 10, 0);
    poll(CO_SDO_BUSY);
    ck_assert_uint_eq(fake_bus_last(&fake, 0x605)->data[0], 0x21);
    ck_assert(say(0x60, 0x2006, 0, 0));
    poll(CO_SDO_BUSY);
    ck_assert_uint_eq(fake_bus_last(&fake, 0x605)->data[0], 0x00);
}

START_TEST(a_toggle_bit_that_does_not_alternate)
{
    read_segments();
    ck_assert(say(0x10, 0, 0, 0));
    is_aborted_with(TOGGLE_NOT_ALTERNATED, 0x2006);
    write_segments();
    ck_assert(say(0x30, 0, 0, 0));
    is_aborted_with(TOGGLE_NOT_ALTERNATED, 0x2006);
}
END_TEST

START_TEST(more_than_there_is_room_for)
{
    co_sdo_client_read(&client, 0x2006, 0, 0);
    poll(CO_SDO_BUSY);
    ck_assert(say(0x41, 0x2006, 0, CO_VALUE_MAX + 1)); /* said at once */
    is_aborted_with(OUT_OF_MEMORY, 0x2006);
    co_sdo_client_read(&client, 0x2006, 0, 0);
    poll(CO_SDO_BUSY);
    ck_assert(say(0x40, 0x2006, 0, 0)); /* not said: it comes and comes */
    for (int i = 0; i < CO_VALUE_MAX / 7; i++) {
        poll(CO_SDO_BUSY);
        ck_assert(say(i % 2 == 0 ? 0x00 : 0x10, 0x6261, 'c', 0));
    }
    poll(CO_SDO_BUSY);
    ck_assert(say(CO_VALUE_MAX / 7 % 2 == 0 ? 0x00 : 0x10, 0x6261, 'c', 0));
    is_aborted_with(OUT_OF_MEMORY, 0x2006);
}
END_TEST

/* An answer of another service than the one asked for, in every state. */
START_TEST(an_answer_to_something_else)
{
    co_sdo_client_read(&client, 0x2000, 0, 0);
    poll(CO_SDO_BUSY);
    ck_assert(say(0x20, 0x2000, 0, 0));
    is_aborted_with(UNKNOWN_COMMAND, 0x2000);
    const uint8_t one[1] = {1};
    co_sdo_client_write(&client, 0x2000, 0, one, 1, 0);
    poll(CO_SDO_BUSY);
    ck_assert(say(0x00, 0x2000, 0, 1));
    is_aborted_with(UNKNOWN_COMMAND, 0x2000);
    read_segments();
    ck_assert(say(0x20, 0, 0, 0));
    is_aborted_with(UNKNOWN_COMMAND, 0x2006);
    write_segments();
    ck_assert(say(0x00, 0, 0, 0));
    is_aborted_with(UNKNOWN_COMMAND, 0x2006);
}
END_TEST

/* What was asked for again is answered twice, and the second answer may come into the transfer
 * behind it, the reading back of the same object: it is none to that one, and ends nothing. */
START_TEST(a_second_answer_to_what_was_repeated)
{
    const uint8_t one[1] = {7};
    co_sdo_client_write(&client, 0x2000, 0, one, 1, 0);
    poll(CO_SDO_BUSY);
    ck_assert(say(0x60, 0x2000, 0, 0));
    poll(CO_SDO_DONE);
    co_sdo_client_read(&client, 0x2000, 0, 0);
    poll(CO_SDO_BUSY);
    ck_assert(say(0x60, 0x2000, 0, 0));
    poll(CO_SDO_BUSY);
    ck_assert(say(0x4F, 0x2000, 0, 7));
    poll(CO_SDO_DONE);
    ck_assert_uint_eq(client.buffer[0], 7);
    co_sdo_client_write(&client, 0x2000, 0, one, 1, 0);
    poll(CO_SDO_BUSY);
    ck_assert(say(0x4F, 0x2000, 0, 7)); /* of the read before it */
    poll(CO_SDO_BUSY);
    ck_assert(say(0x60, 0x2000, 0, 0));
    poll(CO_SDO_DONE);
}
END_TEST

/* The answer to a transfer that was given up for this one: not its own, and no reason to end. */
START_TEST(an_answer_of_an_earlier_transfer)
{
    const uint8_t two[2] = {1, 2};
    co_sdo_client_write(&client, 0x2001, 0, two, 2, 0);
    poll(CO_SDO_BUSY);
    ck_assert(say(0x60, 0x2000, 0, 0));
    ck_assert(say(0x60, 0x2001, 1, 0));
    ck_assert(say(0x80, 0x2000, 0, 0x06020000)); /* nor is its abort */
    poll(CO_SDO_BUSY);
    ck_assert(say(0x60, 0x2001, 0, 0));
    poll(CO_SDO_DONE);
    co_sdo_client_read(&client, 0x2001, 0, 0);
    poll(CO_SDO_BUSY);
    ck_assert(say(0x4F, 0x2000, 0, 9));
    poll(CO_SDO_BUSY);
    ck_assert(say(0x80, 0x2001, 0, 0x06010001));
    poll(CO_SDO_ABORTED);
    ck_assert_uint_eq(client.abort_code, 0x06010001);
}
END_TEST

/* Two clients on one server: the other's answers end nothing, and do not keep this one waiting. */
START_TEST(answers_to_another_client_are_not_its_own)
{
    read_segments();
    ck_assert(say(0x43, 0x2000, 0, 7)); /* the other read, wrote, and was refused */
    ck_assert(say(0x60, 0x2001, 0, 0));
    ck_assert(say(0x80, 0x2002, 0, 0x06020000));
    poll(CO_SDO_BUSY);
    ck_assert(say(0x01, 0x6261, 'c', 0));
    poll(CO_SDO_DONE);
    write_segments();
    ck_assert(say(0x43, 0x2000, 0, 7));
    poll(CO_SDO_BUSY);
    ck_assert(say(0x20, 0, 0, 0));
    poll(CO_SDO_BUSY);
    ck_assert(say(0x30, 0, 0, 0));
    poll(CO_SDO_DONE);
    co_sdo_client_read(&client, 0x2000, 0, 0);
    poll(CO_SDO_BUSY);
    struct can_msg message = {.id = 0x585, .length = 8, .data = {0x43, 0x01, 0x20}};
    enum co_sdo_result result = CO_SDO_BUSY;
    for (uint64_t now_ns = 0; now_ns < 3000000; now_ns += 500000) { /* its patience is 1 ms */
        ck_assert(co_sdo_client_receive(&client, &message, now_ns));
        result = co_sdo_client_poll(&client, &bus, now_ns);
    }
    ck_assert_int_eq(result, CO_SDO_ABORTED);
    ck_assert_uint_eq(client.abort_code, 0x05040000);
}
END_TEST

START_TEST(an_expedited_answer_without_a_size_has_four_bytes)
{
    co_sdo_client_read(&client, 0x2002, 1, 0);
    poll(CO_SDO_BUSY);
    ck_assert(say(0x42, 0x2002, 1, 0x0D0C0B0A));
    poll(CO_SDO_DONE);
    ck_assert_uint_eq(client.length, 4);
    ck_assert_uint_eq(bytes_get_u32(client.buffer), 0x0D0C0B0A);
}
END_TEST

/* Asked for nothing, waiting for the bus, or with flags that no answer has. */
START_TEST(an_answer_before_the_question_changes_nothing)
{
    ck_assert(say(0x4F, 0x2000, 0, 7));
    poll(CO_SDO_DONE);
    fake.verdict = CAN_FULL;
    co_sdo_client_read(&client, 0x2000, 0, 0);
    poll(CO_SDO_BUSY);
    ck_assert(say(0x4F, 0x2000, 0, 7)); /* the question has not left yet */
    fake.verdict = CAN_OK;
    poll(CO_SDO_BUSY);
    struct can_msg message = {.id = 0x585, .length = 8, .flags = CAN_FRAME_EXTENDED};
    ck_assert(!co_sdo_client_receive(&client, &message, 0));
    ck_assert(say(0x4F, 0x2000, 0, 8));
    poll(CO_SDO_DONE);
    ck_assert_uint_eq(client.buffer[0], 8);
}
END_TEST

/* Contracts: a broken one traps. */
START_TEST(node_0_is_no_server)
{
    co_sdo_client_init(&client, 0, 1000);
}
END_TEST

START_TEST(node_128_is_no_server)
{
    co_sdo_client_init(&client, 128, 1000);
}
END_TEST

START_TEST(nothing_cannot_be_written)
{
    const uint8_t bytes[1] = {0};
    co_sdo_client_write(&client, 0x2000, 0, bytes, 0, 0);
}
END_TEST

START_TEST(too_much_cannot_be_written)
{
    const uint8_t bytes[CO_VALUE_MAX + 1] = {0};
    co_sdo_client_write(&client, 0x2000, 0, bytes, sizeof bytes, 0);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("co_sdo_client");
    TCase *tcase = tcase_create("all");
    tcase_add_checked_fixture(tcase, setup, NULL);
    tcase_add_test(tcase, a_toggle_bit_that_does_not_alternate);
    tcase_add_test(tcase, more_than_there_is_room_for);
    tcase_add_test(tcase, an_answer_to_something_else);
    tcase_add_test(tcase, a_second_answer_to_what_was_repeated);
    tcase_add_test(tcase, an_answer_of_an_earlier_transfer);
    tcase_add_test(tcase, answers_to_another_client_are_not_its_own);
    tcase_add_test(tcase, an_expedited_answer_without_a_size_has_four_bytes);
    tcase_add_test(tcase, an_answer_before_the_question_changes_nothing);
    tcase_add_test_raise_signal(tcase, node_0_is_no_server, SIGILL);
    tcase_add_test_raise_signal(tcase, node_128_is_no_server, SIGILL);
    tcase_add_test_raise_signal(tcase, nothing_cannot_be_written, SIGILL);
    tcase_add_test_raise_signal(tcase, too_much_cannot_be_written, SIGILL);
    suite_add_tcase(suite, tcase);
    return run_suite(suite);
}
