/* The motor's reference never steps, and the latch is armed in one place only. */
#include "controller/actuation/sea_reference.h"
#include "tests/support/assert_close.h"

#include <math.h>

static struct control_params limits(void)
{
    return (struct control_params){.sea_speed_max_m_s = 0.5f,
                                   .sea_acceleration_m_s2 = 10.0f,
                                   .sea_tolerance_m = 0.001f,
                                   .leg_length_m = 1.0f};
}

/* Runs n ticks with a motor that follows perfectly; checks the limits each tick. */
static struct sea_request run(struct sea_reference *sea, const struct control_params *params, int n)
{
    struct sea_request request = {0};
    float last = sea->position_m;
    float last_speed = sea->speed_m_s;
    for (int i = 0; i < n; i++) {
        request = sea_reference_update(sea, params, sea->position_m);
        const float speed = (request.precompression_m - last) / 0.001f;
        ck_assert_msg(fabsf(speed) <= params->sea_speed_max_m_s * 1.001f, "speed %g",
                      (double)speed);
        ck_assert_msg(fabsf(speed - last_speed) <= params->sea_acceleration_m_s2 * 0.00205f,
                      "speed step %g", (double)(speed - last_speed));
        last = request.precompression_m;
        last_speed = speed;
    }
    return request;
}

START_TEST(one_step_of_walking)
{
    const struct control_params params = limits();
    struct sea_reference sea;
    sea_reference_init(&sea, 0.0f);
    ck_assert(!run(&sea, &params, 10).latch_armed);
    sea_reference_begin_loading(&sea, 0.1f);
    struct sea_request request = run(&sea, &params, 600);
    assert_close(request.precompression_m, 0.1, 1e-6, 0.0);
    ck_assert_msg(!request.latch_armed, "loaded but the law has not spoken");
    sea_reference_set_target(&sea, 0.12f);
    ck_assert_msg(!run(&sea, &params, 5).latch_armed, "armed before the spring is at r0");
    request = run(&sea, &params, 300);
    ck_assert(request.latch_armed);
    assert_close(request.precompression_m, 0.12, 1e-6, 0.0);
    sea_reference_unload(&sea);
    ck_assert_msg(!run(&sea, &params, 1).latch_armed, "still armed after lift-off");
    request = run(&sea, &params, 600);
    assert_close(request.precompression_m, 0.0, 1e-9, 0.0);
    ck_assert_int_eq(sea.phase, SEA_UNLOADED);
}
END_TEST

/* Once the latch is armed the other foot may land at any moment: nothing changes what it would release. */
START_TEST(an_armed_spring_takes_no_new_target)
{
    const struct control_params params = limits();
    struct sea_reference sea;
    sea_reference_init(&sea, 0.0f);
    sea_reference_begin_loading(&sea, 0.1f);
    (void)run(&sea, &params, 600);
    sea_reference_set_target(&sea, 0.12f);
    ck_assert(run(&sea, &params, 300).latch_armed);
    sea_reference_set_target(&sea, 0.2f);
    const struct sea_request request = run(&sea, &params, 500);
    ck_assert(request.latch_armed);
    assert_close(request.precompression_m, 0.12, 1e-6, 0.0);
}
END_TEST

START_TEST(time_to_load_is_that_of_the_trapezoid)
{
    /* 0.1 m at 0.5 m/s and 10 m/s^2: 0.05 s up, 0.05 s down, the rest at full speed. */
    const struct control_params params = limits();
    struct sea_reference sea;
    sea_reference_init(&sea, 0.0f);
    sea_reference_begin_loading(&sea, 0.1f);
    int ticks = 0;
    while (sea.position_m != 0.1f && ticks < 1000) {
        (void)run(&sea, &params, 1);
        ticks++;
    }
    const double expected_s = 0.1 / 0.5 + 0.5 / 10.0;
    assert_close(ticks * 1e-3, expected_s, 0.005, 0.0);
}
END_TEST

START_TEST(not_armed_when_the_motor_lags)
{
    const struct control_params params = limits();
    struct sea_reference sea;
    sea_reference_init(&sea, 0.0f);
    sea_reference_begin_loading(&sea, 0.05f);
    sea_reference_set_target(&sea, 0.05f);
    for (int i = 0; i < 1000; i++) {
        ck_assert(!sea_reference_update(&sea, &params, 0.04f).latch_armed);
        ck_assert(!sea_reference_update(&sea, &params, NAN).latch_armed);
    }
    ck_assert(sea_reference_update(&sea, &params, 0.0495f).latch_armed);
}
END_TEST

START_TEST(trim_out_of_turn_is_ignored)
{
    const struct control_params params = limits();
    struct sea_reference sea;
    sea_reference_init(&sea, 0.0f);
    sea_reference_set_target(&sea, 0.2f);
    ck_assert(run(&sea, &params, 500).precompression_m == 0.0f);
    sea_reference_begin_loading(&sea, 0.1f);
    (void)run(&sea, &params, 100);
    sea_reference_unload(&sea);
    sea_reference_set_target(&sea, 0.2f);
    ck_assert(run(&sea, &params, 600).precompression_m == 0.0f);
}
END_TEST

START_TEST(limits_hold_for_any_sequence_of_targets)
{
    const struct control_params params = limits();
    struct sea_reference sea;
    unsigned random = 12345;
    sea_reference_init(&sea, 0.03f);
    for (int i = 0; i < 3000; i++) {
        random = random * 1664525u + 1013904223u;
        const float target = (float)(random >> 8) / 16777216.0f * 0.3f;
        switch (random % 3u) {
        case 0:
            sea_reference_begin_loading(&sea, target);
            break;
        case 1:
            sea_reference_set_target(&sea, target);
            break;
        default:
            sea_reference_unload(&sea);
            break;
        }
        (void)run(&sea, &params, (int)(random >> 20) % 300);
        ck_assert(sea.position_m >= -1e-4f && sea.position_m <= 0.32f);
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("sea_reference");
    TCase *tests = tcase_create("all");
    tcase_set_timeout(tests, 60);
    tcase_add_test(tests, one_step_of_walking);
    tcase_add_test(tests, time_to_load_is_that_of_the_trapezoid);
    tcase_add_test(tests, not_armed_when_the_motor_lags);
    tcase_add_test(tests, trim_out_of_turn_is_ignored);
    tcase_add_test(tests, limits_hold_for_any_sequence_of_targets);
    tcase_add_test(tests, an_armed_spring_takes_no_new_target);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
