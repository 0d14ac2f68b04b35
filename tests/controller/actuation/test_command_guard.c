/* The last gate by itself: its limits are those of when the walk began. */
#include "controller/actuation/command_guard.h"
#include "tests/support/assert_close.h"

#include <math.h>

static struct command_guard guard;
static struct control_params params;
static struct sea_request request[SIDE_COUNT];

/* A rise of 1.25 * 0.8 mm a tick; commands within 0.3 m and what counts as slack. */
static void setup(void)
{
    params = (struct control_params){.leg_length_m = REAL(1.0),
                                     .r0_max_m = REAL(0.3),
                                     .sea_speed_max_m_s = REAL(0.8),
                                     .sea_tolerance_m = REAL(0.001)};
    guard = (struct command_guard){0};
    command_guard_begin(&guard, &params);
    request[SIDE_LEFT] = (struct sea_request){REAL(0.1), true, true};
    request[SIDE_RIGHT] = (struct sea_request){REAL(-0.1), true, false};
    command_guard_limit(&guard, true, request);
}

START_TEST(the_first_command_is_taken_as_it_is)
{
    ck_assert(request[SIDE_LEFT].precompression_m == REAL(0.1) && request[SIDE_LEFT].latch_armed);
    ck_assert(request[SIDE_RIGHT].precompression_m == REAL(-0.1) && request[SIDE_RIGHT].enable);
}
END_TEST

START_TEST(a_rise_is_limited_a_fall_is_not)
{
    params.sea_speed_max_m_s = REAL(80.0); /* changed since: does not count */
    request[SIDE_LEFT].precompression_m = REAL(0.2);
    request[SIDE_RIGHT].precompression_m = REAL(-0.2);
    command_guard_limit(&guard, true, request);
    assert_close((double)request[SIDE_LEFT].precompression_m, 0.101, 1e-6, 0.0);
    assert_close((double)request[SIDE_RIGHT].precompression_m, -0.2, 1e-6, 0.0);
    request[SIDE_LEFT].precompression_m = REAL(0.2);
    command_guard_limit(&guard, true, request);
    assert_close((double)request[SIDE_LEFT].precompression_m, 0.102, 1e-6, 0.0);
}
END_TEST

START_TEST(what_is_out_of_reach_or_no_number_is_switched_off)
{
    const real wrong[] = {REAL(0.302), REAL(-0.302), (real)NAN, (real)INFINITY, -(real)INFINITY};
    guard.last[SIDE_LEFT].enable = false; /* no rise to be limited */
    request[SIDE_LEFT].precompression_m = wrong[_i];
    request[SIDE_RIGHT].precompression_m = REAL(-0.3);
    command_guard_limit(&guard, true, request);
    ck_assert(request[SIDE_LEFT].precompression_m == REAL(0.0));
    ck_assert(!request[SIDE_LEFT].enable && !request[SIDE_LEFT].latch_armed);
    ck_assert(request[SIDE_RIGHT].enable);
}
END_TEST

/* A drive that is switched off lets a loaded spring go: it is held where it may be, and not released. */
START_TEST(what_climbs_past_the_largest_push_off_is_held_there)
{
    params.r0_max_m = REAL(0.6); /* changed since, by a failing memory */
    request[SIDE_LEFT].precompression_m = REAL(0.1);
    for (int tick = 0; tick < 500; tick++) {
        const bool free = request[SIDE_LEFT].precompression_m < REAL(0.299);
        request[SIDE_LEFT].precompression_m += REAL(0.001);
        request[SIDE_LEFT].latch_armed = true;
        command_guard_limit(&guard, true, request);
        ck_assert(request[SIDE_LEFT].enable);
        ck_assert_double_le((double)request[SIDE_LEFT].precompression_m, 0.301 + 1e-6);
        ck_assert(request[SIDE_LEFT].latch_armed || !free);
    }
    assert_close((double)request[SIDE_LEFT].precompression_m, 0.301, 1e-6, 0.0);
    ck_assert(!request[SIDE_LEFT].latch_armed);
    request[SIDE_LEFT] = (struct sea_request){guard.command_limit_m, true, true};
    command_guard_limit(&guard, true, request);
    ck_assert(request[SIDE_LEFT].latch_armed); /* there, and not beyond it */
    request[SIDE_LEFT].precompression_m = (real)NAN;
    command_guard_limit(&guard, true, request);
    ck_assert(!request[SIDE_LEFT].enable);
}
END_TEST

/* r0_max_m may be raised while walking, up to this person's ceiling: that is no fault. */
START_TEST(what_the_ceiling_allows_passes)
{
    const struct {
        real ceiling_m;
        double most_m;
    } cases[] = {{REAL(0.0), 0.301}, {REAL(0.2), 0.301}, {REAL(0.4), 0.401}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        params.r0_ceiling_m = cases[i].ceiling_m;
        command_guard_begin(&guard, &params);
        for (int tick = 0; tick < 600; tick++) {
            request[SIDE_LEFT].precompression_m += REAL(0.001);
            command_guard_limit(&guard, true, request);
        }
        assert_close((double)request[SIDE_LEFT].precompression_m, cases[i].most_m, 1e-6, 0.0);
    }
}
END_TEST

/* Without power there is nothing to limit: the zero request stays zero. */
START_TEST(without_power_requests_are_only_remembered)
{
    request[SIDE_RIGHT] = (struct sea_request){REAL(0.0), false, false};
    command_guard_limit(&guard, false, request);
    ck_assert(request[SIDE_RIGHT].precompression_m == REAL(0.0));
    ck_assert(guard.last[SIDE_RIGHT].precompression_m == REAL(0.0));
    ck_assert(!guard.last[SIDE_RIGHT].enable);
}
END_TEST

/* Without power nothing is asked for, whatever was; and what was asked before limits no rise after it. */
START_TEST(without_power_a_request_is_taken_back)
{
    request[SIDE_LEFT] = (struct sea_request){REAL(0.1), true, true};
    request[SIDE_RIGHT] = (struct sea_request){REAL(-0.1), true, true};
    command_guard_limit(&guard, false, request);
    for (int side = 0; side < SIDE_COUNT; side++) {
        ck_assert(request[side].precompression_m == REAL(0.0));
        ck_assert(!request[side].enable && !request[side].latch_armed);
        ck_assert(!guard.last[side].enable);
        request[side] = (struct sea_request){REAL(0.25), true, true};
    }
    command_guard_limit(&guard, true, request);
    for (int side = 0; side < SIDE_COUNT; side++) {
        ck_assert(request[side].precompression_m == REAL(0.25));
        ck_assert(request[side].enable && request[side].latch_armed);
    }
}
END_TEST

/* Down to as far below zero as above, and no farther: exactly there is still within. */
START_TEST(the_limit_itself_is_within)
{
    request[SIDE_LEFT].precompression_m = -guard.command_limit_m;
    command_guard_limit(&guard, true, request);
    ck_assert(request[SIDE_LEFT].enable);
    assert_close((double)request[SIDE_LEFT].precompression_m, -0.301, 1e-6, 0.0);
    request[SIDE_LEFT].precompression_m = REAL(-0.3011);
    command_guard_limit(&guard, true, request);
    ck_assert(!request[SIDE_LEFT].enable);
}
END_TEST

/* Motions of commissioning: a share of r0_max and what counts as slack; six tenths of the reference's speed. */
START_TEST(motions_have_limits_of_their_own)
{
    params.r0_ceiling_m = REAL(0.6); /* not for motions */
    command_guard_begin_motions(&guard, &params, REAL(0.25));
    for (int side = 0; side < SIDE_COUNT; side++) {
        guard.last[side] = request[side] = (struct sea_request){REAL(0.0), true, false};
    }
    for (int tick = 1; tick <= 300; tick++) {
        for (int side = 0; side < SIDE_COUNT; side++) {
            request[side].precompression_m = REAL(0.3);
        }
        command_guard_limit(&guard, true, request);
        const double risen_m = 0.6 * 0.8e-3 * tick;
        for (int side = 0; side < SIDE_COUNT; side++) {
            assert_close((double)request[side].precompression_m, risen_m < 0.076 ? risen_m : 0.076,
                         1e-5, 0.0);
        }
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("command guard");
    TCase *tests = tcase_create("all");
    tcase_add_checked_fixture(tests, setup, NULL);
    tcase_add_test(tests, the_first_command_is_taken_as_it_is);
    tcase_add_test(tests, a_rise_is_limited_a_fall_is_not);
    tcase_add_loop_test(tests, what_is_out_of_reach_or_no_number_is_switched_off, 0, 5);
    tcase_add_test(tests, what_climbs_past_the_largest_push_off_is_held_there);
    tcase_add_test(tests, what_the_ceiling_allows_passes);
    tcase_add_test(tests, without_power_requests_are_only_remembered);
    tcase_add_test(tests, without_power_a_request_is_taken_back);
    tcase_add_test(tests, the_limit_itself_is_within);
    tcase_add_test(tests, motions_have_limits_of_their_own);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
