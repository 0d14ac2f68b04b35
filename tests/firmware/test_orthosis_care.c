/* What the device looks after beside its controller: the program in flash, again and again; the first reason of a fault;
 * and the black box' trigger. */
#include "firmware/orthosis.h"

#include <string.h>

#include "hal/bus/bytes.h"
#include "hal/storage/crc.h"
#include "tests/support/assert_close.h"
#include "tests/support/fake_bus.h"
#include "tests/support/nv_memory.h"

enum { ROOM = 4096, IMAGE_BYTES = 2000, ROUND_TICKS_MOST = 5000 };

static uint8_t flash[3 * ROOM];
static struct fake_bus fake;
static struct nv_memory memory;
static struct nv_store nv;
static struct black_box box;
static struct crash_record crash;
static struct orthosis device;

static bool read_word(void *context, uint32_t address, uint8_t *out)
{
    (void)context;
    memcpy(out, flash + address, PROGRAM_WORD_BYTES);
    return true;
}

static bool never_pressed(void *context)
{
    (void)context;
    return false;
}

static void feed(void *context)
{
    (void)context;
}

/* Header and sums as hal/storage/program_image.h lays them out. */
static void make_image(void)
{
    memset(flash, 0xFF, sizeof flash);
    for (uint32_t i = 0; i < IMAGE_BYTES; i++) {
        flash[i] = (uint8_t)(i * 11u + 5u);
    }
    bytes_put_u32(flash + 0x200, 0x474D4941);
    bytes_put_u32(flash + 0x204, 7);
    bytes_put_u32(flash + 0x208, 5);
    bytes_put_u32(flash + 0x210, IMAGE_BYTES);
    bytes_put_u32(flash + 0x21C, crc32_update(crc32_update(CRC32_INIT, flash, 0x21C), flash + 0x220,
                                              IMAGE_BYTES - 0x220));
}

static bool restarted;

static void power_up(void)
{
    static const struct emergency_stop_ops stop_ops = {never_pressed};
    static const struct watchdog_ops feed_ops = {feed};
    static const struct watchdog watchdog = {&feed_ops, NULL};
    static const struct program_slots slots = {.memory = {.read = read_word, .page_bytes = ROOM},
                                               .stage = ROOM,
                                               .room = ROOM,
                                               .mark = 2 * ROOM,
                                               .hardware = 7};
    const struct orthosis_config config = {.bus = fake_bus_interface(&fake),
                                           .stop = {&stop_ops, NULL},
                                           .watchdog = &watchdog,
                                           .nv = &nv,
                                           .black_box = &box,
                                           .crash = &crash,
                                           .program = &slots,
                                           .restarted = restarted};
    nv_memory_init(&memory);
    nv = nv_memory_store(&memory);
    fake_bus_init(&fake);
    orthosis_init(&device, &config);
    device.task.config.configure_nodes = false; /* it would ask the silent ones all the time */
}

/* Ticks until another round is done. */
static void go_round(void)
{
    const uint32_t before = device.program_rounds;
    const struct can_msg sync = {.id = 0x080, .flags = CAN_FRAME_OWN};
    for (int i = 0; i < ROUND_TICKS_MOST && device.program_rounds == before; i++) {
        fake_bus_init(&fake);
        orthosis_start_cycle(&device);
        fake_bus_put(&fake, &sync);
        (void)orthosis_poll(&device);
    }
    ck_assert_uint_eq(device.program_rounds, before + 1);
}

START_TEST(a_damaged_program_stays_damaged)
{
    make_image();
    power_up();
    go_round();
    go_round();
    ck_assert(!orthosis_program_is_damaged(&device));
    flash[IMAGE_BYTES - 100] ^= 0x10; /* a cell that reads as it likes */
    go_round();
    go_round(); /* the round under way may have been past it */
    ck_assert(orthosis_program_is_damaged(&device));
    flash[IMAGE_BYTES - 100] ^= 0x10;
    go_round();
    go_round();
    ck_assert(orthosis_program_is_damaged(&device));
}
END_TEST

START_TEST(the_count_of_rounds_stays_at_its_end)
{
    const struct can_msg sync = {.id = 0x080, .flags = CAN_FRAME_OWN};
    make_image();
    power_up();
    device.program_rounds = UINT32_MAX;
    for (int i = 0; i < ROUND_TICKS_MOST; i++) {
        fake_bus_init(&fake);
        orthosis_start_cycle(&device);
        fake_bus_put(&fake, &sync);
        (void)orthosis_poll(&device);
        ck_assert_uint_eq(device.program_rounds, UINT32_MAX);
    }
}
END_TEST

/* Without settings it does not walk, whatever a restart says in addition. */
START_TEST(missing_settings_outweigh_a_restart)
{
    make_image();
    restarted = true;
    power_up();
    restarted = false;
    ck_assert_int_eq(device.task.controller.supervisor.latched, SUPERVISOR_FAULT_PARAMETERS);
    ck_assert_int_eq(device.task.controller.supervisor.state, SUPERVISOR_FAULT);
}
END_TEST

static void pass(int ticks)
{
    const struct can_msg sync = {.id = 0x080, .flags = CAN_FRAME_OWN};
    for (int i = 0; i < ticks; i++) {
        fake_bus_init(&fake);
        orthosis_start_cycle(&device);
        fake_bus_put(&fake, &sync);
        (void)orthosis_poll(&device);
        fake_bus_init(&fake);
        (void)orthosis_poll(&device);
    }
}

/* A recording that was begun anew in a fault is not ended by what the same stop turns into: its reason was told. */
START_TEST(a_fault_behind_a_fault_triggers_nothing)
{
    make_image();
    memset(&box, 0, sizeof box);
    power_up();
    pass(20);
    ck_assert_int_eq(device.task.output.fault, SUPERVISOR_FAULT_PARAMETERS);
    ck_assert_uint_ne(box.header.state, BLACK_BOX_RECORDING);
    ck_assert_uint_eq(box.header.reason, 1u << SUPERVISOR_FAULT_PARAMETERS);
    black_box_start(&box, 1, 2);
    pass(20);
    ck_assert_uint_eq(box.header.state, BLACK_BOX_RECORDING);
    device.forced_fault = SUPERVISOR_FAULT_NODE_LOST; /* another reason, in every tick */
    pass(20);
    ck_assert_int_eq(device.task.output.fault, SUPERVISOR_FAULT_NODE_LOST);
    ck_assert_uint_eq(box.header.state, BLACK_BOX_RECORDING);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("orthosis' care");
    TCase *tests = tcase_create("all");
    tcase_add_test(tests, a_damaged_program_stays_damaged);
    tcase_add_test(tests, the_count_of_rounds_stays_at_its_end);
    tcase_add_test(tests, missing_settings_outweigh_a_restart);
    tcase_add_test(tests, a_fault_behind_a_fault_triggers_nothing);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
