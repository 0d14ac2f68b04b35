/* Each check of the sensors and drives: what trips it, after how long, and what does not. */
#include "controller/screening/tick_count.h"
#include "tests/support/checks_rig.h"

START_TEST(nothing_is_wrong)
{
    struct rig rig;
    enum supervisor_fault fault;
    start(&rig, SUPERVISOR_WALKING);
    ck_assert_int_eq(ticks_until(&rig, 500, true, &fault), 500);
    ck_assert_int_eq(fault, SUPERVISOR_FAULT_NONE);
}
END_TEST

START_TEST(wrong_at_once)
{
    struct rig rig;
    const real nan = (real)(__builtin_nanf(""));
    warm_up(&rig, SUPERVISOR_WALKING);
    const struct rig well = rig;
#define AT_ONCE(change, fault) \
    rig = well;                \
    change;                    \
    ck_assert_int_eq(tick(&rig), fault)
    AT_ONCE(rig.input.emergency_stop = true, SUPERVISOR_FAULT_EMERGENCY_STOP);
    AT_ONCE(rig.input.nodes_operational = false, SUPERVISOR_FAULT_NODE_LOST);
    AT_ONCE(rig.input.foreign_node = true, SUPERVISOR_FAULT_FOREIGN);
    AT_ONCE(rig.input.node_written = true, SUPERVISOR_FAULT_NODE_WRITTEN);
    AT_ONCE(rig.input.node_changed = true, SUPERVISOR_FAULT_NODE_CHANGED);
    AT_ONCE(rig.input.parameters_corrupt = true, SUPERVISOR_FAULT_PARAMETERS);
    AT_ONCE(rig.input.desired_speed_rad_s = nan, SUPERVISOR_FAULT_NOT_FINITE);
    for (int side = 0; side < SIDE_COUNT; side++) {
        AT_ONCE(rig.input.leg[side].age_ticks = 11, SUPERVISOR_FAULT_SENSOR_STALE);
        AT_ONCE(rig.input.leg[side].age_ticks = 10, SUPERVISOR_FAULT_NONE);
        AT_ONCE(rig.input.sea[side].age_ticks = 11, SUPERVISOR_FAULT_DRIVE_STALE);
        AT_ONCE(rig.input.sea[side].age_ticks = 10, SUPERVISOR_FAULT_NONE);
        AT_ONCE(rig.input.sea[side].force_age_ticks = 351, SUPERVISOR_FAULT_DRIVE_STALE);
        AT_ONCE(rig.input.sea[side].force_age_ticks = AGE_NEVER, SUPERVISOR_FAULT_NONE);
        AT_ONCE(rig.input.leg[side].leg_angle_rad = nan, SUPERVISOR_FAULT_NOT_FINITE);
        AT_ONCE(rig.input.leg[side].ankle_extension_m = nan, SUPERVISOR_FAULT_NOT_FINITE);
        AT_ONCE(rig.input.sea[side].precompression_m = nan, SUPERVISOR_FAULT_NOT_FINITE);
        AT_ONCE(rig.input.sea[side].force_N = nan, SUPERVISOR_FAULT_NOT_FINITE);
        AT_ONCE(rig.input.sea[side].state = DRIVE_FAULT, SUPERVISOR_FAULT_DRIVE);
        AT_ONCE(rig.input.sea[side].state = DRIVE_STOPPING, SUPERVISOR_FAULT_DRIVE);
    }
#undef AT_ONCE
    /* A drive that reports a fault is one, whether it has torque or not. */
    for (int side = 0; side < SIDE_COUNT; side++) {
        warm_up(&rig, SUPERVISOR_STANDBY);
        rig.input.sea[side].state = DRIVE_FAULT;
        ck_assert_int_eq(tick(&rig), SUPERVISOR_FAULT_DRIVE);
    }
}
END_TEST

/* First samples are accepted whatever they are: then the range decides. */
START_TEST(out_of_range)
{
    static const struct {
        real angle, extension, motor;
        enum supervisor_fault fault;
    } cases[] = {
        {REAL(1.19), REAL(0.0), REAL(0.0), SUPERVISOR_FAULT_NONE},
        {REAL(1.21), REAL(0.0), REAL(0.0), SUPERVISOR_FAULT_FALL},
        {REAL(-1.21), REAL(0.0), REAL(0.0), SUPERVISOR_FAULT_FALL},
        {REAL(3.2), REAL(0.0), REAL(0.0), SUPERVISOR_FAULT_SENSOR_RANGE},
        {REAL(0.0), REAL(-0.019), REAL(0.0), SUPERVISOR_FAULT_NONE},
        {REAL(0.0), REAL(-0.021), REAL(0.0), SUPERVISOR_FAULT_SENSOR_RANGE},
        {REAL(0.0), REAL(0.49), REAL(0.0), SUPERVISOR_FAULT_NONE},
        {REAL(0.0), REAL(0.51), REAL(0.0), SUPERVISOR_FAULT_SENSOR_RANGE},
        {REAL(0.0), REAL(0.0), REAL(-0.051), SUPERVISOR_FAULT_SENSOR_RANGE},
        {REAL(0.0), REAL(0.0), REAL(0.39), SUPERVISOR_FAULT_NONE},
        {REAL(0.0), REAL(0.0), REAL(0.41), SUPERVISOR_FAULT_SENSOR_RANGE},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        for (int side = 0; side < SIDE_COUNT; side++) {
            struct rig rig;
            start(&rig, SUPERVISOR_WALKING);
            rig.input.leg[side].leg_angle_rad = cases[i].angle;
            rig.input.leg[side].ankle_extension_m = cases[i].extension;
            rig.input.sea[side].precompression_m = cases[i].motor;
            ck_assert_msg(tick(&rig) == cases[i].fault, "case %zu", i);
        }
    }
}
END_TEST

/* Lying down is no fall while nothing is powered. */
START_TEST(a_fall_counts_while_powered)
{
    struct rig rig;
    start(&rig, SUPERVISOR_STANDBY);
    rig.input.leg[SIDE_LEFT].leg_angle_rad = REAL(1.5);
    ck_assert_int_eq(tick(&rig), SUPERVISOR_FAULT_NONE);
}
END_TEST

START_TEST(a_lasting_jump_is_a_fault_while_walking)
{
    struct rig rig;
    warm_up(&rig, SUPERVISOR_WALKING);
    rig.input.leg[SIDE_LEFT].leg_angle_rad -= REAL(0.6);
    expect(&rig, SUPERVISOR_FAULT_SENSOR_RATE, 11, 11, true);
    warm_up(&rig, SUPERVISOR_WALKING);
    rig.input.leg[SIDE_RIGHT].ankle_extension_m = REAL(0.45);
    expect(&rig, SUPERVISOR_FAULT_SENSOR_RATE, 11, 11, true);
    warm_up(&rig, SUPERVISOR_WALKING);
    rig.input.sea[SIDE_RIGHT].precompression_m = REAL(0.2);
    expect(&rig, SUPERVISOR_FAULT_SENSOR_RATE, 11, 11, true);
    warm_up(&rig,
            SUPERVISOR_WALKING); /* a motor encoder by less than a motor could go in that time */
    rig.input.sea[SIDE_LEFT].precompression_m += REAL(0.017);
    expect(&rig, SUPERVISOR_FAULT_SENSOR_RATE, 11, 11, true);
    /* Somebody puts it on: accepted in the end. */
    enum supervisor_fault fault;
    warm_up(&rig, SUPERVISOR_STANDBY);
    rig.input.leg[SIDE_LEFT].leg_angle_rad -= REAL(0.6);
    ck_assert_int_eq(ticks_until(&rig, 300, true, &fault), 300);
}
END_TEST

/* A spring is still loaded then: what the sensors say of it counts as much as before. */
START_TEST(a_lasting_jump_is_a_fault_while_unloading)
{
    struct rig rig;
    warm_up(&rig, SUPERVISOR_UNLOADING);
    rig.input.leg[SIDE_LEFT].leg_angle_rad -= REAL(0.6);
    expect(&rig, SUPERVISOR_FAULT_SENSOR_RATE, 11, 11, true);
    warm_up(&rig, SUPERVISOR_UNLOADING);
    rig.input.sea[SIDE_RIGHT].precompression_m = REAL(0.2);
    expect(&rig, SUPERVISOR_FAULT_SENSOR_RATE, 11, 11, true);
}
END_TEST

START_TEST(a_stuck_angle)
{
    struct rig rig;
    enum supervisor_fault fault = SUPERVISOR_FAULT_NONE;
    warm_up(&rig, SUPERVISOR_WALKING);
    int ticks = 0;
    for (; ticks < 300 && fault == SUPERVISOR_FAULT_NONE; ticks++) {
        rig.input.leg[SIDE_RIGHT].leg_angle_rad -= REAL(0.001);
        fault = tick(&rig);
    }
    ck_assert_int_eq(fault, SUPERVISOR_FAULT_SENSOR_STUCK);
    ck_assert_int_ge(ticks, 100);
    ck_assert_int_le(ticks, 103);
    warm_up(&rig, SUPERVISOR_WALKING); /* standing still is no stuck sensor */
    ck_assert_int_eq(ticks_until(&rig, 1000, false, &fault), 1000);
}
END_TEST

START_TEST(force_against_spring)
{
    static const struct {
        real force_N;
        enum supervisor_fault fault;
    } cases[] = {
        {REAL(10.0), SUPERVISOR_FAULT_NONE},  {REAL(13.0), SUPERVISOR_FAULT_NONE},
        {REAL(7.0), SUPERVISOR_FAULT_NONE},   {REAL(0.0), SUPERVISOR_FAULT_SPRING},
        {REAL(5.9), SUPERVISOR_FAULT_SPRING}, {REAL(14.0), SUPERVISOR_FAULT_SPRING},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct rig rig;
        start(&rig, SUPERVISOR_WALKING);
        load(&rig, REAL(0.1), cases[i].force_N);
        ck_assert_msg(two_force_samples(&rig) == cases[i].fault, "%g N", (double)cases[i].force_N);
        if (cases[i].fault != SUPERVISOR_FAULT_NONE) { /* not where the force is another's */
            start(&rig, SUPERVISOR_WALKING);
            load(&rig, REAL(0.1), cases[i].force_N);
            rig.input.sea[SIDE_LEFT].latch = LATCH_UNKNOWN;
            rig.input.sea[SIDE_RIGHT].latch = LATCH_UNKNOWN;
            ck_assert_int_eq(two_force_samples(&rig), SUPERVISOR_FAULT_NONE);
        }
    }
}
END_TEST

/* Commissioning has bounds of its own, and what it did says nothing of a walk. */
START_TEST(force_against_spring_is_not_judged_at_commissioning)
{
    struct rig rig;
    start(&rig, SUPERVISOR_COMMISSIONING);
    load(&rig, REAL(0.1), REAL(0.0));
    ck_assert_int_eq(two_force_samples(&rig), SUPERVISOR_FAULT_NONE);
    rig.state = SUPERVISOR_UNLOADING;
    ck_assert_int_eq(tick(&rig), SUPERVISOR_FAULT_NONE);
}
END_TEST

/* At a person's ankle there is less room above: 15 %, and 4 mm of spring a metre of leg. Below it is as ever. */
START_TEST(a_person_s_spring_may_be_little_stronger_than_it_should)
{
    static const struct {
        real force_N;
        enum supervisor_fault fault;
    } cases[] = {{REAL(10.0), SUPERVISOR_FAULT_NONE},   {REAL(11.8), SUPERVISOR_FAULT_NONE},
                 {REAL(12.1), SUPERVISOR_FAULT_SPRING}, {REAL(13.8), SUPERVISOR_FAULT_SPRING},
                 {REAL(7.0), SUPERVISOR_FAULT_NONE},    {REAL(5.9), SUPERVISOR_FAULT_SPRING}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct rig rig;
        start(&rig, SUPERVISOR_WALKING);
        rig.params.body = (real)BODY_PERSON;
        load(&rig, REAL(0.1), cases[i].force_N);
        ck_assert_msg(two_force_samples(&rig) == cases[i].fault, "%g N", (double)cases[i].force_N);
    }
}
END_TEST

/* A spring that stays unexplained stays a fault, however long that lasts: the count ends at its
 * limit. Force samples in every tick, 600 of them. */
START_TEST(a_wrong_force_is_never_forgotten)
{
    struct rig rig;
    enum supervisor_fault fault;
    start(&rig, SUPERVISOR_UNLOADING);
    load(&rig, REAL(0.1), REAL(0.0));
    for (int side = 0; side < SIDE_COUNT; side++) {
        rig.input.sea[side].force_age_ticks = 0;
    }
    ck_assert_int_lt(ticks_until(&rig, 300, true, &fault), 300);
    for (int i = 0; i < 600; i++) {
        swing(&rig);
        ck_assert_int_eq(tick(&rig), fault);
    }
    ck_assert_int_eq(fault, SUPERVISOR_FAULT_SPRING);
}
END_TEST

START_TEST(ankle_against_latch)
{
    struct rig rig;
    enum supervisor_fault fault;
    warm_up(&rig, SUPERVISOR_WALKING);
    rig.input.leg[SIDE_LEFT].ankle_extension_m = REAL(0.021);
    expect(&rig, SUPERVISOR_FAULT_SPRING, 21, 21, true);
    warm_up(&rig, SUPERVISOR_WALKING); /* somebody with a push-off of their own may */
    rig.params.engage_steps = REAL(4.0);
    rig.input.leg[SIDE_LEFT].ankle_extension_m = REAL(0.021);
    ck_assert_int_eq(ticks_until(&rig, 300, true, &fault), 300);
    warm_up(&rig, SUPERVISOR_WALKING); /* so may a person */
    rig.params.body = (real)BODY_PERSON;
    rig.input.leg[SIDE_LEFT].ankle_extension_m = REAL(0.021);
    ck_assert_int_eq(ticks_until(&rig, 300, true, &fault), 300);
}
END_TEST

/* A latch that has just closed leaves the ankle 20 ms to come back before it counts, and then 21 ticks as always. */
START_TEST(an_ankle_may_come_back_behind_a_latch_that_closes)
{
    struct rig rig;
    start(&rig, SUPERVISOR_WALKING);
    rig.command[SIDE_LEFT].latch_armed = true;
    rig.input.sea[SIDE_LEFT].latch = LATCH_OPEN;
    enum supervisor_fault fault;
    ck_assert_int_eq(ticks_until(&rig, 50, true, &fault), 50);
    rig.input.sea[SIDE_LEFT].latch = LATCH_CLOSED;
    rig.input.leg[SIDE_LEFT].ankle_extension_m = REAL(0.021);
    expect(&rig, SUPERVISOR_FAULT_SPRING, 42, 42, true);
}
END_TEST

/* The largest number of 16 bits means "never heard": no count comes to it, and none begins again. */
START_TEST(a_count_of_ticks_stops_below_never)
{
    ck_assert_uint_eq(count_up(0), 1);
    ck_assert_uint_eq(count_up(65533), 65534);
    ck_assert_uint_eq(count_up(65534), 65534);
    ck_assert_uint_eq(count_up(AGE_NEVER), AGE_NEVER);
    ck_assert_uint_eq(count_while(7, true), 8);
    ck_assert_uint_eq(count_while(7, false), 0);
}
END_TEST

START_TEST(a_released_spring_must_move_the_ankle)
{
    struct rig rig;
    enum supervisor_fault fault;
    start(&rig, SUPERVISOR_WALKING);
    load(&rig, REAL(0.1), REAL(10.0));
    rig.command[SIDE_LEFT].latch_armed = true;
    ck_assert_int_eq(ticks_until(&rig, 50, true, &fault), 50);
    rig.input.sea[SIDE_LEFT].latch = LATCH_OPEN;
    expect(&rig, SUPERVISOR_FAULT_SPRING, 102, 102, true);
    start(&rig, SUPERVISOR_WALKING); /* it does */
    load(&rig, REAL(0.1), REAL(10.0));
    rig.command[SIDE_LEFT].latch_armed = true;
    ck_assert_int_eq(ticks_until(&rig, 50, true, &fault), 50);
    rig.input.sea[SIDE_LEFT].latch = LATCH_OPEN;
    for (int i = 0; i < 300; i++) {
        swing(&rig);
        rig.input.leg[SIDE_LEFT].ankle_extension_m =
            REAL(0.1) * (real)(i < 200 ? i : 200) / REAL(200.0);
        ck_assert_int_eq(tick(&rig), SUPERVISOR_FAULT_NONE);
    }
    rig.input.leg[SIDE_LEFT].ankle_extension_m = REAL(0.121); /* beyond its motor */
    expect(&rig, SUPERVISOR_FAULT_SPRING, 21, 21, true);
}
END_TEST

START_TEST(a_latch_opens_only_when_armed)
{
    struct rig rig;
    enum supervisor_fault fault;
    start(&rig, SUPERVISOR_WALKING); /* by itself */
    load(&rig, REAL(0.1), REAL(10.0));
    ck_assert_int_eq(ticks_until(&rig, 50, true, &fault), 50);
    rig.input.sea[SIDE_LEFT].latch = LATCH_OPEN;
    expect(&rig, SUPERVISOR_FAULT_SPRING, 1, 1, true);
    for (int i = 0; i < 5; i++) { /* and it stays one while the latch is open */
        swing(&rig);
        ck_assert_int_eq(tick(&rig), SUPERVISOR_FAULT_SPRING);
    }
    start(&rig, SUPERVISOR_WALKING); /* as it was disarmed: the release was under way */
    load(&rig, REAL(0.1), REAL(10.0));
    rig.command[SIDE_LEFT].latch_armed = true;
    ck_assert_int_eq(ticks_until(&rig, 50, true, &fault), 50);
    rig.command[SIDE_LEFT].latch_armed = false;
    ck_assert_int_eq(ticks_until(&rig, 8, true, &fault), 8);
    rig.input.sea[SIDE_LEFT].latch = LATCH_OPEN;
    ck_assert_int_eq(ticks_until(&rig, 20, true, &fault), 20);
}
END_TEST

START_TEST(a_person_s_latch_closes_behind_an_empty_spring)
{
    struct rig rig;
    enum supervisor_fault fault;
    start(&rig, SUPERVISOR_WALKING);
    rig.params.body = (real)BODY_PERSON;
    rig.command[SIDE_LEFT].latch_armed = true;
    ck_assert_int_eq(ticks_until(&rig, 20, true, &fault), 20);
    rig.input.sea[SIDE_LEFT].latch = LATCH_OPEN;
    rig.input.sea[SIDE_LEFT].precompression_m = REAL(0.0004); /* on its way back */
    ck_assert_int_eq(ticks_until(&rig, 50, true, &fault), 50);
    rig.input.sea[SIDE_LEFT].precompression_m = REAL(0.0);
    expect(&rig, SUPERVISOR_FAULT_SPRING, 11, 11, true);
}
END_TEST

/* 25 and 250 ticks, one more than that, and four that a command takes to the drive and back. */
START_TEST(following_error)
{
    struct rig rig;
    warm_up(&rig, SUPERVISOR_WALKING);
    rig.command[SIDE_LEFT].precompression_m = REAL(0.101);
    expect(&rig, SUPERVISOR_FAULT_FOLLOWING, 30, 30, true);
    warm_up(&rig, SUPERVISOR_WALKING);
    rig.command[SIDE_RIGHT].precompression_m = REAL(0.011);
    expect(&rig, SUPERVISOR_FAULT_FOLLOWING, 255, 255, true);
    enum supervisor_fault fault;
    warm_up(&rig, SUPERVISOR_WALKING);
    rig.command[SIDE_RIGHT].precompression_m = REAL(0.009);
    ck_assert_int_eq(ticks_until(&rig, 600, true, &fault), 600);
}
END_TEST

START_TEST(drives_that_disobey)
{
    struct rig rig;
    start(&rig, SUPERVISOR_ENGAGING); /* never comes */
    rig.input.sea[SIDE_LEFT].state = DRIVE_STARTING;
    expect(&rig, SUPERVISOR_FAULT_DRIVE, 501, 501, true);
    start(&rig, SUPERVISOR_STANDBY); /* never goes */
    rig.input.sea[SIDE_RIGHT].state = DRIVE_ENABLED;
    expect(&rig, SUPERVISOR_FAULT_DRIVE, 1001, 1001, true);
    warm_up(&rig, SUPERVISOR_ENGAGING); /* was there, and left */
    rig.input.sea[SIDE_RIGHT].state = DRIVE_DISABLED;
    expect(&rig, SUPERVISOR_FAULT_DRIVE, 1, 1, true);
}
END_TEST

START_TEST(standstill_and_slack)
{
    struct rig rig;
    enum supervisor_fault fault;
    start(&rig, SUPERVISOR_STANDBY);
    (void)ticks_until(&rig, 499, false, &fault);
    ck_assert(!checks_standstill(&rig.checks));
    (void)ticks_until(&rig, 5, false, &fault);
    ck_assert(checks_standstill(&rig.checks));
    (void)ticks_until(&rig, 25, true, &fault);
    ck_assert(!checks_standstill(&rig.checks));
    ck_assert(checks_springs_slack(&rig.params, &rig.input));
    rig.input.sea[SIDE_LEFT].precompression_m = REAL(0.0011);
    ck_assert(!checks_springs_slack(&rig.params, &rig.input));
    rig.input.sea[SIDE_LEFT].precompression_m = REAL(0.0);
    rig.input.sea[SIDE_RIGHT].age_ticks = 1; /* not known now */
    ck_assert(!checks_springs_slack(&rig.params, &rig.input));
}
END_TEST

/* Legs of a person: swinging legs lean by turns, a sitting person's to one side. */
START_TEST(who_sits_lies_or_hangs_is_not_upright)
{
    struct rig rig;
    start(&rig, SUPERVISOR_STANDBY);
    rig.params.body = (real)BODY_PERSON;
    rig.input.leg[SIDE_LEFT].foot = rig.input.leg[SIDE_RIGHT].foot = FOOT_DOWN;
    rig.input.leg[SIDE_LEFT].leg_angle_rad = REAL(0.7);
    rig.input.leg[SIDE_RIGHT].leg_angle_rad = REAL(-0.3); /* a long step: 0.2 on average */
    for (int i = 0; i < 1000; i++) {
        (void)tick(&rig);
    }
    ck_assert(checks_upright(&rig.checks));
    for (int side = 0; side < SIDE_COUNT; side++) { /* thighs level, shanks upright */
        rig.input.leg[side].leg_angle_rad = REAL(0.785);
    }
    for (int i = 0; i < 600; i++) {
        (void)tick(&rig);
    }
    ck_assert(!checks_upright(&rig.checks));
    for (int side = 0; side < SIDE_COUNT; side++) {
        rig.input.leg[side].leg_angle_rad = REAL(-0.6); /* on the face */
    }
    for (int i = 0; i < 600; i++) {
        (void)tick(&rig);
    }
    ck_assert(!checks_upright(&rig.checks));
    for (int side = 0; side < SIDE_COUNT; side++) {
        rig.input.leg[side].leg_angle_rad = REAL(0.0);
    }
    for (int i = 0; i < 600; i++) {
        (void)tick(&rig);
    }
    for (int side = 0; side < SIDE_COUNT; side++) {
        rig.input.leg[side].foot = FOOT_UP; /* in a harness */
    }
    for (int i = 0; i < 490; i++) {
        (void)tick(&rig);
    }
    ck_assert(checks_upright(&rig.checks)); /* so long nobody knows */
    for (int i = 0; i < 30; i++) {
        (void)tick(&rig);
    }
    ck_assert(!checks_upright(&rig.checks));
    for (int side = 0; side < SIDE_COUNT; side++) { /* one foot in the air is a stance */
        rig.input.leg[side].foot = FOOT_DOWN;
        rig.input.leg[1 - side].foot = FOOT_UP;
        (void)tick(&rig);
        ck_assert(checks_upright(&rig.checks));
        for (int i = 0; i < 600; i++) {
            (void)tick(&rig);
        }
        ck_assert(checks_upright(&rig.checks));
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("checks");
    TCase *tests = tcase_create("all");
    tcase_add_test(tests, nothing_is_wrong);
    tcase_add_test(tests, wrong_at_once);
    tcase_add_test(tests, out_of_range);
    tcase_add_test(tests, a_fall_counts_while_powered);
    tcase_add_test(tests, a_lasting_jump_is_a_fault_while_walking);
    tcase_add_test(tests, a_stuck_angle);
    tcase_add_test(tests, force_against_spring_is_not_judged_at_commissioning);
    tcase_add_test(tests, force_against_spring);
    tcase_add_test(tests, a_person_s_spring_may_be_little_stronger_than_it_should);
    tcase_add_test(tests, a_wrong_force_is_never_forgotten);
    tcase_add_test(tests, ankle_against_latch);
    tcase_add_test(tests, an_ankle_may_come_back_behind_a_latch_that_closes);
    tcase_add_test(tests, a_count_of_ticks_stops_below_never);
    tcase_add_test(tests, a_released_spring_must_move_the_ankle);
    tcase_add_test(tests, a_latch_opens_only_when_armed);
    tcase_add_test(tests, a_person_s_latch_closes_behind_an_empty_spring);
    tcase_add_test(tests, following_error);
    tcase_add_test(tests, drives_that_disobey);
    tcase_add_test(tests, standstill_and_slack);
    tcase_add_test(tests, who_sits_lies_or_hangs_is_not_upright);
    tcase_add_test(tests, a_lasting_jump_is_a_fault_while_unloading);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
