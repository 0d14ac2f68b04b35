/* What became of a push: every outcome, and the misses in a row. */
#include "controller/actuation/push_watch.h"
#include "tests/support/assert_close.h"

static struct push_watch watch;

static void setup(void)
{
    watch = (struct push_watch){0};
}

static uint32_t now;

static void tick(enum side side, bool armed, bool waits, bool behind, enum latch_state latch)
{
    const struct push_view view = {
        .full = armed, .armed = armed, .waits = waits, .behind = behind, .latch = latch};
    push_watch_tick(&watch, side, &view, ++now);
}

/* One stance of the left leg; loaded: armed before the other foot landed. */
static enum push_outcome stance(bool armed, bool waits, enum latch_state latch, bool loaded)
{
    push_watch_prescribe(&watch, SIDE_LEFT);
    tick(SIDE_LEFT, false, waits, false, LATCH_CLOSED);
    tick(SIDE_LEFT, armed, waits, false, latch);
    push_watch_strike(&watch, SIDE_LEFT, loaded ? now : now - 1);
    return push_watch_end(&watch, SIDE_LEFT);
}

START_TEST(every_outcome_has_its_reason)
{
    ck_assert_int_eq(stance(true, false, LATCH_OPEN, true), PUSH_GIVEN);
    ck_assert_int_eq(stance(true, false, LATCH_UNKNOWN, true), PUSH_GIVEN);
    ck_assert_int_eq(stance(false, true, LATCH_OPEN, false), PUSH_LATCH_OPEN);
    ck_assert_int_eq(stance(false, false, LATCH_CLOSED, false), PUSH_NOT_LOADED);
    ck_assert_int_eq(stance(true, false, LATCH_CLOSED, false), PUSH_NOT_LOADED); /* too late */
    ck_assert_int_eq(stance(true, false, LATCH_CLOSED, true), PUSH_NOT_RELEASED);
    const struct push_leg *leg = &watch.leg[SIDE_LEFT];
    ck_assert_uint_eq(leg->count[PUSH_GIVEN], 2);
    ck_assert_uint_eq(leg->count[PUSH_LATCH_OPEN], 1);
    ck_assert_uint_eq(leg->count[PUSH_NOT_LOADED], 2);
    ck_assert_uint_eq(leg->count[PUSH_NOT_RELEASED], 1);
    ck_assert_uint_eq(leg->last, PUSH_NOT_RELEASED);
    ck_assert_uint_eq(watch.leg[SIDE_RIGHT].count[PUSH_GIVEN], 0);
}
END_TEST

START_TEST(an_open_latch_that_nobody_armed_is_no_push)
{
    push_watch_prescribe(&watch, SIDE_LEFT);
    tick(SIDE_LEFT, false, false, false, LATCH_OPEN);
    push_watch_strike(&watch, SIDE_LEFT, now);
    ck_assert_int_eq(push_watch_end(&watch, SIDE_LEFT), PUSH_NOT_LOADED);
}
END_TEST

START_TEST(three_misses_in_a_row_of_either_leg)
{
    for (int i = 0; i < PUSH_WATCH_MISSES - 1; i++) {
        ck_assert_int_eq(stance(false, false, LATCH_CLOSED, false), PUSH_NOT_LOADED);
    }
    ck_assert_uint_eq(watch.missed_in_row, PUSH_WATCH_MISSES - 1);
    push_watch_prescribe(&watch, SIDE_RIGHT);
    tick(SIDE_RIGHT, true, false, false, LATCH_OPEN);
    ck_assert_int_eq(push_watch_end(&watch, SIDE_RIGHT), PUSH_GIVEN); /* before the other landed */
    ck_assert_uint_eq(watch.missed_in_row, 0);
    for (int i = 0; i < 300; i++) {
        (void)stance(false, false, LATCH_CLOSED, false);
    }
    ck_assert_uint_eq(watch.missed_in_row, UINT8_MAX);
    push_watch_begin(&watch);
    ck_assert_uint_eq(watch.missed_in_row, 0);
    ck_assert_uint_eq(watch.leg[SIDE_LEFT].count[PUSH_NOT_LOADED], 302); /* stays counted */
}
END_TEST

START_TEST(a_stance_that_was_not_seen_to_its_end_says_nothing)
{
    push_watch_prescribe(&watch, SIDE_LEFT);
    push_watch_prescribe(&watch, SIDE_LEFT); /* no other foot landed in between */
    ck_assert_int_eq(push_watch_end(&watch, SIDE_LEFT), PUSH_NONE);
    ck_assert_int_eq(push_watch_end(&watch, SIDE_LEFT), PUSH_NONE);
    ck_assert_uint_eq(watch.missed_in_row, 0);
    push_watch_strike(&watch, SIDE_LEFT, now); /* nothing is prescribed */
    ck_assert_int_eq(push_watch_end(&watch, SIDE_LEFT), PUSH_NONE);
}
END_TEST

START_TEST(a_walk_begins_without_the_pushes_of_the_last)
{
    for (int side = 0; side < SIDE_COUNT; side++) {
        push_watch_prescribe(&watch, (enum side)side);
        tick((enum side)side, true, false, false, LATCH_OPEN);
        push_watch_strike(&watch, (enum side)side, now);
        (void)push_watch_drag(&watch, (enum side)side);
    }
    watch.missed_in_row = watch.dragged_in_row = PUSH_WATCH_MISSES;
    push_watch_begin(&watch);
    ck_assert(!push_watch_fails(&watch));
    for (int side = 0; side < SIDE_COUNT; side++) {
        ck_assert_int_eq(push_watch_end(&watch, (enum side)side), PUSH_NONE);
        ck_assert(push_watch_drag(&watch, (enum side)side)); /* anew */
    }
}
END_TEST

START_TEST(a_motor_that_is_behind_is_counted_always)
{
    tick(SIDE_RIGHT, false, false, true, LATCH_CLOSED);
    tick(SIDE_RIGHT, false, false, false, LATCH_CLOSED);
    ck_assert_uint_eq(watch.leg[SIDE_RIGHT].behind_ticks, 1);
    watch.leg[SIDE_RIGHT].behind_ticks = UINT32_MAX;
    tick(SIDE_RIGHT, false, false, true, LATCH_CLOSED);
    ck_assert_uint_eq(watch.leg[SIDE_RIGHT].behind_ticks, UINT32_MAX);
}
END_TEST

/* One release of the left leg, loaded in time; before and while it opens, the latch tells these. */
static void release(enum latch_state before, enum latch_state then)
{
    push_watch_prescribe(&watch, SIDE_LEFT);
    tick(SIDE_LEFT, true, false, false, before);
    push_watch_strike(&watch, SIDE_LEFT, now);
    tick(SIDE_LEFT, true, false, false, then);
    (void)push_watch_end(&watch, SIDE_LEFT);
}

static const struct {
    enum latch_state before, then;
    bool stuck;
} reports[] = {{LATCH_CLOSED, LATCH_CLOSED, true},
               {LATCH_OPEN, LATCH_OPEN, true}, /* the bench loads behind it, too */
               {LATCH_CLOSED, LATCH_OPEN, false},
               {LATCH_OPEN, LATCH_CLOSED, false},
               {LATCH_UNKNOWN, LATCH_UNKNOWN, false}};

/* The other leg's pushes, given in between, do not excuse it. */
START_TEST(a_report_that_does_not_change_in_three_releases_is_stuck)
{
    for (int i = 0; i < PUSH_WATCH_UNCHANGED; i++) {
        ck_assert(!push_watch_latch_is_stuck(&watch, SIDE_LEFT));
        release(reports[_i].before, reports[_i].then);
        push_watch_prescribe(&watch, SIDE_RIGHT);
        tick(SIDE_RIGHT, true, false, false, LATCH_OPEN);
        (void)push_watch_end(&watch, SIDE_RIGHT);
    }
    ck_assert(push_watch_latch_is_stuck(&watch, SIDE_LEFT) == reports[_i].stuck);
    ck_assert(!push_watch_latch_is_stuck(&watch, SIDE_RIGHT));
    for (int i = 0; i < 300; i++) {
        release(reports[_i].before, reports[_i].then);
    }
    ck_assert(push_watch_latch_is_stuck(&watch, SIDE_LEFT) == reports[_i].stuck);
    release(LATCH_CLOSED, LATCH_OPEN);
    ck_assert(!push_watch_latch_is_stuck(&watch, SIDE_LEFT));
}
END_TEST

/* Not armed, or not loaded in time: nothing should have opened it. And a new walk begins anew. */
START_TEST(only_what_should_have_opened_it_counts)
{
    release(LATCH_CLOSED, LATCH_CLOSED);
    release(LATCH_CLOSED, LATCH_CLOSED);
    for (int i = 0; i < 5; i++) {
        push_watch_prescribe(&watch, SIDE_LEFT);
        tick(SIDE_LEFT, false, false, false, LATCH_CLOSED);
        push_watch_strike(&watch, SIDE_LEFT, now);
        (void)push_watch_end(&watch, SIDE_LEFT);
        (void)stance(true, false, LATCH_CLOSED, false); /* full behind the strike */
    }
    ck_assert(!push_watch_latch_is_stuck(&watch, SIDE_LEFT));
    push_watch_begin(&watch);
    release(LATCH_CLOSED, LATCH_CLOSED);
    release(LATCH_CLOSED, LATCH_CLOSED);
    ck_assert(!push_watch_latch_is_stuck(&watch, SIDE_LEFT));
    release(LATCH_CLOSED, LATCH_CLOSED);
    ck_assert(push_watch_latch_is_stuck(&watch, SIDE_LEFT));
}
END_TEST

/* The other foot's first landing counts: what is loaded by its second was late. */
START_TEST(a_second_strike_makes_nothing_loaded)
{
    push_watch_prescribe(&watch, SIDE_LEFT);
    tick(SIDE_LEFT, false, false, false, LATCH_CLOSED);
    push_watch_strike(&watch, SIDE_LEFT, now);
    tick(SIDE_LEFT, true, false, false, LATCH_CLOSED);
    push_watch_strike(&watch, SIDE_LEFT, now);
    ck_assert_int_eq(push_watch_end(&watch, SIDE_LEFT), PUSH_NOT_LOADED);
}
END_TEST

/* Three in a row of either kind, and not two. */
START_TEST(two_in_a_row_are_not_three)
{
    watch.missed_in_row = PUSH_WATCH_MISSES - 1;
    watch.dragged_in_row = PUSH_WATCH_MISSES - 1;
    ck_assert(!push_watch_fails(&watch));
    watch.missed_in_row = PUSH_WATCH_MISSES;
    ck_assert(push_watch_fails(&watch));
    watch.missed_in_row = 0;
    watch.dragged_in_row = PUSH_WATCH_MISSES;
    ck_assert(push_watch_fails(&watch));
}
END_TEST

/* Only a push that was given and did not drag ends a row of drags; one that was missed says nothing of it. */
START_TEST(a_row_of_drags_ends_with_a_push_that_does_not)
{
    (void)stance(true, false, LATCH_OPEN, true);
    ck_assert(push_watch_drag(&watch, SIDE_LEFT));
    ck_assert(!push_watch_drag(&watch, SIDE_LEFT)); /* once a swing */
    ck_assert_uint_eq(watch.dragged_in_row, 1);
    ck_assert_uint_eq(watch.leg[SIDE_LEFT].count[PUSH_DRAGS], 1);
    ck_assert_int_eq(stance(false, false, LATCH_CLOSED, false), PUSH_NOT_LOADED);
    ck_assert_uint_eq(watch.dragged_in_row, 1);
    (void)stance(true, false, LATCH_OPEN, true);
    ck_assert_uint_eq(watch.dragged_in_row, 1); /* the one before was no push */
    ck_assert(push_watch_drag(&watch, SIDE_LEFT));
    ck_assert_uint_eq(watch.dragged_in_row, 2);
    (void)stance(true, false, LATCH_OPEN, true);
    ck_assert_uint_eq(watch.dragged_in_row, 2);
    push_watch_prescribe(&watch, SIDE_LEFT); /* that was given, and nobody saw it drag */
    ck_assert_uint_eq(watch.dragged_in_row, 0);
}
END_TEST

/* A leg waits for its latch while it does, not for ever: what opens later was late, not open. */
START_TEST(who_has_stopped_waiting_does_not_wait)
{
    push_watch_prescribe(&watch, SIDE_LEFT);
    tick(SIDE_LEFT, false, true, false, LATCH_OPEN);
    tick(SIDE_LEFT, false, false, false, LATCH_CLOSED);
    push_watch_strike(&watch, SIDE_LEFT, now);
    ck_assert_int_eq(push_watch_end(&watch, SIDE_LEFT), PUSH_NOT_LOADED);
}
END_TEST

/* Full at some tick, and the first of them counts: what is lost again was loaded in time all the same. */
START_TEST(the_first_full_tick_counts)
{
    push_watch_prescribe(&watch, SIDE_LEFT);
    tick(SIDE_LEFT, true, false, false, LATCH_CLOSED);
    const uint32_t full_tick = now;
    tick(SIDE_LEFT, false, false, false, LATCH_CLOSED);
    tick(SIDE_LEFT, true, false, false, LATCH_CLOSED);
    push_watch_strike(&watch, SIDE_LEFT, full_tick);
    ck_assert_int_eq(push_watch_end(&watch, SIDE_LEFT), PUSH_NOT_RELEASED);
}
END_TEST

/* A new stance knows nothing of the one before, given or not. */
START_TEST(a_stance_begins_afresh)
{
    (void)stance(true, true, LATCH_OPEN, true);
    push_watch_prescribe(&watch, SIDE_LEFT);
    tick(SIDE_LEFT, false, false, false, LATCH_OPEN);
    push_watch_strike(&watch, SIDE_LEFT, now);
    ck_assert_int_eq(push_watch_end(&watch, SIDE_LEFT), PUSH_NOT_LOADED);
}
END_TEST

/* What is not prescribed leaves no trace: not that it was armed, full or struck. What the latch tells is always noted. */
START_TEST(nothing_counts_that_was_not_prescribed)
{
    tick(SIDE_LEFT, true, true, false, LATCH_OPEN);
    push_watch_strike(&watch, SIDE_LEFT, now);
    const struct push_leg *leg = &watch.leg[SIDE_LEFT];
    ck_assert(!leg->waited && !leg->armed && !leg->full && !leg->opened && !leg->struck &&
              !leg->loaded);
    ck_assert_uint_eq(leg->told, PUSH_WATCH_OPEN);
    tick(SIDE_LEFT, false, false, false, LATCH_CLOSED);
    ck_assert_uint_eq(leg->told, PUSH_WATCH_OPEN | PUSH_WATCH_CLOSED);
    ck_assert_uint_eq(watch.leg[SIDE_RIGHT].told, 0);
    tick(SIDE_RIGHT, false, false, false, LATCH_UNKNOWN);
    ck_assert_uint_eq(watch.leg[SIDE_RIGHT].told, 0);
    tick(SIDE_RIGHT, false, false, false, LATCH_CLOSED);
    ck_assert_uint_eq(watch.leg[SIDE_RIGHT].told, PUSH_WATCH_CLOSED);
    push_watch_begin(&watch);
    ck_assert_uint_eq(leg->told, 0);
    ck_assert_uint_eq(watch.leg[SIDE_RIGHT].told, 0);
    ck_assert_uint_eq(watch.missed_in_row, 0);
    ck_assert_uint_eq(watch.dragged_in_row, 0);
    ck_assert_uint_eq(leg->unchanged_in_row, 0);
    ck_assert_int_eq(push_watch_end(&watch, SIDE_LEFT), PUSH_NONE);
    ck_assert_uint_eq(leg->last, PUSH_NONE);
}
END_TEST

/* A latch that opened, and closes again before the foot leaves; armed once is armed, full before is in time. */
START_TEST(what_was_seen_stays_seen)
{
    push_watch_prescribe(&watch, SIDE_LEFT);
    tick(SIDE_LEFT, true, false, false, LATCH_CLOSED);
    tick(SIDE_LEFT, false, false, false, LATCH_OPEN); /* not armed any more: it was on its way */
    tick(SIDE_LEFT, false, false, false, LATCH_CLOSED);
    push_watch_strike(&watch, SIDE_LEFT, now);
    ck_assert_int_eq(push_watch_end(&watch, SIDE_LEFT), PUSH_GIVEN);
    push_watch_prescribe(&watch, SIDE_LEFT);
    tick(SIDE_LEFT, true, false, false, LATCH_CLOSED);
    tick(SIDE_LEFT, true, false, false, LATCH_CLOSED);
    push_watch_strike(&watch, SIDE_LEFT, now + 5);
    ck_assert_int_eq(push_watch_end(&watch, SIDE_LEFT), PUSH_NOT_RELEASED);
}
END_TEST

/* A stance that was given and has no end yet ends where the next one begins. */
START_TEST(the_next_stance_ends_the_one_before)
{
    push_watch_prescribe(&watch, SIDE_LEFT);
    tick(SIDE_LEFT, true, false, false, LATCH_OPEN);
    push_watch_prescribe(&watch, SIDE_LEFT);
    ck_assert_uint_eq(watch.leg[SIDE_LEFT].count[PUSH_GIVEN], 1);
    tick(SIDE_LEFT, false, false, false, LATCH_CLOSED);
    push_watch_strike(&watch, SIDE_LEFT, now);
    ck_assert_int_eq(push_watch_end(&watch, SIDE_LEFT), PUSH_NOT_LOADED);
}
END_TEST

/* A drag that was seen in this swing is no push that did not drag, whatever the one before was. */
START_TEST(a_drag_is_the_last_that_is_known_of_a_push)
{
    (void)stance(true, false, LATCH_OPEN, true);
    (void)push_watch_drag(&watch, SIDE_LEFT);
    ck_assert_uint_eq(watch.leg[SIDE_LEFT].last, PUSH_DRAGS);
    push_watch_prescribe(&watch, SIDE_LEFT);
    ck_assert_uint_eq(watch.dragged_in_row, 1);
    push_watch_prescribe(&watch, SIDE_LEFT); /* and no push since */
    ck_assert_uint_eq(watch.dragged_in_row, 1);
}
END_TEST

/* A leg that never pushed ends no row of the other's drags. */
START_TEST(a_leg_without_a_push_ends_no_row)
{
    (void)stance(true, false, LATCH_OPEN, true);
    (void)push_watch_drag(&watch, SIDE_LEFT);
    push_watch_prescribe(&watch, SIDE_RIGHT);
    ck_assert_uint_eq(watch.dragged_in_row, 1);
}
END_TEST

/* A latch that changes begins a new row of three, and what it told of one stance says nothing of the next. */
START_TEST(a_change_begins_a_new_row_of_unchanged_reports)
{
    release(LATCH_CLOSED, LATCH_OPEN);
    release(LATCH_CLOSED, LATCH_CLOSED);
    release(LATCH_CLOSED, LATCH_CLOSED);
    ck_assert_uint_eq(watch.leg[SIDE_LEFT].unchanged_in_row, 2);
    release(LATCH_CLOSED, LATCH_OPEN);
    ck_assert_uint_eq(watch.leg[SIDE_LEFT].unchanged_in_row, 0);
    release(LATCH_CLOSED, LATCH_CLOSED);
    ck_assert_uint_eq(watch.leg[SIDE_LEFT].unchanged_in_row, 1);
    ck_assert_uint_eq(watch.leg[SIDE_RIGHT].unchanged_in_row, 0);
}
END_TEST

/* Full in time, but never armed, for the other foot's strike was never near: no report had to change. */
START_TEST(a_spring_that_was_never_armed_had_nothing_to_tell)
{
    for (int i = 0; i < 5; i++) {
        push_watch_prescribe(&watch, SIDE_LEFT);
        const struct push_view view = {.full = true, .latch = LATCH_CLOSED};
        push_watch_tick(&watch, SIDE_LEFT, &view, ++now);
        push_watch_strike(&watch, SIDE_LEFT, now);
        ck_assert_int_eq(push_watch_end(&watch, SIDE_LEFT), PUSH_NOT_RELEASED);
        ck_assert_uint_eq(watch.leg[SIDE_LEFT].behind_ticks, 0);
    }
    ck_assert(!push_watch_latch_is_stuck(&watch, SIDE_LEFT));
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("push_watch");
    TCase *tests = tcase_create("outcomes");
    tcase_add_checked_fixture(tests, setup, NULL);
    tcase_add_test(tests, every_outcome_has_its_reason);
    tcase_add_test(tests, an_open_latch_that_nobody_armed_is_no_push);
    tcase_add_test(tests, three_misses_in_a_row_of_either_leg);
    tcase_add_test(tests, a_stance_that_was_not_seen_to_its_end_says_nothing);
    tcase_add_test(tests, a_walk_begins_without_the_pushes_of_the_last);
    tcase_add_test(tests, a_motor_that_is_behind_is_counted_always);
    tcase_add_loop_test(tests, a_report_that_does_not_change_in_three_releases_is_stuck, 0,
                        (int)(sizeof reports / sizeof reports[0]));
    tcase_add_test(tests, only_what_should_have_opened_it_counts);
    tcase_add_test(tests, a_second_strike_makes_nothing_loaded);
    tcase_add_test(tests, two_in_a_row_are_not_three);
    tcase_add_test(tests, a_row_of_drags_ends_with_a_push_that_does_not);
    tcase_add_test(tests, who_has_stopped_waiting_does_not_wait);
    tcase_add_test(tests, the_first_full_tick_counts);
    tcase_add_test(tests, a_stance_begins_afresh);
    tcase_add_test(tests, nothing_counts_that_was_not_prescribed);
    tcase_add_test(tests, what_was_seen_stays_seen);
    tcase_add_test(tests, the_next_stance_ends_the_one_before);
    tcase_add_test(tests, a_drag_is_the_last_that_is_known_of_a_push);
    tcase_add_test(tests, a_leg_without_a_push_ends_no_row);
    tcase_add_test(tests, a_change_begins_a_new_row_of_unchanged_reports);
    tcase_add_test(tests, a_spring_that_was_never_armed_had_nothing_to_tell);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
