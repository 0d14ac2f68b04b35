/* One leg of a person, tick by tick, on made-up rates: what is a step and what is one given up, and
 * events whose time follows from straight lines and the constants that person_events.h's prose names. */
#include "controller/estimator/person_events.h"

#include "tests/support/assert_close.h"

/* The walking_speed of the walking speed, and the delay of the smoothed rates. */
#define WALKING_SPEED 1.0
#define DELAY_S (1e-3 * LEG_RATE_HALF_WINDOW)

static struct person_events leg;
static struct leg_view view;
static uint32_t tick;
static double ankle, ankle_step; /* its extension, share of the leg, and the change a tick */

static void setup(void)
{
    leg = (struct person_events){0};
    view = (struct leg_view){.walking_speed_rad_s = WALKING_SPEED, .fresh = true};
    tick = 5000;
    ankle = ankle_step = 0.0;
}

static struct leg_event step(double rate_rad_s, double ahead_rad)
{
    view.rate_rad_s = (real)rate_rad_s;
    view.ahead_rad = (real)ahead_rad;
    view.extension = (real)ankle;
    ankle += ankle_step;
    return person_events_update(&leg, &view, tick++);
}

/* The rate goes from one value to another by 0.02 a tick; returns the first event on the way. */
static struct leg_event ramp(double from, double to, double ahead_rad)
{
    struct leg_event event = {LEG_EVENT_NONE, REAL(0.0)};
    const int ticks = (int)((to > from ? to - from : from - to) / 0.02 + 0.5);
    for (int i = 1; i <= ticks && event.kind == LEG_EVENT_NONE; i++) {
        event = step(from + (to - from) * i / ticks, ahead_rad);
    }
    return event;
}

static void hold(double rate, double ahead_rad, int ticks)
{
    for (int i = 0; i < ticks; i++) {
        ck_assert_int_eq(step(rate, ahead_rad).kind, LEG_EVENT_NONE);
    }
}

static void stand_on_it(void)
{
    hold(-1.0, -0.4, 50);
    ck_assert_int_eq(leg.contact, LEG_STANCE);
}

/* When the event lies, in ticks; steps on with the last rate until it is told. */
static double event_time(struct leg_event event, double rate)
{
    for (int i = 0; i < 100 && event.kind == LEG_EVENT_NONE; i++) {
        event = step(rate, 0.4);
    }
    ck_assert_int_eq(event.kind, LEG_EVENT_STRIKE);
    ck_assert(event.age_s >= REAL(0.0)); /* none is told before it happens */
    return (double)(tick - 1) - 1000.0 * (double)event.age_s;
}

/* Falling by 20 rad/s^2 the rate goes through 0 and, 30 ms later, through -0.6 walking speeds: the strike
 * lies half that time and 6 ms after the second, of rates that are 16 ms old. */
START_TEST(a_strike_is_placed_by_two_levels_of_the_rate)
{
    hold(1.5, 0.4, 50);
    const uint32_t second = tick - 1 + 105; /* (1.5 + 0.6) / 0.02 ticks on */
    const double strike = event_time(ramp(1.5, -1.5, 0.4), -1.5);
    assert_close(strike - second, 0.5 * 30.0 + 6.0 - LEG_RATE_HALF_WINDOW, 0.1, 0.0);
    ck_assert_int_eq(leg.contact, LEG_STANCE);
}
END_TEST

/* A slower walker at once (the mean speed was taken anew): the level comes to the rate, not the rate
 * to the level. 31 ms after the rate went through 0. */
START_TEST(a_level_that_comes_to_the_rate_is_crossed_now)
{
    hold(1.5, 0.4, 50);
    ck_assert_int_eq(ramp(1.5, -0.5, 0.4).kind, LEG_EVENT_NONE);
    hold(-0.5, 0.4, 5);
    view.walking_speed_rad_s = REAL(0.8); /* the level: -0.48 */
    const uint32_t second = tick;
    const double strike = event_time(step(-0.5, 0.4), -0.5);
    assert_close(strike - second, 0.5 * 31.0 + 6.0 - LEG_RATE_HALF_WINDOW, 0.1, 0.0);
}
END_TEST

/* It lands beside the other foot, or never swung fast enough: a step given up. */
START_TEST(a_step_given_up_is_no_strike)
{
    stand_on_it();
    ck_assert_int_ne(ramp(-1.0, 1.5, -0.4).kind, LEG_EVENT_STRIKE);
    hold(1.5, 0.0, 60);
    ck_assert_int_eq(ramp(1.5, -1.0, 0.08).kind, LEG_EVENT_NONE); /* 0.09 rad is ahead */
    ck_assert_int_eq(leg.contact, LEG_STANCE);
    ck_assert_int_ne(ramp(-1.0, 0.4, -0.4).kind, LEG_EVENT_STRIKE);
    hold(0.4, 0.0, 60); /* half a walking_speed is a swing */
    ck_assert_int_eq(ramp(0.4, -1.0, 0.4).kind, LEG_EVENT_NONE);
    ck_assert_int_eq(leg.contact, LEG_STANCE);
}
END_TEST

/* A leg that swings on and on for 1.5 s is on no step: nobody knows where it is. */
START_TEST(a_swing_has_an_end)
{
    int ticks = 0;
    (void)step(1.5, 0.0);
    ck_assert_int_eq(leg.contact, LEG_SWING);
    while (leg.contact == LEG_SWING && ticks < 3000) {
        ck_assert_int_eq(step(1.5, 0.4).kind, LEG_EVENT_NONE);
        ticks++;
    }
    ck_assert_int_eq(leg.contact, LEG_UNKNOWN);
    assert_close(ticks, 1500, 2.0, 0.0);
}
END_TEST

/* ---- toe-off: the leg's turn, and the end of its ankle's push --------------------------------- */

/* The ankle extends at 1 /s and stops at once `stops_ms` after the leg's rate went through 0.3
 * walking speeds. The filter's rate is down to a half 10 ms after that. */
static struct leg_event toe_off(int stops_ms, int *held_ms)
{
    struct leg_event event = {LEG_EVENT_NONE, REAL(0.0)};
    stand_on_it();
    ankle_step = 0.001;
    hold(-1.0, -0.4, 100);
    if (stops_ms < 0) { /* the turn comes after the ramp's 65 */
        ankle_step = 0.0;
        hold(-1.0, -0.4, -stops_ms - 65);
    }
    ck_assert_int_eq(ramp(-1.0, 0.28, -0.4).kind, LEG_EVENT_NONE);
    for (*held_ms = 0; *held_ms < 200 && event.kind == LEG_EVENT_NONE; ++*held_ms) {
        ankle_step = *held_ms >= stops_ms ? 0.0 : ankle_step;
        event = step(0.32, -0.4); /* the first of them: half a tick after the turn */
    }
    ck_assert_int_eq(event.kind, LEG_EVENT_TOE_OFF);
    ck_assert_int_eq(leg.contact, LEG_SWING);
    return event;
}

/* The push ends 10 ms after the turn: the event is held back for it, and lies 19 ms before the mean
 * of both. What is told is old by the delay of the rates. */
START_TEST(a_toe_off_waits_for_the_end_of_the_push)
{
    int held_ms;
    const struct leg_event event = toe_off(10, &held_ms);
    ck_assert_int_ge(held_ms, 15); /* 10 ms, and what the filter lags */
    ck_assert_int_le(held_ms, 25);
    const double since_turn_s = 1e-3 * held_ms - 0.0005;
    const double since_push_s = 1e-3 * held_ms - 0.010;
    assert_close(event.age_s, 0.5 * (DELAY_S + since_turn_s + since_push_s) + 0.019, 3e-3, 0.0);
}
END_TEST

/* 30 ms after the turn nobody waits any more: the turn alone, 14.5 ms before it. */
START_TEST(a_toe_off_does_not_wait_for_ever)
{
    int held_ms;
    const struct leg_event event = toe_off(100, &held_ms);
    assert_close(held_ms, 31, 1.0, 0.0);
    assert_close(event.age_s, DELAY_S + 1e-3 * held_ms - 0.0005 + 0.0145, 1.1e-3, 0.0);
}
END_TEST

/* A push that was over 130 ms before the turn belongs to something else. */
START_TEST(a_push_of_long_before_does_not_place_the_toe_off)
{
    int held_ms;
    const struct leg_event event = toe_off(-130, &held_ms);
    ck_assert_int_eq(held_ms, 1);
    ck_assert(leg.push.over);
    assert_close(event.age_s, DELAY_S + 0.0005 + 0.0145, 1.1e-3, 0.0);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("leg events");
    TCase *tests = tcase_create("all");
    tcase_add_checked_fixture(tests, setup, NULL);
    tcase_add_test(tests, a_strike_is_placed_by_two_levels_of_the_rate);
    tcase_add_test(tests, a_level_that_comes_to_the_rate_is_crossed_now);
    tcase_add_test(tests, a_step_given_up_is_no_strike);
    tcase_add_test(tests, a_swing_has_an_end);
    tcase_add_test(tests, a_toe_off_waits_for_the_end_of_the_push);
    tcase_add_test(tests, a_toe_off_does_not_wait_for_ever);
    tcase_add_test(tests, a_push_of_long_before_does_not_place_the_toe_off);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
