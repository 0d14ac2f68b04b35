/* A picture of numbers ends, whatever they are: a constant, nothing at all, one number. */
#include "sim_host/cli/figure.h"
#include "tests/support/assert_close.h"

#include <math.h>
#include <string.h>

static long bytes_of(const double *value, size_t count)
{
    static const double number[] = {1.0, 2.0, 3.0};
    static struct figure_panel panel;
    panel = (struct figure_panel){
        .title = "Panel (1)", .series = {{"line", number, value, NULL, count}}, .series_count = 1};
    FILE *file = tmpfile();
    ck_assert_ptr_nonnull(file);
    figure_write(file, "Title", &panel, 1);
    const long bytes = ftell(file);
    fclose(file);
    return bytes;
}

START_TEST(a_constant_has_a_few_lines_across)
{
    static const double constants[] = {0.0, 1e-12, 1.0, 400.0, -3e6, 1e15};
    for (size_t i = 0; i < sizeof constants / sizeof constants[0]; i++) {
        const double value[3] = {constants[i], constants[i], constants[i]};
        const long bytes = bytes_of(value, 3);
        ck_assert_msg(bytes > 500 && bytes < 10000, "%g: %ld bytes", constants[i], bytes);
    }
}
END_TEST

START_TEST(a_line_of_gaps_has_a_frame)
{
    const double value[2] = {(double)NAN, (double)NAN};
    const long bytes = bytes_of(value, 2);
    ck_assert(bytes > 500 && bytes < 10000);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("figure");
    TCase *tests = tcase_create("all");
    tcase_add_test(tests, a_constant_has_a_few_lines_across);
    tcase_add_test(tests, a_line_of_gaps_has_a_frame);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
