/* The return map in double, against the reference values of the re-derived model and the paper's. */
#include <math.h>

#include "model/stride.h"
#include "tests/support/assert_close.h"

static struct walker paper_walker(void)
{
    struct walker walker;
    const struct walker_params params = walker_paper_params();
    ck_assert_int_eq(walker_init(&walker, &params), WALKER_OK);
    return walker;
}

/* Iterates the map from a state near the stable gait until it settles. */
static struct apex settle(const struct walker *walker, const struct stride_settings *settings,
                          double r0)
{
    struct apex x = {-0.4069, -0.0596, 1.7568};
    for (int i = 0; i < 80; i++) {
        struct stride_result result;
        ck_assert_int_eq(stride(walker, settings, &x, r0, &result), STRIDE_OK);
        x = result.next;
    }
    return x;
}

START_TEST(the_papers_gait_is_found)
{
    const struct walker walker = paper_walker();
    const struct stride_settings settings = stride_settings_accurate(&walker);
    const struct apex x = settle(&walker, &settings, 0.05);
    assert_close(x.stance_rate_rad_s, -0.406960, 1e-6, 0.0);
    assert_close(x.swing_angle_rad, -0.059569, 1e-6, 0.0);
    assert_close(x.swing_rate_rad_s, 1.756768, 1e-6, 0.0);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("stride");
    TCase *tests = tcase_create("stride");
    suite_add_tcase(suite, tests);
    tcase_add_test(tests, the_papers_gait_is_found);
    return run_suite(suite);
}
