/* What the drives bear. The expected figures are computed from the header's prose, not from the code. */
#include "controller/supervisor/derate.h"

#include <math.h>

#include "controller/signals.h"
#include "tests/support/assert_close.h"

static struct derate derate;
static struct derate_limits limit[SIDE_COUNT];
static struct derate_reading reading[SIDE_COUNT];
static uint32_t now;

static void setup(void)
{
    derate_init(&derate);
    now = 1000;
    for (int side = 0; side < SIDE_COUNT; side++) {
        limit[side] = (struct derate_limits){80.0f, 100.0f, 20.0f, 60.0f};
        reading[side] = (struct derate_reading){true, true, true, false, 25.0f, 48.0f};
    }
}

/* A look every tenth of a second for so long. */
static void look(double seconds)
{
    for (int i = 0; i < (int)lround(10.0 * seconds); i++) {
        now += TICKS_OF_MS(100);
        (void)derate_update(&derate, limit, reading, now);
    }
}

START_TEST(nothing_is_spared_where_nothing_is_near_a_limit)
{
    look(100.0);
    assert_close(derate.share, 1.0, 0.0, 0.0);
    assert_close(derate.least_share, 1.0, 0.0, 0.0);
    ck_assert(!derate.withdrawn);
    reading[SIDE_LEFT].temperature_degC = 80.0f;
    reading[SIDE_LEFT].supply_V = 21.0f;
    reading[SIDE_RIGHT].supply_V = 57.0f;
    look(100.0);
    assert_close(derate.share, 1.0, 1e-4, 0.0);
}
END_TEST

/* Linear between warn and stop, by the one that bears less; where no limit is told there is none. */
static const struct {
    float degC[SIDE_COUNT], volt[SIDE_COUNT];
    double share;
    enum derate_cause left, right;
} steady[] = {
    {{90.0f, 25.0f}, {48.0f, 48.0f}, 0.5, DERATE_TEMPERATURE, DERATE_NONE},
    {{25.0f, 95.0f}, {48.0f, 48.0f}, 0.25, DERATE_NONE, DERATE_TEMPERATURE},
    {{84.0f, 95.0f}, {48.0f, 48.0f}, 0.25, DERATE_TEMPERATURE, DERATE_TEMPERATURE},
    {{25.0f, 25.0f}, {20.6f, 48.0f}, 0.6, DERATE_SUPPLY_LOW, DERATE_NONE},
    {{25.0f, 25.0f}, {48.0f, 58.5f}, 0.5, DERATE_NONE, DERATE_SUPPLY_HIGH},
    {{82.0f, 25.0f}, {20.2f, 48.0f}, 0.2, DERATE_SUPPLY_LOW, DERATE_NONE},
};

START_TEST(the_share_is_linear_and_both_legs)
{
    for (int side = 0; side < SIDE_COUNT; side++) {
        reading[side].temperature_degC = steady[_i].degC[side];
        reading[side].supply_V = steady[_i].volt[side];
    }
    look(20.0);
    assert_close(derate.share, steady[_i].share, 1e-4, 0.0);
    ck_assert_int_eq(derate.leg[SIDE_LEFT].cause, steady[_i].left);
    ck_assert_int_eq(derate.leg[SIDE_RIGHT].cause, steady[_i].right);
    ck_assert(!derate.withdrawn);
    for (int side = 0; side < SIDE_COUNT; side++) {
        limit[side] = (struct derate_limits){0};
    }
    look(60.0);
    assert_close(derate.share, 1.0, 1e-6, 0.0);
}
END_TEST

/* 0.2 a second down, 0.05 a second up: no reading changes a push at once. */
START_TEST(the_share_moves_by_ramps)
{
    look(1.0);
    reading[SIDE_LEFT].temperature_degC = 98.0f;
    look(0.5);
    assert_close(derate.share, 0.9, 1e-4, 0.0);
    look(2.0);
    assert_close(derate.share, 0.5, 1e-4, 0.0);
    look(10.0);
    assert_close(derate.share, 0.1, 1e-4, 0.0);
    reading[SIDE_LEFT].temperature_degC = 25.0f;
    look(4.0);
    assert_close(derate.share, 0.3, 1e-4, 0.0);
    look(20.0);
    assert_close(derate.share, 1.0, 1e-4, 0.0);
    assert_close(derate.least_share, 0.1, 1e-4, 0.0);
}
END_TEST

/* It rises for a tenth or more, and then all the way; for less it stays. */
START_TEST(it_rises_only_for_something)
{
    reading[SIDE_RIGHT].temperature_degC = 90.0f;
    look(20.0);
    reading[SIDE_RIGHT].temperature_degC = 88.2f; /* 0.59 */
    look(60.0);
    assert_close(derate.share, 0.5, 1e-4, 0.0);
    reading[SIDE_RIGHT].temperature_degC = 87.8f; /* 0.61 */
    look(60.0);
    assert_close(derate.share, 0.61, 1e-4, 0.0);
    reading[SIDE_RIGHT].temperature_degC = 88.0f;
    look(60.0);
    assert_close(derate.share, 0.6, 1e-4, 0.0);
}
END_TEST

/* Two seconds beyond, and not before; a moment below it counts back. */
START_TEST(beyond_a_limit_it_withdraws_and_returns_with_hysteresis)
{
    reading[SIDE_RIGHT].temperature_degC = 101.0f;
    look(1.9);
    ck_assert(!derate.withdrawn);
    reading[SIDE_RIGHT].temperature_degC = 99.0f;
    look(0.5);
    reading[SIDE_RIGHT].temperature_degC = 101.0f;
    look(0.5);
    ck_assert(!derate.withdrawn);
    look(0.3);
    ck_assert(derate.withdrawn);
    ck_assert_int_eq(derate.withdrew_cause, DERATE_TEMPERATURE);
    ck_assert_int_eq(derate.withdrew_leg, SIDE_RIGHT);
    look(20.0);
    assert_close(derate.share, 0.0, 0.0, 0.0);
    reading[SIDE_RIGHT].temperature_degC = 81.0f; /* below the stop, not below the warning */
    look(60.0);
    ck_assert(derate.withdrawn);
    assert_close(derate.share, 0.0, 0.0, 0.0);
    reading[SIDE_RIGHT].temperature_degC = 79.0f;
    look(0.1);
    ck_assert(!derate.withdrawn);
    ck_assert_int_eq(derate.withdrew_cause, DERATE_TEMPERATURE); /* why it was, stays told */
    look(30.0);
    assert_close(derate.share, 1.0, 1e-4, 0.0);
}
END_TEST

/* A short sag of the supply, twice a second, changes next to nothing. */
START_TEST(a_sag_in_every_step_is_no_low_supply)
{
    for (int i = 0; i < 100; i++) {
        reading[SIDE_LEFT].supply_V = 19.0f;
        look(0.1);
        reading[SIDE_LEFT].supply_V = 24.0f;
        look(0.4);
    }
    ck_assert(derate.least_share >= 0.97f);
    ck_assert(!derate.withdrawn);
    reading[SIDE_LEFT].supply_V = 19.0f;
    look(2.1);
    ck_assert(derate.withdrawn);
    ck_assert_int_eq(derate.withdrew_cause, DERATE_SUPPLY_LOW);
}
END_TEST

START_TEST(a_warning_that_lasts_halves_the_push_and_ends_no_walk)
{
    reading[SIDE_LEFT].warning = true;
    look(4.9);
    assert_close(derate.share, 1.0, 0.0, 0.0);
    look(100.0);
    assert_close(derate.share, 0.5, 1e-4, 0.0);
    ck_assert_int_eq(derate.leg[SIDE_LEFT].cause, DERATE_WARNING);
    ck_assert(!derate.withdrawn);
    reading[SIDE_LEFT].temperature_degC = 95.0f; /* the lesser of both counts */
    look(20.0);
    assert_close(derate.share, 0.25, 1e-4, 0.0);
    ck_assert_int_eq(derate.leg[SIDE_LEFT].cause, DERATE_TEMPERATURE);
    reading[SIDE_LEFT].temperature_degC = 25.0f;
    reading[SIDE_LEFT].warning = false;
    look(30.0);
    assert_close(derate.share, 1.0, 1e-4, 0.0);
}
END_TEST

/* After a stop by temperature a warning alone keeps nobody from walking with half of the push. */
START_TEST(a_warning_does_not_keep_it_withdrawn)
{
    reading[SIDE_LEFT].warning = true;
    reading[SIDE_LEFT].temperature_degC = 120.0f;
    look(10.0);
    ck_assert(derate.withdrawn);
    reading[SIDE_LEFT].temperature_degC = 25.0f;
    look(20.0);
    ck_assert(!derate.withdrawn);
    assert_close(derate.share, 0.5, 1e-4, 0.0);
}
END_TEST

static const float no_numbers[] = {NAN, INFINITY, -INFINITY};

START_TEST(what_is_no_number_is_beyond_the_limit)
{
    reading[SIDE_LEFT].supply_V = no_numbers[_i];
    look(10.0);
    ck_assert(derate.withdrawn);
    assert_close(derate.share, 0.0, 0.0, 0.0);
    setup();
    reading[SIDE_RIGHT].temperature_degC = no_numbers[_i];
    look(10.0);
    ck_assert(derate.withdrawn);
    assert_close(derate.share, 0.0, 0.0, 0.0);
}
END_TEST

/* A drive that is there and does not tell; one that is away tells nothing, and another check stops it. */
START_TEST(a_limit_that_nobody_can_watch_withdraws)
{
    reading[SIDE_LEFT].has_temperature = false;
    look(0.4); /* its first telegram may be on the way */
    assert_close(derate.share, 1.0, 0.0, 0.0);
    ck_assert_int_eq(derate.leg[SIDE_LEFT].cause, DERATE_NONE);
    look(3.0);
    ck_assert(derate.withdrawn);
    ck_assert_int_eq(derate.withdrew_cause, DERATE_SILENT);
    setup();
    reading[SIDE_RIGHT].has_supply = false;
    look(3.0);
    ck_assert_int_eq(derate.withdrew_cause, DERATE_SILENT);
    ck_assert_int_eq(derate.withdrew_leg, SIDE_RIGHT);
    setup();
    reading[SIDE_RIGHT] = (struct derate_reading){0};
    look(60.0);
    ck_assert(!derate.withdrawn);
    assert_close(derate.share, 1.0, 0.0, 0.0);
    setup();
    limit[SIDE_LEFT] = (struct derate_limits){0};
    reading[SIDE_LEFT] = (struct derate_reading){.heard = true};
    look(60.0);
    assert_close(derate.share, 1.0, 0.0, 0.0);
}
END_TEST

/* A look that comes late moves it by one second at most, across the tick's wrap, too. */
START_TEST(time_between_looks_is_bounded)
{
    now = UINT32_MAX - (uint32_t)TICKS_OF_MS(100);
    look(0.1);
    reading[SIDE_LEFT].temperature_degC = 100.0f;
    look(0.2);
    assert_close(derate.share, 0.96, 1e-4, 0.0);
    now += TICKS_OF_MS(60000);
    ck_assert(derate_update(&derate, limit, reading, now) == false);
    assert_close(derate.share, 0.76, 1e-3, 0.0);
    ck_assert(!derate.withdrawn);
}
END_TEST

START_TEST(what_is_new_is_told_once)
{
    ck_assert(!derate_update(&derate, limit, reading, ++now));
    reading[SIDE_LEFT].temperature_degC = 90.0f;
    ck_assert(derate_update(&derate, limit, reading, ++now));
    ck_assert(!derate_update(&derate, limit, reading, ++now));
    reading[SIDE_LEFT].temperature_degC = 20.0f;
    ck_assert(derate_update(&derate, limit, reading, ++now));
    for (int cause = 0; cause < DERATE_CAUSES; cause++) {
        ck_assert_str_ne(derate_cause_name((enum derate_cause)cause), "unknown");
        for (int other = 0; other <= cause; other++) { /* each its own, and none empty */
            ck_assert_str_ne(derate_cause_name((enum derate_cause)cause),
                             other < cause ? derate_cause_name((enum derate_cause)other) : "");
        }
    }
    ck_assert_str_eq(derate_cause_name((enum derate_cause)99), "unknown");
}
END_TEST

/* Half a second of silence, two seconds beyond a limit, five of a warning: and not before. */
START_TEST(times_are_waited_for)
{
    look(1.0);
    reading[SIDE_RIGHT].has_temperature = false;
    look(0.4);
    ck_assert_int_eq(derate.leg[SIDE_RIGHT].cause, DERATE_NONE);
    look(0.2);
    ck_assert_int_eq(derate.leg[SIDE_RIGHT].cause, DERATE_SILENT);
    setup();
    look(1.0);
    reading[SIDE_LEFT].supply_V = 61.0f;
    look(1.9);
    ck_assert(!derate.withdrawn);
    look(0.2);
    ck_assert(derate.withdrawn);
    ck_assert_int_eq(derate.withdrew_leg, SIDE_LEFT);
    ck_assert_int_eq(derate.withdrew_cause, DERATE_SUPPLY_HIGH);
    setup();
    look(1.0);
    reading[SIDE_RIGHT].warning = true;
    look(4.9);
    ck_assert_int_eq(derate.leg[SIDE_RIGHT].cause, DERATE_NONE);
    look(0.2);
    ck_assert_int_eq(derate.leg[SIDE_RIGHT].cause, DERATE_WARNING);
}
END_TEST

/* What was true for long is forgotten within the same time, not later: it is counted no further than it is asked. */
START_TEST(what_is_over_is_forgotten_in_its_own_time)
{
    look(1.0);
    reading[SIDE_LEFT].warning = true;
    look(60.0);
    reading[SIDE_LEFT].warning = false;
    look(0.2);
    ck_assert_int_eq(derate.leg[SIDE_LEFT].cause, DERATE_NONE);
    look(4.9); /* to nothing, and below that it does not go */
    reading[SIDE_LEFT].warning = true;
    look(4.8);
    ck_assert_int_eq(derate.leg[SIDE_LEFT].cause, DERATE_NONE);
    look(0.4);
    ck_assert_int_eq(derate.leg[SIDE_LEFT].cause, DERATE_WARNING);
}
END_TEST

/* A limit that is not told is none, whatever the reading; and one limit alone is one. */
START_TEST(each_limit_stands_alone)
{
    static const struct {
        struct derate_limits limit;
        float degC, volt;
        bool tells_temperature, tells_supply;
        double share;
        enum derate_cause cause;
    } cases[] = {{{0, 0, 20.0f, 0}, 500.0f, 1000.0f, true, true, 1.0, DERATE_NONE},
                 {{0, 0, 20.0f, 0}, 500.0f, 20.5f, true, true, 0.5, DERATE_SUPPLY_LOW},
                 {{0, 0, 0, 60.0f}, 500.0f, 1.0f, true, true, 1.0, DERATE_NONE},
                 {{0, 0, 0, 60.0f}, 500.0f, 58.5f, true, true, 0.5, DERATE_SUPPLY_HIGH},
                 {{80.0f, 100.0f, 0, 0}, 90.0f, 0.0f, true, true, 0.5, DERATE_TEMPERATURE},
                 {{80.0f, 100.0f, 0, 0}, 25.0f, 0.0f, true, false, 1.0, DERATE_NONE},
                 {{0, 0, 20.0f, 60.0f}, 0.0f, 48.0f, false, true, 1.0, DERATE_NONE},
                 {{0, 0, 20.0f, 0}, 0.0f, 48.0f, true, false, 0.0, DERATE_SILENT},
                 {{0, 0, 0, 60.0f}, 0.0f, 48.0f, true, false, 0.0, DERATE_SILENT},
                 {{80.0f, 100.0f, 0, 0}, 25.0f, 48.0f, false, true, 0.0, DERATE_SILENT}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        for (int side = 0; side < SIDE_COUNT; side++) {
            setup();
            limit[side] = cases[i].limit;
            reading[side] = (struct derate_reading){true,
                                                    cases[i].tells_temperature,
                                                    cases[i].tells_supply,
                                                    false,
                                                    cases[i].degC,
                                                    cases[i].volt};
            look(20.0);
            assert_close(derate.share, cases[i].share, 1e-4, 0.0);
            ck_assert_msg(derate.leg[side].cause == (int)cases[i].cause, "case %zu", i);
            ck_assert_int_eq(derate.leg[1 - side].cause, DERATE_NONE);
        }
    }
}
END_TEST

/* Back to all of it, however little is missing; for less than a tenth otherwise not. */
START_TEST(the_last_bit_is_given_back)
{
    look(1.0);
    reading[SIDE_LEFT].temperature_degC = 81.0f; /* 0.95 */
    look(5.0);
    assert_close(derate.share, 0.95, 1e-4, 0.0);
    reading[SIDE_LEFT].temperature_degC = 80.2f; /* 0.99 */
    look(20.0);
    assert_close(derate.share, 0.95, 1e-4, 0.0);
    reading[SIDE_LEFT].temperature_degC = 80.0f;
    look(20.0);
    assert_close(derate.share, 1.0, 1e-6, 0.0);
    assert_close(derate.least_share, 0.95, 1e-4, 0.0);
}
END_TEST

/* Withdrawn, it returns when both legs are well, whichever was beyond. */
START_TEST(it_returns_when_both_are_well)
{
    for (int side = 0; side < SIDE_COUNT; side++) {
        setup();
        look(1.0);
        reading[side].temperature_degC = 101.0f;
        reading[1 - side].temperature_degC = 85.0f;
        look(3.0);
        ck_assert(derate.withdrawn);
        reading[side].temperature_degC = 25.0f;
        look(10.0);
        ck_assert(derate.withdrawn); /* the other is not */
        reading[1 - side].temperature_degC = 25.0f;
        ck_assert(derate_update(&derate, limit, reading, ++now)); /* and that is told */
        ck_assert(!derate.withdrawn);
        ck_assert(!derate_update(&derate, limit, reading, ++now));
        reading[side].temperature_degC = 90.0f;
        ck_assert(derate_update(&derate, limit, reading, ++now)); /* a cause, of either leg */
    }
}
END_TEST

/* The first look knows no time before it. */
START_TEST(the_first_look_moves_nothing)
{
    reading[SIDE_LEFT].temperature_degC = 100.0f;
    now += 500;
    ck_assert(derate_update(&derate, limit, reading, now));
    assert_close(derate.share, 1.0, 0.0, 0.0);
    assert_close(derate.leg[SIDE_LEFT].share, 0.0, 0.0, 0.0);
    now += 500;
    (void)derate_update(&derate, limit, reading, now);
    assert_close(derate.share, 0.9, 1e-5, 0.0);
}
END_TEST

/* What a drive does not tell is not judged, whatever stands there; and a drive without room between warn and stop is
 * not judged by a division by it. */
START_TEST(only_what_is_told_is_judged)
{
    look(1.0);
    reading[SIDE_LEFT].has_temperature = false;
    reading[SIDE_LEFT].temperature_degC = 95.0f;
    look(0.3);
    ck_assert_int_eq(derate.leg[SIDE_LEFT].cause, DERATE_NONE);
    reading[SIDE_LEFT].has_temperature = true;
    reading[SIDE_LEFT].has_supply = false;
    reading[SIDE_LEFT].temperature_degC = 25.0f;
    reading[SIDE_LEFT].supply_V = 0.0f;
    look(0.1);
    ck_assert_int_eq(derate.leg[SIDE_LEFT].cause, DERATE_NONE);
    setup();
    limit[SIDE_LEFT].temperature_warn_degC = limit[SIDE_LEFT].temperature_stop_degC;
    look(10.0);
    assert_close(derate.share, 1.0, 0.0, 0.0);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("derate");
    TCase *tests = tcase_create("all");
    tcase_add_checked_fixture(tests, setup, NULL);
    tcase_add_test(tests, nothing_is_spared_where_nothing_is_near_a_limit);
    tcase_add_loop_test(tests, the_share_is_linear_and_both_legs, 0,
                        (int)(sizeof steady / sizeof steady[0]));
    tcase_add_test(tests, the_share_moves_by_ramps);
    tcase_add_test(tests, it_rises_only_for_something);
    tcase_add_test(tests, beyond_a_limit_it_withdraws_and_returns_with_hysteresis);
    tcase_add_test(tests, a_sag_in_every_step_is_no_low_supply);
    tcase_add_test(tests, a_warning_that_lasts_halves_the_push_and_ends_no_walk);
    tcase_add_test(tests, a_warning_does_not_keep_it_withdrawn);
    tcase_add_loop_test(tests, what_is_no_number_is_beyond_the_limit, 0, 3);
    tcase_add_test(tests, a_limit_that_nobody_can_watch_withdraws);
    tcase_add_test(tests, time_between_looks_is_bounded);
    tcase_add_test(tests, what_is_new_is_told_once);
    tcase_add_test(tests, times_are_waited_for);
    tcase_add_test(tests, what_is_over_is_forgotten_in_its_own_time);
    tcase_add_test(tests, each_limit_stands_alone);
    tcase_add_test(tests, the_last_bit_is_given_back);
    tcase_add_test(tests, it_returns_when_both_are_well);
    tcase_add_test(tests, the_first_look_moves_nothing);
    tcase_add_test(tests, only_what_is_told_is_judged);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
