/* The controller as a whole, in the loop with the simulated walker: how it begins, shares,
 * withdraws and stops. The plant is the judge. */
#include "sim_host/faults/injector.h"
#include "sim_host/loop/loop.h"
#include "tests/support/assert_close.h"

#include <stdlib.h>
#include <string.h>

struct rig {
    struct loop loop;
    struct injector injector;
};

/* steps 0: the bench; otherwise a walker with a push-off of their own. */
static struct rig *start(double speed_rad_s, unsigned engage_steps)
{
    char message[LOOP_MESSAGE_MAX] = "";
    struct subject subject;
    struct control_params params;
    struct loop_config config;
    struct rig *rig = (struct rig *)calloc(1, sizeof *rig);
    ck_assert_ptr_nonnull(rig);
    subject_default(&subject);
    ck_assert_int_eq(subject_control_params(&subject, &params, message), 0);
    params.start_r0_m = speed_table_inverse(&params.table, (real)speed_rad_s);
    ck_assert_int_eq(
        loop_configure(&config, &subject, &params, speed_rad_s, SENSORS_17BIT, 1, message), 0);
    if (engage_steps > 0) {
        loop_configure_person(&config, engage_steps);
    }
    ck_assert_int_eq(loop_init(&rig->loop, &config, NULL, message), 0);
    injector_begin(&rig->injector, &rig->loop, NULL, 0);
    return rig;
}

static struct controller *controller_of(struct rig *rig)
{
    return &rig->loop.rig.task.controller;
}

static enum supervisor_state state_of(struct rig *rig)
{
    return rig->loop.rig.task.output.state;
}

/* Ticks until the law has seen so many steps; fails when they do not come. */
static void walk(struct rig *rig, uint32_t steps)
{
    const uint64_t limit = rig->loop.tick + 20000;
    while (controller_of(rig)->plan.law.steps < steps && rig->loop.tick < limit) {
        injector_tick(&rig->injector);
    }
    ck_assert_uint_ge(controller_of(rig)->plan.law.steps, steps);
}

static void run(struct rig *rig, int ticks)
{
    for (int i = 0; i < ticks; i++) {
        injector_tick(&rig->injector);
    }
}

static double motor_m(const struct rig *rig, enum side side)
{
    return rig->loop.nodes.plant.sea[side].position_m;
}

START_TEST(bad_parameters_are_refused)
{
    struct control_params params = {0};
    struct controller controller;
    ck_assert_int_ge(controller_init(&controller, &params), 0);
}
END_TEST

START_TEST(the_bench_walks_and_stops_when_asked)
{
    struct rig *rig = start(0.6, 0);
    walk(rig, 6);
    ck_assert_int_eq(state_of(rig), SUPERVISOR_WALKING);
    assert_close((double)controller_of(rig)->plan.assist_level, 1.0, 0.0, 0.0);
    rig->loop.rig.task.node.objects.walk_requested = 0;
    run(rig, 2);
    ck_assert_int_eq(state_of(rig), SUPERVISOR_UNLOADING);
    run(rig, 400);
    ck_assert_int_eq(state_of(rig), SUPERVISOR_STANDBY);
    for (int side = 0; side < SIDE_COUNT; side++) {
        assert_close(motor_m(rig, (enum side)side), 0.0, 0.006, 0.0);
        ck_assert(!rig->loop.rig.task.output.sea[side].enable);
    }
    free(rig);
}
END_TEST

/* The walker falls over when the push-off ends; nobody asks again: never loaded again. */
START_TEST(the_bench_does_not_load_again_by_itself)
{
    struct rig *rig = start(0.6, 0);
    const struct fault_shot trip = {.kind = FAULT_TRIP, .start_tick = 0, .duration_ticks = 3000};
    walk(rig, 6);
    injector_begin(&rig->injector, &rig->loop, &trip, 1);
    run(rig, 2500);
    ck_assert_int_ne(plant_fault(&rig->loop.nodes.plant), WALK_FAULT_NONE);
    for (int i = 0; i < 4000; i++) {
        injector_tick(&rig->injector);
        ck_assert(!supervisor_may_assist(state_of(rig)));
    }
    free(rig);
}
END_TEST

START_TEST(a_person_is_engaged_step_by_step_and_let_go)
{
    struct rig *rig = start(0.45, 4);
    walk(rig, 4);
    ck_assert_int_eq(state_of(rig), SUPERVISOR_ENGAGING);
    assert_close((double)controller_of(rig)->plan.assist_level, 0.0, 0.0, 0.0);
    assert_close(motor_m(rig, SIDE_LEFT), 0.0, 1e-3, 0.0);
    walk(rig, 9);
    ck_assert_int_eq(state_of(rig), SUPERVISOR_WALKING);
    ck_assert(controller_of(rig)->plan.assist_level > REAL(0.1) &&
              controller_of(rig)->plan.assist_level < REAL(0.5));
    walk(rig, 22);
    assert_close((double)controller_of(rig)->plan.assist_level, 1.0, 0.0, 0.0);
    double least = 1.0; /* share of the push-off that is still the person's */
    for (int i = 0; i < 2000; i++) {
        injector_tick(&rig->injector);
        least = rig->loop.own_push.share < least ? rig->loop.own_push.share : least;
    }
    ck_assert(least < 0.05);
    rig->loop.rig.task.node.objects.walk_requested = 0;
    run(rig, 6000); /* they walk on by themselves */
    ck_assert_int_eq(plant_fault(&rig->loop.nodes.plant), WALK_FAULT_NONE);
    ck_assert_int_eq(state_of(rig), SUPERVISOR_STANDBY);
    rig->loop.rig.task.node.objects.walk_requested = 1;
    run(rig, 200); /* and are verified anew */
    ck_assert_int_eq(state_of(rig), SUPERVISOR_ENGAGING);
    assert_close((double)controller_of(rig)->plan.assist_level, 0.0, 0.0, 0.0);
    const struct step_record before = controller_of(rig)->last_step;
    ck_assert_uint_gt(before.number, 20);
    ck_assert(before.r0_m > REAL(0.02));
    walk(rig, 2); /* the first steps give nothing, however much the last walk's steps had given */
    ck_assert_uint_le(controller_of(rig)->last_step.number, 2);
    assert_close((double)controller_of(rig)->last_step.r0_m, 0.0, 0.0, 0.0);
    free(rig);
}
END_TEST

/* One step unlike the others is borne, but the share does not rise with it. */
START_TEST(an_unsteady_step_does_not_raise_the_share)
{
    struct rig *rig = start(0.45, 4);
    walk(rig, 9);
    const real share = controller_of(rig)->plan.assist_level;
    ck_assert(share > REAL(0.0) && share < REAL(1.0));
    controller_of(rig)->step_monitor.step_ticks[0] *= 2;
    walk(rig, 10);
    run(rig, 1);
    ck_assert_uint_eq(controller_of(rig)->step_monitor.unsteady, 1);
    ck_assert(controller_of(rig)->plan.assist_level == share);
    ck_assert_int_eq(state_of(rig), SUPERVISOR_WALKING);
    free(rig);
}
END_TEST

static void press_button(struct rig *rig)
{
    rig->loop.rig.task.node.objects.wearer_button = 1;
    run(rig, 100);
    rig->loop.rig.task.node.objects.wearer_button = 0;
}

/* By the virtual button. The person walks on; the operator's request stands. */
START_TEST(the_wearer_pauses_and_goes_on)
{
    struct rig *rig = start(0.45, 4);
    walk(rig, 12);
    walk(rig, 22);
    const real before = controller_of(rig)->plan.assist_level;
    ck_assert(before > REAL(0.5));
    press_button(rig);
    ck_assert_int_eq(controller_cue(controller_of(rig)), WEARER_CUE_FADES);
    ck_assert_int_eq(state_of(rig), SUPERVISOR_WALKING);
    const uint32_t steps = controller_of(rig)->plan.law.steps;
    walk(rig, steps + 2);
    ck_assert_int_eq(state_of(rig), SUPERVISOR_WALKING);
    ck_assert(controller_of(rig)->plan.assist_level < REAL(0.5) * before);
    ck_assert(controller_of(rig)->plan.assist_level > REAL(0.0));
    run(rig, 4000);
    ck_assert_int_eq(state_of(rig), SUPERVISOR_STANDBY);
    ck_assert_int_eq(controller_cue(controller_of(rig)), WEARER_CUE_PAUSED);
    ck_assert_int_eq(plant_fault(&rig->loop.nodes.plant), WALK_FAULT_NONE);
    press_button(rig);
    ck_assert_int_eq(state_of(rig), SUPERVISOR_ENGAGING);
    bool told = false;
    for (int i = 0; i < 20000 && controller_of(rig)->plan.assist_level == REAL(0.0); i++) {
        run(rig, 1);
        told = told || controller_cue(controller_of(rig)) == WEARER_CUE_SOON;
    }
    ck_assert(told);
    ck_assert_int_eq(controller_cue(controller_of(rig)), WEARER_CUE_ASSISTS);
    free(rig);
}
END_TEST

/* It ends the walk, and does not stand in the way of a reset: somebody may have put it right by then. */
START_TEST(what_is_misplaced_is_a_fault_before_the_first_push)
{
    struct rig *rig = start(0.45, 4);
    walk(rig, 4);
    ck_assert_int_eq(state_of(rig), SUPERVISOR_ENGAGING);
    controller_of(rig)->observer.state.misplaced = PLACEMENT_STUCK;
    run(rig, 2);
    ck_assert_int_eq(state_of(rig), SUPERVISOR_UNLOADING);
    ck_assert_int_eq(rig->loop.rig.task.output.fault, SUPERVISOR_FAULT_PLACEMENT);
    ck_assert_uint_eq(rig->loop.rig.task.node.objects.misplaced, PLACEMENT_STUCK);
    run(rig, 400);
    ck_assert_int_eq(state_of(rig), SUPERVISOR_FAULT);
    controller_of(rig)->checks.standstill_ticks = UINT16_MAX;
    rig->loop.rig.task.node.objects.reset_requested = 1;
    run(rig, 2);
    ck_assert_int_eq(state_of(rig), SUPERVISOR_SELF_TEST);
    free(rig);
}
END_TEST

/* A fault ends commissioning's motion, and it begins with small loads again. One while walking is none of
 * commissioning's. */
START_TEST(a_fault_ends_a_motion_only_of_commissioning)
{
    struct rig *rig = start(0.6, 0);
    walk(rig, 6);
    struct motion *motion = &controller_of(rig)->motion;
    controller_of(rig)->supervisor.state = _i == 0 ? SUPERVISOR_COMMISSIONING : SUPERVISOR_WALKING;
    motion->phase = MOTION_LOADS;
    motion->outcome = MOTION_NONE_YET;
    motion->proven[SIDE_LEFT] = motion->proven[SIDE_RIGHT] = 1;
    rig->loop.rig.stop_pressed = true;
    run(rig, 3);
    ck_assert_int_eq(state_of(rig), SUPERVISOR_UNLOADING);
    ck_assert_int_eq(rig->loop.rig.task.output.fault, SUPERVISOR_FAULT_EMERGENCY_STOP);
    ck_assert_int_eq(motion->phase, _i == 0 ? MOTION_IDLE : MOTION_LOADS);
    ck_assert_int_eq(motion->outcome, _i == 0 ? MOTION_INTERRUPTED : MOTION_NONE_YET);
    ck_assert_uint_eq(motion->proven[SIDE_RIGHT], _i == 0 ? 0 : 1);
    free(rig);
}
END_TEST

/* A person whose steps turn irregular: two unsteady ones in a row. */
START_TEST(irregular_steps_withdraw_the_assistance)
{
    struct rig *rig = start(0.45, 4);
    walk(rig, 20);
    controller_of(rig)->step_monitor.unsteady = STEP_MONITOR_IRREGULAR;
    run(rig, 2);
    ck_assert_int_eq(state_of(rig), SUPERVISOR_UNLOADING);
    ck_assert_int_eq(rig->loop.rig.task.output.fault, SUPERVISOR_FAULT_NONE);
    run(rig, 400);
    ck_assert_int_eq(state_of(rig), SUPERVISOR_ENGAGING); /* begins to verify again */
    free(rig);
}
END_TEST

/* Not given three times in a row, or dragging: unloaded, and nothing begins anew without a new request. */
START_TEST(pushes_that_never_come_end_the_assistance)
{
    for (int drags = 0; drags < 2; drags++) {
        struct rig *rig = start(0.45, 4);
        walk(rig, 14);
        ck_assert_int_eq(state_of(rig), SUPERVISOR_WALKING);
        struct push_watch *watch = &controller_of(rig)->springs.watch;
        ck_assert_uint_ge(
            watch->leg[SIDE_LEFT].count[PUSH_GIVEN] + watch->leg[SIDE_RIGHT].count[PUSH_GIVEN], 1);
        watch->missed_in_row = PUSH_WATCH_MISSES - 1;
        run(rig, 1);
        ck_assert_int_eq(state_of(rig), SUPERVISOR_WALKING);
        *(drags != 0 ? &watch->dragged_in_row : &watch->missed_in_row) = PUSH_WATCH_MISSES;
        run(rig, 2);
        ck_assert_int_eq(state_of(rig), SUPERVISOR_UNLOADING);
        for (int i = 0; i < 8000; i++) {
            injector_tick(&rig->injector);
            ck_assert(!supervisor_may_assist(state_of(rig)));
        }
        ck_assert_int_eq(state_of(rig), SUPERVISOR_STANDBY);
        free(rig);
    }
}
END_TEST

/* A push that was not given makes the next ones smaller, for the rest of the walk. */
START_TEST(what_was_not_given_is_prescribed_smaller)
{
    struct rig *rig = start(0.45, 4);
    walk(rig, 9);
    struct controller *controller = controller_of(rig);
    const double before = (double)controller->plan.assist_level;
    step_plan_lower_assist(&controller->plan, controller->params);
    assert_close((double)controller->plan.assist_level, 0.75 * before, 1e-6, 0.0);
    for (int i = 0; i < 30; i++) {
        step_plan_raise_assist(&controller->plan, controller->params);
    }
    assert_close((double)controller->plan.assist_level, 0.75 * before, 1e-6, 0.0);
    free(rig);
}
END_TEST

START_TEST(the_same_leg_twice_is_a_fault_on_the_bench)
{
    struct rig *rig = start(0.6, 0);
    walk(rig, 4);
    controller_of(rig)->step_monitor.same_side = true;
    run(rig, 2);
    ck_assert_int_eq(state_of(rig), SUPERVISOR_UNLOADING);
    ck_assert_int_eq(rig->loop.rig.task.output.fault, SUPERVISOR_FAULT_LEGS);
    free(rig);
}
END_TEST

/* After a stop the reset alone starts nothing, whoever walks: it takes a new request. */
START_TEST(a_reset_does_not_start_a_walk)
{
    struct rig *rig = start(0.45, (unsigned)_i);
    rig->loop.rig.stop_pressed = true;
    run(rig, 2000); /* held by the hand meanwhile */
    ck_assert_int_eq(state_of(rig), SUPERVISOR_FAULT);
    ck_assert_int_eq(rig->loop.rig.task.output.fault, SUPERVISOR_FAULT_EMERGENCY_STOP);
    rig->loop.rig.stop_pressed = false;
    run(rig, 1000);
    ck_assert_int_eq(state_of(rig), SUPERVISOR_FAULT);
    rig->loop.rig.task.node.objects.reset_requested = 1;
    run(rig, 1000);
    ck_assert_int_eq(state_of(rig), SUPERVISOR_STANDBY);
    rig->loop.rig.task.node.objects.walk_requested = 0;
    run(rig, 10);
    rig->loop.rig.task.node.objects.walk_requested = 1;
    run(rig, 10);
    ck_assert_int_eq(state_of(rig), SUPERVISOR_ENGAGING);
    free(rig);
}
END_TEST

/* Memory fails: what leaves the controller keeps its bounds. */
START_TEST(the_last_gate)
{
    struct rig *rig = start(0.6, 0);
    walk(rig, 4);
    const enum side stance = controller_of(rig)->observer.state.stance;
    struct sea_reference *sea = &controller_of(rig)->springs.sea[stance];
    const real before = controller_of(rig)->guard.last[stance].precompression_m;
    sea->position_m = sea->target_m = before + REAL(0.2);
    run(rig, 1);
    ck_assert(controller_of(rig)->guard.last[stance].precompression_m < before + REAL(0.003));
    for (int beyond = -1; beyond <= 1; beyond += 2) {
        controller_of(rig)->guard.last[stance].enable = false; /* no rise to be limited */
        sea->position_m = sea->target_m = (real)beyond * REAL(0.45);
        run(rig, 1);
        ck_assert(!controller_of(rig)->guard.last[stance].enable);
        ck_assert(controller_of(rig)->guard.last[stance].precompression_m == REAL(0.0));
    }
    sea->position_m = sea->target_m = (real)__builtin_nanf("");
    run(rig, 1);
    ck_assert(!controller_of(rig)->guard.last[stance].enable);
    ck_assert(controller_of(rig)->guard.last[stance].precompression_m == REAL(0.0));
    free(rig);
}
END_TEST

/* And r0 from step to step, also where an apex came before the last one's answer was final: that step's number
 * is skipped (1), the push-off given before it counts. */
START_TEST(the_step_of_r0_is_bounded_without_the_parameters)
{
    struct rig *rig = start(0.6, 0);
    walk(rig, 6);
    struct control_params *params = &rig->loop.rig.task.node.objects.params;
    const real limit_m = params->r0_change_max_m;
    const real before_m = controller_of(rig)->last_step.r0_m;
    const uint32_t number = controller_of(rig)->last_step.number;
    params->r0_change_max_m = REAL(0.3);
    for (unsigned i = 0; i < params->table.count; i++) {
        params->table.speed_rad_s[i] *= REAL(0.5); /* asks for much more push-off */
    }
    controller_of(rig)->plan.law.steps += (uint32_t)_i;
    for (int i = 0; i < 3000 && controller_of(rig)->last_step.number == number; i++) {
        rig->loop.rig.task.node.guard.at = 0; /* the checksum's round never ends */
        run(rig, 1);
    }
    ck_assert_uint_eq(controller_of(rig)->last_step.number, number + 1 + (uint32_t)_i);
    assert_close((double)controller_of(rig)->last_step.r0_m, (double)(before_m + limit_m), 1e-6,
                 0.0);
    free(rig);
}
END_TEST

/* The drive with an encoder that says zero is given the time to follow. */
START_TEST(unloading_lasts_its_time)
{
    struct rig *rig = start(0.6, 0);
    walk(rig, 4);
    rig->loop.rig.stop_pressed = true;
    run(rig, 2);
    ck_assert_int_eq(state_of(rig), SUPERVISOR_UNLOADING);
    int ticks = 0;
    while (state_of(rig) == SUPERVISOR_UNLOADING && ticks < 1000) {
        run(rig, 1);
        ticks++;
    }
    ck_assert_int_ge(ticks, 195);
    ck_assert_int_le(ticks, 300);
    ck_assert_int_eq(state_of(rig), SUPERVISOR_FAULT);
    run(rig, 500);
    rig->loop.rig.stop_pressed = false;
    rig->loop.rig.task.node.objects.reset_requested = 1;
    run(rig, 2); /* falls, does not stand still: stays latched */
    ck_assert_int_eq(state_of(rig), SUPERVISOR_FAULT);
    free(rig);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("controller");
    TCase *tests = tcase_create("all");
    tcase_set_timeout(tests, 120);
    tcase_add_test(tests, bad_parameters_are_refused);
    tcase_add_test(tests, the_bench_walks_and_stops_when_asked);
    tcase_add_test(tests, the_bench_does_not_load_again_by_itself);
    tcase_add_test(tests, a_person_is_engaged_step_by_step_and_let_go);
    tcase_add_test(tests, pushes_that_never_come_end_the_assistance);
    tcase_add_test(tests, what_was_not_given_is_prescribed_smaller);
    tcase_add_test(tests, an_unsteady_step_does_not_raise_the_share);
    tcase_add_loop_test(tests, a_fault_ends_a_motion_only_of_commissioning, 0, 2);
    tcase_add_test(tests, what_is_misplaced_is_a_fault_before_the_first_push);
    tcase_add_test(tests, the_wearer_pauses_and_goes_on);
    tcase_add_test(tests, irregular_steps_withdraw_the_assistance);
    tcase_add_test(tests, the_same_leg_twice_is_a_fault_on_the_bench);
    tcase_add_loop_test(tests, a_reset_does_not_start_a_walk, 0, 2);
    tcase_add_test(tests, the_last_gate);
    tcase_add_loop_test(tests, the_step_of_r0_is_bounded_without_the_parameters, 0, 2);
    tcase_add_test(tests, unloading_lasts_its_time);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
