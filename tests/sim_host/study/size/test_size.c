/* Sizing: the shipped device bears what it is for, and the tables say what limits one that does not. */
#include <math.h>
#include <string.h>

#include "sim_host/cli/walk_options.h"
#include "sim_host/study/size/ankle_curve.h"
#include "sim_host/study/size/size.h"
#include "tests/support/assert_close.h"

#define DEVICE "sim_host/devices/exo50.ini"
#define PERSON "sim_host/persons/adult70.ini"

static struct size_setup setup;
static struct size_row row;
static double share[SIZE_LIMITS];

static void prepare(void)
{
    struct walk_options options;
    struct subject subject;
    char message[SUBJECT_MESSAGE_MAX];
    double speed_rad_s;
    walk_options_init(&options);
    options.person_path = PERSON;
    options.device_path = DEVICE;
    options.person = true;
    ck_assert_msg(walk_options_resolve(&options, &subject, &setup.params, &speed_rad_s, message) ==
                      0,
                  "%s", message);
    setup.config = subject.actuators.config[SIDE_LEFT];
    setup.seed = 1;
}

static void walk(double cadence_1_min)
{
    size_walk(&setup, cadence_1_min, &row);
    size_shares(&setup, &row, share);
}

START_TEST(the_ankle_passes_its_landmarks_smoothly)
{
    const double deg = 0.017453292519943295;
    assert_close(ankle_curve_rad(0.0), 0.0, 1e-12, 0.0);
    assert_close(ankle_curve_rad(0.44), -10.0 * deg, 1e-12, 0.0);
    assert_close(ankle_curve_rad(ANKLE_CURVE_TOE_OFF), 19.0 * deg, 1e-12, 0.0);
    for (double s = -1.0; s < 2.0; s += 1e-3) {
        assert_close(ankle_curve_rad(s), ankle_curve_rad(s + 1.0), 1e-9, 0.0);
        ck_assert(fabs(ankle_curve_rad(s + 1e-3) - ankle_curve_rad(s)) < 0.3 * deg);
    }
}
END_TEST

START_TEST(the_shipped_device_gives_every_push_with_margin)
{
    for (double cadence = 80.0; cadence <= 130.0; cadence += 10.0) {
        walk(cadence);
        ck_assert_int_eq(row.pushes, SIZE_STRIDES);
        for (int i = 0; i < SIZE_LIMITS; i++) {
            ck_assert_msg(share[i] < 0.95, "%s used by %g at %g",
                          size_limit_name((enum size_limit)i), share[i], cadence);
        }
        /* Peak: the series of spring and cuff at r0*, on the lever. */
        const double series = 12000.0 * 60000.0 / 72000.0;
        const double peak_Nm = series * (double)setup.params.start_r0_m * 0.12;
        assert_close(row.peak_torque_Nm, peak_Nm, 0.0, 0.03);
        /* Work: of what is stored a sixth goes in the cuff, the hysteresis takes some. */
        const double stored_J =
            0.5 * series * (double)setup.params.start_r0_m * (double)setup.params.start_r0_m;
        ck_assert(row.work_J > 0.9 * stored_J && row.work_J < 1.05 * stored_J);
        ck_assert(row.release_share >= 0.5 && row.release_share < 0.53);
        ck_assert(row.spare_s > 0.2);
        ck_assert_msg(row.swing_Nm < fmax(1.0, 0.02 * row.peak_torque_Nm), "%g", row.swing_Nm);
        ck_assert(row.hour_degC > 60.0 && row.hour_degC < 130.0);
    }
}
END_TEST

START_TEST(heat_after_an_hour_is_that_of_the_current)
{
    walk(110.0);
    /* Steady state: T = 25 + I^2 R(T) (0.209 + 7.4). Copper warms itself, which also makes the housing's
     * 1180 s longer: by 1 / (1 - the share that comes back). */
    const double per_ohm = row.rms_A * row.rms_A * 7.609;
    const double back = per_ohm * 0.102 * 0.00393;
    const double rise_K = per_ohm * 0.102 / (1.0 - back);
    const double part = 1.0 - exp(-3600.0 * (1.0 - back * 7.4 / 7.609) / 1180.0);
    assert_close(row.hour_degC - 25.0, rise_K * part, 0.0, 0.02);
}
END_TEST

START_TEST(what_is_too_weak_is_named)
{
    /* Too little voltage for the speed: the spring is not loaded in time, and nothing is pushed. */
    setup.config.supply_V = 6.0;
    walk(130.0);
    ck_assert(row.voltage_limited_s > 0.0);
    assert_close(share[SIZE_VOLTAGE], 1.0, 0.0, 0.0);
    prepare();
    /* A drive that may give too little current for the spring: no push at all, and no torque. */
    setup.config.current_peak_A = setup.config.current_continuous_A = 5.0;
    walk(100.0);
    ck_assert_int_eq(row.pushes, 0);
    assert_close(share[SIZE_PEAK_CURRENT], 1.0, 1e-3, 0.0);
    ck_assert(share[SIZE_TIME] > 1.0);
    ck_assert(row.swing_Nm < 1.0);
    prepare();
    setup.config.latch_holding_N = 300.0;
    walk(100.0);
    ck_assert(share[SIZE_LATCH] > 1.0);
}
END_TEST

START_TEST(drive_and_impedance_answer_as_their_parts_say)
{
    double gain, lag_rad;
    size_answer(&setup, 1.0, 0.002, &gain, &lag_rad);
    assert_close(gain, 1.0, 0.03, 0.0);
    ck_assert(lag_rad >= 0.0 && lag_rad < 0.1);
    /* A motor that holds its place shows the ankle spring and cuff in series, on the lever. */
    assert_close(size_impedance_Nm_rad(&setup, 2.0), 10000.0 * 0.12 * 0.12, 0.0, 0.1);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("size");
    TCase *tests = tcase_create("size");
    tcase_add_checked_fixture(tests, prepare, NULL);
    tcase_add_test(tests, the_ankle_passes_its_landmarks_smoothly);
    tcase_add_test(tests, the_shipped_device_gives_every_push_with_margin);
    tcase_add_test(tests, heat_after_an_hour_is_that_of_the_current);
    tcase_add_test(tests, what_is_too_weak_is_named);
    tcase_add_test(tests, drive_and_impedance_answer_as_their_parts_say);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
