/* The float model against the double one: the same source, so only rounding may differ. */
#include <math.h>

#include "model/collision.h"
#include "model/double_support.h"
#include "model/stride.h"
#include "tests/model/walkers.h"

START_TEST(the_papers_gait_in_float)
{
    const struct walker walker = paper_walker();
    const struct stride_settings settings = stride_settings_fixed(&walker, 1e-3f);
    struct apex x = {-0.4069f, -0.0596f, 1.7568f};
    struct stride_result r;
    for (int i = 0; i < 60; i++) {
        ck_assert_int_eq(stride(&walker, &settings, &x, 0.05f, &r), STRIDE_OK);
        x = r.next;
    }
    assert_close(x.stance_rate_rad_s, -0.406960, 3e-5, 0.0);
    assert_close(x.swing_angle_rad, -0.059569, 3e-5, 0.0);
    assert_close(x.swing_rate_rad_s, 1.756768, 1e-4, 0.0);
    assert_close(r.apex_to_strike_s + r.double_support_s + r.lift_off_to_apex_s, 0.950081, 1e-4,
                 0.0);
    assert_close(r.step_length_m, 0.538979, 3e-5, 0.0);
}
END_TEST

START_TEST(collision_in_float)
{
    const struct walker w = heavy_legged_walker();
    const struct collision_rates in = {-1.2f, 0.4f, 0.0f};
    for (float d = -1.5f; d < -0.1f; d += 0.1f) {
        const float got = collision_ankle_rate_m_s(&w, d, in.stance_rad_s, in.swing_rad_s);
        assert_close(got, collision_apply(&w, d, 0.0f, in).ankle_m_s, 1e-6, 1e-6);
    }
    int clamped;
    ck_assert(collision_clamp_m_s(-1.0f, &clamped) == 0.0f && clamped);
}
END_TEST

START_TEST(landings_in_float_take_few_steps)
{
    /* At 1 ms the event's rounding is as large as a Newton correction: it must still end soon. */
    const struct walker w = paper_walker();
    const struct ode ode = {single_support_rates, &w, SINGLE_SUPPORT_STATES};
    const struct ode_event upright = {{1.0f, 0.0f, 0.0f, 0.0f}, 0.0f};
    for (int i = 1; i < 100; i++) {
        const float state[4] = {4e-6f * (float)i, -0.1f, -0.407f, 1.7f};
        float end[4], landed[4];
        ode_step(&ode, ODE_RK4, 1e-3f, state, end);
        const struct ode_landing landing =
            ode_land(&ode, ODE_RK4, &upright, state, 1e-3f, end, landed);
        ck_assert_int_le(landing.iterations, 3);
        assert_close(landing.step_s, 4e-6 * i / 0.407, 3e-8, 0.0);
        assert_close(landed[0], 0.0, 1e-9, 0.0);
    }
}
END_TEST

START_TEST(bad_input_in_float)
{
    const struct walker walker = paper_walker();
    const struct stride_settings settings = stride_settings_fixed(&walker, 1e-3f);
    const struct apex bad = {NAN, 0.0f, 0.0f}, wild = {-1e30f, 0.0f, 1e30f};
    struct stride_result r;
    ck_assert_int_eq(stride(&walker, &settings, &bad, 0.05f, &r), STRIDE_BAD_INPUT);
    ck_assert_int_eq(stride(&walker, &settings, &wild, 0.05f, &r), STRIDE_NOT_FINITE);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("stride in float");
    TCase *tests = tcase_create("float");
    suite_add_tcase(suite, tests);
    tcase_add_test(tests, the_papers_gait_in_float);
    tcase_add_test(tests, collision_in_float);
    tcase_add_test(tests, landings_in_float_take_few_steps);
    tcase_add_test(tests, bad_input_in_float);
    return run_suite(suite);
}
