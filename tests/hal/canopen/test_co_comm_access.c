/* Whom the device asks about an object: the profile about its own, programs and storing
 * parameters (0x1010, 0x1011, 0x1F50 and above, co_device.h), itself about all others. */
#include <check.h>
#include <string.h>

#include "hal/bus/bytes.h"
#include "hal/canopen/co_device.h"
#include "hal/canopen/co_pdo_objects.h"
#include "tests/support/assert_close.h"
#include "tests/support/fake_bus.h"

enum { NODE = 5, PROFILE_REFUSES = 0x08000022 };

struct values {
    uint32_t store, restore, program, selection, number;
};

#define RW (CO_READ | CO_WRITE)
static const struct co_entry table[] = {
    CO_ANY(struct values, store, 0x1010, 0, CO_UNSIGNED32, RW, "store"),
    CO_ANY(struct values, restore, 0x1011, 0, CO_UNSIGNED32, RW, "restore"),
    CO_ANY(struct values, program, 0x1F50, 0, CO_UNSIGNED32, RW, "program"),
    CO_ANY(struct values, selection, 0x1F51, 0, CO_UNSIGNED32, RW, "control"),
    CO_ANY(struct values, number, 0x2000, 0, CO_UNSIGNED32, RW, "number"),
};

static struct fake_bus fake;
static struct values values;
static struct co_pdo_four pdos;
static struct co_device device;
static uint32_t verdict;
static unsigned asked_writing, asked_reading, told_written;

static uint32_t writing(void *context, const struct co_entry *entry, const uint8_t *bytes,
                        unsigned length)
{
    (void)context, (void)entry, (void)bytes, (void)length;
    asked_writing++;
    return verdict;
}

static void written(void *context, const struct co_entry *entry)
{
    (void)context, (void)entry;
    told_written++;
}

static uint32_t reading(void *context, const struct co_entry *entry)
{
    (void)context, (void)entry;
    asked_reading++;
    return verdict;
}

static void defaults(void *context, struct co_comm *comm)
{
    (void)context;
    comm->heartbeat_ms = 100;
}

static void setup(void)
{
    static const struct co_device_ops ops = {
        .access = {.writing = writing, .written = written, .reading = reading}};
    static const struct co_dictionary dictionary = {table, sizeof table / sizeof table[0], &values};
    const struct co_device_config config = {.node_id = NODE,
                                            .application = &dictionary,
                                            .ops = &ops,
                                            .pdos = co_pdo_four_init(&pdos),
                                            .defaults = defaults};
    fake_bus_init(&fake);
    verdict = 0;
    ck_assert_int_eq(co_device_init(&device, &config, fake_bus_interface(&fake), 0), 0);
    asked_writing = asked_reading = told_written = 0;
}

/* Returns the answer's abort code, or 0. */
static uint32_t sdo(uint8_t command, uint16_t index, uint8_t sub, uint32_t data)
{
    struct can_msg request = {.id = 0x600 + NODE, .length = 8, .data = {command}};
    bytes_put_u16(request.data + 1, index);
    request.data[3] = sub;
    bytes_put_u32(request.data + 4, data);
    ck_assert(co_device_receive(&device, &request, 1000000));
    const struct can_msg *answer = fake_bus_last(&fake, 0x580 + NODE);
    ck_assert_ptr_nonnull(answer);
    return answer->data[0] == 0x80 ? bytes_get_u32(answer->data + 4) : 0;
}

START_TEST(the_profile_answers_for_its_own_objects)
{
    static const uint16_t indices[] = {0x1010, 0x1011, 0x1F50, 0x1F51, 0x2000};
    const uint32_t *const kept[] = {&values.store, &values.restore, &values.program,
                                    &values.selection, &values.number};
    for (unsigned i = 0; i < sizeof indices / sizeof indices[0]; i++) {
        verdict = 0;
        ck_assert_uint_eq(sdo(0x23, indices[i], 0, i), 0);
        ck_assert_uint_eq(sdo(0x40, indices[i], 0, 0), 0);
        ck_assert_uint_eq(asked_writing, 2 * i + 1);
        ck_assert_uint_eq(told_written, i + 1);
        ck_assert_uint_eq(asked_reading, 2 * i + 1);
        verdict = PROFILE_REFUSES;
        ck_assert_uint_eq(*kept[i], i);
        ck_assert_uint_eq(sdo(0x23, indices[i], 0, i + 1), PROFILE_REFUSES);
        ck_assert_uint_eq(*kept[i], i);
        ck_assert_uint_eq(sdo(0x40, indices[i], 0, 0), PROFILE_REFUSES);
        ck_assert_uint_eq(told_written, i + 1);
    }
}
END_TEST

START_TEST(it_is_not_asked_about_communication)
{
    static const struct {
        uint8_t command;
        uint16_t index;
        uint8_t sub;
        uint32_t data;
    } writes[] = {{0x2F, 0x1003, 0, 0},          {0x23, 0x1005, 0, 0x80}, {0x23, 0x1006, 0, 1000},
                  {0x23, 0x1016, 1, 0x00070064}, {0x2B, 0x1017, 0, 50},   {0x2F, 0x1400, 2, 1},
                  {0x2F, 0x1600, 0, 0},          {0x2F, 0x1800, 2, 1},    {0x2F, 0x1A00, 0, 0}};
    static const uint16_t reads[] = {0x1000, 0x1001, 0x1005, 0x1008, 0x1009, 0x1014, 0x1017,
                                     0x1018, 0x1029, 0x1200, 0x1400, 0x1600, 0x1800, 0x1A00};
    verdict = PROFILE_REFUSES;
    for (unsigned i = 0; i < sizeof writes / sizeof writes[0]; i++) {
        ck_assert_msg(sdo(writes[i].command, writes[i].index, writes[i].sub, writes[i].data) == 0,
                      "%#x was refused", writes[i].index);
    }
    for (unsigned i = 0; i < sizeof reads / sizeof reads[0]; i++) {
        ck_assert_msg(sdo(0x40, reads[i], 0, 0) == 0, "%#x was refused", reads[i]);
    }
    ck_assert_uint_eq(asked_writing + asked_reading + told_written, 0);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("access to communication objects");
    TCase *tests = tcase_create("all");
    tcase_add_checked_fixture(tests, setup, NULL);
    tcase_add_test(tests, the_profile_answers_for_its_own_objects);
    tcase_add_test(tests, it_is_not_asked_about_communication);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
