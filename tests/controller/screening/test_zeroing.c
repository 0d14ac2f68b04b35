/* Zeroing while standing: offsets come out as put in, and no wrong moment is taken. */
#include <check.h>
#include <math.h>

#include "controller/screening/zeroing.h"
#include "tests/support/assert_close.h"

static struct zeroing zeroing;

struct stance {
    double offset_rad[SIDE_COUNT], offset_m[SIDE_COUNT];
    double sway_rad, noise_rad;
    int lost_from, lost_to; /* ticks without samples */
};

static void stand(const struct stance *stance, int ticks)
{
    for (int n = 0; n < ticks; n++) {
        struct leg_measurement leg[SIDE_COUNT];
        for (int side = 0; side < SIDE_COUNT; side++) {
            const double sway = stance->sway_rad * sin(2.0 * 3.14159265 * 0.4 * 1e-3 * n);
            const double noise = stance->noise_rad * ((n * 7919 + side * 31) % 13 - 6) / 4.0;
            leg[side] = (struct leg_measurement){
                (real)(stance->offset_rad[side] + sway + noise), (real)stance->offset_m[side],
                (uint16_t)(n >= stance->lost_from && n < stance->lost_to ? 1 : 0), FOOT_UNKNOWN};
        }
        zeroing_update(&zeroing, leg);
    }
}

START_TEST(offsets_are_found)
{
    const struct stance stance = {{0.03, -0.05}, {0.002, 0.0}, 0.006, 1e-3, 100, 110};
    zeroing = (struct zeroing){0};
    stand(&stance, 100);
    ck_assert_int_eq(zeroing.state, ZEROING_IDLE);
    zeroing_start(&zeroing);
    stand(&stance, 2900);
    ck_assert_int_eq(zeroing.state, ZEROING_RUNNING);
    stand(&stance, 200);
    ck_assert_int_eq(zeroing.state, ZEROING_DONE);
    assert_close((double)zeroing.mean.angle_rad[SIDE_LEFT], 0.03, 2e-3, 0.0);
    assert_close((double)zeroing.mean.angle_rad[SIDE_RIGHT], -0.05, 2e-3, 0.0);
    assert_close((double)zeroing.mean.ankle_m[SIDE_LEFT], 0.002, 1e-6, 0.0);
    assert_close((double)zeroing.mean.ankle_m[SIDE_RIGHT], 0.0, 1e-6, 0.0);
}
END_TEST

START_TEST(wrong_moments_are_refused)
{
    static const struct {
        struct stance stance;
        enum zeroing_state verdict;
    } cases[] = {
        {{{0, 0}, {0, 0}, 0.03, 0, 0, 0}, ZEROING_MOVED},
        {{{0.3, 0}, {0, 0}, 0, 0, 0, 0}, ZEROING_TOO_FAR},
        {{{0, 0}, {0, 0.05}, 0, 0, 0, 0}, ZEROING_TOO_FAR},
        {{{0, 0}, {0, 0}, 0, 0, 50, 90}, ZEROING_NO_SAMPLE},
        {{{(double)NAN, 0}, {0, 0}, 0, 0, 0, 0}, ZEROING_NO_SAMPLE},
    };
    zeroing_start(&zeroing);
    stand(&cases[_i].stance, 4000);
    ck_assert_int_eq(zeroing.state, cases[_i].verdict);
}
END_TEST

START_TEST(a_run_can_be_given_up)
{
    const struct stance still = {0};
    zeroing_start(&zeroing);
    stand(&still, 1000);
    zeroing_stop(&zeroing);
    ck_assert_int_eq(zeroing.state, ZEROING_MOVED);
    stand(&still, 4000);
    ck_assert_int_eq(zeroing.state, ZEROING_MOVED);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("zeroing");
    TCase *tcase = tcase_create("standing");
    tcase_add_test(tcase, offsets_are_found);
    tcase_add_loop_test(tcase, wrong_moments_are_refused, 0, 5);
    tcase_add_test(tcase, a_run_can_be_given_up);
    suite_add_tcase(suite, tcase);
    return run_suite(suite);
}
