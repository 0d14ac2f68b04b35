/* The comparison that every numeric test rests on must not let NaN through. */
#include "tests/support/assert_close.h"

#include <math.h>

START_TEST(test_absolute_tolerance)
{
    ck_assert(is_close(1.0 + 0.9e-6, 1.0, 1e-6, 0.0));
    ck_assert(!is_close(1.0 + 1.1e-6, 1.0, 1e-6, 0.0));
    ck_assert(is_close(-1.0, -1.0, 0.0, 0.0));
}
END_TEST

START_TEST(test_relative_tolerance)
{
    ck_assert(is_close(-1000.9, -1000.0, 0.0, 1e-3));
    ck_assert(!is_close(-1001.1, -1000.0, 0.0, 1e-3));
}
END_TEST

START_TEST(test_nothing_is_close_to_nan_or_infinity)
{
    ck_assert(!is_close((double)NAN, (double)NAN, 1e9, 1e9));
    ck_assert(!is_close((double)NAN, 0.0, 1e9, 1e9));
    ck_assert(!is_close(0.0, (double)NAN, 1e9, 1e9));
    ck_assert(!is_close((double)INFINITY, (double)INFINITY, 1e9, 1e9));
    ck_assert(!is_close(1.0, (double)INFINITY, 1e9, 1e9));
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("assert_close");
    TCase *tcase = tcase_create("is_close");
    tcase_add_test(tcase, test_absolute_tolerance);
    tcase_add_test(tcase, test_relative_tolerance);
    tcase_add_test(tcase, test_nothing_is_close_to_nan_or_infinity);
    suite_add_tcase(suite, tcase);
    return run_suite(suite);
}
