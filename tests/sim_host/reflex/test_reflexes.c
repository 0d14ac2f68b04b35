/* Who is stimulated by what, and how late; from the reflexes' description by Geyer & Herr (2010). */
#include "sim_host/reflex/reflexes.h"
#include "tests/support/assert_close.h"

static struct reflex_gains gains;
static struct reflexes reflexes;

/* Both feet in the air, everything at rest; standing is a load. */
static struct reflex_moment rest(double left_load, double right_load)
{
    struct reflex_moment moment = {.lean_rad = 0.105};
    for (int side = 0; side < SIDE_COUNT; side++) {
        moment.leg[side].knee_rad = 2.8;
        for (int i = 0; i < MUSCLE_COUNT; i++) {
            moment.leg[side].length[i] = 0.5;
        }
    }
    moment.leg[SIDE_LEFT].load = left_load;
    moment.leg[SIDE_RIGHT].load = right_load;
    return moment;
}

static double stimulation_of(enum side side, enum muscle_id id)
{
    double stimulation[MUSCLE_COUNT];
    reflexes_stimulate(&reflexes, &gains, side, stimulation);
    return stimulation[id];
}

/* A force of 0.5 appears: after how many milliseconds is more asked of the muscle? */
static int delay_of(enum muscle_id from, enum muscle_id to, double load)
{
    struct reflex_moment moment = rest(load, 0.0);
    reflexes_init(&reflexes, &moment);
    const double before = stimulation_of(SIDE_LEFT, to);
    moment.leg[SIDE_LEFT].force[from] = 0.5;
    for (int ms = 0; ms < 50; ms++) {
        reflexes_sense(&reflexes, &moment);
        if (stimulation_of(SIDE_LEFT, to) > before) {
            return ms;
        }
    }
    return -1;
}

START_TEST(nerves_take_their_time)
{
    reflex_gains_published(&gains);
    ck_assert_int_eq(delay_of(MUSCLE_SOL, MUSCLE_SOL, 1.0), 20);
    ck_assert_int_eq(delay_of(MUSCLE_GAS, MUSCLE_GAS, 1.0), 20);
    ck_assert_int_eq(delay_of(MUSCLE_VAS, MUSCLE_VAS, 1.0), 10);
    ck_assert_int_eq(delay_of(MUSCLE_HAM, MUSCLE_HAM, 0.0), 5);
    ck_assert_int_eq(delay_of(MUSCLE_GLU, MUSCLE_GLU, 0.0), 5);
    ck_assert_int_eq(delay_of(MUSCLE_SOL, MUSCLE_SOL, 0.0), -1); /* swing: no such reflex */
}
END_TEST

START_TEST(stance_and_swing_ask_for_what_is_published)
{
    reflex_gains_published(&gains);
    struct reflex_moment moment = rest(1.0, 0.0);
    moment.leg[SIDE_LEFT].force[MUSCLE_SOL] = 0.5;
    moment.leg[SIDE_LEFT].length[MUSCLE_TA] = 0.91;
    moment.leg[SIDE_RIGHT].length[MUSCLE_HFL] = 1.0;
    moment.leg[SIDE_RIGHT].length[MUSCLE_HAM] = 0.87;
    moment.lean_rad = 0.205;
    reflexes_init(&reflexes, &moment);
    assert_close(stimulation_of(SIDE_LEFT, MUSCLE_SOL), 0.01 + 1.2 * 0.5, 1e-12, 0.0);
    assert_close(stimulation_of(SIDE_LEFT, MUSCLE_TA), 0.01 + 1.1 * 0.2 - 0.3 * 0.5, 1e-12, 0.0);
    assert_close(stimulation_of(SIDE_LEFT, MUSCLE_VAS), 0.09, 1e-12, 0.0);
    assert_close(stimulation_of(SIDE_LEFT, MUSCLE_HAM), 0.05 + 1.2 * 1.91 * 0.1, 1e-12, 0.0);
    assert_close(stimulation_of(SIDE_LEFT, MUSCLE_GLU), 0.05 + 0.68 * 1.2 * 1.91 * 0.1, 1e-12, 0.0);
    assert_close(stimulation_of(SIDE_LEFT, MUSCLE_HFL), 0.05, 1e-12, 0.0);
    assert_close(stimulation_of(SIDE_RIGHT, MUSCLE_HFL),
                 0.01 + 1.15 * 0.1 + 0.35 * 0.4 - 4.0 * 0.02, 1e-12, 0.0);
    assert_close(stimulation_of(SIDE_RIGHT, MUSCLE_SOL), 0.01, 1e-12, 0.0);
}
END_TEST

/* The other foot comes down: the leg behind gives way at the knee and is brought forward at the hip. */
START_TEST(the_leg_behind_is_sent_forward)
{
    reflex_gains_published(&gains);
    struct reflex_moment moment = rest(1.0, 0.0);
    moment.leg[SIDE_LEFT].force[MUSCLE_VAS] = 0.4;
    reflexes_init(&reflexes, &moment);
    assert_close(stimulation_of(SIDE_LEFT, MUSCLE_VAS), 0.09 + 1.15 * 0.4, 1e-12, 0.0);
    moment.leg[SIDE_RIGHT].load = 0.25;
    for (int ms = 0; ms < 30; ms++) {
        reflexes_sense(&reflexes, &moment);
    }
    assert_close(stimulation_of(SIDE_LEFT, MUSCLE_VAS), 0.09 + 1.15 * 0.4 - 1.2 * 0.25, 1e-12, 0.0);
    assert_close(stimulation_of(SIDE_LEFT, MUSCLE_HFL), 0.05 + 0.25, 1e-12, 0.0);
    assert_close(stimulation_of(SIDE_LEFT, MUSCLE_GLU), 0.01, 1e-12,
                 0.0); /* 0.05 - 0.25, held at rest */
    assert_close(stimulation_of(SIDE_RIGHT, MUSCLE_HFL), 0.05, 1e-12,
                 0.0); /* the one ahead: nothing of it */
}
END_TEST

/* A knee that straightens beyond 170 degrees is pushed less. */
START_TEST(a_straight_knee_is_spared)
{
    reflex_gains_published(&gains);
    struct reflex_moment moment = rest(1.0, 0.0);
    moment.leg[SIDE_LEFT].knee_rad = 3.0;
    moment.leg[SIDE_LEFT].knee_rate_rad_s = 0.1;
    reflexes_init(&reflexes, &moment);
    assert_close(stimulation_of(SIDE_LEFT, MUSCLE_VAS), 0.09 - 2.0 * (3.0 - 2.967), 1e-12, 0.0);
    moment.leg[SIDE_LEFT].knee_rate_rad_s = -0.1; /* it bends already */
    reflexes_init(&reflexes, &moment);
    assert_close(stimulation_of(SIDE_LEFT, MUSCLE_VAS), 0.09, 1e-12, 0.0);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("reflexes");
    TCase *tests = tcase_create("all");
    tcase_add_test(tests, nerves_take_their_time);
    tcase_add_test(tests, stance_and_swing_ask_for_what_is_published);
    tcase_add_test(tests, the_leg_behind_is_sent_forward);
    tcase_add_test(tests, a_straight_knee_is_spared);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
