/* Three seconds to the tick, which only double can say: 3000 ticks are more than that in float. */
#include "controller/estimator/walking_speed.h"
#include "tests/support/assert_close.h"

START_TEST(a_speed_is_forgotten_after_three_seconds)
{
    const struct control_params params = {.gravity_m_s2 = REAL(9.81), .leg_length_m = REAL(0.9)};
    const uint32_t three_seconds = 3000000 / TICK_PERIOD_US;
    struct walking_speed speed = {0};
    walking_speed_apex(&speed, 5000, REAL(1.0));
    assert_close(walking_speed_at(&speed, &params, 5000 + three_seconds), 1.0, 1e-12, 0.0);
    struct walking_speed mean = speed, anew = speed;
    walking_speed_apex(&mean, 5000 + three_seconds, REAL(1.1));
    assert_close(walking_speed_at(&mean, &params, 5000 + three_seconds), 1.03, 1e-12, 0.0);
    walking_speed_apex(&anew, 5001 + three_seconds, REAL(1.1));
    assert_close(walking_speed_at(&anew, &params, 5001 + three_seconds), 1.1, 1e-12, 0.0);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("walking_speed in double");
    TCase *tests = tcase_create("all");
    tcase_add_test(tests, a_speed_is_forgotten_after_three_seconds);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
