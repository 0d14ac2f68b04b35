/* When a person's latch may be armed. */
#include "controller/estimator/arm_window.h"
#include "tests/support/assert_close.h"

struct bench {
    struct arm_window window;
    struct control_params params;
    struct arm_view view;
    uint32_t tick;
    uint32_t opened_tick, closed_tick; /* of the last step; 0 = did not */
};

static void start(struct bench *bench, double switches, double strike_error_s)
{
    *bench = (struct bench){.tick = 1000, .view.own_foot = FOOT_DOWN};
    bench->params.foot_switches = (real)switches;
    bench->params.strike_error_s = (real)strike_error_s;
}

static void pass(struct bench *bench, uint32_t ms)
{
    for (uint32_t i = 0; i < ms; i++) {
        const bool before = arm_window_is_open(&bench->window, &bench->params, bench->tick);
        bench->tick++;
        arm_window_update(&bench->window, &bench->params, &bench->view, bench->tick);
        const bool now = arm_window_is_open(&bench->window, &bench->params, bench->tick);
        if (now && !before) {
            bench->opened_tick = bench->tick;
        } else if (!now && before) {
            bench->closed_tick = bench->tick;
        }
    }
}

/* A step whose foot lands lag_ms behind the slowing of its leg; then its stance. Returns the tick of
 * the contact. */
static uint32_t step(struct bench *bench, uint32_t lag_ms)
{
    bench->opened_tick = bench->closed_tick = 0;
    bench->view = (struct arm_view){.swings = true,
                                    .contact_tick = bench->view.contact_tick,
                                    .own_foot = FOOT_DOWN,
                                    .own_leg_turns_back = true};
    pass(bench, 300);
    bench->view.slowing = true;
    pass(bench, lag_ms);
    const uint32_t contact_tick = bench->tick + 1;
    bench->view.contact_tick = contact_tick;
    pass(bench, 20);
    bench->view.slowing = bench->view.swings = false;
    pass(bench, 30);
    bench->view.own_leg_turns_back = false;
    bench->view.own_foot = FOOT_UP;
    pass(bench, 200);
    return contact_tick;
}

START_TEST(it_opens_a_stated_time_ahead_of_the_contact)
{
    static const uint32_t lags_ms[] = {30, 60, 120, 200};
    struct bench bench;
    start(&bench, 1.0, 0.0);
    (void)step(&bench, lags_ms[_i]);
    ck_assert_uint_eq(bench.opened_tick, 0); /* nothing learned yet */
    (void)step(&bench, lags_ms[_i]);
    for (int i = 0; i < 5; i++) {
        const uint32_t contact_tick = step(&bench, lags_ms[_i]);
        const double lead_s = 1e-3 * ((double)contact_tick - bench.opened_tick);
        assert_close(lead_s, (double)ARM_LEAD_S, 0.002, 0.0);
        ck_assert_uint_gt(bench.closed_tick, contact_tick);
        ck_assert_uint_le(bench.closed_tick, contact_tick + 32);
    }
}
END_TEST

/* Each sign alone closes it, and for the rest of the step. */
START_TEST(any_sign_of_the_own_toe_off_closes_it)
{
    struct bench bench;
    start(&bench, 1.0, 0.0);
    for (int i = 0; i < 4; i++) {
        (void)step(&bench, 60);
    }
    bench.view = (struct arm_view){.swings = true,
                                   .slowing = false,
                                   .contact_tick = bench.view.contact_tick,
                                   .own_foot = FOOT_DOWN,
                                   .own_leg_turns_back = true};
    pass(&bench, 300);
    bench.view.slowing = true;
    pass(&bench, 55);
    ck_assert(arm_window_is_open(&bench.window, &bench.params, bench.tick));
    const struct arm_view well = bench.view;
    switch (_i) {
    case 0:
        bench.view.own_foot = FOOT_UP;
        break;
    case 1:
        bench.view.own_foot = FOOT_UNKNOWN;
        break;
    default:
        bench.view.own_leg_turns_back = false;
        break;
    }
    pass(&bench, 1);
    ck_assert(!arm_window_is_open(&bench.window, &bench.params, bench.tick));
    bench.view = well;
    pass(&bench, 20);
    ck_assert(!arm_window_is_open(&bench.window, &bench.params, bench.tick));
}
END_TEST

START_TEST(it_closes_when_no_contact_comes)
{
    struct bench bench;
    start(&bench, 1.0, 0.0);
    for (int i = 0; i < 4; i++) {
        (void)step(&bench, 60);
    }
    bench.view.own_foot = FOOT_DOWN;
    bench.view.own_leg_turns_back = bench.view.swings = true;
    pass(&bench, 300);
    bench.view.slowing = true;
    pass(&bench, 100);
    ck_assert(arm_window_is_open(&bench.window, &bench.params, bench.tick));
    pass(&bench, 60);
    ck_assert(!arm_window_is_open(&bench.window, &bench.params, bench.tick));
}
END_TEST

START_TEST(without_switches_it_opens_behind_the_strike_or_not_at_all)
{
    struct bench bench;
    start(&bench, 0.0, _i == 0 ? 0.0 : 0.03);
    bench.view = (struct arm_view){.swings = true, .own_leg_turns_back = true};
    pass(&bench, 300);
    bench.view.slowing = true;
    pass(&bench, 50);
    arm_window_strike(&bench.window, bench.tick, REAL(0.02));
    ck_assert(!arm_window_is_open(&bench.window, &bench.params, bench.tick));
    const uint32_t strike_tick = bench.tick - 20;
    pass(&bench, 40);
    if (_i == 0) {
        ck_assert_uint_eq(bench.opened_tick, 0);
    } else {
        ck_assert_uint_ge(bench.opened_tick, strike_tick + 30);
        ck_assert_uint_le(bench.opened_tick, strike_tick + 32);
        ck_assert_uint_ge(bench.closed_tick, strike_tick + 60);
    }
}
END_TEST

/* Only while the other leg slows down, and from the very first ticks on, too. */
START_TEST(a_strike_alone_opens_nothing)
{
    struct bench bench;
    start(&bench, 0.0, 0.03);
    arm_window_strike(&bench.window, bench.tick, REAL(0.02));
    ck_assert(!arm_window_is_open(&bench.window, &bench.params, bench.tick + 100));
    start(&bench, 0.0, 0.03);
    bench.tick = 5;
    bench.view = (struct arm_view){.slowing = true, .swings = true, .own_leg_turns_back = true};
    pass(&bench, 5);
    arm_window_strike(&bench.window, bench.tick, REAL(0.02)); /* before there were ticks */
    pass(&bench, 40);
    ck_assert_uint_ne(bench.opened_tick, 0);
}
END_TEST

/* Double supports of 0.05 s and more have time for a push; the legs' angles and the switches both have to say that
 * one is shorter. Times in ms: from the strike as found to the toe-off as found, and from the other foot's contact to
 * the own switch's opening; told 0 = the own switch has opened before, or is not heard. */
START_TEST(a_double_support_too_short_for_a_push_is_known)
{
    static const struct {
        uint32_t found_ms, told_ms;
        bool has_time;
    } cases[] = {{100, 110, true}, {60, 0, true},  {20, 80, true}, {44, 47, false},
                 {20, 20, false},  {0, 0, false},  {51, 10, true}, {10, 51, true},
                 {49, 49, false},  {10, 0, false}, {49, 51, true}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct bench bench;
        start(&bench, 1.0, 0.0);
        ck_assert(!arm_window_has_time(&bench.window)); /* nothing is known */
        for (int k = 0; k < 3; k++) {
            (void)step(&bench, 60);
        }
        const uint32_t strike_tick = bench.tick - 200;
        arm_window_strike(&bench.window, bench.tick, REAL(0.2));
        bench.window.edge_tick = strike_tick;
        arm_window_toe_off(&bench.window, bench.tick,
                           REAL(0.2) - (real)cases[i].found_ms * REAL(0.001),
                           strike_tick + cases[i].told_ms);
        ck_assert_msg(arm_window_has_time(&bench.window) == cases[i].has_time, "%u and %u ms",
                      cases[i].found_ms, cases[i].told_ms);
        ck_assert(!arm_window_is_open(&bench.window, &bench.params, bench.tick));
    }
}
END_TEST

/* A toe-off without its strike, or long after it, tells of no double support: the one before counts. */
START_TEST(what_was_not_found_tells_of_no_double_support)
{
    struct bench bench;
    start(&bench, 1.0, 0.0);
    arm_window_strike(&bench.window, bench.tick, REAL(0.1));
    arm_window_toe_off(&bench.window, bench.tick, REAL(0.0), bench.tick);
    ck_assert(arm_window_has_time(&bench.window));
    bench.window.strike_tick = 0;
    arm_window_toe_off(&bench.window, bench.tick, REAL(0.0), bench.tick);
    ck_assert(arm_window_has_time(&bench.window));
    arm_window_strike(&bench.window, bench.tick, REAL(0.0));
    arm_window_toe_off(&bench.window, bench.tick + 20, REAL(0.0), bench.tick + 20);
    ck_assert(!arm_window_has_time(&bench.window));
    arm_window_toe_off(&bench.window, bench.tick + 900, REAL(0.0), bench.tick + 900);
    ck_assert(!arm_window_has_time(&bench.window));
}
END_TEST

/* Without switches it opens behind the strike of this swing: without one it does not, however long ago the last was. */
START_TEST(without_a_strike_it_does_not_open)
{
    struct bench bench;
    start(&bench, 0.0, 0.02);
    bench.view.own_leg_turns_back = true;
    pass(&bench, 100);
    bench.view.slowing = bench.view.swings = true;
    pass(&bench, 300);
    ck_assert_uint_eq(bench.opened_tick, 0);
    arm_window_strike(&bench.window, bench.tick, REAL(0.0));
    pass(&bench, 19);
    ck_assert_uint_eq(bench.opened_tick, 0);
    pass(&bench, 2);
    ck_assert_uint_ne(bench.opened_tick, 0);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("arm_window");
    TCase *all = tcase_create("all");
    tcase_add_loop_test(all, it_opens_a_stated_time_ahead_of_the_contact, 0, 4);
    tcase_add_loop_test(all, any_sign_of_the_own_toe_off_closes_it, 0, 3);
    tcase_add_test(all, it_closes_when_no_contact_comes);
    tcase_add_loop_test(all, without_switches_it_opens_behind_the_strike_or_not_at_all, 0, 2);
    tcase_add_test(all, a_strike_alone_opens_nothing);
    tcase_add_test(all, a_double_support_too_short_for_a_push_is_known);
    tcase_add_test(all, what_was_not_found_tells_of_no_double_support);
    tcase_add_test(all, without_a_strike_it_does_not_open);
    suite_add_tcase(suite, all);
    return run_suite(suite);
}
