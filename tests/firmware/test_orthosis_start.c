/* The device from power-on: with whose settings it starts, what it holds on to until somebody
 * resets it, when it feeds its watchdog, and how it comes back from bus-off. */
#include "firmware/orthosis.h"

#include <string.h>

#include "sim_host/subjects/settings_image.h"
#include "tests/support/assert_close.h"
#include "tests/support/fake_bus.h"

static uint8_t image[SETTINGS_IMAGE_BYTES];
static struct fake_bus fake;
static struct black_box box;
static struct orthosis orthosis;
static struct orthosis_config config;
static unsigned feeds, toggles;

/* ---- The board ---------------------------------------------------------------------------- */

static uint32_t bank_words(void *context)
{
    (void)context;
    return SETTINGS_IMAGE_WORDS;
}

static uint8_t *word(uint32_t bank, uint32_t index)
{
    return image + (bank * SETTINGS_IMAGE_WORDS + index) * NV_WORD_BYTES;
}

static enum nv_result read_word(void *context, uint32_t bank, uint32_t index, uint8_t *out)
{
    (void)context;
    memcpy(out, word(bank, index), NV_WORD_BYTES);
    return NV_OK;
}

static const uint8_t *map(void *context, uint32_t bank)
{
    (void)context;
    return word(bank, 0);
}

static enum nv_result erase(void *context, uint32_t bank)
{
    (void)context;
    memset(word(bank, 0), 0xFF, (size_t)SETTINGS_IMAGE_WORDS * NV_WORD_BYTES);
    return NV_OK;
}

static enum nv_result write_word(void *context, uint32_t bank, uint32_t index, const uint8_t *bytes)
{
    (void)context;
    memcpy(word(bank, index), bytes, NV_WORD_BYTES);
    return NV_OK;
}

static void feed(void *context)
{
    (void)context;
    feeds++;
}

static void toggle(void *context)
{
    (void)context;
    toggles++;
}

static bool is_pressed(void *context)
{
    (void)context;
    return false;
}

static const struct nv_store_ops nv_ops = {bank_words, read_word, map, erase, write_word};
static const struct nv_store nv = {&nv_ops, NULL};
static const struct watchdog_ops watchdog_ops = {feed};
static const struct watchdog watchdog = {&watchdog_ops, NULL};
static const struct drive_power_enable_ops drive_power_ops = {toggle};
static const struct drive_power_enable drive_power = {&drive_power_ops, NULL};
static const struct emergency_stop_ops stop_ops = {is_pressed};

static void setup(void)
{
    fake_bus_init(&fake);
    memset(image, 0xFF, sizeof image);
    memset(&box, 0, sizeof box);
    feeds = toggles = 0;
    config = (struct orthosis_config){.bus = fake_bus_interface(&fake),
                                      .stop = {&stop_ops, NULL},
                                      .watchdog = &watchdog,
                                      .drive_power = &drive_power,
                                      .nv = &nv,
                                      .black_box = &box};
}

static void keep(float speed_rad_s, uint32_t walk_at_start)
{
    struct settings settings;
    settings_default(&settings);
    settings.desired_speed_rad_s = speed_rad_s;
    settings.walk_at_start = walk_at_start;
    ck_assert_int_eq(settings_image(&settings, image), 0);
}

static void run(int ticks)
{
    const struct can_msg sync = {.id = 0x080, .flags = CAN_FRAME_OWN};
    for (int i = 0; i < ticks; i++) {
        fake_bus_clear(&fake);
        orthosis_start_cycle(&orthosis);
        fake_bus_put(&fake, &sync);
        (void)orthosis_poll(&orthosis);
    }
}

static enum supervisor_state state(void)
{
    return orthosis.task.output.state;
}

/* ---- Settings ----------------------------------------------------------------------------- */

START_TEST(an_empty_memory_is_a_fault_that_stays)
{
    orthosis_init(&orthosis, &config);
    ck_assert_int_eq(orthosis.store_result, PARAM_STORE_EMPTY);
    run(5);
    ck_assert_int_eq(state(), SUPERVISOR_FAULT);
    ck_assert_int_eq(orthosis.task.output.fault, SUPERVISOR_FAULT_PARAMETERS);
    for (int i = 0; i < 2000; i++) { /* however often it is reset */
        orthosis.task.node.objects.reset_requested = 1;
        run(1);
        ck_assert_int_eq(state(), SUPERVISOR_FAULT);
        ck_assert(!orthosis.task.output.sea[SIDE_LEFT].enable &&
                  !orthosis.task.output.sea[SIDE_RIGHT].enable);
    }
}
END_TEST

START_TEST(kept_settings_are_the_ones_in_force)
{
    keep(0.613f, 1);
    orthosis_init(&orthosis, &config);
    ck_assert_int_eq(orthosis.store_result, PARAM_STORE_OK);
    ck_assert_int_eq(orthosis.settings_result, SETTINGS_OK);
    ck_assert_int_eq(orthosis.forced_fault, SUPERVISOR_FAULT_NONE);
    ck_assert(orthosis.task.node.objects.desired_speed_rad_s == 0.613f);
    ck_assert_uint_eq(orthosis.task.node.objects.walk_requested, 1);
    run(3);
    ck_assert_int_eq(state(), SUPERVISOR_INIT); /* no node has been heard */
}
END_TEST

START_TEST(settings_that_do_not_pass_are_not_used)
{
    keep(0.6f, 2); /* neither 0 nor 1 */
    orthosis_init(&orthosis, &config);
    ck_assert_int_eq(orthosis.store_result, PARAM_STORE_OK);
    ck_assert_int_eq(orthosis.settings_result, SETTINGS_BAD_SPEED);
    run(1);
    ck_assert_int_eq(orthosis.task.output.fault, SUPERVISOR_FAULT_PARAMETERS);
    ck_assert_uint_eq(orthosis.task.node.objects.walk_requested, 0);
}
END_TEST

START_TEST(one_changed_bit_in_the_memory_is_noticed)
{
    keep(0.6f, 0);
    image[40 * NV_WORD_BYTES] ^= 0x04;
    orthosis_init(&orthosis, &config);
    ck_assert_int_ne(orthosis.store_result, PARAM_STORE_OK);
    run(1);
    ck_assert_int_eq(orthosis.task.output.fault, SUPERVISOR_FAULT_PARAMETERS);
}
END_TEST

/* ---- Restarts ----------------------------------------------------------------------------- */

START_TEST(after_a_crash_it_waits_for_a_reset)
{
    keep(0.6f, 1);
    config.restarted = true;
    orthosis_init(&orthosis, &config);
    run(3);
    ck_assert_int_eq(state(), SUPERVISOR_FAULT);
    ck_assert_int_eq(orthosis.task.output.fault, SUPERVISOR_FAULT_RESTARTED);
    run(2000);
    ck_assert_int_eq(state(), SUPERVISOR_FAULT); /* not by itself */
}
END_TEST

/* What was recorded before the crash is frozen; a box that is no box is started anew. */
START_TEST(the_record_of_a_crash_is_kept)
{
    keep(0.6f, 0);
    orthosis_init(&orthosis, &config);
    ck_assert(black_box_is_valid(&box));
    ck_assert_uint_eq(box.header.state, BLACK_BOX_RECORDING);
    run(50);
    config.restarted = true;
    orthosis_init(&orthosis, &config);
    ck_assert_uint_eq(box.header.state, BLACK_BOX_FROZEN);
    ck_assert_uint_eq(box.header.reason, 1u << SUPERVISOR_FAULT_RESTARTED);
    config.restarted = false; /* and over the next power-on, as long as the memory lasts */
    orthosis_init(&orthosis, &config);
    ck_assert_uint_eq(box.header.state, BLACK_BOX_FROZEN);
    box.header.magic ^= 1;
    config.restarted = true;
    orthosis_init(&orthosis, &config);
    ck_assert_uint_eq(box.header.state, BLACK_BOX_RECORDING);
}
END_TEST

/* ---- Watchdog and bus --------------------------------------------------------------------- */

START_TEST(without_a_tick_it_is_not_fed)
{
    keep(0.6f, 0);
    orthosis_init(&orthosis, &config);
    for (int i = 0; i < 5; i++) { /* until the first SYNC is back: nothing can move yet */
        (void)orthosis_poll(&orthosis);
    }
    ck_assert_uint_eq(feeds, 5);
    run(10);
    ck_assert_uint_eq(feeds, 15);
    for (int i = 0; i < 10; i++) { /* no SYNC: no tick */
        (void)orthosis_poll(&orthosis);
    }
    ck_assert_uint_eq(feeds, 15);
    ck_assert_uint_eq(toggles, feeds); /* the drives' power is permitted by the same sign */
    config.drive_power = NULL;
    orthosis_init(&orthosis, &config);
    run(3);
    ck_assert_uint_eq(toggles, 15);
    ck_assert_uint_eq(feeds, 18);
}
END_TEST

START_TEST(a_bus_that_is_off_is_asked_back_now_and_then)
{
    keep(0.6f, 0);
    orthosis_init(&orthosis, &config);
    fake.verdict = CAN_DOWN;
    for (int i = 0; i < 5 * (BUS_RECOVERY_TICKS + 1); i++) {
        orthosis_start_cycle(&orthosis);
    }
    ck_assert_uint_eq(orthosis.recovery.asked, 5);
    ck_assert_uint_eq(fake.recoveries, 5);
    orthosis.recovery.asked = UINT32_MAX;
    for (int i = 0; i <= BUS_RECOVERY_TICKS; i++) {
        orthosis_start_cycle(&orthosis);
    }
    ck_assert_uint_eq(orthosis.recovery.asked, UINT32_MAX);
    ck_assert_uint_eq(fake.recoveries, 6);
    fake.verdict = CAN_OK;
    orthosis_start_cycle(&orthosis);
    ck_assert_uint_eq(fake_bus_count(&fake, 0x080), 1);
    fake.verdict = CAN_DOWN; /* off again: at once, not after the rest of the wait */
    orthosis.task.sync_waits = 0;
    orthosis_start_cycle(&orthosis);
    ck_assert_uint_eq(fake.recoveries, 7);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("orthosis start");
    TCase *tests = tcase_create("all");
    tcase_add_checked_fixture(tests, setup, NULL);
    tcase_add_test(tests, an_empty_memory_is_a_fault_that_stays);
    tcase_add_test(tests, kept_settings_are_the_ones_in_force);
    tcase_add_test(tests, settings_that_do_not_pass_are_not_used);
    tcase_add_test(tests, one_changed_bit_in_the_memory_is_noticed);
    tcase_add_test(tests, after_a_crash_it_waits_for_a_reset);
    tcase_add_test(tests, the_record_of_a_crash_is_kept);
    tcase_add_test(tests, without_a_tick_it_is_not_fed);
    tcase_add_test(tests, a_bus_that_is_off_is_asked_back_now_and_then);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
