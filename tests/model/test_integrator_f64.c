/* Orders of the methods, and landing on events whose time is known in closed form. */
#include <math.h>

#include "model/integrator.h"
#include "model/single_support.h"
#include "tests/model/walkers.h"

static void oscillator(const void *context, const double *state, double *rates)
{
    (void)context;
    rates[0] = state[1];
    rates[1] = -state[0];
}

/* Counts its calls through the context. */
static void counted(const void *context, const double *state, double *rates)
{
    int *const *count = (int *const *)context;
    ++**count;
    oscillator(NULL, state, rates);
}

static double error_after_a_step(const struct walker *w, ode_method *method, int steps)
{
    const struct ode ode = {single_support_rates, w, SINGLE_SUPPORT_STATES};
    double state[4] = {0.27, -0.27, -1.1, 0.3}, fine[4] = {0.27, -0.27, -1.1, 0.3};
    for (int i = 0; i < steps; i++) {
        ode_step(&ode, method, 0.8 / steps, state, state);
    }
    for (int i = 0; i < 400; i++) {
        ode_step(&ode, ODE_RK8, 0.8 / 400, fine, fine);
    }
    double worst = 0.0;
    for (int k = 0; k < 4; k++) {
        worst = fmax(worst, fabs(state[k] - fine[k]));
    }
    return worst;
}

START_TEST(errors_fall_with_the_methods_order)
{
    const struct walker w = heavy_legged_walker();
    const double two =
        log2(error_after_a_step(&w, ODE_MIDPOINT, 40) / error_after_a_step(&w, ODE_MIDPOINT, 80));
    const double four =
        log2(error_after_a_step(&w, ODE_RK4, 40) / error_after_a_step(&w, ODE_RK4, 80));
    const double eight =
        log2(error_after_a_step(&w, ODE_RK8, 8) / error_after_a_step(&w, ODE_RK8, 16));
    ck_assert_msg(fabs(two - 2.0) < 0.2, "the midpoint rule has order %g", two);
    ck_assert_msg(fabs(four - 4.0) < 0.5, "RK4 has order %g", four);
    ck_assert_msg(fabs(eight - 8.0) < 1.2, "RK8 has order %g", eight);
    ck_assert(error_after_a_step(&w, ODE_RK8, 32) < 1e-10);
}
END_TEST

START_TEST(a_linear_system_is_exact_to_order_eight)
{
    /* The stability polynomial of an order-8 method matches exp(ih) through h^8. */
    const struct ode ode = {oscillator, NULL, 2};
    double state[2] = {1.0, 0.0};
    ode_step(&ode, ODE_RK8, 0.01, state, state);
    assert_close(state[0], cos(0.01), 1e-16, 0.0);
    assert_close(state[1], -sin(0.01), 1e-17, 0.0);
    double back[2] = {state[0], state[1]};
    ode_step(&ode, ODE_RK8, -0.01, back, back);
    assert_close(back[0], 1.0, 2e-16, 0.0);
}
END_TEST

START_TEST(events_are_landed_to_a_picosecond)
{
    const struct ode ode = {oscillator, NULL, 2};
    for (int i = 1; i < 100; i++) {
        const double h = 0.1,
                     before = h * i / 100.0; /* the zero of cos lies `before` into the step */
        const double state[2] = {cos(M_PI_2 - before), -sin(M_PI_2 - before)};
        const struct ode_event zero = {{1.0, 0.0, 0.0, 0.0}, 0.0};
        double end[2], landed[2];
        ode_step(&ode, ODE_RK8, h, state, end);
        const struct ode_landing landing = ode_land(&ode, ODE_RK8, &zero, state, h, end, landed);
        assert_close(landing.step_s, before, 1e-12, 0.0);
        assert_close(landed[0], 0.0, 1e-15, 0.0);
        assert_close(landed[1], -1.0, 1e-14, 0.0);
        ck_assert_int_le(landing.iterations, 4);
    }
}
END_TEST

START_TEST(a_grazing_event_is_landed_in_bounded_work)
{
    /* cos(t) - 0.99999999: crosses zero at a slope of 1e-4, nearly tangent. */
    const double offset = -0.99999999, when = acos(0.99999999);
    int calls = 0;
    int *const counter = &calls;
    const struct ode ode = {counted, &counter, 2};
    const struct ode_event event = {{1.0, 0.0, 0.0, 0.0}, offset};
    const double state[2] = {1.0, 0.0};
    double end[2], landed[2];
    ode_step(&ode, ODE_RK8, 0.5, state, end);
    const struct ode_landing landing = ode_land(&ode, ODE_RK8, &event, state, 0.5, end, landed);
    assert_close(landing.step_s, when, 1e-11, 0.0); /* rounding of 1 over the slope of 1e-4 */
    ck_assert_int_le(landing.iterations, 20);
    ck_assert_int_le(calls, 12 * 22);
}
END_TEST

START_TEST(events_at_the_ends_of_the_step_are_served)
{
    const struct ode ode = {oscillator, NULL, 2};
    const double state[2] = {0.0, 1.0};
    double end[2], landed[2];
    ode_step(&ode, ODE_RK8, 0.1, state, end);
    const struct ode_event at_start = {{1.0, 0.0, 0.0, 0.0}, 0.0};
    assert_close(ode_land(&ode, ODE_RK8, &at_start, state, 0.1, end, landed).step_s, 0.0, 1e-12,
                 0.0);
    const struct ode_event at_end = {{1.0, 0.0, 0.0, 0.0}, -end[0]};
    const struct ode_landing landing = ode_land(&ode, ODE_RK8, &at_end, state, 0.1, end, landed);
    ck_assert(landing.step_s == 0.1 && landed[0] == end[0] && landed[1] == end[1]);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("integrator");
    TCase *tests = tcase_create("integrator");
    suite_add_tcase(suite, tests);
    tcase_add_test(tests, errors_fall_with_the_methods_order);
    tcase_add_test(tests, a_linear_system_is_exact_to_order_eight);
    tcase_add_test(tests, events_are_landed_to_a_picosecond);
    tcase_add_test(tests, a_grazing_event_is_landed_in_bounded_work);
    tcase_add_test(tests, events_at_the_ends_of_the_step_are_served);
    return run_suite(suite);
}
