/* The last gate before the drives, when what stands behind it has been changed by a failing
 * memory: no command rises faster than the limits of when it engaged, none lies beyond its reach,
 * and no latch is armed before the other foot can land. In the loop with the walker. */
#include <math.h>
#include <stdlib.h>

#include "sim_host/loop/loop.h"
#include "tests/support/assert_close.h"

static struct loop *loop;
static struct control_params params;

static void setup(void)
{
    char message[LOOP_MESSAGE_MAX] = "";
    struct subject subject;
    struct loop_config config;
    loop = (struct loop *)calloc(1, sizeof *loop);
    ck_assert_ptr_nonnull(loop);
    subject_default(&subject);
    ck_assert_int_eq(subject_control_params(&subject, &params, message), 0);
    params.start_r0_m = speed_table_inverse(&params.table, 0.6f);
    ck_assert_int_eq(loop_configure(&config, &subject, &params, 0.6, SENSORS_17BIT, 1, message), 0);
    ck_assert_int_eq(loop_init(loop, &config, NULL, message), 0);
}

static void teardown(void)
{
    loop_free(loop);
    free(loop);
}

static struct controller *controller(void)
{
    return &loop->rig.task.controller;
}

static void walk(uint32_t steps)
{
    for (int i = 0; i < 20000 && controller()->plan.law.steps < steps; i++) {
        loop_tick(loop);
    }
    ck_assert_uint_ge(controller()->plan.law.steps, steps);
    ck_assert_int_eq(loop->rig.task.output.state, SUPERVISOR_WALKING);
}

/* How far the command rose in this tick, and that it is a command. */
static float rise(enum side side, float *last)
{
    loop_tick(loop);
    const float now = loop->rig.task.output.sea[side].precompression_m;
    const float risen = now - *last;
    ck_assert(isfinite(now));
    *last = now;
    return risen;
}

/* 1.25 times the reference's speed limit, over one tick. */
START_TEST(a_reference_that_jumps_is_not_followed_at_once)
{
    walk(4);
    const enum side side = controller()->last_step.side;
    const float most = 1.25f * params.sea_speed_max_m_s * 0.001f;
    float last = loop->rig.task.output.sea[side].precompression_m, risen = 0.0f;
    controller()->springs.sea[side].position_m += 0.1f;
    controller()->springs.sea[side].target_m += 0.1f;
    for (int i = 0; i < 20 && loop->rig.task.output.sea[side].enable; i++) {
        const float now = rise(side, &last);
        ck_assert_msg(now <= most * 1.001f, "rose by %g of %g", (double)now, (double)most);
        risen += now;
    }
    ck_assert(risen > 3.0f * most); /* it was asked for */
}
END_TEST

/* The largest push-off of this walk, and what counts as slack. */
static float reach_m(void)
{
    return fmaxf(params.r0_max_m, params.r0_ceiling_m) + params.sea_tolerance_m;
}

static enum side refer_to(float there_m)
{
    const enum side side = controller()->last_step.side;
    controller()->guard.last[side].precompression_m = there_m;
    controller()->springs.sea[side] =
        (struct sea_reference){.phase = SEA_TRIMMED, .position_m = there_m, .target_m = there_m};
    return side;
}

START_TEST(a_reference_out_of_reach_is_none)
{
    walk(4);
    const enum side side = refer_to((_i == 0 ? 1.02f : -1.02f) * reach_m());
    controller()->guard.last[side].enable = _i != 0;
    loop_tick(loop);
    ck_assert(!loop->rig.task.output.sea[side].enable);
    ck_assert(!loop->rig.task.output.sea[side].latch_armed);
    ck_assert(loop->rig.task.output.sea[side].precompression_m == 0.0f);
}
END_TEST

START_TEST(a_reference_that_leaves_its_reach_is_held_at_its_end)
{
    walk(4);
    const enum side side = refer_to(1.02f * reach_m());
    loop_tick(loop);
    ck_assert(loop->rig.task.output.sea[side].enable);
    ck_assert(!loop->rig.task.output.sea[side].latch_armed);
    assert_close((double)loop->rig.task.output.sea[side].precompression_m, (double)reach_m(), 1e-6,
                 0.0);
}
END_TEST

START_TEST(a_reference_within_reach_is_one)
{
    walk(4);
    const enum side side = refer_to(0.98f * reach_m());
    loop_tick(loop);
    ck_assert(loop->rig.task.output.sea[side].enable);
    assert_close((double)loop->rig.task.output.sea[side].precompression_m, 0.98 * (double)reach_m(),
                 1e-6, 0.0);
}
END_TEST

/* Armed whatever the reference says only when the other foot may land: a reference that a
 * memory fault has armed since lift-off does not push. */
START_TEST(armed_too_early_is_not_armed)
{
    walk(4);
    int armed = 0, held = 0;
    for (int i = 0; i < 4000; i++) {
        for (int side = 0; side < SIDE_COUNT; side++) {
            if (controller()->springs.sea[side].phase != SEA_UNLOADED &&
                controller()->springs.sea[side].phase != SEA_UNLOADING) {
                controller()->springs.sea[side].phase = SEA_ARMED;
            }
        }
        loop_tick(loop);
        for (int side = 0; side < SIDE_COUNT; side++) {
            const struct gait_state *gait = &controller()->observer.state;
            if (!loop->rig.task.output.sea[side].latch_armed) {
                held += controller()->springs.sea[side].phase == SEA_ARMED ? 1 : 0;
                continue;
            }
            armed++;
            ck_assert_int_eq((int)gait->stance, side);
            /* Past the vertical, as the sensor sees it: walking, a stance leg's angle falls. */
            ck_assert(loop->rig.task.sensors.reading[side].leg_angle_rad < 0.02f);
        }
    }
    ck_assert_int_gt(armed, 100);
    ck_assert_int_gt(held, 100);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("controller guard");
    TCase *tests = tcase_create("all");
    tcase_set_timeout(tests, 120);
    tcase_add_checked_fixture(tests, setup, teardown);
    tcase_add_test(tests, a_reference_that_jumps_is_not_followed_at_once);
    tcase_add_loop_test(tests, a_reference_out_of_reach_is_none, 0, 2);
    tcase_add_test(tests, a_reference_that_leaves_its_reach_is_held_at_its_end);
    tcase_add_test(tests, a_reference_within_reach_is_one);
    tcase_add_test(tests, armed_too_early_is_not_armed);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
