/* SDO server frame by frame against CiA 301 clause 7.2.4.3 (byte layouts of its
 * figures), and server and client against each other. */
#include <check.h>
#include <stdio.h>
#include <string.h>

#include "hal/canopen/co_defs.h"
#include "hal/canopen/co_sdo_client.h"
#include "hal/canopen/co_sdo_server.h"
#include "tests/support/assert_close.h"

struct values {
    uint8_t flag;
    int16_t limited;
    uint32_t wide;
    int32_t narrow24;
    float real;
    uint32_t secret;
    char name[20];
    char label[CO_VALUE_MAX];
    uint32_t refused;
};

#define RW (CO_READ | CO_WRITE)
static const struct co_entry table[] = {
    CO_ANY(struct values, flag, 0x2000, 0, CO_BOOLEAN, RW, "flag"),
    CO_OBJECT(struct values, limited, 0x2001, 0, CO_INTEGER16, RW, -5, 100, "limited"),
    CO_ANY(struct values, wide, 0x2002, 1, CO_UNSIGNED32, RW, "wide"),
    CO_ANY(struct values, narrow24, 0x2002, 2, CO_INTEGER24, RW, "narrow"),
    CO_OBJECT(struct values, real, 0x2003, 0, CO_REAL32, RW, 100, 1500, "real"),
    CO_ANY(struct values, secret, 0x2004, 0, CO_UNSIGNED32, CO_WRITE, "write only"),
    CO_STRING(struct values, name, 0x2005, 0, CO_READ | CO_CONST, "name"),
    CO_STRING(struct values, label, 0x2006, 0, RW, "label"),
    CO_ANY(struct values, refused, 0x2007, 0, CO_UNSIGNED32, RW, "refused by the owner"),
};

static struct values values;
static struct co_dictionary dictionary;
static struct co_sdo_server server;
static unsigned written_count;

static uint32_t writing(void *context, const struct co_entry *entry, const uint8_t *bytes,
                        unsigned length)
{
    (void)context;
    (void)bytes;
    (void)length;
    return entry->index == 0x2007 ? CO_ABORT_DEVICE_STATE : CO_ABORT_NONE;
}

static void written(void *context, const struct co_entry *entry)
{
    (void)context;
    (void)entry;
    written_count++;
}

static const struct co_access_hooks hooks = {.writing = writing, .written = written};

static void setup(void)
{
    memset(&values, 0, sizeof values);
    strcpy(values.name, "a name of 19 bytes.");
    dictionary = (struct co_dictionary){table, sizeof table / sizeof table[0], &values};
    co_sdo_server_init(&server, &dictionary, 1, &hooks, NULL);
    written_count = 0;
}

/* Sends 8 bytes, expects 8 bytes; both as hex. */
static void exchange_at(const char *request, const char *want, uint64_t now_ns)
{
    uint8_t bytes[8];
    uint8_t answer[8];
    char got[17] = "";
    for (unsigned i = 0; i < 8; i++) {
        unsigned value = 0;
        ck_assert_int_eq(sscanf(request + 2 * i, "%2x", &value), 1);
        bytes[i] = (uint8_t)value;
    }
    if (co_sdo_server_handle(&server, bytes, now_ns, answer)) {
        for (unsigned i = 0; i < 8; i++) {
            snprintf(got + 2 * i, 3, "%02x", answer[i]);
        }
    }
    ck_assert_msg(strcmp(got, want) == 0, "request %s: answer %s, expected %s", request, got, want);
}

static void exchange(const char *request, const char *want)
{
    exchange_at(request, want, 0);
}

START_TEST(expedited_transfers_of_each_length)
{
    exchange("2f00200001000000", "6000200000000000"); /* 1 byte */
    ck_assert_uint_eq(values.flag, 1);
    exchange("2b012000feff0000", "6001200000000000"); /* 2 bytes */
    ck_assert_int_eq(values.limited, -2);
    exchange("2302200178563412", "6002200100000000"); /* 4 bytes */
    ck_assert_uint_eq(values.wide, 0x12345678);
    exchange("27022002ffffff00", "6002200200000000"); /* 3 bytes */
    ck_assert_int_eq(values.narrow24, -1);
    exchange("220220010d0c0b0a", "6002200100000000"); /* size not indicated */
    ck_assert_uint_eq(values.wide, 0x0A0B0C0D);
    ck_assert_uint_eq(written_count, 5);

    exchange("4000200000000000", "4f00200001000000");
    exchange("4001200000000000", "4b012000feff0000");
    exchange("4002200100000000", "430220010d0c0b0a");
    exchange("4002200200000000", "47022002ffffff00");
}
END_TEST

START_TEST(abort_codes_of_cia_301)
{
    exchange("4000100000000000", "8000100000000206"); /* no such object */
    exchange("4000200500000000", "8000200511000906"); /* no such sub-index */
    exchange("4002200000000000", "8002200011000906");
    exchange("4004200000000000", "8004200001000106"); /* read of a write-only object */
    exchange("2305200000000000", "8005200002000106"); /* write of a read-only object */
    exchange("2b01200065000000", "8001200031000906"); /* too high */
    exchange("2b012000faff0000", "8001200032000906"); /* too low */
    exchange("2301200000000000", "8001200012000706"); /* too long */
    exchange("2f01200000000000", "8001200013000706"); /* too short */
    exchange("2f00200002000000", "8000200031000906"); /* no boolean */
    exchange("2307200000000000", "8007200022000008"); /* owner: device state */
    exchange("230320000000c07f", "8003200030000906"); /* not a number */
    exchange("230320000000803f", "6003200000000000"); /* 1.0 */
    exchange("230320009a99d93f", "8003200031000906"); /* 1.7 above 1.5 */
    exchange("c000200000000000", "8000200001000405"); /* block download */
    exchange("a000200000000000", "8000200001000405"); /* block upload */
    exchange("e000200000000000", "8000200001000405");
    ck_assert_uint_eq(server.aborts, 16);
    exchange("8000200000000000", ""); /* the client's abort is not answered */
}
END_TEST

START_TEST(segmented_upload_by_the_figures)
{
    exchange("4005200000000000", "4105200013000000"); /* 19 bytes */
    exchange("6000000000000000", "0061206e616d6520"); /* "a name " */
    exchange("7000000000000000", "106f662031392062"); /* "of 19 b" */
    exchange("6000000000000000", "05797465732e0000"); /* "ytes.", 2 unused, last */
    exchange("7000000000000000", "8005200001000405"); /* no more */
}
END_TEST

START_TEST(segmented_download_by_the_figures)
{
    exchange("210620000a000000", "6006200000000000");
    exchange("0061626364656667", "2000000000000000");
    exchange("1968696a00000000", "3000000000000000"); /* toggle, 4 unused, last */
    ck_assert_str_eq(values.label, "abcdefghij");
    ck_assert_uint_eq(written_count, 1);
    exchange("210620000b000000", "6006200000000000"); /* 11 announced */
    exchange("0061626364656667", "2000000000000000");
    exchange("1968696a00000000", "8006200013000706"); /* 10 came */
    ck_assert_str_eq(values.label, "abcdefghij");
    exchange("2106200041000000", "8006200012000706"); /* 65 bytes: too long */
    exchange("2105200004000000", "8005200002000106"); /* read only, told at once */
    exchange("0061626364656667", "8005200001000405"); /* nothing under way */
}
END_TEST

/* More than announced, more than the object, and a value that its owner refuses. */
/* The size need not be indicated (CiA 301, figure of SDO download initiate); an empty string is an
 * upload of one segment without bytes. */
START_TEST(a_size_may_be_unknown_or_nothing)
{
    exchange("2006200000000000", "6006200000000000");
    exchange("0048656c6c6f2c20", "2000000000000000"); /* "Hello, " */
    exchange("1549542100000000",
             "3000000000000000"); /* "IT!", not the last bytes' place: 4 unused */
    ck_assert_str_eq(values.label, "Hello, IT!");
    memset(values.label, 0, sizeof values.label);
    exchange("4006200000000000", "4106200000000000");
    exchange("6000000000000000", "0f00000000000000"); /* 7 of 7 unused, the last */
}
END_TEST

START_TEST(segmented_downloads_are_refused_like_expedited_ones)
{
    exchange("2106200008000000", "6006200000000000"); /* 8 announced */
    exchange("0061626364656667", "2000000000000000");
    exchange("1968696a00000000", "8006200012000706"); /* 10 came */
    exchange("2107200004000000", "6007200000000000");
    exchange("0701020304000000", "8007200022000008"); /* owner: device state */
    exchange("2103200004000000", "6003200000000000");
    exchange("079a99d93f000000", "8003200031000906"); /* 1.7 above 1.5 */
    exchange("230320000ad7233d", "8003200032000906"); /* 0.04 below 0.1 */
    ck_assert_uint_eq(written_count, 0);
}
END_TEST

/* A dictionary whose owner wants to hear of nothing. */
START_TEST(without_an_owner_the_dictionary_decides)
{
    static const struct co_access_hooks none = {0};
    for (int i = 0; i < 2; i++) {
        co_sdo_server_init(&server, &dictionary, 1, i == 0 ? NULL : &none, NULL);
        exchange("2307200078563412", "6007200000000000");
        ck_assert_uint_eq(values.refused, 0x12345678);
        exchange("4007200000000000", "4307200078563412");
        values.refused = 0;
    }
    ck_assert_uint_eq(written_count, 0);
}
END_TEST

START_TEST(toggle_and_overflow_end_a_transfer)
{
    exchange("2006200000000000", "6006200000000000"); /* no size announced */
    exchange("1061626364656667", "8006200000000305"); /* wrong toggle */
    exchange("4005200000000000", "4105200013000000");
    exchange("7000000000000000", "8005200000000305");
    exchange("2006200000000000", "6006200000000000");
    for (int i = 0; i < 9; i++) { /* 63 bytes */
        exchange(i % 2 == 0 ? "0061626364656667" : "1061626364656667",
                 i % 2 == 0 ? "2000000000000000" : "3000000000000000");
    }
    exchange("1061626364656667", "8006200012000706"); /* longer than any object */
}
END_TEST

START_TEST(a_transfer_that_stands_still_is_forgotten)
{
    exchange_at("4005200000000000", "4105200013000000", 0);
    exchange_at("6000000000000000", "8005200001000405", UINT64_C(1000000001));
    exchange_at("4005200000000000", "4105200013000000", 0);
    exchange_at("6000000000000000", "0061206e616d6520", UINT64_C(1000000000));
}
END_TEST

/* ---- client and server against each other ------------------------------------ */

static struct can_msg last_sent;
static bool has_sent;
static bool bus_is_full;

static enum can_result fake_send(void *context, const struct can_msg *message)
{
    (void)context;
    if (bus_is_full) {
        return CAN_FULL;
    }
    last_sent = *message;
    has_sent = true;
    return CAN_OK;
}

static const struct can_bus_ops fake_ops = {.send = fake_send};
static const struct can_bus fake_bus = {.ops = &fake_ops};

static enum co_sdo_result transfer(struct co_sdo_client *client)
{
    for (int i = 0; i < 50; i++) {
        has_sent = false;
        const enum co_sdo_result result = co_sdo_client_poll(client, &fake_bus, 0);
        struct can_msg answer = {.id = 0x585, .length = 8};
        if (has_sent && co_sdo_server_handle(&server, last_sent.data, 0, answer.data)) {
            ck_assert(co_sdo_client_receive(client, &answer, 0));
        }
        if (result != CO_SDO_BUSY) {
            return result;
        }
    }
    return CO_SDO_BUSY;
}

START_TEST(client_and_server_carry_every_length_both_ways)
{
    struct co_sdo_client client;
    uint8_t bytes[CO_VALUE_MAX];
    co_sdo_client_init(&client, 5, 1000);
    for (unsigned length = 1; length <= CO_VALUE_MAX; length++) {
        for (unsigned i = 0; i < length; i++) {
            bytes[i] = (uint8_t)('A' + (i * 7 + length) % 50);
        }
        co_sdo_client_write(&client, 0x2006, 0, bytes, length, 0);
        ck_assert_int_eq(transfer(&client), CO_SDO_DONE);
        ck_assert_mem_eq(values.label, bytes, length);
        memset(client.buffer, 0, sizeof client.buffer);
        co_sdo_client_read(&client, 0x2006, 0, 0);
        ck_assert_int_eq(transfer(&client), CO_SDO_DONE);
        ck_assert_uint_eq(client.length, length);
        ck_assert_mem_eq(client.buffer, bytes, length);
    }
}
END_TEST

START_TEST(the_client_gives_back_the_servers_abort)
{
    struct co_sdo_client client;
    const uint8_t one[2] = {1, 0};
    co_sdo_client_init(&client, 5, 1000);
    co_sdo_client_read(&client, 0x5000, 0, 0);
    ck_assert_int_eq(transfer(&client), CO_SDO_ABORTED);
    ck_assert_uint_eq(client.abort_code, CO_ABORT_NO_OBJECT);
    co_sdo_client_write(&client, 0x2005, 0, one, 2, 0);
    ck_assert_int_eq(transfer(&client), CO_SDO_ABORTED);
    ck_assert_uint_eq(client.abort_code, CO_ABORT_READ_ONLY);
}
END_TEST

START_TEST(the_client_does_not_wait_for_ever)
{
    struct co_sdo_client client;
    co_sdo_client_init(&client, 5, 1000);
    co_sdo_client_read(&client, 0x2000, 0, 0);
    bus_is_full = true;
    ck_assert_int_eq(co_sdo_client_poll(&client, &fake_bus, 0), CO_SDO_BUSY);
    bus_is_full = false;
    ck_assert_int_eq(co_sdo_client_poll(&client, &fake_bus, 500), CO_SDO_BUSY);
    ck_assert_uint_eq(last_sent.id, 0x605);
    ck_assert_int_eq(co_sdo_client_poll(&client, &fake_bus, 1001), CO_SDO_ABORTED);
    ck_assert_uint_eq(client.abort_code, CO_ABORT_TIMEOUT);
    ck_assert_uint_eq(last_sent.data[0], 0x80);
    /* The late answer changes nothing. */
    const struct can_msg late = {.id = 0x585, .length = 8, .data = {0x4F, 0x00, 0x20, 0x00, 0x01}};
    ck_assert(co_sdo_client_receive(&client, &late, 1100));
    ck_assert_int_eq(co_sdo_client_poll(&client, &fake_bus, 1200), CO_SDO_ABORTED);
}
END_TEST

START_TEST(the_client_ignores_frames_that_are_not_its_answer)
{
    struct co_sdo_client client;
    co_sdo_client_init(&client, 5, 1000);
    co_sdo_client_read(&client, 0x2000, 0, 0);
    ck_assert_int_eq(co_sdo_client_poll(&client, &fake_bus, 0), CO_SDO_BUSY);
    struct can_msg message = {.id = 0x584, .length = 8, .data = {0x4F, 0x00, 0x20, 0x00, 0x07}};
    ck_assert(!co_sdo_client_receive(&client, &message, 0)); /* another server */
    message.id = 0x585;
    message.length = 5;
    ck_assert(co_sdo_client_receive(&client, &message, 0)); /* too short */
    message.length = 8;
    message.data[3] = 1; /* another sub-index */
    ck_assert(co_sdo_client_receive(&client, &message, 0));
    ck_assert_int_eq(co_sdo_client_poll(&client, &fake_bus, 0), CO_SDO_BUSY);
    message.data[3] = 0;
    ck_assert(co_sdo_client_receive(&client, &message, 0));
    ck_assert_int_eq(co_sdo_client_poll(&client, &fake_bus, 0), CO_SDO_DONE);
    ck_assert_uint_eq(client.buffer[0], 7);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("co_sdo");
    TCase *tcase = tcase_create("all");
    tcase_add_checked_fixture(tcase, setup, NULL);
    tcase_add_test(tcase, expedited_transfers_of_each_length);
    tcase_add_test(tcase, abort_codes_of_cia_301);
    tcase_add_test(tcase, segmented_upload_by_the_figures);
    tcase_add_test(tcase, segmented_download_by_the_figures);
    tcase_add_test(tcase, a_size_may_be_unknown_or_nothing);
    tcase_add_test(tcase, segmented_downloads_are_refused_like_expedited_ones);
    tcase_add_test(tcase, without_an_owner_the_dictionary_decides);
    tcase_add_test(tcase, toggle_and_overflow_end_a_transfer);
    tcase_add_test(tcase, a_transfer_that_stands_still_is_forgotten);
    tcase_add_test(tcase, client_and_server_carry_every_length_both_ways);
    tcase_add_test(tcase, the_client_gives_back_the_servers_abort);
    tcase_add_test(tcase, the_client_does_not_wait_for_ever);
    tcase_add_test(tcase, the_client_ignores_frames_that_are_not_its_answer);
    suite_add_tcase(suite, tcase);
    return run_suite(suite);
}
