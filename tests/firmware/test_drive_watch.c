/* When the hardware takes the drives' power, and when it gives it back: the counts alone, on drives that say anything. */
#include "firmware/drive_watch.h"
#include "tests/support/assert_close.h"

static struct sea_drive_reading told[SIDE_COUNT];
static struct sea_request asked[SIDE_COUNT];
static struct control_params params;
static struct drive_watch watch;

static void read_told(const void *context, enum side leg, struct sea_drive_reading *reading)
{
    (void)context;
    *reading = told[leg];
}

static const struct sea_drives_ops ops = {.read = read_told};
static const struct sea_drives drives = {&ops, NULL, NULL};

static void start(void)
{
    watch = (struct drive_watch){0};
    asked[SIDE_LEFT] = asked[SIDE_RIGHT] = (struct sea_request){0};
    params.leg_length_m = 1.0f;
    params.sea_tolerance_m = 0.001f;
    told[SIDE_LEFT] = told[SIDE_RIGHT] = (struct sea_drive_reading){.state = DRIVE_DISABLED};
}

/* So many ticks, or until the power must go; returns how many they were. */
static int run(enum supervisor_state state, int ticks)
{
    int i = 0;
    while (i < ticks && !drive_watch_power_must_go(&watch)) {
        (void)drive_watch_update(&watch, &drives, state, asked, &params);
        i++;
    }
    return i;
}

static void cut_the_power(void)
{
    start();
    told[SIDE_RIGHT].age_ticks = UINT16_MAX;
    ck_assert_int_eq(run(SUPERVISOR_FAULT, 5000), TICKS_OF_MS(500));
    ck_assert(drive_watch_power_must_go(&watch));
}

/* The relay K2 waits 400 ms: by then somebody may have reset the fault, and K2 must fall all the same. */
START_TEST(a_reset_gives_no_power_back_before_the_relay_has_fallen)
{
    static const enum supervisor_state after[] = {SUPERVISOR_INIT, SUPERVISOR_SELF_TEST,
                                                  SUPERVISOR_STANDBY};
    for (size_t i = 0; i < sizeof after / sizeof after[0]; i++) {
        cut_the_power();
        for (int tick = 0; tick < TICKS_OF_MS(600) - 1; tick++) {
            (void)drive_watch_update(&watch, &drives, after[i], asked,
                                     &params); /* the drive is silent still */
            ck_assert(drive_watch_power_must_go(&watch));
        }
        (void)drive_watch_update(&watch, &drives, after[i], asked, &params);
        (void)drive_watch_update(&watch, &drives, after[i], asked, &params);
        ck_assert(!drive_watch_power_must_go(&watch));
        (void)drive_watch_update(&watch, &drives, after[i], asked, &params);
        ck_assert(!drive_watch_power_must_go(&watch));
    }
}
END_TEST

/* What was counted for less than half a second ends with the stop. */
START_TEST(each_stop_has_its_own_half_second)
{
    start();
    told[SIDE_LEFT].age_ticks = UINT16_MAX;
    ck_assert_int_eq(run(SUPERVISOR_FAULT, TICKS_OF_MS(499)), TICKS_OF_MS(499));
    ck_assert_int_eq(run(SUPERVISOR_INIT, 1), 1);
    ck_assert_int_eq(run(SUPERVISOR_FAULT, 5000), TICKS_OF_MS(500));
}
END_TEST

/* A drive under torque says now and then that it is off, or a corrupt frame says so. */
START_TEST(a_telegram_now_and_then_does_not_keep_the_power)
{
    start();
    for (int tick = 1; tick <= TICKS_OF_MS(700); tick++) {
        told[_i].state = tick % 10 == 0 ? DRIVE_DISABLED : DRIVE_ENABLED;
        if (run(SUPERVISOR_FAULT, 1) == 0) {
            break;
        }
    }
    ck_assert(drive_watch_power_must_go(&watch));
}
END_TEST

/* And one that is off is not cut for a telegram now and then, however long it stands there. */
START_TEST(a_telegram_now_and_then_does_not_take_the_power)
{
    start();
    for (int tick = 1; tick <= 20 * TICKS_OF_MS(500); tick++) {
        told[_i].state = tick % 10 == 0 ? DRIVE_ENABLED : DRIVE_DISABLED;
        ck_assert_int_eq(run(SUPERVISOR_FAULT, 1), 1);
    }
    ck_assert(!drive_watch_power_must_go(&watch));
}
END_TEST

/* Under torque at 50 mm, as a walk leaves it. */
static void load(enum side leg)
{
    start();
    told[SIDE_LEFT].state = told[SIDE_RIGHT].state = DRIVE_ENABLED;
    told[leg].precompression_m = asked[leg].precompression_m = 0.05f;
    ck_assert_int_eq(run(SUPERVISOR_WALKING, 10), 10);
}

/* Its control loop hangs, its telegrams come: it is not led, however long the unload may last. */
START_TEST(a_drive_that_answers_and_holds_its_spring_is_not_led)
{
    load((enum side)_i);
    asked[_i].precompression_m = 0.0f;
    ck_assert_int_eq(run(SUPERVISOR_UNLOADING, 5000), TICKS_OF_MS(550));
}
END_TEST

/* Also where an encoder flickers by some hundredths of a millimetre. */
START_TEST(noise_is_no_motion)
{
    load((enum side)_i);
    asked[_i].precompression_m = 0.0f;
    int ticks = 0;
    while (run(SUPERVISOR_UNLOADING, 1) == 1 && ticks < 5000) {
        ticks++;
        told[_i].precompression_m = 0.05f + (ticks % 3 == 0 ? 5e-5f : -5e-5f);
    }
    ck_assert_int_le(ticks, TICKS_OF_MS(600));
}
END_TEST

/* 50 mm in 1.9 s, as unload_timeout_s allows: far behind its target all the time. */
START_TEST(a_drive_that_unloads_slowly_keeps_its_power)
{
    load((enum side)_i);
    asked[_i].precompression_m = 0.0f;
    for (int tick = 0; tick <= TICKS_OF_MS(1900); tick++) {
        told[_i].precompression_m = 0.05f * (1.0f - (float)tick / (float)TICKS_OF_MS(1900));
        ck_assert_int_eq(run(SUPERVISOR_UNLOADING, 1), 1);
    }
    ck_assert_int_eq(run(SUPERVISOR_UNLOADING, TICKS_OF_MS(2000)), TICKS_OF_MS(2000)); /* slack */
    told[_i].state = told[1 - _i].state = DRIVE_DISABLED;
    ck_assert_int_eq(run(SUPERVISOR_FAULT, 2000), 2000);
}
END_TEST

/* The target brakes and turns, or is slow: 60 mm up, 60 mm back in a second, and the drive with it, 10 mm behind. */
START_TEST(a_drive_that_follows_its_target_keeps_its_power)
{
    load((enum side)_i);
    for (int tick = 0; tick < TICKS_OF_MS(1000); tick++) {
        const int from_turn =
            tick < TICKS_OF_MS(500) ? TICKS_OF_MS(500) - tick : tick - TICKS_OF_MS(500);
        asked[_i].precompression_m = 0.07f - 0.06f * (float)from_turn / (float)TICKS_OF_MS(500);
        told[_i].precompression_m =
            asked[_i].precompression_m + (tick < TICKS_OF_MS(500) ? -0.01f : 0.01f);
        ck_assert_int_eq(run(SUPERVISOR_UNLOADING, 1), 1);
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("drive_watch");
    TCase *tests = tcase_create("all");
    tcase_add_test(tests, a_reset_gives_no_power_back_before_the_relay_has_fallen);
    tcase_add_test(tests, each_stop_has_its_own_half_second);
    tcase_add_loop_test(tests, a_telegram_now_and_then_does_not_keep_the_power, 0, SIDE_COUNT);
    tcase_add_loop_test(tests, a_telegram_now_and_then_does_not_take_the_power, 0, SIDE_COUNT);
    tcase_add_loop_test(tests, a_drive_that_answers_and_holds_its_spring_is_not_led, 0, SIDE_COUNT);
    tcase_add_loop_test(tests, noise_is_no_motion, 0, SIDE_COUNT);
    tcase_add_loop_test(tests, a_drive_that_unloads_slowly_keeps_its_power, 0, SIDE_COUNT);
    tcase_add_loop_test(tests, a_drive_that_follows_its_target_keeps_its_power, 0, SIDE_COUNT);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
