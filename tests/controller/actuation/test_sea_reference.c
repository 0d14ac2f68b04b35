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

/* Ticks until it is at its target, with a motor that follows; past it by what one tick brakes at most. */
static int ticks_to(struct sea_reference *sea, const struct control_params *params)
{
    int ticks = 0;
    const float sign = sea->target_m > sea->position_m ? 1.0f : -1.0f;
    float before_m = sea->position_m;
    const float one_tick_m = 25.0f * 1e-6f;
    while (sea->position_m != sea->target_m && ticks < 2000) {
        (void)sea_reference_update(sea, params, sea->position_m);
        ck_assert(sign * (sea->position_m - before_m) >= -one_tick_m);
        ck_assert(sign * (sea->target_m - sea->position_m) >= -one_tick_m);
        before_m = sea->position_m;
        ticks++;
    }
    ck_assert(sea->speed_m_s == 0.0f);
    return ticks;
}

static double trapezoid_s(double way_m, double speed_m_s, double acceleration_m_s2)
{
    return way_m / speed_m_s + speed_m_s / acceleration_m_s2;
}

/* A stop may use 1.2 times the speed and 1.6 times the acceleration, and the next load has the usual limits again. */
START_TEST(a_stop_goes_faster_and_the_next_load_does_not)
{
    const struct control_params params = limits();
    const struct sea_stop stop = sea_reference_stop_limits(&params);
    struct sea_reference sea;
    sea_reference_init(&sea, 0.0f);
    for (int i = 0; i < 2; i++) {
        sea_reference_begin_loading(&sea, 0.1f);
        assert_close(ticks_to(&sea, &params) * 1e-3, trapezoid_s(0.1, 0.5, 10.0), 0.004, 0.0);
        sea_reference_stop(&sea, &stop, sea.position_m);
        assert_close(ticks_to(&sea, &params) * 1e-3, trapezoid_s(0.1, 0.6, 16.0), 0.004, 0.0);
        ck_assert_int_eq(sea.phase, SEA_UNLOADED);
    }
}
END_TEST

START_TEST(who_hurries_back_has_the_limits_that_were_given)
{
    const struct control_params params = limits();
    struct sea_reference sea;
    sea_reference_init(&sea, 0.0f);
    sea_reference_begin_loading(&sea, 0.1f);
    (void)ticks_to(&sea, &params);
    sea_reference_hurry_back(&sea, 0.8f, 25.0f);
    assert_close(ticks_to(&sea, &params) * 1e-3, trapezoid_s(0.1, 0.8, 25.0), 0.004, 0.0);
    ck_assert_int_eq(sea.phase, SEA_UNLOADED);
}
END_TEST

/* A motor left behind by more than 1 % of the leg is taken back from where it is, not from where it was to be. */
START_TEST(a_stop_begins_where_a_motor_was_left_behind)
{
    const struct control_params params = limits();
    const struct sea_stop stop = sea_reference_stop_limits(&params);
    static const struct {
        double measured_m, from_m;
    } cases[] = {{0.091, 0.1}, {0.089, 0.089}, {0.02, 0.02}, {-0.02, 0.0}, {0.15, 0.1}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct sea_reference sea;
        sea_reference_init(&sea, 0.0f);
        sea_reference_begin_loading(&sea, 0.2f);
        while (sea.position_m < 0.1f) {
            (void)sea_reference_update(&sea, &params, sea.position_m);
        }
        sea.position_m = 0.1f;
        const float speed_m_s = sea.speed_m_s;
        ck_assert(speed_m_s > 0.4f);
        sea_reference_stop(&sea, &stop, (float)cases[i].measured_m);
        assert_close(sea.position_m, cases[i].from_m, 1e-7, 0.0);
        assert_close(sea.speed_m_s, cases[i].from_m < 0.1 ? 0.0 : (double)speed_m_s, 1e-7, 0.0);
        ck_assert_int_eq(sea.phase, SEA_UNLOADING);
    }
}
END_TEST

/* By just 1 % it is not behind yet. */
START_TEST(a_motor_at_the_limit_is_not_left_behind)
{
    const struct sea_stop stop = {
        .speed_m_s = 0.6f, .acceleration_m_s2 = 16.0f, .left_behind_m = 0.125f};
    struct sea_reference sea;
    sea_reference_init(&sea, 0.5f);
    sea_reference_begin_loading(&sea, 0.5f);
    sea.speed_m_s = 0.25f;
    sea_reference_stop(&sea, &stop, 0.375f);
    ck_assert(sea.position_m == 0.5f && sea.speed_m_s == 0.25f);
}
END_TEST

/* Within 1 mm to either side: armed where it was sent, unloaded at zero. */
START_TEST(a_motor_has_arrived_within_its_tolerance)
{
    static const struct {
        double off_m;
        bool arrived;
    } cases[] = {
        {0.0, true}, {0.00099, true}, {-0.00099, true}, {0.00101, false}, {-0.00101, false}};
    const struct control_params params = limits();
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct sea_reference sea;
        const float off_m = (float)cases[i].off_m;
        sea_reference_init(&sea, 0.0f);
        sea_reference_begin_loading(&sea, 0.05f);
        sea_reference_set_target(&sea, 0.04f);
        sea_reference_set_target(&sea, 0.05f); /* the last word counts until it is armed */
        struct sea_request request = {0};
        for (int k = 0; k < 500; k++) {
            request = sea_reference_update(&sea, &params, sea.position_m + off_m);
        }
        assert_close(request.precompression_m, 0.05, 1e-7, 0.0);
        ck_assert_int_eq(request.latch_armed, cases[i].arrived);
        sea_reference_unload(&sea);
        for (int k = 0; k < 500; k++) {
            request = sea_reference_update(&sea, &params, sea.position_m + off_m);
        }
        assert_close(request.precompression_m, 0.0, 1e-9, 0.0);
        ck_assert_int_eq(sea.phase, cases[i].arrived ? SEA_UNLOADED : SEA_UNLOADING);
        ck_assert(!request.latch_armed && !request.enable);
    }
}
END_TEST

/* What is unloaded stays so; a reference that began elsewhere goes to zero. */
START_TEST(an_unloaded_spring_is_not_unloaded_again)
{
    const struct control_params params = limits();
    struct sea_reference sea;
    sea_reference_init(&sea, 0.03f);
    ck_assert_int_eq(sea.phase, SEA_UNLOADED);
    assert_close(sea.position_m, 0.03, 1e-9, 0.0);
    sea_reference_unload(&sea);
    ck_assert_int_eq(sea.phase, SEA_UNLOADED);
    assert_close(ticks_to(&sea, &params) * 1e-3, 2.0 * sqrt(0.03 / 10.0), 0.004,
                 0.0); /* a triangle */
}
END_TEST

/* Left behind by 1 % of the leg, whatever its length. */
START_TEST(the_limits_of_a_stop_scale)
{
    struct control_params params = limits();
    params.leg_length_m = 0.5f;
    const struct sea_stop stop = sea_reference_stop_limits(&params);
    assert_close(stop.left_behind_m, 0.005, 1e-8, 0.0);
    assert_close(stop.speed_m_s, 0.6, 1e-7, 0.0);
    assert_close(stop.acceleration_m_s2, 16.0, 1e-5, 0.0);
}
END_TEST

/* The fastest that can still be braked: one tick at v and then down by a T each tick ends at the target. */
START_TEST(a_short_way_is_braked_as_late_as_possible)
{
    const struct control_params params = limits();
    const double change = 10.0 * 1e-3;
    for (int ticks = 2; ticks <= 5; ticks++) {
        struct sea_reference sea;
        /* so far that braking from `ticks` times the change takes just that way */
        const double way_m = change * 1e-3 * ticks * (ticks + 1) / 2.0;
        sea_reference_init(&sea, 0.0f);
        sea_reference_begin_loading(&sea, (float)way_m);
        sea.speed_m_s = (float)(ticks * change);
        (void)sea_reference_update(&sea, &params, 0.0f);
        assert_close(sea.speed_m_s, ticks * change, 1e-5, 0.0);
        assert_close(sea.position_m, ticks * change * 1e-3, 1e-8, 0.0);
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
    tcase_add_test(tests, a_stop_goes_faster_and_the_next_load_does_not);
    tcase_add_test(tests, who_hurries_back_has_the_limits_that_were_given);
    tcase_add_test(tests, a_stop_begins_where_a_motor_was_left_behind);
    tcase_add_test(tests, a_motor_has_arrived_within_its_tolerance);
    tcase_add_test(tests, an_unloaded_spring_is_not_unloaded_again);
    tcase_add_test(tests, the_limits_of_a_stop_scale);
    tcase_add_test(tests, a_short_way_is_braked_as_late_as_possible);
    tcase_add_test(tests, a_motor_at_the_limit_is_not_left_behind);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
