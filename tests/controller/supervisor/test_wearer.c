/* The wearer's button and cue; and who may be enabled at all. */
#include "controller/controller.h"
#include "controller/supervisor/conditions.h"
#include "tests/support/assert_close.h"

static void pass(struct wearer *wearer, bool pressed, int ticks, bool fades)
{
    for (int i = 0; i < ticks; i++) {
        wearer_update(wearer, pressed, true, SUPERVISOR_WALKING, fades);
    }
}

static void press(struct wearer *wearer, bool fades)
{
    pass(wearer, true, WEARER_PRESS_TICKS, fades);
    pass(wearer, false, 1, fades);
}

START_TEST(a_press_pauses_and_the_next_goes_on)
{
    struct wearer wearer = {0};
    ck_assert(wearer_allows(&wearer));
    pass(&wearer, true, WEARER_PRESS_TICKS - 1, false); /* bounce */
    pass(&wearer, false, 100, false);
    ck_assert(wearer_allows(&wearer));
    press(&wearer, false);
    ck_assert(!wearer_allows(&wearer));
    pass(&wearer, false, 60000, false);
    ck_assert(!wearer_allows(&wearer));
    press(&wearer, false);
    ck_assert(wearer_allows(&wearer));
}
END_TEST

START_TEST(pushes_get_smaller_before_they_end)
{
    struct wearer wearer = {0};
    real level = REAL(1.0);
    ck_assert(wearer_end_step(&wearer) == REAL(1.0));
    press(&wearer, true);
    for (int i = 1; i <= WEARER_FADE_STEPS; i++) {
        ck_assert(wearer_allows(&wearer));
        pass(&wearer, false, 600, true);
        level *= wearer_end_step(&wearer);
        assert_close((double)level, 1.0 - (double)i / WEARER_FADE_STEPS, 1e-6, 0.0);
    }
    ck_assert(!wearer_allows(&wearer));
    /* Without steps it ends by itself. */
    wearer = (struct wearer){0};
    press(&wearer, true);
    pass(&wearer, false, WEARER_FADE_TICKS - 3, true);
    ck_assert(wearer_allows(&wearer));
    pass(&wearer, false, 1, true);
    ck_assert(!wearer_allows(&wearer));
    /* Who presses again does not wait. */
    wearer = (struct wearer){0};
    press(&wearer, true);
    press(&wearer, true);
    ck_assert(!wearer_allows(&wearer));
}
END_TEST

START_TEST(held_it_stops_until_a_new_request)
{
    struct wearer wearer = {0};
    pass(&wearer, true, WEARER_HOLD_TICKS - 1, true);
    ck_assert(wearer_allows(&wearer)); /* the pushes get smaller by now */
    pass(&wearer, true, 1, true);
    ck_assert(!wearer_allows(&wearer));
    pass(&wearer, false, 100, false);
    press(&wearer, false);
    press(&wearer, false);
    ck_assert(!wearer_allows(&wearer));
    wearer_update(&wearer, false, false, SUPERVISOR_STANDBY, false);
    wearer_update(&wearer, false, true, SUPERVISOR_STANDBY, false);
    ck_assert(wearer_allows(&wearer));
}
END_TEST

START_TEST(a_button_that_hangs_stops_every_request)
{
    struct wearer wearer = {0};
    pass(&wearer, true, 3000, false);
    for (int i = 0; i < 10; i++) {
        wearer_update(&wearer, true, false, SUPERVISOR_STANDBY, false);
        wearer_update(&wearer, true, true, SUPERVISOR_STANDBY, false);
        ck_assert(!wearer_allows(&wearer));
    }
}
END_TEST

START_TEST(a_request_without_a_walk_is_given_up)
{
    struct wearer wearer = {0};
    for (int i = 0; i < WEARER_WAIT_TICKS - 1; i++) {
        wearer_update(&wearer, false, true, SUPERVISOR_STANDBY, false);
    }
    ck_assert(wearer_allows(&wearer));
    wearer_update(&wearer, false, true, SUPERVISOR_STANDBY, false);
    ck_assert(!wearer_allows(&wearer));
    wearer = (struct wearer){0};
    for (int i = 0; i < 3 * WEARER_WAIT_TICKS; i++) { /* a walk */
        wearer_update(&wearer, false, true, SUPERVISOR_WALKING, false);
    }
    ck_assert(wearer_allows(&wearer));
}
END_TEST

START_TEST(the_cue_comes_before_the_first_assisted_step)
{
    static struct controller controller;
    static struct control_params params;
    params.engage_steps = REAL(4.0);
    controller.params = &params;
    ck_assert_int_eq(controller_cue(&controller), WEARER_CUE_NONE);
    controller.supervisor.state = SUPERVISOR_ENGAGING;
    ck_assert_int_eq(controller_cue(&controller), WEARER_CUE_NONE);
    controller.supervisor.state = SUPERVISOR_WALKING;
    ck_assert_int_eq(controller_cue(&controller), WEARER_CUE_SOON);
    controller.plan.assist_level = REAL(0.1);
    ck_assert_int_eq(controller_cue(&controller), WEARER_CUE_ASSISTS);
    controller.wearer.fade_steps = 2;
    ck_assert_int_eq(controller_cue(&controller), WEARER_CUE_FADES);
    controller.wearer = (struct wearer){.paused = true};
    ck_assert_int_eq(controller_cue(&controller), WEARER_CUE_PAUSED);
}
END_TEST

/* ---- sit, lie, stand -------------------------------------------------------------------- */

struct person {
    struct control_params params;
    struct checks checks;
    struct step_monitor steps;
    struct sea_reference sea[SIDE_COUNT];
    struct controller_input input;
    struct supervisor supervisor;
    struct conditions_view view;
};

static void stand(struct person *person, enum body_kind body)
{
    *person = (struct person){.params.body = (real)body, .params.engage_steps = REAL(4.0)};
    person->view = (struct conditions_view){.params = &person->params,
                                            .input = &person->input,
                                            .checks = &person->checks,
                                            .step_monitor = &person->steps,
                                            .sea = person->sea,
                                            .walk_wanted = true};
}

static bool may_walk(const struct person *person, enum supervisor_state state)
{
    const struct supervisor supervisor = {.state = state};
    return (conditions_find(&supervisor, &person->view, SUPERVISOR_FAULT_NONE) &
            SUPERVISOR_IF_WALK_REQUESTED) != 0;
}

START_TEST(no_drive_is_enabled_at_a_person_who_is_not_on_their_feet)
{
    struct person person;
    stand(&person, BODY_PERSON);
    ck_assert(may_walk(&person, SUPERVISOR_STANDBY));
    person.checks.standstill_ticks = TICKS_OF_MS(500); /* lies, or stands */
    ck_assert(!may_walk(&person, SUPERVISOR_STANDBY));
    ck_assert(!may_walk(&person, SUPERVISOR_ENGAGING));
    ck_assert(may_walk(&person, SUPERVISOR_WALKING)); /* whose steps end are seen to otherwise */
    person.checks.standstill_ticks = 0;               /* moves */
    person.checks.tilted_ticks = TICKS_OF_MS(200);
    ck_assert(!may_walk(&person, SUPERVISOR_STANDBY));
    ck_assert(!may_walk(&person, SUPERVISOR_WALKING));
    person.checks.tilted_ticks = 0;
    person.checks.lifted_ticks = TICKS_OF_MS(500);
    ck_assert(!may_walk(&person, SUPERVISOR_STANDBY));
    ck_assert(!may_walk(&person, SUPERVISOR_WALKING));
    stand(&person, BODY_COMPASS); /* the bench: a hand is there */
    person.checks.standstill_ticks = TICKS_OF_MS(500);
    ck_assert(may_walk(&person, SUPERVISOR_STANDBY));
}
END_TEST

/* Only STANDBY is waiting: a fault or an unload in between begins anew, and a pause waits for nobody. */
START_TEST(only_standby_is_waited_in)
{
    static const enum supervisor_state between[] = {SUPERVISOR_INIT,      SUPERVISOR_SELF_TEST,
                                                    SUPERVISOR_ENGAGING,  SUPERVISOR_WALKING,
                                                    SUPERVISOR_UNLOADING, SUPERVISOR_FAULT};
    for (size_t i = 0; i < sizeof between / sizeof between[0]; i++) {
        struct wearer wearer = {0};
        for (int round = 0; round < 2; round++) {
            for (int k = 0; k < WEARER_WAIT_TICKS - 1; k++) {
                wearer_update(&wearer, false, true, SUPERVISOR_STANDBY, false);
            }
            ck_assert(wearer_allows(&wearer));
            ck_assert_uint_eq(wearer.wait_ticks, WEARER_WAIT_TICKS - 1);
            wearer_update(&wearer, false, true, between[i], false);
            ck_assert_uint_eq(wearer.wait_ticks, 0);
        }
    }
    struct wearer wearer = {.paused = true};
    for (int k = 0; k < WEARER_WAIT_TICKS + 10; k++) {
        wearer_update(&wearer, false, true, SUPERVISOR_STANDBY, false);
    }
    ck_assert(!wearer.stopped);
    ck_assert_uint_eq(wearer.wait_ticks, 0);
}
END_TEST

/* However long it hangs, it is one press, and held. */
START_TEST(a_button_that_hangs_is_one_press)
{
    struct wearer wearer = {0};
    pass(&wearer, true, 200000, true);
    ck_assert_uint_eq(wearer.pressed_ticks, UINT16_MAX);
    ck_assert(wearer.stopped);
    ck_assert(wearer.paused); /* its pushes had become smaller for 4 s */
}
END_TEST

/* The second press while they become smaller ends them, with nothing left of the fading; the third goes on. */
START_TEST(nothing_of_a_fade_is_left_in_a_pause)
{
    struct wearer wearer = {0};
    press(&wearer, true);
    ck_assert_uint_eq(wearer.fade_steps, WEARER_FADE_STEPS);
    ck_assert(wearer_end_step(&wearer) < REAL(1.0));
    press(&wearer, true);
    ck_assert(wearer.paused);
    ck_assert_uint_eq(wearer.fade_steps, 0);
    ck_assert(wearer_end_step(&wearer) == REAL(1.0));
    pass(&wearer, false, 10, true);
    ck_assert_uint_eq(wearer.fade_ticks, 0);
    press(&wearer, true);
    ck_assert(wearer_allows(&wearer));
    press(&wearer, true); /* a new one takes its whole time again */
    pass(&wearer, false, WEARER_FADE_TICKS - 3, true);
    ck_assert(wearer_allows(&wearer));
    pass(&wearer, false, 1, true);
    ck_assert(!wearer_allows(&wearer));
}
END_TEST

/* Where nothing can become smaller a press pauses at once. */
START_TEST(without_pushes_a_press_pauses_at_once)
{
    struct wearer wearer = {0};
    pass(&wearer, true, WEARER_PRESS_TICKS, false);
    ck_assert(wearer.paused && !wearer.stopped);
    ck_assert_uint_eq(wearer.fade_steps, 0);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("wearer");
    TCase *tcase = tcase_create("wearer");
    tcase_add_test(tcase, a_press_pauses_and_the_next_goes_on);
    tcase_add_test(tcase, pushes_get_smaller_before_they_end);
    tcase_add_test(tcase, held_it_stops_until_a_new_request);
    tcase_add_test(tcase, a_button_that_hangs_stops_every_request);
    tcase_add_test(tcase, a_request_without_a_walk_is_given_up);
    tcase_add_test(tcase, the_cue_comes_before_the_first_assisted_step);
    tcase_add_test(tcase, no_drive_is_enabled_at_a_person_who_is_not_on_their_feet);
    tcase_add_test(tcase, only_standby_is_waited_in);
    tcase_add_test(tcase, a_button_that_hangs_is_one_press);
    tcase_add_test(tcase, nothing_of_a_fade_is_left_in_a_pause);
    tcase_add_test(tcase, without_pushes_a_press_pauses_at_once);
    suite_add_tcase(suite, tcase);
    return run_suite(suite);
}
