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
static struct crash_streak streak;
static unsigned feeds, toggles, cuts;
static bool is_cut;
static unsigned reads;                    /* of the memory */
static double now_ms, fed_ms, longest_ms; /* what erasing and writing take; between two feeds */
static double erase_ms, word_ms;

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
    reads++;
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
    now_ms += erase_ms;
    memset(word(bank, 0), 0xFF, (size_t)SETTINGS_IMAGE_WORDS * NV_WORD_BYTES);
    return NV_OK;
}

static enum nv_result write_word(void *context, uint32_t bank, uint32_t index, const uint8_t *bytes)
{
    (void)context;
    now_ms += word_ms;
    memcpy(word(bank, index), bytes, NV_WORD_BYTES);
    return NV_OK;
}

static void feed(void *context)
{
    (void)context;
    feeds++;
    longest_ms = now_ms - fed_ms > longest_ms ? now_ms - fed_ms : longest_ms;
    fed_ms = now_ms;
}

static void toggle(void *context)
{
    (void)context;
    toggles++;
}

static void cut(void *context, bool on)
{
    (void)context;
    is_cut = on;
    cuts++;
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
static const struct drive_power_enable_ops drive_power_ops = {toggle, cut};
static const struct drive_power_enable drive_power = {&drive_power_ops, NULL};
static uint64_t clock_ns(void *context)
{
    (void)context;
    return (uint64_t)(now_ms * 1e6);
}

static const struct clock_ops clock_ops = {.now_ns = clock_ns};
static const struct clock real_clock = {&clock_ops, NULL};
static const struct emergency_stop_ops stop_ops = {is_pressed};

static void setup(void)
{
    fake_bus_init(&fake);
    memset(image, 0xFF, sizeof image);
    memset(&box, 0, sizeof box);
    memset(&streak, 0, sizeof streak);
    feeds = toggles = cuts = reads = 0;
    is_cut = false;
    erase_ms = 49; /* two pages at their longest, DS12288 */
    word_ms = 0.0834;
    config = (struct orthosis_config){.bus = fake_bus_interface(&fake),
                                      .stop = {&stop_ops, NULL},
                                      .watchdog = &watchdog,
                                      .clock = &real_clock,
                                      .drive_power = &drive_power,
                                      .nv = &nv,
                                      .streak = &streak,
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

static void run_with(int ticks, int answers)
{
    const struct can_msg sync = {.id = 0x080, .flags = CAN_FRAME_OWN};
    const struct can_msg answer = {.id = 0x181, .length = 6};
    for (int i = 0; i < ticks; i++) {
        fake_bus_clear(&fake);
        orthosis_start_cycle(&orthosis);
        fake_bus_put(&fake, &sync);
        for (int k = 0; k < answers; k++) {
            fake_bus_put(&fake, &answer);
        }
        (void)orthosis_poll(&orthosis);
    }
}

static void run(int ticks)
{
    run_with(ticks, 0);
}

/* With so much on the bus that no tick is quiet. */
enum { MANY_ANSWERS = 14 };

static void run_busy(int ticks)
{
    run_with(ticks, MANY_ANSWERS);
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

/* Somebody must get at it whatever the memory does to it: crash by crash, no SYNC between. */
START_TEST(the_settings_are_not_read_after_three_crashes_without_a_sync)
{
    keep(0.6f, 1);
    config.restarted = true;
    for (int crashes = 1; crashes <= 5; crashes++) {
        crash_streak_add(&streak);
        reads = 0;
        orthosis_init(&orthosis, &config);
        ck_assert_int_eq(reads == 0, crashes >= 3);
        ck_assert_int_eq(orthosis.forced_fault,
                         crashes >= 3 ? SUPERVISOR_FAULT_RESTARTED : SUPERVISOR_FAULT_NONE);
    }
    ck_assert_uint_eq(orthosis.task.node.objects.walk_requested, 0);
    ck_assert_uint_eq(orthosis.task.node.objects.crash_streak, 5);
    const struct can_msg *emcy = NULL;
    for (int i = 0; i < 50 && emcy == NULL; i++) { /* it says so, by itself */
        run(1);
        emcy = fake_bus_last(&fake, 0x090);
        emcy = emcy != NULL && emcy->data[0] == 0x00 && emcy->data[1] == 0x61 ? emcy : NULL;
    }
    ck_assert_ptr_nonnull(emcy);
    ck_assert_uint_eq(emcy->data[3], 5);
    ck_assert_int_eq(state(), SUPERVISOR_FAULT);
    /* Not "bad parameters": nobody looked at them. */
    ck_assert_int_eq(orthosis.task.output.fault, SUPERVISOR_FAULT_RESTARTED);
    for (int i = 0; i < 1000; i++) { /* and no reset request lifts it */
        orthosis.task.node.objects.reset_requested = 1;
        run(1);
        ck_assert_int_eq(state(), SUPERVISOR_FAULT);
    }
    reads = 0; /* "load" erases without reading, so that the next start finds none */
    const struct write_rules *rules = &orthosis.task.node.rules;
    ck_assert_uint_eq(rules->settings_store->forget_settings(rules->settings_store_context), 0);
    ck_assert_uint_eq(reads, 0);
    ck_assert_uint_eq(image[0], 0xFF);
}
END_TEST

START_TEST(a_sync_that_came_back_ends_the_streak)
{
    keep(0.6f, 0);
    crash_streak_add(&streak);
    crash_streak_add(&streak);
    crash_streak_add(&streak);
    orthosis_init(&orthosis, &config);
    for (int i = 0; i < 9; i++) {
        (void)orthosis_poll(&orthosis);
    }
    ck_assert_uint_eq(crash_streak_length(&streak), 3);
    run(1);
    ck_assert_uint_eq(crash_streak_length(&streak), 0);
    orthosis_init(&orthosis, &config);
    ck_assert_int_eq(orthosis.forced_fault, SUPERVISOR_FAULT_NONE);
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
    black_box_start(&box, 0, 0);
    config.restarted = false; /* a reset at the pin, in the middle of recording */
    orthosis_init(&orthosis, &config);
    ck_assert_uint_eq(box.header.state, BLACK_BOX_RECORDING); /* there was nothing in it yet */
    run(50);
    orthosis_init(&orthosis, &config);
    ck_assert_uint_eq(box.header.state, BLACK_BOX_FROZEN);
    ck_assert_uint_eq(box.header.reason, BLACK_BOX_REASON_RESET);
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
    config.drive_power = NULL;
    orthosis_init(&orthosis, &config);
    run(3);
    ck_assert_uint_eq(feeds, 18);
}
END_TEST

/* The board's button and light: read in every tick, however much there is to do, and told in the state that a
 * replay reads back. */
static bool panel_pressed, panel_lit;
static bool panel_is_pressed(void *context)
{
    (void)context;
    return panel_pressed;
}
static void panel_set_cue(void *context, bool on)
{
    (void)context;
    panel_lit = on;
}

START_TEST(the_wearer_s_panel_is_read_and_lit)
{
    static const struct wearer_panel_ops ops = {panel_is_pressed, panel_set_cue};
    static const struct wearer_panel panel = {&ops, NULL};
    struct controller *controller = &orthosis.task.controller;
    keep(0.6f, 0);
    config.wearer = &panel;
    orthosis_init(&orthosis, &config);
    panel_lit = true;
    run(20);
    ck_assert(!panel_lit);
    ck_assert_uint_eq(orthosis.task.node.objects.state & 0x40u, 0);
    ck_assert_uint_eq(controller->wearer.pressed_ticks, 0);
    panel_pressed = true;
    run_busy(20);
    ck_assert_uint_eq(controller->wearer.pressed_ticks, 20);
    ck_assert_uint_eq(orthosis.task.node.objects.state & 0x40u, 0x40u);
    panel_pressed = false;
    run_busy(2);
    ck_assert_uint_eq(controller->wearer.pressed_ticks, 0);
    orthosis.task.node.objects.wearer_button = 1; /* the virtual one does the same */
    run(5);
    ck_assert_uint_eq(controller->wearer.pressed_ticks, 5);
    ck_assert_uint_eq(orthosis.task.node.objects.state & 0x40u, 0);
    controller->wearer.fade_steps = 1;
    orthosis_start_cycle(&orthosis);
    ck_assert(panel_lit);
}
END_TEST

/* On a bus that is dead no drive can be told to stop: the relay must fall, also after a restart. */
START_TEST(without_a_bus_the_drives_get_no_power)
{
    keep(0.6f, 0);
    for (int restart = 0; restart < 2; restart++) {
        toggles = feeds = 0;
        config.restarted = restart != 0;
        orthosis_init(&orthosis, &config);
        for (int i = 0; i < 3000; i++) {
            orthosis_start_cycle(&orthosis);
            (void)orthosis_poll(&orthosis);
        }
        ck_assert_uint_eq(feeds, 3000);
        ck_assert_uint_eq(toggles, 0);
        for (unsigned ticks = 1; ticks <= 10; ticks++) { /* once a tick, however often it polls */
            run(1);
            for (int i = 0; i < 7; i++) {
                (void)orthosis_poll(&orthosis);
            }
            ck_assert_uint_eq(toggles, ticks);
        }
    }
}
END_TEST

static unsigned looks;

static void look_at_permit(void)
{
    looks++;
    ck_assert_uint_eq(toggles, orthosis.task.tick);
}

/* The board tells from the line's level at two looks whether it moves: also of looks in a tick and without one. */
START_TEST(the_board_looks_at_the_permit_line_behind_the_tick_s_edge)
{
    config.in_quiet_ticks = look_at_permit;
    orthosis_init(&orthosis, &config);
    for (int gap = 0; gap < 3; gap++) {
        looks = 0;
        run(101);
        ck_assert_uint_ge(looks, 30);
        looks = 0;
        for (int i = 0; i < 10; i++) { /* no bus: no tick */
            orthosis_start_cycle(&orthosis);
            (void)orthosis_poll(&orthosis);
        }
        ck_assert_uint_ge(looks, 9);
    }
    ck_assert_uint_eq(toggles, 303);
}
END_TEST

/* While a node is silent it is asked in each tick, and none is quiet. A board that stands then is tested all the same. */
START_TEST(a_board_in_fault_is_looked_after_on_a_full_bus)
{
    config.in_quiet_ticks = look_at_permit;
    orthosis_init(&orthosis, &config); /* an empty memory: FAULT */
    looks = 0;
    run_busy(450);
    ck_assert_int_eq(state(), SUPERVISOR_FAULT);
    ck_assert_uint_ge(looks, 29);
}
END_TEST

/* In FAULT, and no drive tells that it is off. After a restart the line is low again, as the pin is. */
START_TEST(the_torque_is_taken_where_no_drive_says_that_it_is_off)
{
    for (int restart = 0; restart < 2; restart++) {
        toggles = cuts = 0;
        is_cut = false;
        orthosis_init(&orthosis, &config); /* an empty memory: FAULT */
        run(DRIVE_WATCH_POWER_TICKS - 2);
        ck_assert_uint_eq(cuts, 0);
        run(4);
        ck_assert_uint_ge(cuts, 1);
        ck_assert(is_cut);
        const unsigned before = toggles;
        ck_assert_uint_ge(before, DRIVE_WATCH_POWER_TICKS - 2);
        ck_assert_uint_le(before, DRIVE_WATCH_POWER_TICKS);
        run(2000);
        ck_assert(is_cut);
        ck_assert_uint_eq(toggles, before);
    }
    config.drive_power = NULL; /* a board without the lines */
    orthosis_init(&orthosis, &config);
    cuts = 0;
    run(DRIVE_WATCH_POWER_TICKS + 2);
    ck_assert_uint_eq(cuts, 0);
}
END_TEST

/* Where the bus takes no commands nothing is fed: the torque is taken all the same. */
START_TEST(the_torque_is_taken_also_where_nothing_is_fed)
{
    struct drive_power power;
    drive_power_init(&power, &drive_power);
    orthosis_init(&orthosis, &config);
    drive_power_update(&power, &orthosis.task, false);
    ck_assert_uint_eq(toggles + cuts, 0);
    orthosis.task.watch.powered_ticks = DRIVE_WATCH_POWER_TICKS;
    drive_power_update(&power, &orthosis.task, false);
    ck_assert_uint_eq(cuts, 1);
    ck_assert(is_cut);
    orthosis.task.watch.powered_ticks = 0;
    drive_power_update(&power, &orthosis.task, false);
    ck_assert_uint_eq(cuts, 2);
    ck_assert_uint_eq(toggles, 0);
    drive_power_update(&power, &orthosis.task, true);
    ck_assert_uint_eq(toggles, 1);
}
END_TEST

/* One write that is lost, one bit of the port that flips: the next tick sets the line again. */
START_TEST(the_line_that_takes_the_torque_is_set_anew_in_each_tick)
{
    struct drive_power power;
    drive_power_init(&power, &drive_power);
    orthosis_init(&orthosis, &config);
    orthosis.task.watch.powered_ticks = DRIVE_WATCH_POWER_TICKS;
    for (int tick = 0; tick < 5; tick++) {
        is_cut = false;
        drive_power_update(&power, &orthosis.task, tick % 2 == 0);
        ck_assert(is_cut);
    }
    orthosis.task.watch.powered_ticks = 0;
    drive_power_update(&power, &orthosis.task, true);
    ck_assert(!is_cut);
    const unsigned before = cuts; /* and nothing of it costs a usual tick time */
    drive_power_update(&power, &orthosis.task, true);
    ck_assert_uint_eq(cuts, before);
}
END_TEST

/* Settings that ask for a walk are obeyed at power-on alone: behind any other reset (a dip of the
 * supply, a pin, a debugger) nobody may expect the drives to move. The setting itself is kept. */
START_TEST(a_reset_is_no_request_to_walk)
{
    keep(0.6f, 1);
    orthosis_init(&orthosis, &config);
    ck_assert_uint_eq(orthosis.task.node.objects.walk_requested, 1);
    run(3);
    orthosis_init(&orthosis, &config);
    ck_assert_uint_eq(orthosis.task.node.objects.walk_requested, 0);
    ck_assert_uint_eq(orthosis.walk_at_start, 1);
    memset(&streak, 0x77, sizeof streak); /* the memory was without power */
    orthosis_init(&orthosis, &config);
    ck_assert_uint_eq(orthosis.task.node.objects.walk_requested, 1);
    config.streak = NULL; /* nothing tells a reset from power-on */
    orthosis_init(&orthosis, &config);
    ck_assert_uint_eq(orthosis.task.node.objects.walk_requested, 0);
}
END_TEST

/* The number of the tick wraps after 49 days: that is no start. */
START_TEST(the_wrap_of_the_tick_is_no_start)
{
    keep(0.6f, 0);
    orthosis_init(&orthosis, &config);
    run(1);
    orthosis.task.tick = UINT32_MAX;
    feeds = toggles = 0;
    run(1);
    ck_assert_uint_eq(orthosis.task.tick, 0);
    for (int i = 0; i < 9; i++) {
        (void)orthosis_poll(&orthosis);
    }
    ck_assert_uint_eq(feeds, 1);
    ck_assert_uint_eq(toggles, 1);
}
END_TEST

/* Of the watchdog's 120 ms at most half is used, whatever is asked for. */
START_TEST(it_is_fed_while_settings_are_saved_and_forgotten)
{
    keep(0.6f, 0);
    orthosis_init(&orthosis, &config);
    run(1);
    const struct write_rules *rules = &orthosis.task.node.rules;
    for (int forget = 0; forget < 2; forget++) {
        now_ms = fed_ms = longest_ms = 0;
        const uint32_t verdict =
            forget ? rules->settings_store->forget_settings(rules->settings_store_context)
                   : rules->settings_store->save_settings(rules->settings_store_context);
        ck_assert_uint_eq(verdict, 0);
        ck_assert_double_gt(now_ms, 70);
        run(1);
        ck_assert_double_gt(longest_ms, 40);
        ck_assert_double_le(longest_ms, 60);
    }
}
END_TEST

/* A flash that answers at once, or a clock that stands: nothing is going on that would need a
 * feed, and a loop that goes round and round in there must not live on them. */
START_TEST(no_real_tick_no_feed_while_settings_are_saved)
{
    keep(0.6f, 0);
    orthosis_init(&orthosis, &config);
    run(1);
    const struct write_rules *rules = &orthosis.task.node.rules;
    erase_ms = word_ms = 0;
    now_ms += 5;
    const unsigned before = feeds;
    for (int save = 0; save < 100; save++) {
        ck_assert_uint_eq(rules->settings_store->save_settings(rules->settings_store_context), 0);
    }
    ck_assert_uint_le(feeds - before, 1);
    /* Words as slow as they are: no more feeds than milliseconds. */
    word_ms = 0.0834;
    const double began_ms = now_ms;
    ck_assert_uint_eq(rules->settings_store->save_settings(rules->settings_store_context), 0);
    ck_assert_double_le(feeds - before, 1 + now_ms - began_ms);
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
    tcase_add_test(tests, the_settings_are_not_read_after_three_crashes_without_a_sync);
    tcase_add_test(tests, a_sync_that_came_back_ends_the_streak);
    tcase_add_test(tests, the_record_of_a_crash_is_kept);
    tcase_add_test(tests, without_a_tick_it_is_not_fed);
    tcase_add_test(tests, the_wearer_s_panel_is_read_and_lit);
    tcase_add_test(tests, without_a_bus_the_drives_get_no_power);
    tcase_add_test(tests, a_board_in_fault_is_looked_after_on_a_full_bus);
    tcase_add_test(tests, the_board_looks_at_the_permit_line_behind_the_tick_s_edge);
    tcase_add_test(tests, the_torque_is_taken_where_no_drive_says_that_it_is_off);
    tcase_add_test(tests, the_torque_is_taken_also_where_nothing_is_fed);
    tcase_add_test(tests, the_line_that_takes_the_torque_is_set_anew_in_each_tick);
    tcase_add_test(tests, the_wrap_of_the_tick_is_no_start);
    tcase_add_test(tests, it_is_fed_while_settings_are_saved_and_forgotten);
    tcase_add_test(tests, no_real_tick_no_feed_while_settings_are_saved);
    tcase_add_test(tests, a_bus_that_is_off_is_asked_back_now_and_then);
    tcase_add_test(tests, a_reset_is_no_request_to_walk);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
