/* A motor's encoder jumps, at any time of a stride: in a simulated walk, on the bench and on a person. The drive
 * leads its reading back to the target at once, and its motor away from it; so the jump shows for some ticks only. */
#include "tests/support/injected_walk.h"

static struct loop loop;
static struct injector injector;

/* Ticks from the jump, so many ticks after the walk's 14th step, until the controller has a fault; 200 at most. */
static int ticks_to_notice(bool person, int at, double jump_m)
{
    const struct fault_shot shot = {
        .kind = FAULT_ENCODER_OFFSET, .duration_ticks = TICKS_OF_MS(3000), .magnitude = jump_m};
    int ticks = 0;
    injected_walk_prepare(&loop, NULL, person ? 4 : 0);
    injected_walk_begin(&injector, &loop, 14);
    for (int i = 0; i < at; i++) {
        injector_tick(&injector);
    }
    ck_assert_int_eq(loop.rig.task.output.state, SUPERVISOR_WALKING);
    injector_begin(&injector, &loop, &shot, 1);
    while (loop.rig.task.output.fault == SUPERVISOR_FAULT_NONE && ticks < TICKS_OF_MS(200)) {
        injector_tick(&injector);
        ticks++;
    }
    loop_free(&loop);
    return ticks;
}

/* The limit is two speeds of 1.5 m/s in a tick and 2 mm; 10 ms of wrong readings are a fault. */
START_TEST(a_jump_is_noticed_at_once_at_any_time_of_a_stride)
{
    static const double jumps_m[] = {-0.03, -0.014, -0.01, -0.008, 0.008, 0.012, 0.03};
    const int most = TICKS_OF_MS(20);
    const double jump_m = jumps_m[_i / 2] * TICK_PERIOD_US / 1000.0;
    for (int at = 0; at < TICKS_OF_MS(1600); at += TICKS_OF_MS(160)) {
        const int ticks = ticks_to_notice(_i % 2 != 0, at, jump_m);
        ck_assert_msg(ticks <= most, "%.3f m, %d ticks on: after %d ticks", jump_m, at, ticks);
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("encoder_jump");
    TCase *tests = tcase_create("simulated walk");
    tcase_set_timeout(tests, 120);
    tcase_add_loop_test(tests, a_jump_is_noticed_at_once_at_any_time_of_a_stride, 0, 14);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
