/* finv against a curve that is known in closed form, inverted in double. */
#include "controller/laws/speed_table.h"
#include "tests/support/assert_close.h"

#include <math.h>

/* Shaped like the walker's curve: a square root that bends further down. */
static double curve(double r0)
{
    return 2.0 * sqrt(r0 + 0.0005) * (1.0 - 0.5 * r0);
}

static double curve_inverse(double v)
{
    double low = 0.0, high = 0.5;
    for (int i = 0; i < 60; i++) {
        const double middle = 0.5 * (low + high);
        if (curve(middle) < v) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return low;
}

static struct speed_table sampled_curve(void)
{
    struct speed_table table = {.count = SPEED_TABLE_MAX, .r0_min_m = 0.005f, .r0_step_m = 0.0047f};
    for (int i = 0; i < SPEED_TABLE_MAX; i++) {
        table.speed_rad_s[i] = (float)curve((double)table.r0_min_m + i * (double)table.r0_step_m);
    }
    return table;
}

START_TEST(inverse_matches_the_curve)
{
    const struct speed_table table = sampled_curve();
    ck_assert_int_eq(speed_table_check(&table), SPEED_TABLE_OK);
    const double low = (double)table.speed_rad_s[0];
    const double high = (double)table.speed_rad_s[SPEED_TABLE_MAX - 1];
    for (int i = 0; i <= 1000; i++) {
        const double v = low + (high - low) * i / 1000.0;
        assert_close(speed_table_inverse(&table, (float)v), curve_inverse(v), 3e-7, 0.0);
    }
}
END_TEST

START_TEST(speed_matches_the_curve)
{
    const struct speed_table table = sampled_curve();
    for (int i = 0; i <= 1000; i++) {
        const double r0 = 0.01 + 0.28 * i / 1000.0;
        assert_close(speed_table_speed(&table, (float)r0), curve(r0), 1e-6, 0.0);
    }
}
END_TEST

START_TEST(inverse_is_exact_at_entries_and_clamped_beyond)
{
    const struct speed_table table = sampled_curve();
    for (int i = 0; i < SPEED_TABLE_MAX; i++) {
        assert_close(speed_table_inverse(&table, table.speed_rad_s[i]),
                     (double)table.r0_min_m + i * (double)table.r0_step_m, 2e-7, 0.0);
    }
    ck_assert(speed_table_inverse(&table, 0.0f) == table.r0_min_m);
    ck_assert(speed_table_inverse(&table, -1.0f) == table.r0_min_m);
    ck_assert(speed_table_inverse(&table, NAN) == table.r0_min_m);
    assert_close(speed_table_inverse(&table, 100.0f), 0.005 + 63 * 0.0047, 1e-6, 0.0);
}
END_TEST

START_TEST(inverse_rises_everywhere)
{
    const struct speed_table table = sampled_curve();
    float before = 0.0f;
    for (int i = 0; i <= 20000; i++) {
        const float r0 = speed_table_inverse(&table, 0.1f + 0.9f * (float)i / 20000.0f);
        ck_assert(r0 >= before - 1e-7f);
        before = r0;
    }
}
END_TEST

START_TEST(speed_is_the_end_entries_at_and_beyond_the_ends)
{
    const struct speed_table table = sampled_curve();
    const int last = SPEED_TABLE_MAX - 1;
    const float end_m = table.r0_min_m + (float)last * table.r0_step_m;
    assert_close(speed_table_speed(&table, end_m), table.speed_rad_s[last], 1e-6, 0.0);
    assert_close(speed_table_speed(&table, 2.0f * end_m), table.speed_rad_s[last], 1e-6, 0.0);
    assert_close(speed_table_speed(&table, -1.0f), table.speed_rad_s[0], 1e-6, 0.0);
}
END_TEST

START_TEST(bad_tables_are_refused)
{
    struct speed_table table = sampled_curve();
    table.count = 3;
    ck_assert_int_eq(speed_table_check(&table), SPEED_TABLE_BAD_COUNT);
    table.count = SPEED_TABLE_MAX + 1;
    ck_assert_int_eq(speed_table_check(&table), SPEED_TABLE_BAD_COUNT);
    table = sampled_curve();
    table.r0_step_m = 0.0f;
    ck_assert_int_eq(speed_table_check(&table), SPEED_TABLE_BAD_GRID);
    table.r0_step_m = INFINITY;
    ck_assert_int_eq(speed_table_check(&table), SPEED_TABLE_BAD_GRID);
    table = sampled_curve();
    const float no_grid[] = {NAN, INFINITY, -INFINITY, 0.0f, -0.001f};
    for (size_t i = 0; i < sizeof no_grid / sizeof no_grid[0]; i++) {
        table = sampled_curve();
        table.r0_min_m = no_grid[i];
        ck_assert_int_eq(speed_table_check(&table), SPEED_TABLE_BAD_GRID);
        table = sampled_curve();
        table.r0_step_m = no_grid[i];
        ck_assert_int_eq(speed_table_check(&table), SPEED_TABLE_BAD_GRID);
    }
    table = sampled_curve();
    table.speed_rad_s[20] = table.speed_rad_s[19];
    ck_assert_int_eq(speed_table_check(&table), SPEED_TABLE_NOT_RISING);
    table = sampled_curve();
    table.speed_rad_s[63] = NAN;
    ck_assert_int_eq(speed_table_check(&table), SPEED_TABLE_NOT_RISING);
    table.speed_rad_s[63] = INFINITY;
    ck_assert_int_eq(speed_table_check(&table), SPEED_TABLE_NOT_RISING);
    table = sampled_curve();
    table.speed_rad_s[0] = 0.0f;
    ck_assert_int_eq(speed_table_check(&table), SPEED_TABLE_NOT_RISING);
    table = sampled_curve();
    table.count = 4;
    ck_assert_int_eq(speed_table_check(&table), SPEED_TABLE_OK);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("speed_table");
    TCase *tests = tcase_create("all");
    tcase_add_test(tests, inverse_matches_the_curve);
    tcase_add_test(tests, speed_matches_the_curve);
    tcase_add_test(tests, inverse_is_exact_at_entries_and_clamped_beyond);
    tcase_add_test(tests, inverse_rises_everywhere);
    tcase_add_test(tests, speed_is_the_end_entries_at_and_beyond_the_ends);
    tcase_add_test(tests, bad_tables_are_refused);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
