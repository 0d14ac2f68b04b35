/* Muscle and tendon against closed forms, and the exponential against the C library's. */
#include "sim_host/reflex/exponential.h"
#include "sim_host/reflex/muscle.h"
#include "sim_host/reflex/muscles.h"
#include "tests/support/assert_close.h"

#include <math.h>

static const struct muscle soleus = {4000.0, 6.0, 0.04, 0.26};

START_TEST(the_exponential_is_the_librarys)
{
    for (int i = 0; i <= 3000; i++) {
        const double x = -7.3e-3 * i * (i % 7 == 0 ? 30.0 : 1.0);
        assert_close(exponential(x), exp(x), 0.0, 4e-16);
    }
    ck_assert(exponential(0.0) == 1.0 && exponential(3.0) == 1.0);
    ck_assert(exponential(-1e9) == 0.0);
    assert_close(exponential(-699.0), exp(-699.0), 0.0, 4e-16);
}
END_TEST

START_TEST(force_of_length_and_speed_have_their_marks)
{
    assert_close(muscle_force_of_length(&soleus, 0.04), 1.0, 0.0, 1e-15);
    assert_close(muscle_force_of_length(&soleus, 0.04 * 1.56), 0.05, 0.0, 1e-12);
    assert_close(muscle_force_of_length(&soleus, 0.04 * 0.44), 0.05, 0.0, 1e-12);
    assert_close(muscle_force_of_length(&soleus, 0.04 * 1.28), exp(log(0.05) / 8.0), 0.0, 1e-12);
    assert_close(muscle_force_of_speed(&soleus, 0.0), 1.0, 0.0, 1e-15);
    assert_close(muscle_force_of_speed(&soleus, -0.24), 0.0, 1e-12, 0.0);
    assert_close(muscle_force_of_speed(&soleus, -0.12), 1.0 / 7.0, 0.0,
                 1e-12); /* half: (1 - 1/2) / (1 + 5/2) */
    ck_assert(muscle_force_of_speed(&soleus, -1.0) == 0.0);
    assert_close(muscle_force_of_speed(&soleus, 1e9), 1.5 + 0.5 / 37.8, 0.0, 1e-6);
    for (double speed = -0.23; speed < 0.2; speed += 0.01) { /* the inverse, up to 1.45 */
        const double fraction = muscle_force_of_speed(&soleus, speed);
        if (fraction < 1.45) {
            assert_close(muscle_speed_of_force(&soleus, fraction), speed, 1e-12, 1e-9);
        }
    }
    assert_close(muscle_tendon_force_N(&soleus, 0.26 * 1.04), 4000.0, 0.0, 1e-12);
    assert_close(muscle_tendon_force_N(&soleus, 0.26 * 1.02), 1000.0, 0.0, 1e-12);
    ck_assert(muscle_tendon_force_N(&soleus, 0.26) == 0.0);
}
END_TEST

/* Held at one length, fully on: in the end the element stands still, and its force is the tendon's. */
START_TEST(an_isometric_contraction_ends_in_balance)
{
    struct muscle_state state;
    const double total_m = 0.04 + 0.26 * 1.02;
    muscle_settle(&soleus, total_m, 0.01, &state);
    for (int i = 0; i < 8000; i++) {
        (void)muscle_step(&soleus, total_m, 1.0, 0.00025, &state);
    }
    assert_close(state.activation, 1.0, 1e-12, 0.0);
    assert_close(state.speed_m_s, 0.0, 1e-8, 0.0);
    const double stretch = (total_m - state.length_m - 0.26) / (0.26 * 0.04);
    const double off = fabs(state.length_m - 0.04) / (0.04 * 0.56);
    assert_close(4000.0 * stretch * stretch, 4000.0 * exp(log(0.05) * off * off * off), 0.0, 1e-6);
    assert_close(state.force_N, 4000.0 * stretch * stretch, 0.0, 1e-6);
    ck_assert(state.length_m < 0.04); /* it took up the tendon's stretch */
}
END_TEST

/* Activation follows by 10 ms: 63 % after that time. */
START_TEST(activation_is_late)
{
    struct muscle_state state;
    muscle_settle(&soleus, 0.30, 0.01, &state);
    for (int i = 0; i < 10000; i++) {
        (void)muscle_step(&soleus, 0.30, 1.0, 1e-6, &state);
    }
    assert_close(state.activation, 1.0 - 0.99 * exp(-1.0), 1e-4, 0.0);
}
END_TEST

static double total_m(const struct muscle *muscle, int id, const struct joint_angles *joints)
{
    struct muscle_passes passes;
    muscles_pass(joints, &passes);
    return muscles_total_m(muscle, (enum muscle_id)id, 1.0, &passes);
}

/* At the reference angles of Table II of Geyer & Herr (2010) a muscle and its tendon have their optimal and slack lengths,
 * to the last bit. */
START_TEST(lengths_are_at_rest_at_the_reference)
{
#define RAD(degrees) ((degrees)*3.14159265358979323846 / 180.0)
    static const struct joint_angles reference[MUSCLE_COUNT] = {
        [MUSCLE_SOL] = {{1.0, 1.0, RAD(80.0)}, {0.0}},
        [MUSCLE_TA] = {{1.0, 1.0, RAD(110.0)}, {0.0}},
        [MUSCLE_GAS] = {{1.0, RAD(165.0), RAD(80.0)}, {0.0}},
        [MUSCLE_VAS] = {{1.0, RAD(125.0), 1.0}, {0.0}},
        [MUSCLE_HAM] = {{RAD(155.0), RAD(180.0), 1.0}, {0.0}},
        [MUSCLE_GLU] = {{RAD(150.0), 1.0, 1.0}, {0.0}},
        [MUSCLE_HFL] = {{RAD(180.0), 1.0, 1.0}, {0.0}}};
#undef RAD
    struct muscle muscle[MUSCLE_COUNT];
    muscles_default(80.0, 1.0, muscle);
    for (int id = 0; id < MUSCLE_COUNT; id++) {
        ck_assert(total_m(muscle, id, &reference[id]) == muscle[id].optimal_m + muscle[id].slack_m);
    }
}
END_TEST

/* What a muscle does at a joint: its arm is the change of its length there, but for pennation. */
START_TEST(arms_are_the_slopes_of_lengths)
{
    static const double pennation[MUSCLE_COUNT] = {0.5, 0.7, 0.7, 0.7, 0.7, 0.5, 0.5};
    struct muscle muscle[MUSCLE_COUNT];
    muscles_default(80.0, 1.0, muscle);
    for (int id = 0; id < MUSCLE_COUNT; id++) {
        for (int joint = 0; joint < JOINT_COUNT; joint++) {
            struct joint_angles at = {{2.6, 2.5, 1.7}, {0.0}}, less = at, more = at;
            double torque_Nm[JOINT_COUNT] = {0.0};
            less.angle_rad[joint] -= 1e-6;
            more.angle_rad[joint] += 1e-6;
            struct muscle_passes here;
            muscles_pass(&at, &here);
            const double slope_m = (total_m(muscle, id, &more) - total_m(muscle, id, &less)) / 2e-6;
            muscles_add_torque((enum muscle_id)id, 1.0, &here, 1000.0, torque_Nm);
            assert_close(torque_Nm[joint] * pennation[id], -1000.0 * slope_m, 1e-4, 1e-6);
        }
    }
}
END_TEST

START_TEST(joints_end_softly)
{
    struct joint_angles knee = {{2.6, 178.0 * 3.14159265358979 / 180.0, 1.7}, {0.0}};
    double torque_Nm[JOINT_COUNT] = {0.0};
    muscles_add_joint_ends(&knee, 80.0, torque_Nm);
    assert_close(torque_Nm[JOINT_KNEE], -0.9, 1e-9,
                 0.0); /* 3 degrees too far, 0.3 N m a degree: flexes */
    ck_assert(torque_Nm[JOINT_HIP] == 0.0 && torque_Nm[JOINT_ANKLE] == 0.0);
    knee.rate_rad_s[JOINT_KNEE] = -1.0; /* on its way back: nothing holds it */
    torque_Nm[JOINT_KNEE] = 0.0;
    muscles_add_joint_ends(&knee, 80.0, torque_Nm);
    ck_assert(torque_Nm[JOINT_KNEE] == 0.0);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("muscle");
    TCase *tests = tcase_create("all");
    tcase_add_test(tests, the_exponential_is_the_librarys);
    tcase_add_test(tests, force_of_length_and_speed_have_their_marks);
    tcase_add_test(tests, an_isometric_contraction_ends_in_balance);
    tcase_add_test(tests, activation_is_late);
    tcase_add_test(tests, lengths_are_at_rest_at_the_reference);
    tcase_add_test(tests, arms_are_the_slopes_of_lengths);
    tcase_add_test(tests, joints_end_softly);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
