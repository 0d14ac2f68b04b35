/* The seven segments against Lagrange's equations (SymPy 1.11, from the kinetic and potential energy of the same
 * segments), and against what holds of every body: its centre of mass falls as a stone, its energy stays. */
#include "sim_host/reflex/multibody.h"
#include "tests/support/assert_close.h"

#include <math.h>

static const struct segments segments = {
    .trunk = {50.0, 0.0, {0.01, 0.33}, 2.5},
    .part = {{8.0, 0.42, {0.01, -0.19}, 0.12},
             {3.4, 0.44, {-0.005, -0.18}, 0.05},
             {1.2, 0.0, {0.05, -0.03}, 0.006}},
    .heel_m = {-0.05, -0.07},
    .ball_m = {0.14, -0.07},
    .gravity_m_s2 = 9.80665,
};
static const struct multibody_state moving = {{0.3, 0.9, -0.12, 0.4, -0.2, 0.15, -0.3, -0.7, -0.5},
                                              {1.2, -0.3, 0.6, 2.5, -3.5, 1.8, -1.1, -2.0, -4.0}};

static void accelerate(const struct multibody_state *state, const double force[MULTIBODY_DOF],
                       double acceleration[MULTIBODY_DOF])
{
    struct multibody_pose pose;
    multibody_pose(&segments, state, &pose);
    multibody_accelerations(&segments, state, &pose, force, acceleration);
}

START_TEST(accelerations_are_those_of_lagrange)
{
    static const double force[MULTIBODY_DOF] = {12.0, -35.0, 8.0, -6.0, 4.0, 1.5, 9.0, -3.0, -2.5};
    static const double expected[MULTIBODY_DOF] = {
        1.2428588103735687,  -10.327860919786518, 3.7199442913646026,
        -22.511832273234692, 31.52156799829299,   127.73250522007768,
        14.305082202649325,  -18.292010451619582, -277.2291099567003};
    double found[MULTIBODY_DOF];
    accelerate(&moving, force, found);
    for (int i = 0; i < MULTIBODY_DOF; i++) {
        assert_close(found[i], expected[i], 1e-12, 1e-12);
    }
    assert_close(multibody_energy_J(&segments, &moving), 788.4908439637817, 0.0, 1e-14);
}
END_TEST

/* Kutta's fourth-order step. */
static void advance(struct multibody_state *state, const double force[MULTIBODY_DOF], double step_s)
{
    static const double at[4] = {0.0, 0.5, 0.5, 1.0}, weight[4] = {1.0, 2.0, 2.0, 1.0};
    const struct multibody_state start = *state;
    struct multibody_state slope = {{0}, {0}};
    for (int stage = 0; stage < 4; stage++) {
        struct multibody_state here;
        for (int i = 0; i < MULTIBODY_DOF; i++) {
            here.q[i] = start.q[i] + at[stage] * step_s * slope.q[i];
            here.dq[i] = start.dq[i] + at[stage] * step_s * slope.dq[i];
        }
        accelerate(&here, force, slope.dq);
        for (int i = 0; i < MULTIBODY_DOF; i++) {
            slope.q[i] = here.dq[i];
            state->q[i] += step_s * weight[stage] / 6.0 * slope.q[i];
            state->dq[i] += step_s * weight[stage] / 6.0 * slope.dq[i];
        }
    }
}

START_TEST(a_fall_keeps_the_energy_and_follows_the_parabola)
{
    static const double none[MULTIBODY_DOF] = {0.0};
    struct multibody_state state = moving;
    struct vector2 start, speed, at, later;
    multibody_centre(&segments, &state, &start, &speed);
    const double energy_J = multibody_energy_J(&segments, &state);
    const double time_s = 1.0;
    for (int i = 0; i < 4000; i++) {
        advance(&state, none, time_s / 4000.0);
    }
    multibody_centre(&segments, &state, &at, &later);
    assert_close(multibody_energy_J(&segments, &state), energy_J, 0.0, 1e-9);
    assert_close(at.x, start.x + speed.x * time_s, 1e-9, 0.0);
    assert_close(at.y, start.y + speed.y * time_s - 0.5 * 9.80665 * time_s * time_s, 1e-9, 0.0);
    assert_close(later.x, speed.x, 1e-9, 0.0);
}
END_TEST

/* A force at the ball of a foot: the whole gains its momentum, and its work is the energy's change. */
START_TEST(a_force_at_a_foot_moves_the_whole_body)
{
    const struct vector2 push = {30.0, 700.0};
    struct multibody_pose pose;
    double force[MULTIBODY_DOF] = {0.0}, acceleration[MULTIBODY_DOF];
    multibody_pose(&segments, &moving, &pose);
    multibody_add_force(&pose, SIDE_RIGHT, segments.ball_m, push, force);
    accelerate(&moving, force, acceleration);
    const double step_s = 1e-6, mass_kg = 50.0 + 2.0 * (8.0 + 3.4 + 1.2);
    struct multibody_state later = moving;
    for (int i = 0; i < MULTIBODY_DOF; i++) {
        later.q[i] += step_s * moving.dq[i];
        later.dq[i] += step_s * acceleration[i];
    }
    struct vector2 at, before, after, foot, foot_speed;
    multibody_centre(&segments, &moving, &at, &before);
    multibody_centre(&segments, &later, &at, &after);
    assert_close((after.x - before.x) / step_s, push.x / mass_kg, 1e-3, 0.0);
    assert_close((after.y - before.y) / step_s, push.y / mass_kg - 9.80665, 1e-3, 0.0);
    multibody_foot_point(&moving, &pose, SIDE_RIGHT, segments.ball_m, &foot, &foot_speed);
    const double power_W = push.x * foot_speed.x + push.y * foot_speed.y;
    const double change_J =
        multibody_energy_J(&segments, &later) - multibody_energy_J(&segments, &moving);
    assert_close(change_J / step_s, power_W, 0.5, 0.0);
}
END_TEST

/* To rounding, close by and far away. */
START_TEST(a_pose_close_by_is_the_pose)
{
    struct multibody_pose at, near, exact;
    multibody_pose(&segments, &moving, &at);
    for (double step = 1e-9; step < 3.0; step *= 1.5) {
        struct multibody_state state = moving;
        for (int i = MULTIBODY_TRUNK; i < MULTIBODY_DOF; i++) {
            state.q[i] += i % 2 == 0 ? step : -step;
        }
        multibody_pose_near(&segments, &state, &moving, &at, &near);
        multibody_pose(&segments, &state, &exact);
        for (int i = MULTIBODY_TRUNK; i < MULTIBODY_DOF; i++) {
            assert_close(near.sine[i], sin(state.q[i]), 4e-16, 0.0);
            assert_close(near.cosine[i], cos(state.q[i]), 4e-16, 0.0);
            ck_assert(step < 0.02 || near.sine[i] == exact.sine[i]);
        }
    }
}
END_TEST

START_TEST(the_feet_are_where_geometry_puts_them)
{
    struct multibody_state state = {{0}, {0}};
    struct multibody_pose pose;
    struct vector2 at, speed;
    state.q[MULTIBODY_Y] = 1.0;
    state.dq[MULTIBODY_LEFT + PART_THIGH] = 1.0; /* the straight leg's thigh alone swings forward */
    multibody_pose(&segments, &state, &pose);
    multibody_foot_point(&state, &pose, SIDE_LEFT, segments.heel_m, &at, &speed);
    assert_close(at.x, -0.05, 1e-15, 0.0);
    assert_close(at.y, 1.0 - 0.86 - 0.07, 1e-15, 0.0);
    assert_close(speed.x, 0.42, 1e-15, 0.0);
    assert_close(speed.y, 0.0, 1e-15, 0.0);
    state.q[MULTIBODY_RIGHT + PART_THIGH] = asin(0.6); /* forward, the shank down */
    multibody_pose(&segments, &state, &pose);
    multibody_foot_point(&state, &pose, SIDE_RIGHT, segments.ball_m, &at, &speed);
    assert_close(at.x, 0.42 * 0.6 + 0.14, 1e-12, 0.0);
    assert_close(at.y, 1.0 - 0.42 * 0.8 - 0.44 - 0.07, 1e-12, 0.0);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("multibody");
    TCase *tests = tcase_create("all");
    tcase_add_test(tests, accelerations_are_those_of_lagrange);
    tcase_add_test(tests, a_fall_keeps_the_energy_and_follows_the_parabola);
    tcase_add_test(tests, a_force_at_a_foot_moves_the_whole_body);
    tcase_add_test(tests, a_pose_close_by_is_the_pose);
    tcase_add_test(tests, the_feet_are_where_geometry_puts_them);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
