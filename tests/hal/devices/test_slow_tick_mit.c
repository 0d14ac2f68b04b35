/* A drive in MIT mode, built for a tick of 2.5 ms: given up after 250 ms, asked to enter its
 * motor mode again after 100 ms. And how the CiA 402 drives are told such a tick. */
#undef TICK_PERIOD_US
#define TICK_PERIOD_US 2500

#include "hal/devices/sea_drive_mit.c"
#include "hal/devices/setup_steps.c"

#include <check.h>
#include <math.h>

#include "tests/support/assert_close.h"
#include "tests/support/fake_bus.h"

START_TEST(a_silent_drive_is_lost_after_250_ms)
{
    struct mit_axis_config config[SIDE_COUNT];
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        config[leg] = (struct mit_axis_config){.motor_id = (uint8_t)(1 + leg),
                                               .answer_id = (uint16_t)(0x11 + leg),
                                               .rad_per_m = 50.0f,
                                               .direction = 1,
                                               .stroke_max_m = 0.35f,
                                               .ranges = {12.5f, 50.0f, 18.0f, 500.0f, 5.0f}};
    }
    const struct can_msg answer = {.id = 0x11, .length = 8, .data = {1, 0x80, 0x00}};
    struct mit_drives axes;
    struct sea_drive_reading reading = {.state = DRIVE_DISABLED};
    int ticks = 0;
    mit_drives_init(&axes, config);
    const struct sea_drives drives = mit_drives_interface(&axes);
    ck_assert(sea_drives_receive(&drives, &answer));
    while (ticks < 1000) {
        sea_drives_read(&drives, SIDE_LEFT, &reading);
        if (reading.state != DRIVE_DISABLED) {
            break;
        }
        sea_drives_age(&drives);
        ticks++;
    }
    ck_assert_int_eq(reading.state, DRIVE_UNKNOWN);
    ck_assert_int_eq(ticks, 250 * 10 / 25 + 1);
    ck_assert_int_eq(ENTER_REPEAT_TICKS, 40);
}
END_TEST

/* 0x60C2 (CiA 402-2): period = sub 1 * 10 ^ sub 2 seconds. */
START_TEST(the_interpolation_period_is_the_tick)
{
    const struct node_setup_config config = {.counts_per_m = {1, 1}};
    unsigned found = 0;
    double value = 0.0, exponent = 0.0;
    struct setup_place place = {.role = NETWORK_DRIVE_LEFT, .node = NODE_DRIVE_LEFT};
    for (; setup_step_at(&config, &place).kind != STEP_END; place.step++) {
        const struct setup_step s = setup_step_at(&config, &place);
        if (s.index == 0x60C2 && s.sub == 1) {
            value = (double)s.value;
            found++;
        } else if (s.index == 0x60C2 && s.sub == 2) {
            exponent = (double)(int8_t)s.value;
            found++;
        }
    }
    ck_assert_uint_eq(found, 2);
    ck_assert(value >= 1.0 && value <= 255.0);
    assert_close(value * pow(10.0, exponent), 0.0025, 1e-12, 0.0);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("slow_tick_mit");
    TCase *tests = tcase_create("all");
    tcase_add_test(tests, a_silent_drive_is_lost_after_250_ms);
    tcase_add_test(tests, the_interpolation_period_is_the_tick);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
