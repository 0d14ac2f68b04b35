/* Frames of the leg sensors, byte by byte, and at the limits of their fields. */
#include "hal/bus/frame_table.h"
#include "hal/devices/duplicate_id.h"
#include "hal/devices/leg_sensors.h"
#include "tests/support/assert_close.h"

#include <math.h>

static const struct leg_sensor_config straight[SIDE_COUNT] = {{.angle_direction = 1},
                                                              {.angle_direction = 1}};

static struct can_msg leg_frame(uint32_t id, int32_t angle, int16_t ankle)
{
    const uint32_t a = (uint32_t)angle;
    const uint16_t r = (uint16_t)ankle;
    return (struct can_msg){.id = id,
                            .length = 5,
                            .data = {(uint8_t)(a & 255u), (uint8_t)((a >> 8) & 255u),
                                     (uint8_t)((a >> 16) & 255u), (uint8_t)(r & 255u),
                                     (uint8_t)(r >> 8)}};
}

START_TEST(counts_become_radians_and_metres)
{
    static const struct {
        int32_t counts;
        double turns;
    } cases[] = {{0, 0.0},        {1, 1.0 / 16777216.0}, {-1, -1.0 / 16777216.0},
                 {4194304, 0.25}, {-4194304, -0.25},     {8388607, 0.5 - 1.0 / 16777216.0}};
    struct leg_sensors sensors;
    leg_sensors_init(&sensors, straight);
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const struct can_msg frame =
            leg_frame(0x283, cases[i].counts, (int16_t)(100 * (int)i - 250));
        ck_assert(leg_sensors_receive(&sensors, &frame));
        assert_close(sensors.reading[SIDE_LEFT].leg_angle_rad, cases[i].turns * 2.0 * M_PI, 1e-9,
                     2e-7);
        assert_close(sensors.reading[SIDE_LEFT].ankle_extension_m, 1e-3 * (double)i - 2.5e-3, 1e-9,
                     1e-6);
        ck_assert_int_eq(sensors.reading[SIDE_LEFT].age_ticks, 0);
    }
    ck_assert_int_eq(sensors.reading[SIDE_RIGHT].age_ticks, UINT16_MAX);
}
END_TEST

START_TEST(offset_and_direction_of_the_mounting)
{
    struct leg_sensor_config config[SIDE_COUNT] = {
        {.angle_direction = 1, .angle_zero_rad = 3.0f},
        {.angle_direction = -1, .angle_zero_rad = -0.5f}};
    struct leg_sensors sensors;
    leg_sensors_init(&sensors, config);
    struct can_msg frame = leg_frame(0x283, -8388608, 0); /* -pi: across the wrap from +3 rad */
    ck_assert(leg_sensors_receive(&sensors, &frame));
    assert_close(sensors.reading[SIDE_LEFT].leg_angle_rad, M_PI - 3.0, 1e-6, 0.0);
    frame = leg_frame(0x284, 0, 0);
    ck_assert(leg_sensors_receive(&sensors, &frame));
    assert_close(sensors.reading[SIDE_RIGHT].leg_angle_rad, -0.5, 1e-6, 0.0);
}
END_TEST

START_TEST(lever_ankle_is_the_sine_and_never_negative)
{
    struct leg_sensor_config config[SIDE_COUNT] = {{.angle_direction = 1,
                                                    .ankle_is_lever = true,
                                                    .ankle_lever_m = 0.12f,
                                                    .ankle_neutral_rad = 0.1f},
                                                   {.angle_direction = 1}};
    struct leg_sensors sensors;
    leg_sensors_init(&sensors, config);
    for (int counts = -32768; counts <= 32767; counts += 97) {
        const struct can_msg frame = leg_frame(0x283, 0, (int16_t)counts);
        ck_assert(leg_sensors_receive(&sensors, &frame));
        const double angle = counts * 2.0 * M_PI / 65536.0 - 0.1;
        const double expected = 0.12 * sin(angle);
        assert_close(sensors.reading[SIDE_LEFT].ankle_extension_m, expected > 0.0 ? expected : 0.0,
                     2e-7, 0.0);
    }
}
END_TEST

/* The lever's corners, and its integral by many small steps. */
static double way_of(double angle, double step, const double lever[5])
{
    enum { PARTS = 20000 };
    double way = 0.0;
    for (int i = 0; i < PARTS && angle > 0.0; i++) {
        const double at = angle * (i + 0.5) / PARTS / step;
        const int corner = at < 4.0 ? (int)at : 4;
        const double next = corner < 4 ? lever[corner + 1] : lever[4];
        way += (lever[corner] + (at - corner) * (next - lever[corner])) * angle / PARTS;
    }
    return way;
}

START_TEST(a_lever_by_a_table_is_integrated)
{
    static const double lever[5] = {0.12, 0.13, 0.11, 0.08, 0.05};
    struct leg_sensor_config config[SIDE_COUNT] = {{.angle_direction = 1,
                                                    .ankle_is_lever = true,
                                                    .ankle_lever_m = 0.12f,
                                                    .ankle_neutral_rad = -0.05f,
                                                    .ankle_table_rad = 0.15f,
                                                    .ankle_table_m = {0.13f, 0.11f, 0.08f, 0.05f}},
                                                   {.angle_direction = 1}};
    struct leg_sensors sensors;
    leg_sensors_init(&sensors, config);
    for (int counts = -4000; counts <= 10000; counts += 250) {
        const struct can_msg frame = leg_frame(0x283, 0, (int16_t)counts);
        ck_assert(leg_sensors_receive(&sensors, &frame));
        const double angle = counts * 2.0 * M_PI / 65536.0 + 0.05;
        assert_close(sensors.reading[SIDE_LEFT].ankle_extension_m, way_of(angle, 0.15, lever), 2e-6,
                     0.0);
    }
}
END_TEST

START_TEST(malformed_frames_change_nothing_and_are_counted)
{
    struct leg_sensors sensors;
    leg_sensors_init(&sensors, straight);
    struct can_msg frame = leg_frame(0x283, 1000, 5);
    ck_assert(leg_sensors_receive(&sensors, &frame));
    const float before = sensors.reading[SIDE_LEFT].leg_angle_rad;
    leg_sensors_age(&sensors);
    frame = leg_frame(0x283, 2000, 6);
    for (uint8_t length = 0; length <= 8; length++) {
        frame.length = length;
        if (length != 5) {
            ck_assert(leg_sensors_receive(&sensors, &frame));
        }
    }
    frame.length = 5;
    frame.flags = CAN_FRAME_REMOTE;
    ck_assert(leg_sensors_receive(&sensors, &frame));
    ck_assert_uint_eq(sensors.rx_malformed, 9);
    ck_assert(sensors.reading[SIDE_LEFT].leg_angle_rad == before);
    ck_assert_int_eq(sensors.reading[SIDE_LEFT].age_ticks, 1);
    frame = leg_frame(0x285, 0, 0);
    ck_assert_msg(!leg_sensors_receive(&sensors, &frame), "took a foreign frame");
}
END_TEST

START_TEST(age_grows_and_saturates)
{
    struct leg_sensors sensors;
    leg_sensors_init(&sensors, straight);
    struct can_msg frame = leg_frame(0x284, 0, 0);
    ck_assert(leg_sensors_receive(&sensors, &frame));
    for (int i = 0; i < 70000; i++) {
        leg_sensors_age(&sensors);
    }
    ck_assert_int_eq(sensors.reading[SIDE_RIGHT].age_ticks, UINT16_MAX);
}
END_TEST

/* Somebody else with the sensor's identifier: more frames than cycles. */
START_TEST(frames_beyond_one_a_cycle_are_counted)
{
    struct leg_sensors sensors;
    leg_sensors_init(&sensors, straight);
    const struct can_msg own = leg_frame(0x283, 1000, 5), other = leg_frame(0x283, 1001, 5),
                         ankle = leg_frame(0x283, 1000, 6);
    const int8_t *duplicate_id_count = &sensors.reading[SIDE_LEFT].duplicate_id_count;
    for (int cycle = 0; cycle < 100; cycle++) { /* repeated by CAN itself: nothing */
        ck_assert(leg_sensors_receive(&sensors, &own) && leg_sensors_receive(&sensors, &own));
        leg_sensors_age(&sensors);
    }
    ck_assert_int_eq(*duplicate_id_count, 0);
    for (int i = 0; i < 10; i++) { /* silence owes what a full bus can hold up, and then no more */
        ck_assert_int_eq(*duplicate_id_count, i <= DUPLICATE_ID_OWED_MAX ? -i : 0);
        leg_sensors_age(&sensors);
    }
    ck_assert(leg_sensors_receive(&sensors, &own));
    leg_sensors_age(&sensors);
    for (int i = 0; i < DUPLICATE_ID_OWED_MAX; i++) {
        leg_sensors_age(&sensors);
    }
    ck_assert_int_eq(*duplicate_id_count, -DUPLICATE_ID_OWED_MAX);
    for (int i = 0; i < DUPLICATE_ID_OWED_MAX; i++) {
        ck_assert(leg_sensors_receive(&sensors, &own) && leg_sensors_receive(&sensors, &other));
        leg_sensors_age(&sensors);
    }
    ck_assert_int_eq(*duplicate_id_count, 0);
    for (int late = 0; late < 100; late++) { /* a cycle late, and again: what was owed */
        leg_sensors_age(&sensors);
        ck_assert(leg_sensors_receive(&sensors, &own) && leg_sensors_receive(&sensors, &other));
        ck_assert_int_eq(*duplicate_id_count, 0);
        leg_sensors_age(&sensors);
    }
    leg_sensors_age(&sensors);
    leg_sensors_age(&sensors); /* a full bus: two cycles late, then three at once */
    ck_assert(leg_sensors_receive(&sensors, &own) && leg_sensors_receive(&sensors, &other) &&
              leg_sensors_receive(&sensors, &own));
    ck_assert_int_eq(*duplicate_id_count, 0);
    leg_sensors_age(&sensors);
    for (int i = 1; i <= 3; i++) { /* somebody else, each cycle */
        ck_assert(leg_sensors_receive(&sensors, &own) && leg_sensors_receive(&sensors, &ankle));
        ck_assert_int_eq(*duplicate_id_count, i);
        leg_sensors_age(&sensors);
    }
    ck_assert_int_eq(sensors.reading[SIDE_RIGHT].duplicate_id_count, 0); /* it never began */
    for (int i = 0; i < 1000; i++) {
        ck_assert(leg_sensors_receive(&sensors, &own) && leg_sensors_receive(&sensors, &other));
    }
    ck_assert_int_eq(*duplicate_id_count, INT8_MAX);
    for (int i = 0; i < 1000; i++) {
        leg_sensors_age(&sensors);
    }
    ck_assert_int_eq(*duplicate_id_count, 0);
}
END_TEST

START_TEST(a_foot_switch_is_read_ages_and_falls_silent)
{
    struct leg_sensors sensors;
    struct can_msg frame = {.id = 0x384, .length = 1, .data = {1}};
    leg_sensors_init(&sensors, straight);
    const struct leg_sensor_reading *right = &sensors.reading[SIDE_RIGHT];
    ck_assert_int_eq(right->foot, FOOT_UNKNOWN);
    ck_assert(leg_sensors_receive(&sensors, &frame));
    ck_assert_int_eq(right->foot, FOOT_DOWN);
    ck_assert_int_eq(sensors.reading[SIDE_LEFT].foot, FOOT_UNKNOWN);
    for (int i = 0; i < FOOT_AGE_MAX_TICKS; i++) {
        leg_sensors_age(&sensors);
        ck_assert_int_eq(right->foot, FOOT_DOWN);
    }
    leg_sensors_age(&sensors);
    ck_assert_int_eq(right->foot, FOOT_UNKNOWN);
    frame.data[0] = 0;
    ck_assert(leg_sensors_receive(&sensors, &frame));
    ck_assert_int_eq(right->foot, FOOT_UP);
    frame.data[0] = FOOT_HAS_FAULT | FOOT_IS_DOWN;
    ck_assert(leg_sensors_receive(&sensors, &frame));
    ck_assert_int_eq(right->foot, FOOT_UNKNOWN);
    frame.length = 2;
    frame.data[0] = FOOT_IS_DOWN;
    ck_assert(leg_sensors_receive(&sensors, &frame));
    ck_assert_int_eq(right->foot, FOOT_UNKNOWN);
    ck_assert_uint_eq(sensors.rx_malformed, 1);
}
END_TEST

static struct can_msg ankle_frame(uint32_t id, int16_t ankle)
{
    const uint16_t r = (uint16_t)ankle;
    return (struct can_msg){
        .id = id, .length = 2, .data = {(uint8_t)(r & 255u), (uint8_t)(r >> 8)}};
}

/* Two frames make one reading, as old as the older; of the other leg one frame still does. */
START_TEST(an_ankle_sensor_of_its_own_has_a_frame_of_its_own)
{
    struct leg_sensor_config config[SIDE_COUNT] = {
        {.angle_direction = 1, .ankle_is_apart = true, .ankle_reversed = true},
        {.angle_direction = 1}};
    const struct can_msg right_ankle = ankle_frame(0x288, 1);
    struct leg_sensors sensors;
    const struct leg_sensor_reading *left = &sensors.reading[SIDE_LEFT];
    leg_sensors_init(&sensors, config);
    struct can_msg angle = leg_frame(0x283, 4194304, 0);
    ck_assert(leg_sensors_receive(&sensors, &angle)); /* five bytes are not its frame any more */
    ck_assert_uint_eq(sensors.rx_malformed, 1);
    angle.length = 3;
    ck_assert(leg_sensors_receive(&sensors, &angle));
    assert_close(left->leg_angle_rad, M_PI / 2.0, 0.0, 1e-6);
    ck_assert_int_eq(left->age_ticks, UINT16_MAX); /* no ankle yet */
    struct can_msg ankle = ankle_frame(0x287, -250);
    ck_assert(leg_sensors_receive(&sensors, &ankle));
    assert_close(left->ankle_extension_m, 2.5e-3, 0.0, 1e-6);
    ck_assert_int_eq(left->age_ticks, 0);
    leg_sensors_age(&sensors);
    ck_assert(leg_sensors_receive(&sensors, &angle));
    ck_assert_int_eq(left->age_ticks, 1);
    ck_assert(leg_sensors_receive(&sensors, &ankle));
    ck_assert_int_eq(left->age_ticks, 0);
    ankle.length = 5;
    ck_assert(leg_sensors_receive(&sensors, &ankle));
    ck_assert_uint_eq(sensors.rx_malformed, 2);
    ck_assert(!leg_sensors_receive(&sensors, &right_ankle)); /* nobody's on this device */
}
END_TEST

/* Another answer in the same cycle, of either: a second node with that number. */
START_TEST(a_second_ankle_sensor_is_noticed)
{
    struct leg_sensor_config config[SIDE_COUNT] = {{.angle_direction = 1, .ankle_is_apart = true},
                                                   {.angle_direction = 1}};
    struct leg_sensors sensors;
    leg_sensors_init(&sensors, config);
    for (int16_t i = 0; i < 2; i++) {
        const struct can_msg ankle = ankle_frame(0x287, i);
        (void)leg_sensors_receive(&sensors, &ankle);
    }
    ck_assert_int_eq(sensors.reading[SIDE_LEFT].duplicate_id_count, 1);
    const struct can_msg first = leg_frame(0x284, 1, 1), second = leg_frame(0x284, 2, 2);
    (void)leg_sensors_receive(&sensors, &first);
    (void)leg_sensors_receive(&sensors, &second); /* both values differ: one frame too many */
    ck_assert_int_eq(sensors.reading[SIDE_RIGHT].duplicate_id_count, 1);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("leg_sensors");
    TCase *tests = tcase_create("all");
    tcase_add_test(tests, a_foot_switch_is_read_ages_and_falls_silent);
    tcase_add_test(tests, counts_become_radians_and_metres);
    tcase_add_test(tests, offset_and_direction_of_the_mounting);
    tcase_add_test(tests, lever_ankle_is_the_sine_and_never_negative);
    tcase_add_test(tests, a_lever_by_a_table_is_integrated);
    tcase_add_test(tests, malformed_frames_change_nothing_and_are_counted);
    tcase_add_test(tests, age_grows_and_saturates);
    tcase_add_test(tests, frames_beyond_one_a_cycle_are_counted);
    tcase_add_test(tests, an_ankle_sensor_of_its_own_has_a_frame_of_its_own);
    tcase_add_test(tests, a_second_ankle_sensor_is_noticed);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
