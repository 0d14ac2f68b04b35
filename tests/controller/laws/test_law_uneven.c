/* The predictive law on uneven ground, on the map: what it does about rises, how far it comes by it beside eq. (16), and
 * that it does nothing of the kind where the ground is even. */
#include "sim_host/loop/loop.h"
#include "sim_host/study/laws/setup.h"

#include <math.h>

#include "sim_host/random/rng.h"
#include "tests/support/assert_close.h"

enum { WALKS = 20, STEPS_MOST = 500 };

static struct law_setup bench(enum law_mode law)
{
    struct law_setup made;
    struct subject subject;
    char message[SUBJECT_MESSAGE_MAX];
    subject_default(&subject);
    ck_assert_msg(law_setup_init(&made, &subject, law, message) == 0, "%s", message);
    return made;
}

static void start(const struct law_setup *on, struct laws_walk *walk, double speed_rad_s)
{
    double apex[3];
    const double r0_m = law_setup_gait(on, speed_rad_s, apex);
    laws_walk_start(on, walk, apex, r0_m, speed_rad_s);
}

/* The speed that the law steered for in its last answer. */
static double aim(const struct laws_walk *walk)
{
    return (double)walk->law.predictive.target_speed_rad_s;
}

START_TEST(on_even_ground_it_wants_what_is_asked)
{
    static const double asked[] = {0.2, 0.4, 0.6, 0.8, 1.0};
    const struct law_setup on = bench(LAW_PREDICTIVE);
    for (int from = 0; from < 5; from++) {
        for (int to = 0; to < 5; to++) {
            struct laws_walk walk;
            start(&on, &walk, asked[from]);
            for (int k = 0; k < 60; k++) {
                ck_assert_int_eq(laws_walk_step(&on, &walk, asked[to], NULL, 0.0, 0.0), 0);
                assert_close(aim(&walk), asked[to], 1e-6, 0.0);
            }
        }
    }
}
END_TEST

/* What a rise h takes from the apex is its potential energy: v^2 falls by about 2 g h / l. */
START_TEST(after_a_rise_it_wants_to_bear_another_and_comes_back)
{
    const struct law_setup on = bench(LAW_PREDICTIVE);
    const double g = on.truth.gravity_m_s2, l = on.truth.leg_length_m;
    for (int way = -1; way <= 1; way += 2) {
        struct laws_walk walk;
        start(&on, &walk, 0.6);
        ck_assert_int_eq(laws_walk_step(&on, &walk, 0.6, NULL, 0.0, way * 0.008), 0);
        ck_assert_int_eq(laws_walk_step(&on, &walk, 0.6, NULL, 0.0, 0.0), 0);
        const double wanted = aim(&walk);
        ck_assert_double_gt(0.5 * wanted * wanted * l / g, 2.0 * 0.008);
        ck_assert_double_lt(wanted, 0.81);
        for (int k = 0; k < 20; k++) {
            ck_assert_int_eq(laws_walk_step(&on, &walk, 0.6, NULL, 0.0, 0.0), 0);
        }
        assert_close(aim(&walk), 0.6, 1e-6, 0.0);
        assert_close(-walk.apex[0], 0.6, 0.01, 0.0);
    }
}
END_TEST

/* Somebody who must not get faster than asked gives the law no more. */
START_TEST(it_wants_no_more_than_it_may)
{
    static const double may[] = {0.0, 0.5, 0.7};
    for (int i = 0; i < 3; i++) {
        struct law_setup on = bench(LAW_PREDICTIVE);
        struct laws_walk walk;
        on.params.terrain_speed_rad_s = (real)may[i];
        start(&on, &walk, 0.6);
        ck_assert_int_eq(laws_walk_step(&on, &walk, 0.6, NULL, 0.0, 0.008), 0);
        ck_assert_int_eq(laws_walk_step(&on, &walk, 0.6, NULL, 0.0, 0.0), 0);
        assert_close(aim(&walk), may[i] > 0.6 ? may[i] : 0.6, 1e-6, 0.0);
    }
}
END_TEST

/* Through the whole loop: a push of 0.05 N s on level ground. With the parameters of a subject that says nothing (0)
 * the law aims at what is asked, always; where it may hurry (1) it takes the push for a rise. */
START_TEST(a_push_makes_nobody_hurry)
{
    static struct loop loop;
    struct loop_config config;
    struct subject subject;
    struct control_params params;
    char message[LOOP_MESSAGE_MAX] = "";
    double fastest = 0.0;
    subject_default(&subject);
    ck_assert_int_eq(subject_control_params(&subject, &params, message), 0);
    params.law = (real)LAW_PREDICTIVE;
    params.r0_change_max_m = params.r0_change_ceiling_m = params.r0_max_m;
    params.terrain_speed_rad_s += REAL(0.8) * (real)_i;
    ck_assert_int_eq(loop_configure(&config, &subject, &params, 0.4, SENSORS_17BIT, 1, message), 0);
    const int started = loop_init(&loop, &config, NULL, message);
    ck_assert_msg(started == 0, "%s", message);
    const struct step_law *law = &loop.rig.task.controller.plan.law;
    const struct step_record *step = &loop.rig.task.controller.last_step;
    for (int i = 0; i < 100000 && law->steps < 40; i++) {
        if (i == 20000) {
            plant_push(&loop.nodes.plant, 0.05, 0.0);
        }
        loop_tick(&loop);
        /* Whoever reads the telemetry is told. */
        fastest = fmax(fastest, (double)step->commanded_speed_rad_s);
    }
    ck_assert_uint_eq(law->steps, 40);
    if (_i == 0) {
        ck_assert_double_le(fastest, 0.400001);
    } else {
        ck_assert_double_gt(fastest, 0.6);
    }
    loop_free(&loop);
}
END_TEST

START_TEST(a_rise_of_a_millimetre_is_let_pass)
{
    const struct law_setup on = bench(LAW_PREDICTIVE);
    struct laws_walk walk;
    start(&on, &walk, 0.6);
    for (int k = 0; k < 100; k++) {
        const double rise = k % 3 == 0 ? 0.001 : -0.0005;
        ck_assert_int_eq(laws_walk_step(&on, &walk, 0.6, NULL, 0.0, rise), 0);
        assert_close(aim(&walk), 0.6, 1e-6, 0.0);
    }
}
END_TEST

/* Steps per fall. */
static double steps_to_failure(const struct law_setup *on, double speed_rad_s, double rise_most)
{
    struct rng rng;
    int steps = 0, falls = 0;
    rng_init(&rng, 9, 0);
    for (int w = 0; w < WALKS; w++) {
        struct laws_walk walk;
        int fault = 0;
        start(on, &walk, speed_rad_s);
        for (int k = 0; k < STEPS_MOST && fault == 0; k++) {
            const double rise = rise_most * (2.0 * rng_uniform(&rng) - 1.0);
            fault = laws_walk_step(on, &walk, speed_rad_s, NULL, 0.0, rise);
            steps++;
        }
        falls += fault != 0 ? 1 : 0;
    }
    return falls > 0 ? (double)steps / falls : 2.0 * steps;
}

START_TEST(at_0_6_and_0_8_it_walks_a_hundred_times_as_far_as_eq_16)
{
    const struct law_setup paper = bench(LAW_PROPORTIONAL), on = bench(LAW_PREDICTIVE);
    for (double speed = 0.6; speed < 0.9; speed += 0.2) {
        const double far = steps_to_failure(&on, speed, 0.010);
        const double near = steps_to_failure(&paper, speed, 0.010);
        ck_assert_msg(far > 100.0 * near, "%.1f rad/s: %.1f steps, eq. (16) %.1f", speed, far,
                      near);
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("law_uneven");
    TCase *tests = tcase_create("all");
    tcase_set_timeout(tests, 240);
    tcase_add_test(tests, on_even_ground_it_wants_what_is_asked);
    tcase_add_test(tests, after_a_rise_it_wants_to_bear_another_and_comes_back);
    tcase_add_test(tests, it_wants_no_more_than_it_may);
    tcase_add_loop_test(tests, a_push_makes_nobody_hurry, 0, 2);
    tcase_add_test(tests, a_rise_of_a_millimetre_is_let_pass);
    tcase_add_test(tests, at_0_6_and_0_8_it_walks_a_hundred_times_as_far_as_eq_16);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
