/* The best of all laws on uneven ground: against chains whose mean first passage is known, against the tree of all
 * push-offs and rises on the map itself, and against the energy that a rise takes. */
#include "sim_host/study/map/terrain_ground.h"

#include <math.h>
#include <stdlib.h>

#include "model/stride.h"
#include "sim_host/study/map/laws_map.h"
#include "tests/support/assert_close.h"

/* ---- chains ------------------------------------------------------------------------------ */

enum { SPEEDS = 3, PUSHES = 8, RISES = 10 };
static const struct terrain_range CHAIN = {.speed = {0.0, 2.0, 1.0, SPEEDS},
                                           .angle = {0.0, 1.0, 1.0, 2},
                                           .swing = {0.0, 1.0, 1.0, 2},
                                           .legs = {0.5, 1.5, 1.0, SPEEDS},
                                           .ankle = {0.0, 1.0, 1.0, 2},
                                           .push = {0.1, 0.8, 1.0, PUSHES},
                                           .rises = RISES,
                                           .rise_most = 0.01};

/* A table made by hand: the apex' speed is the state, the strike keeps it as the angle between the legs, and
 * push-offs set the next one. falls[state] of the rises fell the walker, whatever it does. */
static struct terrain_table chain_of(const int falls[SPEEDS], int (*next)(int state, int push))
{
    struct terrain_table table = {.walker = gait_walker_of_paper(), .range = CHAIN};
    table.strike = malloc(SPEEDS * 4 * RISES * sizeof *table.strike);
    table.apex = malloc(RISES * SPEEDS * 2 * PUSHES * sizeof *table.apex);
    for (int i = 0; i < SPEEDS * 4 * RISES; i++) {
        const int state = i / RISES / 4;
        table.strike[i] = i % RISES < falls[state] ? (struct terrain_strike){-1.0f, 0.0f}
                                                   : (struct terrain_strike){(float)state, 0.0f};
    }
    for (int i = 0; i < RISES * SPEEDS * 2 * PUSHES; i++) {
        const int to = next(i / PUSHES / 2 % SPEEDS, i % PUSHES);
        table.apex[i] = (struct terrain_apex){(float)to, 0.0f, 0.0f};
    }
    return table;
}

static int stay(int state, int push)
{
    (void)push;
    return state;
}

/* Only the last push-off climbs, one state a step. */
static int climb(int state, int push)
{
    return push < PUSHES - 1 ? 0 : state < SPEEDS - 1 ? state + 1 : state;
}

static double node_value(const struct terrain_table *table, const struct terrain_goal *goal,
                         enum terrain_side side, int rounds, int state)
{
    static const double start[3] = {-1.0, 0.0, 0.0};
    struct terrain_value value;
    ck_assert_int_eq(terrain_solve(table, side, goal, start, rounds, 1, &value), 0);
    const double found = (double)value.apex[state * 4];
    terrain_value_free(&value);
    return found;
}

/* Who falls with chance q at each step takes 1/q steps on the mean, and is up after n with (1 - q)^n. */
START_TEST(a_chain_without_a_choice)
{
    const int falls[SPEEDS] = {5, 1, 2};
    struct terrain_table table = chain_of(falls, stay);
    const struct terrain_goal steps = {TERRAIN_STEPS, 0.0, 1.0},
                              chance = {TERRAIN_CHANCE, 0.0, 1.0};
    for (int state = 0; state < SPEEDS; state++) {
        const double q = falls[state] / (double)RISES;
        assert_close(node_value(&table, &steps, TERRAIN_MIDDLE, 400, state), 1.0 / q, 0.0, 2e-3);
        assert_close(node_value(&table, &chance, TERRAIN_MIDDLE, 7, state), pow(1.0 - q, 7.0), 0.0,
                     1e-5);
    }
    terrain_free(&table);
}
END_TEST

/* The way up is worth its risks: from the bottom 1 + 1/2 (1 + 4/5 V2), V2 = 10 at the top. */
START_TEST(a_chain_with_a_choice)
{
    const int falls[SPEEDS] = {5, 2, 1};
    struct terrain_table table = chain_of(falls, climb);
    const struct terrain_goal steps = {TERRAIN_STEPS, 0.0, 1.0};
    assert_close(node_value(&table, &steps, TERRAIN_MIDDLE, 400, 2), 10.0, 0.0, 2e-3);
    assert_close(node_value(&table, &steps, TERRAIN_MIDDLE, 400, 1), 1.0 + 0.8 * 10.0, 0.0, 2e-3);
    assert_close(node_value(&table, &steps, TERRAIN_MIDDLE, 400, 0), 1.0 + 0.5 * 9.0, 0.0, 2e-3);
    /* From above: a cell is worth its best corner, so the outer values are not below. */
    for (int state = 0; state < SPEEDS; state++) {
        ck_assert_double_ge(node_value(&table, &steps, TERRAIN_OUTER, 400, state),
                            node_value(&table, &steps, TERRAIN_MIDDLE, 400, state) * 0.998);
    }
    terrain_free(&table);
}
END_TEST

/* At a price of 3 on speeds above 1 the top (2 rad/s: it costs 3 a step, a step is worth 1) is shunned: the walker
 * stays at the bottom, where 0 rad/s earns 3 a step that is survived. */
START_TEST(a_price_keeps_the_speed_down)
{
    const int falls[SPEEDS] = {5, 2, 1};
    struct terrain_table table = chain_of(falls, climb);
    const struct terrain_goal goal = {TERRAIN_STEPS, 3.0, 1.0};
    const double bottom = node_value(&table, &goal, TERRAIN_MIDDLE, 400, 0);
    assert_close(bottom, 1.0 + 0.5 * (bottom + 3.0), 0.0, 5e-3);
    terrain_free(&table);
}
END_TEST

/* ---- the map ------------------------------------------------------------------------------- */

static const struct terrain_range WALK = {.speed = {0.0, 1.6, 2.0, 40},
                                          .angle = {-0.6, 0.3, 1.0, 25},
                                          .swing = {-1.0, 3.6, 1.0, 33},
                                          .legs = {0.1, 1.5, 1.0, 45},
                                          .ankle = {0.0, 0.36, 1.0, 37},
                                          .push = {0.005, 0.3, 2.0, 48},
                                          .rises = 5,
                                          .rise_most = 0.010};
static struct terrain_table walks;

/* The greatest chance to be up after `depth` steps, every push-off and rise of the grid tried on the map. */
static double tree(const double apex[3], int depth)
{
    double best = 0.0;
    for (int p = 0; p < WALK.push.count; p++) {
        const double share = p / (WALK.push.count - 1.0);
        const double r0_m = 0.005 + 0.295 * share * share;
        double sum = 0.0;
        for (int i = 0; i < WALK.rises; i++) {
            struct laws_stride stride;
            const double rise = WALK.rise_most * (2.0 * i + 1.0 - WALK.rises) / WALK.rises;
            if (laws_stride(&walks.walker, LAWS_COARSE, apex, r0_m, 0.0, rise, &stride) == 0) {
                sum += depth > 1 ? tree(stride.next, depth - 1) : 1.0;
            }
        }
        best = sum / WALK.rises > best ? sum / WALK.rises : best;
    }
    return best;
}

static double grid_chance(enum terrain_side side, const double apex[3], int steps)
{
    const struct terrain_goal goal = {TERRAIN_CHANCE, 0.0, 1.0};
    struct terrain_value value;
    double chance;
    ck_assert_int_eq(terrain_solve(&walks, side, &goal, apex, steps, 1, &value), 0);
    (void)terrain_law(&walks, &value, apex, 0.0, 1.0, &chance);
    terrain_value_free(&value);
    return chance;
}

START_TEST(grid_and_tree_agree)
{
    const struct gait_walker paper = gait_walker_of_paper();
    ck_assert_int_eq(terrain_make(&walks, &paper, &WALK, 2), 0);
    /* About the gaits of 0.3 and 0.4 rad/s, slower, faster. */
    for (int i = 0; i < 6; i++) {
        const double apex[3] = {-0.20 - 0.05 * i, -0.0595, 1.75};
        const double found = tree(apex, 2);
        assert_close(grid_chance(TERRAIN_MIDDLE, apex, 2), found, 0.12, 0.0);
        ck_assert_double_ge(grid_chance(TERRAIN_OUTER, apex, 2), found - 1e-6);
    }
    terrain_free(&walks);
}
END_TEST

/* A rise is paid for by the next apex' energy, whatever the push-off: the slower, the more of the rises fell. */
START_TEST(the_chance_grows_with_the_energy_at_the_apex)
{
    const struct gait_walker paper = gait_walker_of_paper();
    double before = 0.0;
    ck_assert_int_eq(terrain_make(&walks, &paper, &WALK, 2), 0);
    for (int i = 0; i < 5; i++) {
        const double apex[3] = {-0.25 - 0.1 * i, -0.0595 - 0.012 * i, 1.75 + 0.12 * i};
        const double chance = grid_chance(TERRAIN_MIDDLE, apex, 6);
        ck_assert_double_ge(chance, before - 0.02);
        before = chance;
    }
    ck_assert_double_gt(before, 0.5);
    terrain_free(&walks);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("terrain_ground");
    TCase *tests = tcase_create("all");
    tcase_set_timeout(tests, 240);
    tcase_add_test(tests, a_chain_without_a_choice);
    tcase_add_test(tests, a_chain_with_a_choice);
    tcase_add_test(tests, a_price_keeps_the_speed_down);
    tcase_add_test(tests, grid_and_tree_agree);
    tcase_add_test(tests, the_chance_grows_with_the_energy_at_the_apex);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
