/* Which push-offs the search leaves out, against the return map in steps of 1 ms. */
#include "controller/laws/predictive_search.h"
#include "sim_host/subjects/subject.h"
#include "tests/support/assert_close.h"

/* As predictive_search.c says: the new stance leg at lift-off, from the vertical. */
#define MARGIN_RAD 0.005

static struct control_params params;
static struct apex apex;
static real gait_r0_m;

static void setup(void)
{
    struct subject subject;
    struct gait_branch_point gait;
    char message[SUBJECT_MESSAGE_MAX];
    subject_default(&subject);
    ck_assert_int_eq(subject_control_params(&subject, &params, message), 0);
    apex.stance_rate_rad_s = -gait_branch_at(params.branch, 0.4f, &gait);
    apex.swing_angle_rad = gait.swing_angle_rad;
    apex.swing_rate_rad_s = gait.swing_rate_rad_s;
    gait_r0_m = gait.r0_m;
}

static struct predictive_search made(void)
{
    struct predictive_search search;
    const struct walker_params walker = {params.torso_mass_kg, params.leg_mass_kg,
                                         params.leg_length_m, params.spring_stiffness_n_m,
                                         params.gravity_m_s2};
    ck_assert_int_eq(predictive_search_init(&search, &walker), 0);
    return search;
}

/* The stride of that push-off; a harder one brings the new stance leg closer to the vertical. */
static struct stride_result strides(real r0_m)
{
    const struct predictive_search search = made();
    const struct stride_settings settings = stride_settings_fixed(&search.walker, 0.001f);
    struct stride_result result;
    (void)stride(&search.walker, &settings, &apex, r0_m, &result);
    return result;
}

static real push_off_that_leaves(double angle_rad)
{
    real low_m = gait_r0_m, high_m = 0.3f;
    for (int i = 0; i < 40; i++) {
        const real middle_m = 0.5f * (low_m + high_m);
        const struct stride_result result = strides(middle_m);
        const bool closer = result.fault != STRIDE_OK || (double)result.lift_off[0] < angle_rad;
        *(closer ? &high_m : &low_m) = middle_m;
    }
    return low_m;
}

/* Whether the search takes it where it has no choice. */
static bool takes(real r0_m)
{
    struct predictive_search search = made();
    const struct predictive_request request = {.apex = apex,
                                               .target_speed_rad_s = 0.4f,
                                               .r0_first_m = r0_m,
                                               .r0_low_m = r0_m,
                                               .r0_high_m = r0_m,
                                               .r0_from_m = r0_m,
                                               .motor_speed_m_s = 10.0f,
                                               .motor_acceleration_m_s2 = 1000.0f,
                                               .tick_s = 0.001f};
    predictive_search_begin(&search, params.branch, &request);
    for (int i = 0; i < PREDICTIVE_UNITS; i++) {
        (void)predictive_search_work(&search, params.branch);
    }
    ck_assert_int_eq(search.stage, PREDICTIVE_IDLE);
    return search.answered && search.has_prediction;
}

START_TEST(a_push_that_lifts_off_too_near_the_vertical_is_left_out)
{
    static const struct {
        double angle_rad;
        bool taken;
    } cases[] = {{MARGIN_RAD + 0.05, true},
                 {MARGIN_RAD + 0.001, true},
                 {MARGIN_RAD - 0.001, false},
                 {MARGIN_RAD - 0.004, false}};
    ck_assert(takes(gait_r0_m));
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const real r0_m = push_off_that_leaves(cases[i].angle_rad);
        const struct stride_result result = strides(r0_m);
        ck_assert_int_eq(result.fault, STRIDE_OK); /* the map walks on, with either */
        assert_close(result.lift_off[0], cases[i].angle_rad, 5e-4, 0.0);
        ck_assert_msg(takes(r0_m) == cases[i].taken, "r0 %.4f m leaves %.4f rad", (double)r0_m,
                      cases[i].angle_rad);
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("predictive search");
    TCase *tests = tcase_create("all");
    tcase_add_checked_fixture(tests, setup, NULL);
    tcase_add_test(tests, a_push_that_lifts_off_too_near_the_vertical_is_left_out);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
