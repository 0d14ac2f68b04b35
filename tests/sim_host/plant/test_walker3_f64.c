/* The 3-DOF mechanics against what does not come from its equations: positions of the three masses and
 * differences of their energies (Lagrange), momentum balances, statics, closed forms. */
#include <math.h>

#include "sim_host/plant/walker3.h"
#include "tests/support/assert_close.h"

static const struct walker3_params BODY = {
    .hip_mass_kg = 1.0, .leg_mass_kg = 0.3, .leg_length_m = 0.9, .gravity_m_s2 = 9.80665};

static const struct walker3_state SOME = {.q = {0.21, -0.37, 0.06}, .dq = {-0.8, 1.3, 0.4}};

/* Height and horizontal place of hip, stance mass, swing mass, straight from the drawing. */
static void masses_at(const double q[3], double x[3], double y[3], double m[3])
{
    const double l = BODY.leg_length_m;
    x[0] = (l + q[2]) * sin(q[0]);
    y[0] = (l + q[2]) * cos(q[0]);
    x[1] = (l / 2 + q[2]) * sin(q[0]);
    y[1] = (l / 2 + q[2]) * cos(q[0]);
    x[2] = x[0] - l / 2 * sin(q[1]);
    y[2] = y[0] - l / 2 * cos(q[1]);
    m[0] = BODY.hip_mass_kg;
    m[1] = m[2] = BODY.leg_mass_kg;
}

static double difference_kinetic(const double q[3], const double dq[3])
{
    const double h = 1e-5;
    double forward[3], back[3], xf[3], yf[3], xb[3], yb[3], m[3], energy = 0.0;
    for (int i = 0; i < 3; i++) {
        forward[i] = q[i] + h * dq[i];
        back[i] = q[i] - h * dq[i];
    }
    masses_at(forward, xf, yf, m);
    masses_at(back, xb, yb, m);
    for (int i = 0; i < 3; i++) {
        const double vx = (xf[i] - xb[i]) / (2 * h), vy = (yf[i] - yb[i]) / (2 * h);
        energy += 0.5 * m[i] * (vx * vx + vy * vy);
    }
    return energy;
}

static double height_energy(const double q[3])
{
    double x[3], y[3], m[3], energy = 0.0;
    masses_at(q, x, y, m);
    for (int i = 0; i < 3; i++) {
        energy += m[i] * BODY.gravity_m_s2 * y[i];
    }
    return energy;
}

START_TEST(energies_are_those_of_three_points)
{
    assert_close(walker3_kinetic_J(&BODY, &SOME), difference_kinetic(SOME.q, SOME.dq), 0.0, 1e-8);
    assert_close(walker3_potential_J(&BODY, &SOME), height_energy(SOME.q), 0.0, 1e-14);
}
END_TEST

/* Momenta dL/dq' of the drawing, by differences of the kinetic energy. */
static double momentum_of(int i, const double q[3], const double dq[3])
{
    double up[3], down[3];
    for (int k = 0; k < 3; k++) {
        up[k] = dq[k] + (k == i ? 0.5 : 0.0);
        down[k] = dq[k] - (k == i ? 0.5 : 0.0);
    }
    /* The kinetic energy is quadratic in dq: a central difference is exact. */
    return difference_kinetic(q, up) - difference_kinetic(q, down);
}

/* d/dt dL/dq' - dL/dq along a motion with the given accelerations. */
static double euler_lagrange(int i, const struct walker3_state *s, const double ddq[3])
{
    const double h = 1e-4;
    double qf[3], qb[3], vf[3], vb[3], up[3], down[3];
    for (int k = 0; k < 3; k++) {
        qf[k] = s->q[k] + h * s->dq[k] + 0.5 * h * h * ddq[k];
        qb[k] = s->q[k] - h * s->dq[k] + 0.5 * h * h * ddq[k];
        vf[k] = s->dq[k] + h * ddq[k];
        vb[k] = s->dq[k] - h * ddq[k];
        up[k] = s->q[k] + (k == i ? h : 0.0);
        down[k] = s->q[k] - (k == i ? h : 0.0);
    }
    const double rate = (momentum_of(i, qf, vf) - momentum_of(i, qb, vb)) / (2 * h);
    const double slope = (difference_kinetic(up, s->dq) - height_energy(up) -
                          difference_kinetic(down, s->dq) + height_energy(down)) /
                         (2 * h);
    return rate - slope;
}

START_TEST(free_motion_obeys_lagrange)
{
    const struct walker3_contact contact = {.ankle_locked = false};
    const double push_N = 7.0;
    double ddq[3];
    struct walker3_forces forces;
    walker3_accelerate(&BODY, &SOME, &contact, push_N, ddq, &forces);
    assert_close(euler_lagrange(0, &SOME, ddq), 0.0, 1e-5, 0.0);
    assert_close(euler_lagrange(1, &SOME, ddq), 0.0, 1e-5, 0.0);
    assert_close(euler_lagrange(2, &SOME, ddq), push_N, 1e-5, 0.0);
    assert_close(forces.ankle_lock_N, 0.0, 0.0, 0.0);
}
END_TEST

START_TEST(a_locked_ankle_is_held_by_its_force)
{
    const struct walker3_contact contact = {.ankle_locked = true};
    struct walker3_state state = SOME;
    struct walker3_forces forces;
    double ddq[3];
    state.dq[2] = 0.0;
    walker3_accelerate(&BODY, &state, &contact, 3.0, ddq, &forces);
    assert_close(ddq[2], 0.0, 0.0, 0.0);
    assert_close(euler_lagrange(0, &state, ddq), 0.0, 1e-5, 0.0);
    assert_close(euler_lagrange(1, &state, ddq), 0.0, 1e-5, 0.0);
    assert_close(euler_lagrange(2, &state, ddq), 3.0 + forces.ankle_lock_N, 1e-5, 0.0);
}
END_TEST

/* Total ground force = rate of the masses' momentum - gravity, by differences of positions. */
static void needed_ground_force(const struct walker3_state *s, const double ddq[3], double out[2])
{
    const double h = 1e-4;
    double qf[3], qb[3], xf[3], yf[3], xb[3], yb[3], x[3], y[3], m[3];
    for (int k = 0; k < 3; k++) {
        qf[k] = s->q[k] + h * s->dq[k] + 0.5 * h * h * ddq[k];
        qb[k] = s->q[k] - h * s->dq[k] + 0.5 * h * h * ddq[k];
    }
    masses_at(qf, xf, yf, m);
    masses_at(qb, xb, yb, m);
    masses_at(s->q, x, y, m);
    out[0] = out[1] = 0.0;
    for (int i = 0; i < 3; i++) {
        out[0] += m[i] * (xf[i] - 2 * x[i] + xb[i]) / (h * h);
        out[1] += m[i] * ((yf[i] - 2 * y[i] + yb[i]) / (h * h) + BODY.gravity_m_s2);
    }
}

/* Both toes on the ground: theta_n such that the toe has the wanted height, rates along the one free
 * direction. */
static struct walker3_state standing_on_both(double extension_m, double rate)
{
    const struct walker3_state contact_free = {.q = {-0.25, 0.31, extension_m},
                                               .dq = {0.0, 0.0, 0.0}};
    struct walker3_state state = contact_free;
    state.dq[0] = rate;
    state.dq[1] = 0.7 * rate;
    state.dq[2] = -rate;
    walker3_collide(&BODY, &state, 0.02, NULL); /* projects onto the pinned directions */
    return state;
}

START_TEST(double_support_pins_both_toes)
{
    const struct walker3_contact contact = {.swing_toe_pinned = true, .swing_extension_m = 0.02};
    const struct walker3_state state = standing_on_both(0.05, -0.9);
    const double push_N = 25.0;
    struct walker3_forces forces;
    double ddq[3], toe[2], ground[2], velocity[2];
    walker3_accelerate(&BODY, &state, &contact, push_N, ddq, &forces);
    walker3_toe_velocity(&BODY, &state, 0.02, velocity);
    assert_close(velocity[0], 0.0, 1e-13, 0.0);
    assert_close(velocity[1], 0.0, 1e-13, 0.0);
    /* The pinned toe stays where it is to third order of a small step. */
    const double h = 1e-3;
    struct walker3_state later = state;
    for (int k = 0; k < 3; k++) {
        later.q[k] += h * state.dq[k] + 0.5 * h * h * ddq[k];
    }
    double before[2];
    walker3_toe(&BODY, &state, 0.02, before);
    walker3_toe(&BODY, &later, 0.02, toe);
    assert_close(toe[0], before[0], 1e-8, 0.0);
    assert_close(toe[1], before[1], 1e-8, 0.0);
    needed_ground_force(&state, ddq, ground);
    assert_close(forces.stance_toe_N[0] + forces.swing_toe_N[0], ground[0], 1e-4, 0.0);
    assert_close(forces.stance_toe_N[1] + forces.swing_toe_N[1], ground[1], 1e-4, 0.0);
    /* Lagrange with the toe's force: J^T lambda by differences of the toe's place. */
    for (int i = 0; i < 3; i++) {
        struct walker3_state up = state, down = state;
        double tu[2], td[2];
        up.q[i] += 1e-5;
        down.q[i] -= 1e-5;
        walker3_toe(&BODY, &up, 0.02, tu);
        walker3_toe(&BODY, &down, 0.02, td);
        const double q =
            (forces.swing_toe_N[0] * (tu[0] - td[0]) + forces.swing_toe_N[1] * (tu[1] - td[1])) /
            2e-5;
        assert_close(euler_lagrange(i, &state, ddq), q + (i == 2 ? push_N : 0.0), 2e-5, 0.0);
    }
}
END_TEST

START_TEST(standing_still_carries_the_weight)
{
    const struct walker3_contact contact = {
        .ankle_locked = true, .swing_toe_pinned = true, .swing_extension_m = 0.0};
    const double a = 0.3;
    const struct walker3_state state = {.q = {-a, a, 0.0}, .dq = {0.0, 0.0, 0.0}};
    struct walker3_forces forces;
    double ddq[3];
    walker3_accelerate(&BODY, &state, &contact, 0.0, ddq, &forces);
    const double weight = (BODY.hip_mass_kg + 2 * BODY.leg_mass_kg) * BODY.gravity_m_s2;
    for (int i = 0; i < 3; i++) {
        assert_close(ddq[i], 0.0, 0.0, 0.0);
    }
    /* A symmetric stand: half the weight each; the joint at the hip carries no moment, so the force on a
     * foot balances that leg's own weight about the hip: F_x cos a = (F_y - m g / 2) sin a. */
    assert_close(forces.stance_toe_N[1], weight / 2, 1e-12, 0.0);
    assert_close(forces.swing_toe_N[1], weight / 2, 1e-12, 0.0);
    const double across = (weight / 2 - BODY.leg_mass_kg * BODY.gravity_m_s2 / 2) * tan(a);
    assert_close(fabs(forces.stance_toe_N[0]), across, 1e-12, 0.0);
    assert_close(forces.stance_toe_N[0], -forces.swing_toe_N[0], 1e-12, 0.0);
    /* Stance foot stands behind (+x) the hip's left: the ground pushes it forward, -x. */
    ck_assert(forces.stance_toe_N[0] < 0.0);
}
END_TEST

START_TEST(a_stance_leg_alone_is_an_inverted_pendulum)
{
    /* A swing leg of next to no mass: theta'' = g/l sin theta, by its energy integral. */
    const struct walker3_params light = {
        .hip_mass_kg = 1.0, .leg_mass_kg = 1e-6, .leg_length_m = 1.0, .gravity_m_s2 = 9.80665};
    const struct walker3_contact contact = {.ankle_locked = true};
    const struct walker3_ankle none = {.device_N_per_m = 0.0};
    struct walker3_state state = {.q = {0.2, -0.2, 0.0}, .dq = {-1.2, 0.0, 0.0}};
    for (int i = 0; i < 400; i++) {
        walker3_step(&light, &state, &contact, &none, 0.0, 1e-3, &state);
    }
    const double squared = 1.2 * 1.2 + 2 * 9.80665 * (cos(0.2) - cos(state.q[0]));
    assert_close(state.dq[0] * state.dq[0], squared, 1e-5, 0.0);
}
END_TEST

START_TEST(single_support_keeps_its_energy)
{
    const struct walker3_contact contact = {.ankle_locked = true};
    const struct walker3_ankle none = {.device_N_per_m = 0.0};
    struct walker3_state state = {.q = {0.1753, -0.3546, 0.0}, .dq = {-0.6916, -0.5683, 0.0}};
    const struct walker3_params paper = {
        .hip_mass_kg = 1.0, .leg_mass_kg = 0.01, .leg_length_m = 1.0, .gravity_m_s2 = 9.80665};
    const double before = walker3_kinetic_J(&paper, &state) + walker3_potential_J(&paper, &state);
    for (int i = 0; i < 800; i++) {
        walker3_step(&paper, &state, &contact, &none, 0.0, 1e-3, &state);
    }
    assert_close(walker3_kinetic_J(&paper, &state) + walker3_potential_J(&paper, &state), before,
                 0.0, 1e-10);
}
END_TEST

START_TEST(double_support_keeps_energy_and_toe)
{
    const struct walker3_contact contact = {.swing_toe_pinned = true, .swing_extension_m = 0.02};
    const struct walker3_ankle spring = {
        .device_smooth = true, .device_N_per_m = 300.0, .position_m = 0.2};
    struct walker3_state state = standing_on_both(0.01, -0.9);
    double toe[2], later[2];
    walker3_toe(&BODY, &state, 0.02, toe);
    const double stored = 0.5 * 300.0 * (0.2 - 0.01) * (0.2 - 0.01);
    const double before =
        stored + walker3_kinetic_J(&BODY, &state) + walker3_potential_J(&BODY, &state);
    for (int i = 0; i < 400; i++) {
        walker3_step(&BODY, &state, &contact, &spring, 0.0, 2.5e-4, &state);
    }
    walker3_toe(&BODY, &state, 0.02, later);
    const double left = 0.2 - state.q[2];
    assert_close(0.5 * 300.0 * left * left + walker3_kinetic_J(&BODY, &state) +
                     walker3_potential_J(&BODY, &state),
                 before, 0.0, 1e-10);
    assert_close(later[0], toe[0], 1e-10, 0.0);
    assert_close(later[1], toe[1], 1e-10, 0.0);
    ck_assert(state.q[2] > 0.05);
}
END_TEST

static double total_momentum_x(const struct walker3_state *s)
{
    const double h = 1e-5;
    double qf[3], qb[3], xf[3], yf[3], xb[3], yb[3], m[3], sum = 0.0;
    for (int k = 0; k < 3; k++) {
        qf[k] = s->q[k] + h * s->dq[k];
        qb[k] = s->q[k] - h * s->dq[k];
    }
    masses_at(qf, xf, yf, m);
    masses_at(qb, xb, yb, m);
    for (int i = 0; i < 3; i++) {
        sum += m[i] * (xf[i] - xb[i]) / (2 * h);
    }
    return sum;
}

START_TEST(impact_leaves_the_toe_at_rest_and_balances)
{
    struct walker3_state state = {.q = {-0.2, 0.24, 0.0}, .dq = {-1.0, -0.4, 0.0}};
    const struct walker3_state before = state;
    struct walker3_impact impact;
    double velocity[2];
    walker3_collide(&BODY, &state, 0.01, &impact);
    walker3_toe_velocity(&BODY, &state, 0.01, velocity);
    assert_close(velocity[0], 0.0, 1e-13, 0.0);
    assert_close(velocity[1], 0.0, 1e-13, 0.0);
    ck_assert(state.dq[2] > 0.0);
    ck_assert(!impact.clamped);
    assert_close(impact.stance_toe_Ns[0] + impact.swing_toe_Ns[0],
                 total_momentum_x(&state) - total_momentum_x(&before), 1e-8, 0.0);
    assert_close(impact.lost_J,
                 difference_kinetic(before.q, before.dq) - difference_kinetic(state.q, state.dq),
                 1e-8, 0.0);
    ck_assert(impact.lost_J > 0.0);
    ck_assert(impact.swing_toe_Ns[1] > 0.0);
    /* A second impact changes nothing. */
    const struct walker3_state settled = state;
    walker3_collide(&BODY, &state, 0.01, &impact);
    for (int i = 0; i < 3; i++) {
        assert_close(state.dq[i], settled.dq[i], 1e-14, 0.0);
    }
}
END_TEST

START_TEST(impact_never_drives_the_heel_down)
{
    /* Legs more than a right angle apart: the rate would be negative. */
    struct walker3_state state = {.q = {-0.85, 0.85, 0.0}, .dq = {-1.0, -0.4, 0.0}};
    struct walker3_impact impact;
    walker3_collide(&BODY, &state, 0.0, &impact);
    ck_assert(impact.clamped);
    for (int i = 0; i < 3; i++) {
        assert_close(state.dq[i], 0.0, 0.0, 0.0);
    }
    /* With the heel up it may come down. */
    struct walker3_state lifted = {.q = {-0.85, 0.85, 0.05}, .dq = {-1.0, -0.4, 0.0}};
    walker3_collide(&BODY, &lifted, 0.0, &impact);
    ck_assert(!impact.clamped);
    ck_assert(lifted.dq[2] < 0.0);
}
END_TEST

START_TEST(a_push_on_the_hip_adds_its_impulse)
{
    /* Free ankle: momentum along the leg changes by the impulse along the leg, for nothing else acts
     * there. Swing leg hanging straight down from a vertical stance leg. */
    struct walker3_state state = {.q = {0.0, 0.0, 0.0}, .dq = {0.0, 0.0, 0.0}};
    const struct walker3_contact loose = {.ankle_locked = false}, locked = {.ankle_locked = true};
    const double up[2] = {0.0, 0.5}, back[2] = {-0.5, 0.0};
    walker3_push(&BODY, &state, &loose, up);
    assert_close(state.dq[2], 0.5 / (1.0 + 2 * 0.3), 1e-14, 0.0);
    assert_close(state.dq[0], 0.0, 1e-14, 0.0);
    state.dq[2] = 0.0;
    walker3_push(&BODY, &state, &locked, up);
    assert_close(state.dq[2], 0.0, 0.0, 0.0);
    /* A push forward (-x) turns the stance leg forward: its angle falls. */
    walker3_push(&BODY, &state, &locked, back);
    ck_assert(state.dq[0] < 0.0);
    const double work = difference_kinetic(state.q, state.dq);
    /* Energy given = impulse times mean velocity of the hip. */
    assert_close(work, 0.5 * -0.5 * state.dq[0] * BODY.leg_length_m, 1e-9, 0.0);
}
END_TEST

START_TEST(the_heel_comes_down_without_turning_the_legs_momenta)
{
    const struct walker3_contact single = {.ankle_locked = false};
    struct walker3_state state = SOME;
    const double p0 = momentum_of(0, SOME.q, SOME.dq), p1 = momentum_of(1, SOME.q, SOME.dq);
    walker3_lock_ankle(&BODY, &state, &single);
    assert_close(state.dq[2], 0.0, 0.0, 0.0);
    assert_close(momentum_of(0, state.q, state.dq), p0, 1e-7, 0.0);
    assert_close(momentum_of(1, state.q, state.dq), p1, 1e-7, 0.0);
}
END_TEST

START_TEST(swapping_legs_moves_no_mass)
{
    struct walker3_state state = SOME;
    double x[3], y[3], m[3], x2[3], y2[3], toe[2];
    walker3_toe(&BODY, &state, 0.02, toe);
    masses_at(state.q, x, y, m);
    walker3_swap_legs(&state, 0.02);
    masses_at(state.q, x2, y2, m);
    assert_close(x2[0] + toe[0], x[0], 1e-15, 0.0);
    assert_close(y2[0] + toe[1], y[0], 1e-15, 0.0);
    assert_close(x2[1] + toe[0], x[2], 1e-15, 0.0); /* the masses change names */
    assert_close(x2[2] + toe[0], x[1], 1e-15, 0.0);
    assert_close(y2[2] + toe[1], y[1], 1e-15, 0.0);
}
END_TEST

START_TEST(bad_parameters_are_named)
{
    struct walker3_params p = BODY;
    ck_assert_int_eq(walker3_params_check(&p), WALKER3_PARAMS_OK);
    p.hip_mass_kg = 0.0;
    ck_assert_int_eq(walker3_params_check(&p), WALKER3_BAD_HIP_MASS);
    p = BODY;
    p.leg_mass_kg = (double)NAN;
    ck_assert_int_eq(walker3_params_check(&p), WALKER3_BAD_LEG_MASS);
    p = BODY;
    p.leg_length_m = (double)INFINITY;
    ck_assert_int_eq(walker3_params_check(&p), WALKER3_BAD_LEG_LENGTH);
    p = BODY;
    p.gravity_m_s2 = -9.8;
    ck_assert_int_eq(walker3_params_check(&p), WALKER3_BAD_GRAVITY);
}
END_TEST

START_TEST(ankle_springs_do_not_pull)
{
    struct walker3_ankle ankle = {.device_N_per_m = 100.0,
                                  .position_m = 0.05,
                                  .speed_m_s = 1.0,
                                  .acceleration_m_s2 = 2.0,
                                  .own_N_per_m = 10.0,
                                  .own_rest_m = 0.02};
    assert_close(walker3_ankle_force_N(&ankle, 0.0, 0.01), 4.0 + 0.1, 1e-12, 0.0);
    assert_close(walker3_ankle_force_N(&ankle, 0.1, 0.05), 100.0 * (0.1 + 0.01), 1e-12, 0.0);
    assert_close(walker3_ankle_force_N(&ankle, 0.0, 0.07), 0.0, 0.0, 0.0);
    ankle.device_smooth = true;
    assert_close(walker3_ankle_force_N(&ankle, 0.0, 0.07), -2.0, 1e-12, 0.0);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("walker3");
    TCase *motion = tcase_create("motion"), *impulses = tcase_create("impulses");
    tcase_add_test(motion, energies_are_those_of_three_points);
    tcase_add_test(motion, free_motion_obeys_lagrange);
    tcase_add_test(motion, a_locked_ankle_is_held_by_its_force);
    tcase_add_test(motion, double_support_pins_both_toes);
    tcase_add_test(motion, standing_still_carries_the_weight);
    tcase_add_test(motion, a_stance_leg_alone_is_an_inverted_pendulum);
    tcase_add_test(motion, single_support_keeps_its_energy);
    tcase_add_test(motion, double_support_keeps_energy_and_toe);
    tcase_add_test(motion, bad_parameters_are_named);
    tcase_add_test(motion, ankle_springs_do_not_pull);
    tcase_add_test(impulses, impact_leaves_the_toe_at_rest_and_balances);
    tcase_add_test(impulses, impact_never_drives_the_heel_down);
    tcase_add_test(impulses, a_push_on_the_hip_adds_its_impulse);
    tcase_add_test(impulses, the_heel_comes_down_without_turning_the_legs_momenta);
    tcase_add_test(impulses, swapping_legs_moves_no_mass);
    suite_add_tcase(suite, motion);
    suite_add_tcase(suite, impulses);
    return run_suite(suite);
}
