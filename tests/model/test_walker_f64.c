/* Parameters: each limit, the order of the checks, the words of the errors. */
#include <math.h>
#include <string.h>

#include "tests/model/walkers.h"

static const enum walker_error errors[5] = {WALKER_BAD_HIP_MASS, WALKER_BAD_LEG_MASS,
                                            WALKER_BAD_LEG_LENGTH, WALKER_BAD_ANKLE_STIFFNESS,
                                            WALKER_BAD_GRAVITY};

static double *field(struct walker_params *params, int index)
{
    double *const fields[5] = {&params->hip_mass_kg, &params->leg_mass_kg, &params->leg_length_m,
                               &params->ankle_stiffness_N_m, &params->gravity_m_s2};
    return fields[index];
}

START_TEST(every_field_is_checked)
{
    const double bad[] = {-1.0, 1e30, (double)NAN, (double)INFINITY, -(double)INFINITY};
    for (int i = 0; i < 5; i++) {
        for (unsigned b = 0; b < sizeof bad / sizeof bad[0]; b++) {
            struct walker_params params = walker_paper_params();
            struct walker walker;
            memset(&walker, 0x5a, sizeof walker);
            const struct walker before = walker;
            *field(&params, i) = bad[b];
            ck_assert_int_eq(walker_init(&walker, &params), errors[i]);
            ck_assert_mem_eq(&walker, &before, sizeof walker);
        }
    }
}
END_TEST

START_TEST(zero_is_good_for_the_legs_mass_only)
{
    for (int i = 0; i < 5; i++) {
        struct walker_params params = walker_paper_params();
        struct walker walker;
        *field(&params, i) = 0.0;
        ck_assert_int_eq(walker_init(&walker, &params), i == 1 ? WALKER_OK : errors[i]);
    }
}
END_TEST

START_TEST(legs_heavier_than_the_body_are_refused)
{
    struct walker_params params = walker_paper_params();
    struct walker walker;
    params.leg_mass_kg = params.hip_mass_kg * 1.0001;
    ck_assert_int_eq(walker_init(&walker, &params), WALKER_BAD_MASS_RATIO);
    params.leg_mass_kg = params.hip_mass_kg;
    ck_assert_int_eq(walker_init(&walker, &params), WALKER_OK);
}
END_TEST

START_TEST(each_error_names_its_field)
{
    const char *const words[5] = {"hip mass", "leg mass", "leg length", "stiffness", "gravity"};
    for (int i = 0; i < 5; i++) {
        ck_assert_ptr_nonnull(strstr(walker_error_name(errors[i]), words[i]));
    }
    ck_assert_ptr_nonnull(strstr(walker_error_name(WALKER_BAD_MASS_RATIO), "mass"));
    ck_assert_ptr_nonnull(walker_error_name(WALKER_OK));
    ck_assert_ptr_nonnull(walker_error_name((enum walker_error)(-99)));
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("walker");
    TCase *tests = tcase_create("walker");
    suite_add_tcase(suite, tests);
    tcase_add_test(tests, every_field_is_checked);
    tcase_add_test(tests, zero_is_good_for_the_legs_mass_only);
    tcase_add_test(tests, legs_heavier_than_the_body_are_refused);
    tcase_add_test(tests, each_error_names_its_field);
    return run_suite(suite);
}
