/* sin, cos, acos against the C library's long double functions: an outside source, 11 bits (40 for float) finer. */
#include <math.h>

#include "model/trig.h"
#include "tests/support/assert_close.h"

/* |got - want| in units in the last place of the wanted double (or float). */
static double ulps(long double got, long double want, int mantissa_bits)
{
    int exponent;
    (void)frexpl(want == 0.0L ? 1e-300L : want, &exponent);
    return (double)(fabsl(got - want) / ldexpl(1.0L, exponent - mantissa_bits));
}

START_TEST(double_functions_stay_within_one_and_a_half_units)
{
    double worst_sin = 0.0, worst_cos = 0.0, worst_acos = 0.0;
    for (long i = -400000; i <= 400000; i++) {
        double x = (double)i * (6.2831853 / 400000.0);
        double s, c;
        trig_sincos_f64(x, &s, &c);
        ck_assert(s == trig_sin_f64(x) && c == trig_cos_f64(x));
        worst_sin = fmax(worst_sin, ulps((long double)s, sinl((long double)x), 53));
        worst_cos = fmax(worst_cos, ulps((long double)c, cosl((long double)x), 53));
        double y = (double)i / 400000.0;
        worst_acos =
            fmax(worst_acos, ulps((long double)trig_acos_f64(y), acosl((long double)y), 53));
    }
    ck_assert_msg(worst_sin < 1.5 && worst_cos < 1.5 && worst_acos < 1.5, "%g %g %g", worst_sin,
                  worst_cos, worst_acos);
}
END_TEST

START_TEST(float_functions_stay_within_one_and_a_half_units)
{
    double worst_sin = 0.0, worst_cos = 0.0, worst_acos = 0.0;
    for (long i = -400000; i <= 400000; i++) {
        float x = (float)i * (6.2831853f / 400000.0f);
        float s, c;
        trig_sincos_f32(x, &s, &c);
        ck_assert(s == trig_sin_f32(x) && c == trig_cos_f32(x));
        worst_sin = fmax(worst_sin, ulps((long double)s, sinl((long double)x), 24));
        worst_cos = fmax(worst_cos, ulps((long double)c, cosl((long double)x), 24));
        float y = (float)i / 400000.0f;
        worst_acos =
            fmax(worst_acos, ulps((long double)trig_acos_f32(y), acosl((long double)y), 24));
    }
    ck_assert_msg(worst_sin < 1.5 && worst_cos < 1.5 && worst_acos < 1.5, "%g %g %g", worst_sin,
                  worst_cos, worst_acos);
}
END_TEST

START_TEST(neighbours_of_multiples_of_a_quarter_turn_keep_their_relative_accuracy)
{
    for (int n = -4; n <= 4; n++) {
        double x = n * 1.5707963267948966;
        float y = (float)n * 1.57079633f;
        for (int k = 0; k < 5; k++, x = nextafter(x, 100.0), y = nextafterf(y, 100.0f)) {
            ck_assert(ulps((long double)trig_sin_f64(x), sinl((long double)x), 53) < 1.5);
            ck_assert(ulps((long double)trig_cos_f64(x), cosl((long double)x), 53) < 1.5);
            ck_assert(ulps((long double)trig_sin_f32(y), sinl((long double)y), 24) < 1.5);
            ck_assert(ulps((long double)trig_cos_f32(y), cosl((long double)y), 24) < 1.5);
        }
    }
}
END_TEST

START_TEST(large_angles_are_served)
{
    for (int i = 0; i < 20000; i++) {
        double x = -1e4 + i * 1.00003;
        float y = (float)x;
        assert_close(trig_sin_f64(x), sinl((long double)x), 1e-15, 0.0);
        assert_close(trig_cos_f64(x), cosl((long double)x), 1e-15, 0.0);
        assert_close(trig_sin_f32(y), sinl((long double)y), 4e-7, 0.0);
        assert_close(trig_cos_f32(y), cosl((long double)y), 4e-7, 0.0);
    }
    double beyond[] = {1e7, -1e12, 1e300};
    for (int i = 0; i < 3; i++) {
        ck_assert(fabs(trig_sin_f64(beyond[i])) < 1.1 && fabs(trig_cos_f64(beyond[i])) < 1.1);
        float y = (float)fmax(fmin(beyond[i], 3e38), -3e38);
        ck_assert(fabsf(trig_sin_f32(y)) < 1.1f && fabsf(trig_cos_f32(y)) < 1.1f);
    }
}
END_TEST

START_TEST(edges)
{
    ck_assert(trig_acos_f64(1.0) == 0.0 && trig_acos_f64(2.0) == 0.0);
    ck_assert(trig_acos_f64(-1.0) == 3.14159265358979323846 &&
              trig_acos_f64(-7.0) == trig_acos_f64(-1.0));
    ck_assert(trig_acos_f32(1.0f) == 0.0f && trig_acos_f32(-1.0f) == 3.14159274f);
    ck_assert(trig_sin_f64(0.0) == 0.0 && trig_cos_f64(0.0) == 1.0);
    ck_assert(isnan(trig_sin_f64((double)NAN)) && isnan(trig_cos_f64((double)INFINITY)));
    ck_assert(isnan(trig_sin_f32(NAN)) && isnan(trig_cos_f32(-INFINITY)));
    ck_assert(isnan(trig_acos_f64((double)NAN)) && isnan(trig_acos_f32(NAN)));
    ck_assert(trig_sin_f64(1e-310) == 1e-310 && trig_sin_f32(1e-40f) == 1e-40f);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("trig");
    TCase *tests = tcase_create("trig");
    suite_add_tcase(suite, tests);
    tcase_add_test(tests, double_functions_stay_within_one_and_a_half_units);
    tcase_add_test(tests, float_functions_stay_within_one_and_a_half_units);
    tcase_add_test(tests, neighbours_of_multiples_of_a_quarter_turn_keep_their_relative_accuracy);
    tcase_add_test(tests, large_angles_are_served);
    tcase_add_test(tests, edges);
    return run_suite(suite);
}
