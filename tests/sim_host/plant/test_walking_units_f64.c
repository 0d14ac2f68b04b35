/* The units of gait analysis against closed forms worked out by hand. */
#include <math.h>

#include "sim_host/plant/walking_units.h"
#include "tests/support/assert_close.h"

START_TEST(speed_cadence_and_cost_are_their_definitions)
{
    assert_close(walking_speed_m_s(0.6, 0.5), 1.2, 0.0, 1e-15);
    assert_close(walking_cadence_per_min(0.5), 120.0, 0.0, 1e-15);
    assert_close(walking_cost_of_transport(10.0, 50.0, 10.0, 0.4), 0.05, 0.0, 1e-15);
    ck_assert(isnan(walking_speed_m_s(0.6, 0.0)) && isnan(walking_cadence_per_min(0.0)));
    ck_assert(isnan(walking_cost_of_transport(10.0, 50.0, 10.0, 0.0)));
}
END_TEST

START_TEST(symmetry_is_signed_and_in_shares_of_the_mean)
{
    assert_close(walking_symmetry_percent(0.55, 0.45), 20.0, 0.0, 1e-13);
    assert_close(walking_symmetry_percent(0.45, 0.55), -20.0, 0.0, 1e-13);
    assert_close(walking_symmetry_percent(0.5, 0.5), 0.0, 1e-15, 0.0);
    ck_assert(isnan(walking_symmetry_percent(0.0, 0.0)));
}
END_TEST

/* A pendulum of 0.9 m has sqrt(g / l) = 3.3 /s where g = 9.801. */
START_TEST(the_xcom_leads_by_the_velocity_over_the_pendulums_frequency)
{
    assert_close(walking_xcom_m(0.2, 1.32, 0.9, 9.801), 0.2 + 0.4, 0.0, 1e-14);
}
END_TEST

/* Without legs' masses the hip is the centre of mass: l sin a behind the new toe, at l cos a times the rate. */
START_TEST(the_margin_of_a_walker_whose_mass_is_its_hip)
{
    const double a = 0.3, l = 0.9, g = 9.801, rate = 2.0;
    const struct walking_pose pose = {.hip_mass_kg = 70.0,
                                      .leg_mass_kg = 0.0,
                                      .leg_length_m = l,
                                      .gravity_m_s2 = g,
                                      .stance_rad = -a,
                                      .swing_rad = a,
                                      .stance_rad_s = -rate,
                                      .swing_rad_s = 0.7};
    assert_close(walking_margin_m(&pose), l * sin(a) - l * cos(a) * rate / 3.3, 1e-14, 0.0);
}
END_TEST

/* Legs spread alike, both at rest: the centre of mass is in the middle, and so the margin is half a step. */
START_TEST(the_margin_at_rest_is_half_a_step)
{
    const struct walking_pose pose = {.hip_mass_kg = 60.0,
                                      .leg_mass_kg = 5.0,
                                      .leg_length_m = 1.0,
                                      .gravity_m_s2 = 9.80665,
                                      .stance_rad = -0.25,
                                      .swing_rad = 0.25};
    assert_close(walking_margin_m(&pose), sin(0.25), 1e-14, 0.0);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("walking_units");
    TCase *tcase = tcase_create("closed forms");
    tcase_add_test(tcase, speed_cadence_and_cost_are_their_definitions);
    tcase_add_test(tcase, symmetry_is_signed_and_in_shares_of_the_mean);
    tcase_add_test(tcase, the_xcom_leads_by_the_velocity_over_the_pendulums_frequency);
    tcase_add_test(tcase, the_margin_of_a_walker_whose_mass_is_its_hip);
    tcase_add_test(tcase, the_margin_at_rest_is_half_a_step);
    suite_add_tcase(suite, tcase);
    return run_suite(suite);
}
