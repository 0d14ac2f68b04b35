/* What each kind of node is told, whole and in order, with the numbers as the standards print them:
 * CiA 301 (1000h to 1A02h), CiA 402-2 (6007h to 60FEh) and CiA 406 (6001h, 6503h). */
#include "hal/devices/setup_steps.h"
#include "tests/support/assert_close.h"

enum { LEFT = 0, RIGHT = 1 };
/* Roles as hal/canopen/network.h counts them. */
enum { DRIVE_LEFT, DRIVE_RIGHT, SENSOR_LEFT, SENSOR_RIGHT, BOARD_LEFT, BOARD_RIGHT };
enum { NUMBER = 9, STEPS_MOST = 100 };

#define ALL 0xFFFFFFFF
/* Of a COB-ID: whether the PDO exists, and its identifier; not bit 30. */
#define COB 0x800007FF
#define E STEP_EXPECT
#define A STEP_AWAIT
#define W STEP_WRITE
#define T STEP_TRY
#define C STEP_SCALING
#define V STEP_SPEED

/* CiA 301, 7.5.2.36: off (bit 31), no entries, the entries, their number, the type, on. Three entries
 * are written always; where there are fewer, the last one again. */
#define PDO(index, id, type, count, sub1, map1, sub2, map2, sub3, map3)                     \
    {W, index, 1, 4, 0x80000000 | (id), COB}, {W, (index) + 0x200, 0, 1, 0, ALL},           \
        {W, (index) + 0x200, sub1, 4, map1, ALL}, {W, (index) + 0x200, sub2, 4, map2, ALL}, \
        {W, (index) + 0x200, sub3, 4, map3, ALL}, {W, (index) + 0x200, 0, 1, count, ALL},   \
        {W, index, 2, 1, type, ALL},                                                        \
    {                                                                                       \
        W, index, 1, 4, id, COB                                                             \
    }
/* Every 100 ms the node's heartbeat; that of node 16 is missed after 250 ms. */
#define PRODUCER                  \
    {                             \
        W, 0x1017, 0, 2, 100, ALL \
    }
#define CONSUMER                         \
    {                                    \
        W, 0x1016, 1, 4, 0x001000FA, ALL \
    }
/* Fault on a lost link; a quick stop's ramp, or the slow one, and then torque off. */
#define REACTIONS                                                                    \
    {W, 0x6007, 0, 2, 1, ALL}, {W, 0x605A, 0, 2, 2, ALL}, {W, 0x605B, 0, 2, 1, ALL}, \
        {W, 0x605C, 0, 2, 1, ALL},                                                   \
    {                                                                                \
        W, 0x605E, 0, 2, 2, ALL                                                      \
    }
#define SCALING                                                                    \
    {C, 0x608F, 1, 4, 0, 0}, {C, 0x608F, 2, 4, 0, 0}, {C, 0x6091, 1, 4, 0, 0},     \
        {C, 0x6091, 2, 4, 0, 0}, {C, 0x6092, 1, 4, 0, 0}, {C, 0x6092, 2, 4, 0, 0}, \
        {C, 0x6076, 0, 4, 0, 0},                                                   \
    {                                                                              \
        V, 0x6080, 0, 4, 0, 0                                                      \
    }

static struct node_setup_config config;

static void check(uint8_t role, bool with_rtr, const struct setup_step *expected, unsigned count)
{
    unsigned found = 0, at = 0;
    struct setup_step step;
    for (; at < STEPS_MOST; at++) {
        const struct setup_place place = {role, NUMBER, with_rtr, (uint16_t)at};
        step = setup_step_at(&config, &place);
        if (step.kind == STEP_END) {
            break;
        }
        if (step.kind == STEP_SKIP) {
            continue;
        }
        ck_assert_msg(found < count, "more steps than expected: %04X:%02X", step.index, step.sub);
        const struct setup_step *wanted = &expected[found];
        ck_assert_msg(step.kind == wanted->kind && step.index == wanted->index &&
                          step.sub == wanted->sub && step.bytes == wanted->bytes &&
                          step.value == wanted->value && step.mask == wanted->mask,
                      "step %u: kind %d, %04X:%02X of %u bytes, %08X (%08X), and not kind %d, "
                      "%04X:%02X of %u bytes, %08X (%08X)",
                      found, (int)step.kind, step.index, step.sub, step.bytes, step.value,
                      step.mask, (int)wanted->kind, wanted->index, wanted->sub, wanted->bytes,
                      wanted->value, wanted->mask);
        found++;
    }
    ck_assert_uint_eq(found, count);
    ck_assert_int_eq((int)step.kind, STEP_END);
    /* The end stays the end. */
    const struct setup_place behind = {role, NUMBER, with_rtr, (uint16_t)(at + 1)};
    ck_assert_int_eq((int)setup_step_at(&config, &behind).kind, STEP_END);
}

#define CHECK(role, with_rtr, expected) \
    check(role, with_rtr, expected, sizeof(expected) / sizeof(expected)[0])

static void start(void)
{
    config = (struct node_setup_config){.limit_min_counts = {-11, -22},
                                        .limit_max_counts = {33, 44},
                                        .following_error_counts = {55, 66}};
}

START_TEST(a_drive_is_told_all_that_it_must_do)
{
    static const struct setup_step steps[] = {
        {E, 0x1000, 0, 4, 402, 0xFFFF},
        PRODUCER,
        CONSUMER,
        PDO(0x1400, 0x201, 1, 2, 1, 0x607A0020, 2, 0x00040020, 2, 0x00040020),
        PDO(0x1401, 0x301, 255, 2, 1, 0x60400010, 2, 0x60FE0120, 2, 0x60FE0120),
        PDO(0x1800, 0x40000181, 1, 2, 1, 0x60410010, 2, 0x60640020, 2, 0x60640020),
        PDO(0x1802, 0x40000381, 100, 3, 1, 0x60770010, 2, 0x21000010, 3, 0x60790020),
        {W, 0x6060, 0, 1, 8, ALL},
        {A, 0x6061, 0, 4, 8, 0xFF},
        /* 1 times 10 to the -3 seconds */
        {W, 0x60C2, 1, 1, 1, ALL},
        {W, 0x60C2, 2, 1, 0xFD, ALL},
        REACTIONS,
        {W, 0x6065, 0, 4, 55, ALL},
        {W, 0x6066, 0, 2, 50, ALL},
        {W, 0x607D, 1, 4, 0xFFFFFFF5, ALL},
        {W, 0x607D, 2, 4, 33, ALL},
        {W, 0x60FE, 2, 4, 0x00010000, ALL},
        {W, 0x1400, 5, 2, 50, ALL},
        SCALING};
    start();
    CHECK(DRIVE_LEFT, false, steps);
}
END_TEST

START_TEST(a_makers_drive_with_its_own_target_and_interpolation)
{
    static const struct setup_step steps[] = {
        {E, 0x1000, 0, 4, 402, 0xFFFF},
        PRODUCER,
        CONSUMER,
        PDO(0x1400, 0x202, 1, 1, 1, 0x60C10120, 1, 0x60C10120, 1, 0x60C10120),
        PDO(0x1401, 0x302, 255, 2, 1, 0x60400010, 2, 0x60FE0120, 2, 0x60FE0120),
        PDO(0x1800, 0x182, 1, 2, 1, 0x60410010, 2, 0x60640020, 2, 0x60640020),
        PDO(0x1802, 0x382, 100, 3, 1, 0x60770010, 2, 0x21000010, 3, 0x60790020),
        {W, 0x6060, 0, 1, 7, ALL},
        {A, 0x6061, 0, 4, 7, 0xFF},
        {W, 0x60C2, 1, 1, 1, ALL},
        {W, 0x60C2, 2, 1, 0xFD, ALL},
        REACTIONS,
        {W, 0x6065, 0, 4, 66, ALL},
        {W, 0x6066, 0, 2, 50, ALL},
        {W, 0x607D, 1, 4, 0xFFFFFFEA, ALL},
        {W, 0x607D, 2, 4, 44, ALL},
        {W, 0x60FE, 2, 4, 0x00010000, ALL},
        {W, 0x1400, 5, 2, 50, ALL},
        SCALING,
        /* What it has by CiA 301's connection set, off: 400h, 500h, 280h and 480h plus its number.
         * 1802h is used. */
        {T, 0x1402, 1, 4, 0x80000409, 0},
        {T, 0x1403, 1, 4, 0x80000509, 0},
        {T, 0x1801, 1, 4, 0x80000289, 0},
        {T, 0x1803, 1, 4, 0x80000489, 0}};
    start();
    config.own_target[RIGHT] = config.interpolated[RIGHT] = config.has_others_pdos[RIGHT] = true;
    CHECK(DRIVE_RIGHT, true, steps);
}
END_TEST

START_TEST(both_targets_in_one_frame_leave_the_other_half_alone)
{
    static const struct setup_step right[] = {
        PDO(0x1400, 0x201, 1, 2, 1, 0x00040020, 2, 0x607A0020, 2, 0x607A0020)};
    static const struct setup_step own[] = {
        PDO(0x1400, 0x201, 1, 1, 1, 0x607A0020, 1, 0x607A0020, 1, 0x607A0020)};
    start();
    config.own_target[LEFT] = true;
    for (unsigned i = 0; i < 8; i++) {
        const struct setup_place at_right = {DRIVE_RIGHT, 2, false, (uint16_t)(3 + i)};
        const struct setup_place at_left = {DRIVE_LEFT, 1, false, (uint16_t)(3 + i)};
        const struct setup_step one = setup_step_at(&config, &at_right);
        const struct setup_step other = setup_step_at(&config, &at_left);
        ck_assert_uint_eq(one.index, right[i].index);
        ck_assert_uint_eq(one.value, right[i].value);
        ck_assert_uint_eq(one.sub, right[i].sub);
        ck_assert_uint_eq(other.index, own[i].index);
        ck_assert_uint_eq(other.value, own[i].value);
        ck_assert_uint_eq(other.sub, own[i].sub);
    }
}
END_TEST

START_TEST(what_a_drive_lacks_is_left_alone)
{
    static const struct setup_step steps[] = {
        {E, 0x1000, 0, 4, 402, 0xFFFF},
        PRODUCER,
        PDO(0x1400, 0x201, 1, 2, 1, 0x607A0020, 2, 0x00040020, 2, 0x00040020),
        PDO(0x1401, 0x301, 255, 1, 1, 0x60400010, 1, 0x60400010, 1, 0x60400010),
        PDO(0x1800, 0x40000181, 1, 2, 1, 0x60410010, 2, 0x60640020, 2, 0x60640020),
        {W, 0x6060, 0, 1, 8, ALL},
        {A, 0x6061, 0, 4, 8, 0xFF},
        {T, 0x1402, 1, 4, 0x80000409, 0},
        {T, 0x1403, 1, 4, 0x80000509, 0},
        {T, 0x1801, 1, 4, 0x80000289, 0},
        {T, 0x1803, 1, 4, 0x80000489, 0},
        {T, 0x1802, 1, 4, 0x80000389, 0}};
    start();
    config.lacks[LEFT] = (1u << DEVICE_LACKS_COUNT) - 1;
    config.has_others_pdos[LEFT] = true;
    CHECK(DRIVE_LEFT, false, steps);
}
END_TEST

/* Each thing that is lacking takes its own objects away, and no other. */
START_TEST(one_thing_lacking_takes_its_own_objects_only)
{
    static const struct {
        enum device_lack lack;
        uint16_t gone[6];
        unsigned steps;
    } rows[] = {{DEVICE_LACKS_RPDO_TIMER, {0}, 1},
                {DEVICE_LACKS_OPTION_CODES, {0x605A, 0x605B, 0x605C, 0x605E}, 4},
                {DEVICE_LACKS_RATED_TORQUE, {0x6076}, 1},
                {DEVICE_LACKS_SCALING, {0x608F, 0x6091, 0x6092}, 6},
                {DEVICE_LACKS_ABORT_OPTION, {0x6007}, 1},
                {DEVICE_LACKS_FOLLOWING_TIME, {0x6066}, 1},
                {DEVICE_LACKS_FOLLOWING_WINDOW, {0x6065}, 1},
                {DEVICE_LACKS_OUTPUT_MASK, {0}, 1},
                {DEVICE_LACKS_HEARTBEAT_CONSUMER, {0x1016}, 1},
                {DEVICE_LACKS_MAX_SPEED, {0x6080}, 1},
                {DEVICE_LACKS_POSITION_LIMITS, {0x607D}, 2},
                {DEVICE_LACKS_INTERPOLATION, {0x60C2}, 2}};
    enum { FULL = 58 };
    for (unsigned row = 0; row < sizeof rows / sizeof rows[0]; row++) {
        unsigned steps = 0;
        start();
        config.lacks[RIGHT] = 1u << rows[row].lack;
        for (unsigned at = 0; at < STEPS_MOST; at++) {
            const struct setup_place place = {DRIVE_RIGHT, 2, false, (uint16_t)at};
            const struct setup_step step = setup_step_at(&config, &place);
            if (step.kind == STEP_END) {
                break;
            }
            steps += step.kind != STEP_SKIP;
            for (unsigned i = 0; step.kind != STEP_SKIP && i < 6 && rows[row].gone[i] != 0; i++) {
                ck_assert_uint_ne(step.index, rows[row].gone[i]);
            }
        }
        ck_assert_uint_eq(steps, FULL - rows[row].steps);
        /* It is that leg's only. */
        ck_assert(!setup_lacks(&config, SIDE_LEFT, rows[row].lack));
        ck_assert(setup_lacks(&config, SIDE_RIGHT, rows[row].lack));
    }
}
END_TEST

/* The slow PDO has what is there, in this order. */
START_TEST(the_slow_values_close_up)
{
    static const struct {
        enum device_lack lack;
        uint32_t map[2];
    } rows[] = {{DEVICE_LACKS_TORQUE, {0x21000010, 0x60790020}},
                {DEVICE_LACKS_TEMPERATURE, {0x60770010, 0x60790020}},
                {DEVICE_LACKS_BUS_VOLTAGE, {0x60770010, 0x21000010}}};
    for (unsigned row = 0; row < 3; row++) {
        start();
        config.lacks[LEFT] = 1u << rows[row].lack;
        const struct setup_step wanted[] = {PDO(0x1802, 0x40000381, 100, 2, 1, rows[row].map[0], 2,
                                                rows[row].map[1], 2, rows[row].map[1])};
        for (unsigned i = 0; i < 8; i++) {
            const struct setup_place place = {DRIVE_LEFT, 1, false, (uint16_t)(27 + i)};
            const struct setup_step step = setup_step_at(&config, &place);
            ck_assert_uint_eq(step.index, wanted[i].index);
            ck_assert_uint_eq(step.sub, wanted[i].sub);
            ck_assert_uint_eq(step.value, wanted[i].value);
        }
    }
}
END_TEST

START_TEST(a_leg_sensor_is_asked_what_it_is)
{
    static const struct setup_step left[] = {
        {E, 0x1000, 0, 4, 406, 0xFFFF},
        PRODUCER,
        CONSUMER,
        PDO(0x1801, 0x40000283, 1, 2, 1, 0x20200118, 2, 0x20200210, 2, 0x20200210),
        {E, 0x6001, 0, 4, 0x01000000, ALL},
        {E, 0x2021, 0, 4, 0, 0xFF},
        {A, 0x6503, 0, 4, 0, 0xFFFF}};
    static const struct setup_step lever[] = {
        {E, 0x1000, 0, 4, 406, 0xFFFF},
        PRODUCER,
        CONSUMER,
        PDO(0x1801, 0x284, 1, 2, 1, 0x20200118, 2, 0x20200210, 2, 0x20200210),
        {E, 0x6001, 0, 4, 0x01000000, ALL},
        {E, 0x2021, 0, 4, 1, 0xFF},
        {A, 0x6503, 0, 4, 0, 0xFFFF},
        {T, 0x1800, 1, 4, 0x80000189, 0},
        {T, 0x1802, 1, 4, 0x80000389, 0}};
    start();
    CHECK(SENSOR_LEFT, false, left);
    config.ankle_is_lever[RIGHT] = config.sensor_has_others_pdos[RIGHT] = true;
    CHECK(SENSOR_RIGHT, true, lever);
}
END_TEST

START_TEST(a_makers_leg_sensor_has_its_own_objects)
{
    static const struct setup_step steps[] = {
        {E, 0x1000, 0, 4, 406, 0xFFFF},
        PRODUCER,
        CONSUMER,
        PDO(0x1801, 0x40000284, 1, 2, 1, 0x60000120, 2, 0x60000208, 2, 0x60000208),
        {E, 0x6001, 0, 4, 4096, ALL},
        {A, 0x6503, 0, 4, 0, 0xFFFF},
        {T, 0x1800, 1, 4, 0x80000189, 0},
        {T, 0x1802, 1, 4, 0x80000389, 0},
        {T, 0x1802, 1, 4, 0x384, 0}};
    start();
    config.sensor_has_others_pdos[RIGHT] = config.foot_switch[RIGHT] = true;
    config.leg_object[RIGHT] = 0x600001;
    config.leg_bits[RIGHT] = 32;
    config.ankle_object[RIGHT] = 0x600002;
    config.ankle_bits[RIGHT] = 8;
    config.leg_counts_per_turn[RIGHT] = 4096;
    CHECK(SENSOR_RIGHT, false, steps);
    config.foot_switch[LEFT] = config.sensor_has_others_pdos[LEFT] = true;
    const struct setup_place place = {SENSOR_LEFT, 3, false, 16};
    ck_assert_uint_eq(setup_step_at(&config, &place).value, 0x383);
}
END_TEST

START_TEST(a_latch_board_hears_the_latch_and_tells_where_it_can)
{
    static const struct setup_step silent[] = {
        PRODUCER, CONSUMER,
        PDO(0x1400, 0x303, 255, 1, 1, 0x60FE0120, 1, 0x60FE0120, 1, 0x60FE0120)};
    static const struct setup_step telling[] = {
        PRODUCER,
        CONSUMER,
        PDO(0x1400, 0x304, 255, 1, 1, 0x60FE0120, 1, 0x60FE0120, 1, 0x60FE0120),
        {W, 0x1800, 5, 2, 100, ALL},
        PDO(0x1800, 0x40000386, 255, 1, 1, 0x60000108, 1, 0x60000108, 1, 0x60000108)};
    start();
    config.latch_object[RIGHT] = 0x600001;
    CHECK(BOARD_LEFT, false, silent);
    CHECK(BOARD_RIGHT, false, telling);
    config.latch_object[LEFT] = 0x600001;
    const struct setup_place place = {BOARD_LEFT, 5, true, 19};
    ck_assert_uint_eq(setup_step_at(&config, &place).value, 0x385);
}
END_TEST

/* An ankle sensor on a node of its own: one entry in its frame, and what else it may send is switched off. */
START_TEST(an_ankle_sensor_of_its_own_is_asked_what_it_is)
{
    static const struct setup_step left[] = {
        {E, 0x1000, 0, 4, 406, 0xFFFF},
        PRODUCER,
        CONSUMER,
        PDO(0x1801, 0x40000287, 1, 1, 1, 0x20200210, 1, 0x20200210, 1, 0x20200210),
        {E, 0x2021, 0, 4, 0, 0xFF},
        {A, 0x6503, 0, 4, 0, 0xFFFF},
        {T, 0x1800, 1, 4, 0x80000189, 0},
        {T, 0x1802, 1, 4, 0x80000389, 0}};
    static const struct setup_step makers[] = {
        {E, 0x1000, 0, 4, 406, 0xFFFF},
        PRODUCER,
        CONSUMER,
        PDO(0x1801, 0x288, 1, 1, 1, 0x60040020, 1, 0x60040020, 1, 0x60040020),
        {A, 0x6503, 0, 4, 0, 0xFFFF},
        {T, 0x1800, 1, 4, 0x80000189, 0},
        {T, 0x1802, 1, 4, 0x80000389, 0}};
    start();
    CHECK(NETWORK_ANKLE_LEFT, false, left);
    config.ankle_object[RIGHT] = 0x600400;
    config.ankle_bits[RIGHT] = 32;
    CHECK(NETWORK_ANKLE_RIGHT, true, makers);
}
END_TEST

int main(void)
{
    TCase *tests = tcase_create("setup_steps");
    tcase_add_test(tests, a_drive_is_told_all_that_it_must_do);
    tcase_add_test(tests, a_makers_drive_with_its_own_target_and_interpolation);
    tcase_add_test(tests, both_targets_in_one_frame_leave_the_other_half_alone);
    tcase_add_test(tests, what_a_drive_lacks_is_left_alone);
    tcase_add_test(tests, one_thing_lacking_takes_its_own_objects_only);
    tcase_add_test(tests, the_slow_values_close_up);
    tcase_add_test(tests, a_leg_sensor_is_asked_what_it_is);
    tcase_add_test(tests, a_makers_leg_sensor_has_its_own_objects);
    tcase_add_test(tests, a_latch_board_hears_the_latch_and_tells_where_it_can);
    Suite *suite = suite_create("setup_steps");
    tcase_add_test(tests, an_ankle_sensor_of_its_own_is_asked_what_it_is);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
