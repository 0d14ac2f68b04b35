/* What counts as a verified, steady step. */
#include "controller/supervisor/step_monitor.h"
#include "tests/support/assert_close.h"

struct walk {
    struct step_monitor monitor;
    uint32_t tick;
};

static void strike(struct walk *walk, enum side side)
{
    struct gait_state gait = {.walk_shown = true};
    gait.event[GAIT_HEEL_STRIKE] =
        (struct gait_event){.happened = true, .side = side, .tick = walk->tick};
    ck_assert(!step_monitor_update(&walk->monitor, &gait, walk->tick));
}

/* An apex `ms` after the last one, with one heel strike of the other foot between. */
static void step(struct walk *walk, enum side side, uint32_t ms)
{
    struct gait_state gait = {.walk_shown = true};
    strike(walk, side);
    walk->tick += ms;
    gait.event[GAIT_APEX] = (struct gait_event){.happened = true, .side = side, .tick = walk->tick};
    ck_assert(step_monitor_update(&walk->monitor, &gait, walk->tick + 40));
}

static void start(struct walk *walk)
{
    walk->tick = 1000;
    step_monitor_init(&walk->monitor);
    step(walk, SIDE_LEFT, 0);
}

START_TEST(a_step_that_is_not_shown_to_be_walking_is_not_steady)
{
    struct walk walk;
    struct gait_state gait = {.walk_shown = false};
    start(&walk);
    step(&walk, SIDE_RIGHT, 600);
    step(&walk, SIDE_LEFT, 600);
    ck_assert_uint_eq(walk.monitor.steady, 1);
    strike(&walk, SIDE_RIGHT);
    walk.tick += 600;
    gait.event[GAIT_APEX] =
        (struct gait_event){.happened = true, .side = SIDE_RIGHT, .tick = walk.tick};
    ck_assert(step_monitor_update(&walk.monitor, &gait, walk.tick + 40));
    ck_assert_uint_eq(walk.monitor.steady, 0);
    ck_assert_uint_eq(walk.monitor.unsteady, 1);
}
END_TEST

START_TEST(what_denies_walking_ends_it_at_once)
{
    struct walk walk;
    const struct gait_state denied = {.walk_shown = true, .walk_denied = true};
    start(&walk);
    step(&walk, SIDE_RIGHT, 600);
    step(&walk, SIDE_LEFT, 600);
    ck_assert(!step_monitor_update(&walk.monitor, &denied, walk.tick + 50));
    ck_assert_uint_eq(walk.monitor.steady, 0);
    ck_assert_uint_ge(walk.monitor.unsteady, STEP_MONITOR_IRREGULAR);
    step(&walk, SIDE_RIGHT, 600); /* forgiven by the next steady step */
    ck_assert_uint_eq(walk.monitor.unsteady, 0);
}
END_TEST

START_TEST(equal_steps_are_steady_from_the_third_apex_on)
{
    struct walk walk;
    start(&walk);
    ck_assert_uint_eq(walk.monitor.steady, 0);
    step(&walk, SIDE_RIGHT, 600);
    ck_assert_uint_eq(walk.monitor.steady, 0); /* nothing to compare with */
    for (unsigned i = 1; i <= 6; i++) {
        step(&walk, i % 2 != 0 ? SIDE_LEFT : SIDE_RIGHT, 600 + 20 * i);
        ck_assert_uint_eq(walk.monitor.steady, i);
    }
    ck_assert_uint_eq(walk.monitor.unsteady, 0);
    ck_assert_uint_eq(walk.monitor.known_tick, walk.tick + 40);
}
END_TEST

static const struct {
    const char *what;
    enum side side;
    uint32_t ms;
    int extra_strikes;
} breaks[] = {
    {"half as long", SIDE_RIGHT, 300, 0},
    {"twice as long", SIDE_RIGHT, 1200, 0},
    {"the same leg again", SIDE_LEFT, 600, 0},
    {"two heel strikes", SIDE_RIGHT, 600, 1},
};

START_TEST(a_step_unlike_the_others_begins_anew)
{
    struct walk walk;
    start(&walk);
    step(&walk, SIDE_RIGHT, 600);
    step(&walk, SIDE_LEFT, 600);
    step(&walk, SIDE_RIGHT, 600);
    step(&walk, SIDE_LEFT, 600);
    ck_assert_uint_eq(walk.monitor.steady, 3);
    for (int i = 0; i < breaks[_i].extra_strikes; i++) {
        strike(&walk, breaks[_i].side);
    }
    step(&walk, breaks[_i].side, breaks[_i].ms);
    ck_assert_msg(walk.monitor.steady == 0, "%s", breaks[_i].what);
    ck_assert_uint_eq(walk.monitor.unsteady, 1);
    ck_assert_int_eq(walk.monitor.same_side, breaks[_i].side == SIDE_LEFT);
}
END_TEST

/* As long as the others, one strike of the other foot on the way, and the same leg at the apex: it limps in place. */
START_TEST(the_same_leg_twice_is_no_steady_step)
{
    struct walk walk;
    start(&walk);
    step(&walk, SIDE_RIGHT, 600);
    step(&walk, SIDE_LEFT, 600);
    ck_assert_uint_eq(walk.monitor.steady, 1);
    struct gait_state gait = {.walk_shown = true};
    strike(&walk, SIDE_RIGHT);
    walk.tick += 600;
    gait.event[GAIT_APEX] =
        (struct gait_event){.happened = true, .side = SIDE_LEFT, .tick = walk.tick};
    ck_assert(step_monitor_update(&walk.monitor, &gait, walk.tick));
    ck_assert(walk.monitor.same_side);
    ck_assert_uint_eq(walk.monitor.steady, 0);
    ck_assert_uint_eq(walk.monitor.unsteady, 1);
}
END_TEST

START_TEST(a_step_without_heel_strike_is_none)
{
    struct walk walk;
    struct gait_state gait = {.walk_shown = true};
    start(&walk);
    step(&walk, SIDE_RIGHT, 600);
    step(&walk, SIDE_LEFT, 600);
    ck_assert_uint_eq(walk.monitor.steady, 1);
    walk.tick += 600;
    gait.event[GAIT_APEX] =
        (struct gait_event){.happened = true, .side = SIDE_RIGHT, .tick = walk.tick};
    (void)step_monitor_update(&walk.monitor, &gait, walk.tick);
    ck_assert_uint_eq(walk.monitor.steady, 0);
}
END_TEST

START_TEST(the_legs_may_limp_by_a_third_not_more)
{
    struct walk walk;
    start(&walk);
    for (int i = 0; i < 10; i++) {
        step(&walk, i % 2 == 0 ? SIDE_RIGHT : SIDE_LEFT, i % 2 == 0 ? 500 : 700);
    }
    ck_assert_uint_eq(walk.monitor.steady, 9);
    start(&walk);
    for (int i = 0; i < 10; i++) {
        step(&walk, i % 2 == 0 ? SIDE_RIGHT : SIDE_LEFT, i % 2 == 0 ? 400 : 700);
        ck_assert_uint_eq(walk.monitor.steady, 0);
    }
    ck_assert_uint_eq(walk.monitor.unsteady, 11);
}
END_TEST

/* Each step is like the one before, and the walk slows down all the same. */
START_TEST(a_step_is_held_to_the_two_before)
{
    struct walk walk;
    start(&walk);
    step(&walk, SIDE_RIGHT, 600);
    step(&walk, SIDE_LEFT, 440);
    ck_assert_uint_eq(walk.monitor.steady, 1);
    step(&walk, SIDE_RIGHT, 330); /* three quarters of the last, but half of the one before */
    ck_assert_uint_eq(walk.monitor.steady, 0);
    ck_assert_uint_eq(walk.monitor.unsteady, 1);
}
END_TEST

/* Counters end at their limit, they do not begin again. */
START_TEST(counters_saturate)
{
    struct walk walk;
    start(&walk);
    step(&walk, SIDE_RIGHT, 600);
    walk.monitor.steady = UINT32_MAX;
    step(&walk, SIDE_LEFT, 600);
    ck_assert_uint_eq(walk.monitor.steady, UINT32_MAX);
    walk.monitor.unsteady = UINT32_MAX;
    step(&walk, SIDE_LEFT, 600);
    ck_assert_uint_eq(walk.monitor.unsteady, UINT32_MAX);
    for (int i = 0; i < 300; i++) {
        strike(&walk, SIDE_RIGHT);
    }
    ck_assert_uint_eq(walk.monitor.strikes, UINT8_MAX);
}
END_TEST

/* The clock of ticks runs over after 49 days. */
START_TEST(steps_across_the_end_of_the_clock)
{
    struct walk walk = {.tick = UINT32_MAX - 1500};
    step_monitor_init(&walk.monitor);
    step(&walk, SIDE_LEFT, 0);
    for (int i = 0; i < 6; i++) {
        step(&walk, i % 2 == 0 ? SIDE_RIGHT : SIDE_LEFT, 600);
    }
    ck_assert_uint_lt(walk.tick, 5000);
    ck_assert_uint_eq(walk.monitor.steady, 5);
}
END_TEST

/* By a third of the longer one, and not by a tick more: shorter or longer than the one before. */
START_TEST(a_third_is_still_alike)
{
    static const struct {
        uint32_t first_ms, second_ms;
        unsigned steady;
    } cases[] = {{600, 400, 1}, {600, 399, 0}, {400, 600, 1}, {400, 601, 0}, {400, 602, 0}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct walk walk;
        start(&walk);
        step(&walk, SIDE_RIGHT, cases[i].first_ms);
        step(&walk, SIDE_LEFT, cases[i].second_ms);
        ck_assert_msg(walk.monitor.steady == cases[i].steady, "case %zu", i);
        ck_assert_uint_eq(walk.monitor.step_ticks[0], cases[i].second_ms);
        ck_assert_uint_eq(walk.monitor.step_ticks[1], cases[i].first_ms);
    }
}
END_TEST

/* The foot that strikes is the one that was in swing: the stance leg's own does not count, nor one before any apex. */
START_TEST(only_the_other_foot_s_strike_counts)
{
    struct walk walk;
    start(&walk);
    ck_assert_uint_eq(walk.monitor.strikes, 0);
    strike(&walk, SIDE_LEFT);
    ck_assert_uint_eq(walk.monitor.strikes, 0);
    strike(&walk, SIDE_RIGHT);
    ck_assert_uint_eq(walk.monitor.strikes, 1);
    step_monitor_init(&walk.monitor);
    strike(&walk, SIDE_RIGHT);
    ck_assert_uint_eq(walk.monitor.strikes, 0);
    ck_assert(!walk.monitor.seen);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("step monitor");
    TCase *tests = tcase_create("all");
    tcase_add_test(tests, a_step_that_is_not_shown_to_be_walking_is_not_steady);
    tcase_add_test(tests, what_denies_walking_ends_it_at_once);
    tcase_add_test(tests, equal_steps_are_steady_from_the_third_apex_on);
    tcase_add_loop_test(tests, a_step_unlike_the_others_begins_anew, 0,
                        (int)(sizeof breaks / sizeof breaks[0]));
    tcase_add_test(tests, a_step_without_heel_strike_is_none);
    tcase_add_test(tests, the_legs_may_limp_by_a_third_not_more);
    tcase_add_test(tests, a_step_is_held_to_the_two_before);
    tcase_add_test(tests, counters_saturate);
    tcase_add_test(tests, steps_across_the_end_of_the_clock);
    tcase_add_test(tests, the_same_leg_twice_is_no_steady_step);
    tcase_add_test(tests, a_third_is_still_alike);
    tcase_add_test(tests, only_the_other_foot_s_strike_counts);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
