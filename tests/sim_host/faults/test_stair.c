/* A stair is one stair, however long the fault lasts, and the ground behind it stays as high. */
#include "tests/support/assert_close.h"
#include "tests/support/injected_walk.h"

static struct loop loop;
static struct injector injector;

START_TEST(a_stair_that_is_held_is_one_and_stays)
{
    const double rise_m = _i == 0 ? 0.0003 : -0.0003;
    const struct fault_shot shot = {
        .kind = FAULT_STAIRS, .duration_ticks = TICKS_OF_MS(3000), .magnitude = rise_m};
    const struct walk *walk = &loop.nodes.plant.walk;
    injected_walk_prepare(&loop, NULL, 0);
    injected_walk_begin(&injector, &loop, 6);
    const uint64_t before = plant_steps(&loop.nodes.plant);
    injector_begin(&injector, &loop, &shot, 1);
    while (injector.tick < TICKS_OF_MS(10000)) {
        injector_tick(&injector);
        const uint64_t steps = plant_steps(&loop.nodes.plant) - before;
        ck_assert_int_eq(plant_fault(&loop.nodes.plant), WALK_FAULT_NONE);
        if (steps > 1) {
            assert_close(walk->foot_m[1], rise_m, 1e-12, 0.0);
        }
    }
    ck_assert_uint_ge(plant_steps(&loop.nodes.plant) - before, 8);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("stair");
    TCase *tests = tcase_create("all");
    tcase_set_timeout(tests, 60);
    tcase_add_loop_test(tests, a_stair_that_is_held_is_one_and_stays, 0, 2);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
