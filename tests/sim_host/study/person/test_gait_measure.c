/* What is measured of a gait against what the person's own state says, and the comparison with people against closed
 * forms. */
#include "sim_host/study/person/gait_measure.h"
#include "sim_host/study/person/normative.h"
#include "sim_host/study/person/objective.h"
#include "tests/support/assert_close.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const struct reflex_person_loads alone;

/* Walks 20 s by steps of 0.25 ms. What is counted apart: from the third second on. */
struct counted {
    double distance_m, impulse_Ns, peak_N;
    int strikes;
};

static struct reflex_person person;

static struct counted walk(struct gait_measure *measure)
{
    struct reflex_person_params params;
    struct counted counted = {0.0, 0.0, 0.0, 0};
    double start_m = 0.0, empty_s[SIDE_COUNT] = {0.0};
    reflex_person_default(80.0, 1.0, &params);
    reflex_person_init(&person, &params);
    gait_measure_init(measure, 3.0);
    for (int ms = 1; ms <= 20000; ms++) {
        for (int i = 0; i < 4; i++) {
            reflex_person_step(&person, &alone);
        }
        gait_measure_take(measure, &person, 0.001 * ms);
        start_m = ms == 2999 ? person.body.q[MULTIBODY_X] : start_m;
        for (int side = 0; side < SIDE_COUNT; side++) {
            const double load_N = person.ground_N[side].y;
            counted.strikes += ms >= 3000 && load_N > 0.0 && empty_s[side] > 0.2;
            empty_s[side] = load_N > 0.0 ? 0.0 : empty_s[side] + 0.001;
            counted.impulse_Ns += ms >= 3000 ? 0.001 * load_N : 0.0;
            counted.peak_N = ms >= 3000 ? fmax(counted.peak_N, load_N) : 0.0;
        }
    }
    counted.distance_m = person.body.q[MULTIBODY_X] - start_m;
    return counted;
}

START_TEST(a_walk_is_measured_as_it_was)
{
    static struct gait_measure measure;
    static struct gait_summary summary;
    const struct counted counted = walk(&measure);
    gait_measure_summary(&measure, &summary);
    ck_assert(!summary.fell);
    assert_close(summary.speed_m_s, counted.distance_m / 17.001, 0.0, 1e-3);
    assert_close(summary.peak_weights, counted.peak_N / (80.0 * 9.80665), 0.0, 1e-9);
    ck_assert_int_le(abs(summary.steps + 1 - counted.strikes), 1);
    assert_close(summary.step_time_s * summary.steps, 17.0, 2.0 * summary.step_time_s, 0.0);
    /* Over a stride the ground carries the weight. */
    double load = 0.0;
    for (int i = 0; i + 1 < GAIT_POINTS; i++) {
        load +=
            (summary.curve[0][CURVE_LOAD][i] + summary.curve[1][CURVE_LOAD][i]) / (GAIT_POINTS - 1);
    }
    assert_close(load, 1.0, 0.02, 0.0);
    for (int side = 0; side < SIDE_COUNT; side++) {
        ck_assert(summary.has_curve[side]);
        ck_assert(summary.curve[side][CURVE_LOAD][10] > 0.5);                 /* stance */
        ck_assert(summary.curve[side][CURVE_LOAD][42] == 0.0);                /* swing */
        ck_assert(summary.curve[side][CURVE_MOMENT + JOINT_ANKLE][22] > 0.5); /* the calf pushes */
        ck_assert(summary.curve[side][CURVE_ANGLE + JOINT_KNEE][36] > 30.0);  /* it bends */
        ck_assert(summary.curve[side][CURVE_ANGLE + JOINT_HIP][0] > 10.0);    /* the leg ahead */
        ck_assert(summary.curve[side][CURVE_ANGLE + JOINT_HIP][25] < 0.0);    /* the leg behind */
    }
}
END_TEST

START_TEST(a_curve_is_compared_by_shape_and_size)
{
    for (int c = 0; c < NORMATIVE_CURVES; c++) {
        const struct normative_curve *norm = &normative_curves[c];
        struct normative_match match;
        double curve[GAIT_POINTS] = {0.0}, other[GAIT_POINTS] = {0.0};
        for (int i = 0; i < NORMATIVE_POINTS; i++) {
            curve[2 * i] = norm->mean[i];
            other[2 * i] = 3.0 - 2.0 * norm->mean[i];
        }
        normative_compare(norm, curve, &match);
        assert_close(match.r, 1.0, 1e-12, 0.0);
        assert_close(match.rms, 0.0, 1e-12, 0.0);
        normative_compare(norm, other, &match);
        assert_close(match.r, -1.0, 1e-12, 0.0);
        for (int i = 0; i < NORMATIVE_POINTS; i++) {
            other[2 * i] = norm->mean[i] + 0.5;
        }
        normative_compare(norm, other, &match);
        assert_close(match.r, 1.0, 1e-12, 0.0);
        assert_close(match.rms, 0.5, 1e-12, 0.0);
        assert_close(match.offset, 0.5, 1e-12, 0.0);
    }
}
END_TEST

/* Inside its bands a walk costs its effort alone; outside, by the square; and any fall more than any walk. */
START_TEST(the_objective_is_what_it_says)
{
    static struct gait_summary good;
    memset(&good, 0, sizeof good);
    good.has_curve[0] = good.has_curve[1] = true;
    good.walked_s = 15.0;
    good.speed_m_s = 1.25;
    good.step_time_s = 0.58;
    good.peak_weights = 1.2;
    for (int side = 0; side < SIDE_COUNT; side++) {
        for (int i = 0; i < GAIT_POINTS; i++) {
            good.curve[side][CURVE_ANGLE + JOINT_HIP][i] = i < 30 ? -10.0 : 30.0;
            good.curve[side][CURVE_ANGLE + JOINT_KNEE][i] = i == 36 ? 60.0 : i == 7 ? 15.0 : 5.0;
            good.curve[side][CURVE_ANGLE + JOINT_ANKLE][i] = i == 31 ? -20.0 : i == 20 ? 10.0 : 0.0;
        }
    }
    assert_close(objective_of(&good, 15.0), 0.0, 1e-12, 0.0);
    struct gait_summary other = good;
    other.speed_m_s = 1.28 + 0.06; /* two units beyond, weight 2 */
    assert_close(objective_of(&other, 15.0), 8.0 / 1.08, 1e-9, 0.0);
    other = good;
    other.curve[SIDE_LEFT][CURVE_ANGLE + JOINT_KNEE][36] =
        45.0; /* one leg, two units, weight 0.5 */
    assert_close(objective_of(&other, 15.0), 1.0 / 1.01, 1e-9, 0.0);
    other.speed_m_s = 0.0;
    const double standing = objective_of(&other, 15.0);
    ck_assert(standing > 90.0 && standing < OBJECTIVE_FALL);
    other.speed_m_s = 0.1; /* better, however bad */
    ck_assert(objective_of(&other, 15.0) < standing);
    other = good;
    other.fell = true;
    assert_close(objective_of(&other, 30.0), 150.0, 1e-9, 0.0);
    other.walked_s = 3.0;
    assert_close(objective_of(&other, 30.0), 190.0, 1e-9, 0.0);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("gait_measure");
    TCase *tests = tcase_create("all");
    tcase_set_timeout(tests, 120);
    tcase_add_test(tests, a_walk_is_measured_as_it_was);
    tcase_add_test(tests, a_curve_is_compared_by_shape_and_size);
    tcase_add_test(tests, the_objective_is_what_it_says);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
