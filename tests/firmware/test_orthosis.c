/* The whole device on a bus that the test plays: settings kept and forgotten over SDO, at
 * standstill only, whatever the power does; and what a crash left. */
#include "firmware/orthosis.h"

#include <string.h>

#include "hal/bus/bytes.h"
#include "tests/support/assert_close.h"
#include "tests/support/fake_bus.h"
#include "tests/support/nv_memory.h"

enum { STILL_TICKS = 800, SDO_DONE = 0 };
#define SAVE UINT32_C(0x65766173) /* "save" and "load", CiA 301 7.5.2.13 and 7.5.2.14 */
#define LOAD UINT32_C(0x64616F6C)
#define NOT_STORED UINT32_C(0x08000020)
#define WRONG_STATE UINT32_C(0x08000022)

static struct fake_bus fake;
static struct nv_memory memory, memory_before;
static struct nv_store nv;
static struct black_box box;
static struct crash_record crash;
static struct orthosis device;

static bool never_pressed(void *context)
{
    (void)context;
    return false;
}

static void feed(void *context)
{
    (void)context;
}

static const struct emergency_stop_ops stop_ops = {never_pressed};
static const struct watchdog_ops feed_ops = {feed};
static const struct watchdog watchdog = {&feed_ops, NULL};

static void power_up(void)
{
    const struct orthosis_config config = {
        .bus = fake_bus_interface(&fake),
        .stop = {&stop_ops, NULL},
        .watchdog = &watchdog,
        .nv = &nv,
        .black_box = &box,
        .crash = &crash,
    };
    fake_bus_init(&fake);
    orthosis_init(&device, &config);
}

/* A memory that holds settings, as a delivered device has them. */
static void deliver(void)
{
    struct settings settings;
    struct param_store store;
    nv_memory_init(&memory);
    nv = nv_memory_store(&memory);
    memset(&crash, 0, sizeof crash);
    memset(&box, 0, sizeof box);
    ck_assert_int_eq(settings_load(&settings, &store, &nv), PARAM_STORE_EMPTY);
    settings.control.kp_high_m_s_rad = 0.1f;
    ck_assert_int_eq(settings_save(&settings, &store, true), PARAM_STORE_OK);
}

static void tick(int32_t angle_counts)
{
    struct can_msg leg = {.id = 0x283, .length = 5};
    const struct can_msg sync = {.id = 0x080, .flags = CAN_FRAME_OWN};
    for (unsigned i = 0; i < 3; i++) {
        leg.data[i] = (uint8_t)((uint32_t)angle_counts >> (8 * i));
    }
    fake_bus_init(&fake);
    orthosis_start_cycle(&device);
    fake_bus_put(&fake, &leg);
    leg.id = 0x284;
    fake_bus_put(&fake, &leg);
    fake_bus_put(&fake, &sync);
    (void)orthosis_poll(&device);
}

static void stand(void)
{
    for (int i = 0; i < STILL_TICKS; i++) {
        tick(1000);
    }
}

/* Expedited download of `size` bytes. Returns SDO_DONE or the abort code. */
static uint32_t write(uint16_t index, uint8_t sub, uint32_t value, unsigned size)
{
    struct can_msg request = {.id = 0x610, .length = 8};
    request.data[0] = (uint8_t)(0x23 | (4 - size) << 2);
    bytes_put_u16(request.data + 1, index);
    request.data[3] = sub;
    bytes_put_u32(request.data + 4, value);
    fake_bus_init(&fake);
    fake_bus_put(&fake, &request);
    (void)orthosis_poll(&device);
    const struct can_msg *answer = fake_bus_last(&fake, 0x590);
    ck_assert_ptr_nonnull(answer);
    return answer->data[0] == 0x80 ? bytes_get_u32(answer->data + 4) : SDO_DONE;
}

static uint32_t write_kp(float value)
{
    ck_assert_uint_eq(write(0x2000, 5, settings_lock_key_of(1), 4), SDO_DONE);
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    for (uint8_t i = 0; i < CONTROL_PARAM_COUNT; i++) {
        if (control_param_descriptors[i].offset == offsetof(struct control_params, kp_m_s_rad)) {
            return write(0x2010, (uint8_t)(i + 1), bits, 4);
        }
    }
    return WRONG_STATE;
}

static float kp(void)
{
    return device.task.node.objects.params.kp_m_s_rad;
}

START_TEST(what_is_saved_is_there_after_power_up)
{
    deliver();
    power_up();
    ck_assert_int_eq(device.forced_fault, SUPERVISOR_FAULT_NONE);
    stand();
    const float before = kp();
    ck_assert_uint_eq(write_kp(0.05f), SDO_DONE);
    power_up();
    ck_assert(kp() == before); /* not kept by itself */
    stand();
    ck_assert_uint_eq(write_kp(0.05f), SDO_DONE);
    ck_assert_uint_eq(write(0x1010, 1, SAVE, 4), SDO_DONE);
    const uint32_t crc = device.task.node.objects.params_crc;
    power_up();
    ck_assert(kp() == 0.05f);
    ck_assert_uint_eq(device.task.node.objects.params_crc, crc);
    ck_assert_int_eq(device.store_result, PARAM_STORE_OK);
    ck_assert_int_eq(device.settings_result, SETTINGS_OK);
}
END_TEST

/* What was not changed is kept as well: that it walks at the start, and the branch of the laws, which
 * is of the newer copy from then on. */
START_TEST(what_was_not_changed_is_kept_as_well)
{
    struct settings settings;
    struct param_store store;
    static struct gait_branch branch;
    deliver();
    ck_assert_int_eq(settings_load(&settings, &store, &nv), PARAM_STORE_OK);
    for (uint32_t i = 0; i < sizeof branch; i++) {
        ((uint8_t *)&branch)[i] = (uint8_t)(37u * i + 11u);
    }
    branch.count = 9;
    settings.control.branch = &branch;
    settings.walk_at_start = 1;
    ck_assert_int_eq(settings_save(&settings, &store, true), PARAM_STORE_OK);
    power_up();
    ck_assert_uint_eq(device.walk_at_start, 1);
    const struct gait_branch *const before = device.task.node.objects.params.branch;
    device.task.node.objects.walk_requested = 0; /* not now */
    stand();
    ck_assert_uint_eq(write_kp(0.05f), SDO_DONE);
    ck_assert_uint_eq(write(0x1010, 1, SAVE, 4), SDO_DONE);
    ck_assert_ptr_ne(device.task.node.objects.params.branch, before);
    ck_assert_mem_eq(device.task.node.objects.params.branch, &branch, sizeof branch);
    ck_assert(!device.task.node.guard.corrupt);
    power_up();
    ck_assert(kp() == 0.05f);
    ck_assert_uint_eq(device.walk_at_start, 1);
    ck_assert_mem_eq(device.task.node.objects.params.branch, &branch, sizeof branch);
}
END_TEST

START_TEST(only_at_standstill_and_with_the_signature)
{
    deliver();
    power_up();
    stand();
    const uint32_t operations = memory.operations;
    ck_assert_uint_eq(write(0x1010, 1, LOAD, 4), NOT_STORED);
    ck_assert_uint_eq(write(0x1011, 1, SAVE, 4), NOT_STORED);
    for (int i = 0; i < 200; i++) {
        tick(1000 + 20000 * i);
    }
    ck_assert_uint_eq(write(0x1010, 1, SAVE, 4), WRONG_STATE);
    ck_assert_uint_eq(write(0x1011, 1, LOAD, 4), WRONG_STATE);
    stand();
    device.task.node.rules.powered = true;
    ck_assert_uint_eq(write(0x1010, 1, SAVE, 4), WRONG_STATE);
    ck_assert_uint_eq(memory.operations, operations); /* nothing was touched */
}
END_TEST

START_TEST(forgotten_settings_leave_a_device_that_does_not_walk)
{
    deliver();
    power_up();
    stand();
    ck_assert_uint_eq(write(0x1011, 1, LOAD, 4), SDO_DONE);
    tick(1000);
    ck_assert_int_eq(device.task.output.fault, SUPERVISOR_FAULT_PARAMETERS);
    ck_assert_uint_eq(write(0x1010, 1, SAVE, 4), WRONG_STATE); /* nobody's are not kept */
    power_up();
    ck_assert_int_eq(device.store_result, PARAM_STORE_EMPTY);
    ck_assert_int_eq(device.forced_fault, SUPERVISOR_FAULT_PARAMETERS);
}
END_TEST

/* After a failure at any erase or word, whatever the torn word reads as, the device comes
 * back with the old or with the new settings. */
START_TEST(power_may_fail_at_any_word)
{
    deliver();
    power_up();
    stand();
    memory_before = memory;
    const float old_kp = kp();
    ck_assert_uint_eq(write_kp(0.05f), SDO_DONE);
    ck_assert_uint_eq(write(0x1010, 1, SAVE, 4), SDO_DONE);
    const uint32_t operations = memory.operations - memory_before.operations;
    unsigned old = 0, new = 0;
    ck_assert_uint_gt(operations, 100);
    for (uint32_t i = 0; i <= operations; i++) {
        memory = memory_before;
        power_up();
        ck_assert(kp() == old_kp);
        device.task.node.rules.standstill = true;
        ck_assert_uint_eq(write_kp(0.05f), SDO_DONE);
        memory.power_fails_at = memory.operations + i;
        memory.torn = (enum nv_memory_torn)(i % 4);
        const uint32_t answer = write(0x1010, 1, SAVE, 4);
        nv_memory_power_up(&memory);
        power_up();
        ck_assert_int_eq(device.forced_fault, SUPERVISOR_FAULT_NONE);
        ck_assert(kp() == old_kp || kp() == 0.05f);
        old += kp() == old_kp;
        new += kp() == 0.05f;
        ck_assert(answer != SDO_DONE || kp() == 0.05f);
    }
    ck_assert_uint_ge(old, operations - 1);
    ck_assert_uint_ge(new, 1);
}
END_TEST

START_TEST(a_crash_is_shown_until_it_was_seen)
{
    deliver();
    crash.cause = CRASH_ASSERTION;
    crash.detail = 1234;
    crash_record_seal(&crash);
    power_up();
    const struct controller_objects *objects = &device.task.node.objects;
    ck_assert_uint_eq(objects->crash_cause, CRASH_ASSERTION);
    ck_assert_ptr_eq(objects->crash_image.bytes, &crash);
    ck_assert_uint_eq(objects->crash_image.length, sizeof crash);
    ck_assert_uint_ne(write(0x2032, 1, 5, 1), SDO_DONE); /* only 0 may be written */
    ck_assert_uint_eq(write(0x2032, 1, 0, 1), SDO_DONE);
    ck_assert_uint_eq(objects->crash_cause, CRASH_NONE);
    ck_assert_uint_eq(objects->crash_image.length, 0);
    ck_assert(!crash_record_is_valid(&crash));
    ck_assert_uint_eq(crash_record_count(&crash), 1);
}
END_TEST

static unsigned looks;

static void look(void)
{
    looks++;
}

/* What is usual is known after so many ticks. */
enum { USUAL_FRAMES = 4, SETTLED = 100 };

/* Whatever else a tick may do, it does where there is little to do. */
START_TEST(it_looks_after_itself_in_quiet_ticks_only)
{
    const struct can_msg sync = {.id = 0x080, .flags = CAN_FRAME_OWN};
    const struct can_msg frame = {.id = 0x181, .length = 6};
    unsigned quiet = 0, full = 0;
    deliver();
    power_up();
    device.task.config.configure_nodes = false; /* it would ask the silent ones all the time */
    stand();
    device.in_quiet_ticks = look;
    for (unsigned i = 0; i < 400; i++) {
        const bool is_full = i % 5 == 4;
        const unsigned frames = is_full ? USUAL_FRAMES + 1 + i % 7 : USUAL_FRAMES;
        const uint32_t blocks = box.header.next_sequence;
        fake_bus_clear(&fake);
        for (unsigned k = 0; k < frames; k++) {
            fake_bus_put(&fake, &frame);
        }
        fake_bus_put(&fake, &sync);
        looks = 0;
        orthosis_start_cycle(&device);
        ck_assert_uint_eq(looks, 0); /* no SYNC waits for it */
        (void)orthosis_poll(&device);
        const bool is_busy = control_task_was_busy(&device.task);
        if (i >= SETTLED) {
            ck_assert(looks == 0 || !(is_busy || is_full || box.header.next_sequence != blocks));
            quiet += looks;
            full += !is_busy && is_full;
        }
    }
    ck_assert_uint_ge(quiet, 200);
    ck_assert_uint_ge(full, 50);
}
END_TEST

/* A board without a bus is tested, too. */
START_TEST(without_a_bus_it_looks_after_itself_in_each_cycle)
{
    deliver();
    power_up();
    device.in_quiet_ticks = look;
    looks = 0;
    for (unsigned i = 0; i < 100; i++) {
        fake_bus_clear(&fake);
        orthosis_start_cycle(&device);
        (void)orthosis_poll(&device);
    }
    ck_assert_uint_eq(looks, 100);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("orthosis");
    TCase *tests = tcase_create("all");
    tcase_set_timeout(tests, 60.0);
    tcase_add_test(tests, what_is_saved_is_there_after_power_up);
    tcase_add_test(tests, what_was_not_changed_is_kept_as_well);
    tcase_add_test(tests, only_at_standstill_and_with_the_signature);
    tcase_add_test(tests, forgotten_settings_leave_a_device_that_does_not_walk);
    tcase_add_test(tests, power_may_fail_at_any_word);
    tcase_add_test(tests, a_crash_is_shown_until_it_was_seen);
    tcase_add_test(tests, it_looks_after_itself_in_quiet_ticks_only);
    tcase_add_test(tests, without_a_bus_it_looks_after_itself_in_each_cycle);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
