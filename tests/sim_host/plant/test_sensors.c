/* Sensors against arithmetic of their own: resolution, noise statistics, latency, saturation. */
#include "hal/devices/leg_sensors.h"
#include <math.h>
#include <string.h>

#include "sim_host/plant/sensors.h"
#include "tests/support/assert_close.h"

static const double TURN = 6.283185307179586;
static const double TICK_S = 1e-3;

static struct sensor make(enum sensor_preset_kind kind)
{
    struct sensor_params params;
    struct sensor sensor;
    sensor_preset(kind, &params);
    ck_assert_ptr_null(sensor_params_check(&params));
    sensor_init(&sensor, &params, 5, 0);
    return sensor;
}

static struct sensor_truth still(double angle, double ankle)
{
    const struct sensor_truth truth = {.leg_angle_rad = angle, .ankle_extension_m = ankle};
    return truth;
}

START_TEST(presets_are_named)
{
    enum sensor_preset_kind kind;
    ck_assert(sensor_preset_from_name("ideal", &kind) && kind == SENSORS_IDEAL);
    ck_assert(sensor_preset_from_name("17bit", &kind) && kind == SENSORS_17BIT);
    ck_assert(sensor_preset_from_name("14bit", &kind) && kind == SENSORS_14BIT);
    ck_assert(sensor_preset_from_name("12bit", &kind) && kind == SENSORS_12BIT);
    ck_assert(!sensor_preset_from_name("16bit", &kind));
    ck_assert(!sensor_preset_from_name("", &kind));
}
END_TEST

START_TEST(ideal_gives_the_frames_resolution)
{
    struct sensor sensor = make(SENSORS_IDEAL);
    struct sensor_sample sample;
    for (int i = -400; i <= 400; i++) {
        const struct sensor_truth truth = still(i * 1.2345e-3, fabs(i * 7.77e-5));
        sensor_sample(&sensor, &truth, TICK_S, &sample);
        ck_assert(sample.sent);
        ck_assert_int_eq(sample.leg_angle_counts,
                         (int)lround(truth.leg_angle_rad / TURN * 16777216.0));
        ck_assert_int_eq(sample.ankle_counts, (int)lround(truth.ankle_extension_m * 1e5));
        assert_close(sample.leg_angle_rad, truth.leg_angle_rad, 0.51 * TURN / 16777216.0, 0.0);
        assert_close(sample.ankle_extension_m, truth.ankle_extension_m, 0.51e-5, 0.0);
    }
}
END_TEST

static const struct {
    enum sensor_preset_kind kind;
    double bits, ankle_m;
} PRESETS[] = {
    {SENSORS_17BIT, 131072.0, 1e-5}, {SENSORS_14BIT, 16384.0, 5e-5}, {SENSORS_12BIT, 4096.0, 2e-4}};

START_TEST(noise_is_one_count_rms_on_whole_counts)
{
    struct sensor sensor = make(PRESETS[_i].kind);
    struct sensor_sample sample;
    const double count = TURN / PRESETS[_i].bits;
    const struct sensor_truth truth = still(0.3 * count, 0.0);
    double sum = 0.0, squares = 0.0, ankle_squares = 0.0;
    const int n = 20000;
    for (int i = 0; i < n; i++) {
        sensor_sample(&sensor, &truth, TICK_S, &sample);
        const double counts = sample.leg_angle_rad / count;
        assert_close(counts, round(counts), 1e-9, 0.0);
        sum += counts;
        squares += counts * counts;
        ankle_squares += pow(sample.ankle_extension_m / PRESETS[_i].ankle_m, 2.0);
    }
    const double mean = sum / n;
    /* Rounding adds a twelfth of a count squared. */
    assert_close(mean, 0.3, 0.03, 0.0);
    assert_close(squares / n - mean * mean, 1.0 + 1.0 / 12.0, 0.04, 0.0);
    assert_close(ankle_squares / n, 1.0 + 1.0 / 12.0, 0.04, 0.0);
}
END_TEST

START_TEST(latency_is_interpolated)
{
    static const double LATENCIES[] = {0.0, 1e-4, 1e-3, 2e-3, 2.37e-3, 5e-3};
    struct sensor_params params;
    struct sensor sensor;
    struct sensor_sample sample;
    sensor_preset(SENSORS_IDEAL, &params);
    params.latency_s = LATENCIES[_i];
    sensor_init(&sensor, &params, 1, 0);
    for (int k = 0; k < 200; k++) {
        const double t = k * TICK_S, w = 8.0;
        const struct sensor_truth truth = {0.4 * sin(w * t), 0.4 * w * cos(w * t),
                                           0.05 + 0.05 * cos(w * t), -0.05 * w * sin(w * t)};
        sensor_sample(&sensor, &truth, TICK_S, &sample);
        if (k > 8) {
            const double seen = t - params.latency_s;
            assert_close(sample.leg_angle_rad, 0.4 * sin(w * seen), 0.51 * TURN / 16777216.0 + 1e-9,
                         0.0);
            assert_close(sample.ankle_extension_m, 0.05 + 0.05 * cos(w * seen), 0.51e-5, 0.0);
        }
    }
}
END_TEST

START_TEST(before_history_the_oldest_truth_is_seen)
{
    struct sensor_params params;
    struct sensor sensor;
    struct sensor_sample sample;
    sensor_preset(SENSORS_IDEAL, &params);
    params.latency_s = 5e-3;
    sensor_init(&sensor, &params, 1, 0);
    for (int k = 0; k < 8; k++) {
        const struct sensor_truth truth = still(0.1 + 0.01 * k, 0.0);
        sensor_sample(&sensor, &truth, TICK_S, &sample);
        assert_close(sample.leg_angle_rad, k < 5 ? 0.1 : 0.1 + 0.01 * (k - 5), 1e-6, 0.0);
    }
}
END_TEST

START_TEST(offsets_shift_and_values_saturate)
{
    struct sensor_params params;
    struct sensor sensor;
    struct sensor_sample sample;
    struct sensor_truth truth = still(0.2, 0.03);
    sensor_preset(SENSORS_IDEAL, &params);
    params.angle_offset_rad = -0.05;
    params.ankle_offset_m = 0.002;
    sensor_init(&sensor, &params, 1, 0);
    sensor_sample(&sensor, &truth, TICK_S, &sample);
    assert_close(sample.leg_angle_rad, 0.15, 4e-7, 0.0);
    assert_close(sample.ankle_extension_m, 0.032, 1e-5, 0.0);
    truth = still(4.0, 1.0);
    sensor_sample(&sensor, &truth, TICK_S, &sample);
    ck_assert_int_eq(sample.leg_angle_counts, 8388607);
    ck_assert_int_eq(sample.ankle_counts, 32767);
    truth = still(-4.0, 0.0);
    sensor_sample(&sensor, &truth, TICK_S, &sample);
    ck_assert_int_eq(sample.leg_angle_counts, -8388608);
    truth = still((double)NAN, (double)INFINITY);
    sensor_sample(&sensor, &truth, TICK_S, &sample); /* whatever it says, it is a number */
    ck_assert(isfinite(sample.leg_angle_rad) && isfinite(sample.ankle_extension_m));
}
END_TEST

START_TEST(a_lever_ankle_measures_its_angle)
{
    struct sensor_params params;
    struct sensor sensor;
    struct sensor_sample sample;
    sensor_preset(SENSORS_IDEAL, &params);
    params.ankle_is_lever = true;
    params.ankle_lever_m = 0.1;
    params.ankle_neutral_rad = 0.05;
    sensor_init(&sensor, &params, 1, 0);
    for (int i = 0; i <= 90; i++) {
        const struct sensor_truth truth = still(0.0, i * 1e-3);
        sensor_sample(&sensor, &truth, TICK_S, &sample);
        const double angle = 0.05 + asin(i * 1e-3 / 0.1);
        ck_assert_int_eq(sample.ankle_counts, (int)lround(angle / TURN * 65536.0));
        assert_close(sample.ankle_extension_m, i * 1e-3, 0.1 * 0.51 * TURN / 65536.0, 0.0);
    }
}
END_TEST

/* The device's own reading of such an angle is the extension again: plant and device agree on the lever. */
START_TEST(a_lever_by_a_table_measures_its_angle)
{
    struct sensor_params params;
    struct sensor sensor;
    struct sensor_sample sample;
    struct leg_sensors device;
    const struct leg_sensor_config config[SIDE_COUNT] = {
        {.angle_direction = 1,
         .ankle_is_lever = true,
         .ankle_lever_m = 0.1f,
         .ankle_neutral_rad = 0.05f,
         .ankle_table_rad = 0.2f,
         .ankle_table_m = {0.12f, 0.08f, 0.07f, 0.06f}},
        {.angle_direction = 1}};
    sensor_preset(SENSORS_IDEAL, &params);
    params.ankle_is_lever = true;
    params.ankle_lever_m = 0.1;
    params.ankle_neutral_rad = 0.05;
    params.ankle_table =
        (struct sea_table){5, {0.0, 0.2, 0.4, 0.6, 0.8}, {0.1, 0.12, 0.08, 0.07, 0.06}};
    sensor_init(&sensor, &params, 1, 0);
    leg_sensors_init(&device, config);
    for (int i = 0; i <= 60; i++) {
        const struct sensor_truth truth = still(0.0, i * 1e-3);
        sensor_sample(&sensor, &truth, TICK_S, &sample);
        const uint16_t counts = (uint16_t)sample.ankle_counts;
        const struct can_msg frame = {
            .id = 0x283,
            .length = 5,
            .data = {0, 0, 0, (uint8_t)(counts & 255u), (uint8_t)(counts >> 8)}};
        (void)leg_sensors_receive(&device, &frame);
        assert_close((double)device.reading[SIDE_LEFT].ankle_extension_m, i * 1e-3,
                     0.13 * 0.51 * TURN / 65536.0, 0.0);
        assert_close(sample.ankle_extension_m, i * 1e-3, 0.13 * 0.51 * TURN / 65536.0, 0.0);
    }
}
END_TEST

START_TEST(dropped_samples_repeat_the_last)
{
    struct sensor_params params;
    struct sensor sensor;
    struct sensor_sample sample, last = {0};
    int dropped = 0;
    sensor_preset(SENSORS_IDEAL, &params);
    params.drop_probability = 0.1;
    sensor_init(&sensor, &params, 9, 0);
    for (int i = 0; i < 20000; i++) {
        const struct sensor_truth truth = still(1e-5 * i, 0.0);
        sensor_sample(&sensor, &truth, TICK_S, &sample);
        if (!sample.sent) {
            dropped++;
            ck_assert_int_eq(sample.leg_angle_counts, last.leg_angle_counts);
        }
        last = sample;
    }
    assert_close(dropped, 2000.0, 150.0, 0.0);
}
END_TEST

START_TEST(coloured_noise_has_its_power_and_corner)
{
    struct sensor_params params;
    struct sensor sensor;
    struct sensor_sample sample;
    sensor_preset(SENSORS_IDEAL, &params);
    params.angle_coloured_rad = 1e-3;
    params.angle_coloured_hz = 10.0;
    sensor_init(&sensor, &params, 3, 0);
    const struct sensor_truth truth = still(0.0, 0.0);
    double squares = 0.0, products = 0.0, last = 0.0;
    const int n = 400000;
    for (int i = 0; i < n; i++) {
        sensor_sample(&sensor, &truth, TICK_S, &sample);
        squares += sample.leg_angle_rad * sample.leg_angle_rad;
        products += sample.leg_angle_rad * last;
        last = sample.leg_angle_rad;
    }
    assert_close(sqrt(squares / n), 1e-3, 0.0, 0.05);
    /* Correlation from one tick to the next of a first-order low pass. */
    assert_close(products / squares, exp(-TURN * 10.0 * TICK_S), 0.01, 0.0);
}
END_TEST

START_TEST(same_seed_same_samples)
{
    struct sensor a = make(SENSORS_14BIT), b = make(SENSORS_14BIT), c;
    struct sensor_params params;
    struct sensor_sample sa, sb, sc;
    int different = 0;
    sensor_preset(SENSORS_14BIT, &params);
    sensor_init(&c, &params, 5, 1);
    for (int i = 0; i < 1000; i++) {
        const struct sensor_truth truth = still(0.0, 0.01);
        sensor_sample(&a, &truth, TICK_S, &sa);
        sensor_sample(&b, &truth, TICK_S, &sb);
        sensor_sample(&c, &truth, TICK_S, &sc);
        ck_assert_int_eq(sa.leg_angle_counts, sb.leg_angle_counts);
        ck_assert_int_eq(sa.ankle_counts, sb.ankle_counts);
        different += sa.leg_angle_counts != sc.leg_angle_counts;
    }
    ck_assert(different > 500);
}
END_TEST

START_TEST(random_numbers_are_uniform_and_normal)
{
    struct rng rng;
    double sum = 0.0, squares = 0.0, fourth = 0.0;
    int bins[10] = {0};
    const int n = 200000;
    rng_init(&rng, 1, 2);
    for (int i = 0; i < n; i++) {
        const double u = rng_uniform(&rng);
        ck_assert(u >= 0.0 && u < 1.0);
        bins[(int)(u * 10.0)]++;
    }
    for (int i = 0; i < 10; i++) {
        assert_close(bins[i], n / 10.0, 600.0, 0.0); /* 4.5 sigma */
    }
    for (int i = 0; i < n; i++) {
        const double x = rng_normal(&rng);
        sum += x;
        squares += x * x;
        fourth += x * x * x * x;
    }
    assert_close(sum / n, 0.0, 0.01, 0.0);
    assert_close(squares / n, 1.0, 0.02, 0.0);
    assert_close(fourth / n, 3.0 - 0.1, 0.1, 0.0); /* twelve uniforms: 3 - 6/(5*12) */
}
END_TEST

/* Published reference: first outputs of xoshiro256** with the state 1, 2, 3, 4. */
START_TEST(the_generator_is_xoshiro256_starstar)
{
    struct rng rng = {{1, 2, 3, 4}};
    static const uint64_t FIRST[] = {11520u, 0u, 1509978240u, 1215971899390074240u};
    for (int i = 0; i < 4; i++) {
        ck_assert(rng_next(&rng) == FIRST[i]);
    }
}
END_TEST

START_TEST(bad_parameters_are_named)
{
    struct sensor_params params;
    sensor_preset(SENSORS_17BIT, &params);
    params.latency_s = 0.0051;
    ck_assert_str_eq(sensor_params_check(&params), "latency_s");
    sensor_preset(SENSORS_17BIT, &params);
    params.angle_resolution_rad = 0.0;
    ck_assert_str_eq(sensor_params_check(&params), "angle_resolution_rad");
    sensor_preset(SENSORS_17BIT, &params);
    params.drop_probability = (double)NAN;
    ck_assert_str_eq(sensor_params_check(&params), "drop_probability");
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("sensors");
    TCase *tcase = tcase_create("samples");
    tcase_add_test(tcase, presets_are_named);
    tcase_add_test(tcase, ideal_gives_the_frames_resolution);
    tcase_add_loop_test(tcase, noise_is_one_count_rms_on_whole_counts, 0, 3);
    tcase_add_loop_test(tcase, latency_is_interpolated, 0, 6);
    tcase_add_test(tcase, before_history_the_oldest_truth_is_seen);
    tcase_add_test(tcase, offsets_shift_and_values_saturate);
    tcase_add_test(tcase, a_lever_ankle_measures_its_angle);
    tcase_add_test(tcase, a_lever_by_a_table_measures_its_angle);
    tcase_add_test(tcase, dropped_samples_repeat_the_last);
    tcase_add_test(tcase, coloured_noise_has_its_power_and_corner);
    tcase_add_test(tcase, same_seed_same_samples);
    tcase_add_test(tcase, random_numbers_are_uniform_and_normal);
    tcase_add_test(tcase, the_generator_is_xoshiro256_starstar);
    tcase_add_test(tcase, bad_parameters_are_named);
    suite_add_tcase(suite, tcase);
    return run_suite(suite);
}
