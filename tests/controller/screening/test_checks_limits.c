/* Every limit of the checks from both sides, in value and in ticks: the numbers are those of the comments
 * beside the limits, and of a leg of 1 m at 1 ms a tick. */
#include "tests/support/checks_rig.h"

static struct rig rig;
static enum supervisor_fault fault;

static void expect_none(int count, bool swinging)
{
    ck_assert_int_eq(ticks_until(&rig, count, swinging, &fault), count);
    ck_assert_msg(fault == SUPERVISOR_FAULT_NONE, "%s", supervisor_fault_name(fault));
}

/* ---- posture and standstill --------------------------------------------------------------- */

static void stand(enum body_kind body)
{
    start(&rig, SUPERVISOR_STANDBY);
    rig.params.body = (real)body;
    rig.input.leg[SIDE_LEFT].foot = rig.input.leg[SIDE_RIGHT].foot = FOOT_DOWN;
}

static bool upright_after(int count)
{
    for (int i = 0; i < count; i++) {
        (void)tick(&rig);
    }
    return checks_upright(&rig.checks);
}

static void lean(double left_rad, double right_rad)
{
    rig.input.leg[SIDE_LEFT].leg_angle_rad = (real)left_rad;
    rig.input.leg[SIDE_RIGHT].leg_angle_rad = (real)right_rad;
}

/* Beyond 0.45 rad in the mean of both legs, to either side, for 200 ms. */
START_TEST(who_leans_is_not_upright_after_200_ms)
{
    static const struct {
        double left_rad, right_rad;
        bool tilted;
    } cases[] = {{0.46, 0.46, true},    {-0.46, -0.46, true}, {0.44, 0.44, false},
                 {-0.44, -0.44, false}, {0.90, 0.02, true},   {-0.02, -0.90, true},
                 {0.86, 0.02, false},   {0.9, -0.9, false}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        stand(BODY_PERSON);
        lean(cases[i].left_rad, cases[i].right_rad);
        ck_assert(upright_after(199));
        ck_assert_msg(upright_after(1) != cases[i].tilted, "case %zu", i);
        ck_assert(upright_after(400) != cases[i].tilted);
    }
    stand(BODY_PERSON);
    lean(0.46, 0.46);
    ck_assert(upright_after(199));
    lean(0.44, 0.44); /* for one tick: from the start again */
    ck_assert(upright_after(1));
    lean(0.46, 0.46);
    ck_assert(upright_after(199));
    ck_assert(!upright_after(1));
    lean(0.44, 0.44);
    ck_assert(upright_after(1));
}
END_TEST

/* Both feet in the air for 500 ms; a switch that does not know says nothing. */
START_TEST(who_hangs_is_not_upright_after_500_ms)
{
    stand(BODY_PERSON);
    rig.input.leg[SIDE_LEFT].foot = rig.input.leg[SIDE_RIGHT].foot = FOOT_UP;
    ck_assert(upright_after(499));
    ck_assert(!upright_after(1));
    rig.input.leg[SIDE_RIGHT].foot = FOOT_UNKNOWN;
    ck_assert(upright_after(1));
    ck_assert(upright_after(1000));
}
END_TEST

START_TEST(a_compass_is_always_upright)
{
    stand(BODY_COMPASS);
    lean(0.46, 0.46);
    rig.input.leg[SIDE_LEFT].foot = rig.input.leg[SIDE_RIGHT].foot = FOOT_UP;
    ck_assert(upright_after(1000));
}
END_TEST

static bool stands_after(int count)
{
    for (int i = 0; i < count; i++) {
        (void)tick(&rig);
    }
    return checks_standstill(&rig.checks);
}

/* Within 0.02 rad of where it was for 500 ms: either leg, to either side, and by however many small moves. */
START_TEST(who_moves_by_more_than_0_02_rad_does_not_stand)
{
    start(&rig, SUPERVISOR_STANDBY);
    ck_assert(!stands_after(499));
    ck_assert(stands_after(1));
    for (int side = 0; side < SIDE_COUNT; side++) {
        for (int sign = -1; sign <= 1; sign += 2) {
            start(&rig, SUPERVISOR_STANDBY);
            ck_assert(stands_after(600));
            rig.input.leg[side].leg_angle_rad = (real)(0.019 * sign);
            ck_assert(stands_after(1));
            rig.input.leg[side].leg_angle_rad = (real)(0.021 * sign);
            ck_assert(!stands_after(1));
            ck_assert(!stands_after(499));
            ck_assert(stands_after(1));
        }
    }
    for (int i = 1; i <= 3; i++) {
        rig.input.leg[SIDE_LEFT].leg_angle_rad += REAL(0.009);
        ck_assert_int_eq(stands_after(1), i <= 2);
    }
}
END_TEST

/* ---- stuck --------------------------------------------------------------------------------- */

/* One leg stands for 100 ms while the other moves by 0.06 rad. */
START_TEST(an_angle_is_stuck_after_100_ms_and_0_06_rad_of_the_other)
{
    for (int side = 0; side < SIDE_COUNT; side++) {
        warm_up(&rig, SUPERVISOR_WALKING);
        for (int i = 1; i <= 100; i++) {
            rig.input.leg[1 - side].leg_angle_rad += REAL(0.001);
            ck_assert_int_eq(tick(&rig),
                             i < 100 ? SUPERVISOR_FAULT_NONE : SUPERVISOR_FAULT_SENSOR_STUCK);
        }
        for (int enough = 0; enough < 2; enough++) {
            warm_up(&rig, SUPERVISOR_WALKING);
            (void)tick(&rig); /* from where the other leg is now */
            const int moves = enough ? 61 : 59;
            for (int i = 0; i < 99; i++) {
                rig.input.leg[1 - side].leg_angle_rad -= i < moves ? REAL(0.001) : REAL(0.0);
                fault = tick(&rig);
            }
            ck_assert_int_eq(fault, enough ? SUPERVISOR_FAULT_SENSOR_STUCK : SUPERVISOR_FAULT_NONE);
        }
    }
}
END_TEST

/* Ticks in which the other leg was not heard do not count: nobody knows how far it has moved. */
START_TEST(a_leg_is_stuck_only_while_the_other_is_heard)
{
    warm_up(&rig, SUPERVISOR_WALKING);
    for (int i = 1; i <= 199; i++) {
        rig.input.leg[SIDE_RIGHT].leg_angle_rad -= REAL(0.001);
        rig.input.leg[SIDE_RIGHT].age_ticks = i % 2 == 0 ? 1 : 0;
        ck_assert_int_eq(tick(&rig),
                         i < 199 ? SUPERVISOR_FAULT_NONE : SUPERVISOR_FAULT_SENSOR_STUCK);
    }
}
END_TEST

/* ---- spring and force ---------------------------------------------------------------------- */

/* 25 % and 12 mm of spring a metre of leg; above a person's spring 15 % and 4 mm. 100 N/m. */
START_TEST(a_force_is_explained_by_its_spring_up_to_its_tolerance)
{
    static const struct {
        enum body_kind body;
        double leg_m, motor_m, low_N, high_N;
    } cases[] = {{BODY_COMPASS, 1.0, 0.1, 10.0 - 3.7, 10.0 + 3.7},
                 {BODY_COMPASS, 0.5, 0.1, 10.0 - 3.1, 10.0 + 3.1},
                 {BODY_COMPASS, 1.0, -0.02, -2.0 - 1.7, -2.0 + 1.7},
                 {BODY_PERSON, 1.0, 0.1, 10.0 - 3.7, 10.0 + 1.9},
                 {BODY_PERSON, 0.5, 0.1, 10.0 - 3.1, 10.0 + 1.7},
                 {BODY_PERSON, 1.0, -0.02, -2.0 - 1.7, -2.0 + 0.7}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        for (int k = 0; k < 4; k++) {
            const double force_N =
                (k < 2 ? cases[i].low_N : cases[i].high_N) + (k % 2 == 0 ? -0.05 : 0.05);
            start(&rig, SUPERVISOR_WALKING);
            rig.params.body = (real)cases[i].body;
            rig.params.leg_length_m = (real)cases[i].leg_m;
            load(&rig, (real)cases[i].motor_m, (real)force_N);
            const bool explained = k == 1 || k == 2;
            ck_assert_msg(two_force_samples(&rig) ==
                              (explained ? SUPERVISOR_FAULT_NONE : SUPERVISOR_FAULT_SPRING),
                          "case %zu, %g N", i, force_N);
        }
    }
}
END_TEST

static void set_force_age(uint16_t age_ticks)
{
    rig.input.sea[SIDE_LEFT].force_age_ticks = rig.input.sea[SIDE_RIGHT].force_age_ticks =
        age_ticks;
}

static void move_motors(double by_m)
{
    rig.input.sea[SIDE_LEFT].precompression_m += (real)by_m;
    rig.input.sea[SIDE_RIGHT].precompression_m += (real)by_m;
}

/* A motor that has moved is at rest 20 ms later: its second force sample from there on is the fault. */
START_TEST(a_force_is_judged_20_ms_after_its_motor_came_to_rest)
{
    start(&rig, SUPERVISOR_WALKING);
    load(&rig, REAL(0.1), REAL(0.0));
    expect_none(60, true);
    move_motors(0.0005);
    expect_none(1, true);
    set_force_age(0);
    expect(&rig, SUPERVISOR_FAULT_SPRING, 21, 21, true);
}
END_TEST

/* Two in a row: a good one in between begins anew. */
START_TEST(one_wrong_force_is_none)
{
    start(&rig, SUPERVISOR_WALKING);
    load(&rig, REAL(0.1), REAL(0.0));
    expect_none(60, true);
    for (int i = 0; i < 10; i++) {
        for (int side = 0; side < SIDE_COUNT; side++) {
            rig.input.sea[side].force_N = i % 2 == 0 ? REAL(0.0) : REAL(10.0);
        }
        set_force_age(0);
        expect_none(1, true);
        set_force_age(1);
        expect_none(10, true);
    }
}
END_TEST

/* At rest: less than 0.02 mm a tick; and within 2 mm of where it was sent. 3 s at 19 um are 57 mm. */
START_TEST(only_a_motor_at_rest_where_it_was_sent_is_judged_by_its_force)
{
    static const struct {
        double creep_m, off_m;
        bool judged;
    } cases[] = {{0.000019, 0.0, true},   {0.000022, 0.0, false}, {-0.000019, 0.0, true},
                 {-0.000022, 0.0, false}, {0.0, 0.0019, true},    {0.0, 0.0021, false},
                 {0.0, -0.0019, true},    {0.0, -0.0021, false}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        start(&rig, SUPERVISOR_WALKING);
        load(&rig, REAL(0.1), REAL(0.0));
        for (int side = 0; side < SIDE_COUNT; side++) {
            rig.command[side].precompression_m += (real)cases[i].off_m;
        }
        set_force_age(0);
        fault = SUPERVISOR_FAULT_NONE;
        for (int k = 0; k < 200 && fault == SUPERVISOR_FAULT_NONE; k++) {
            for (int side = 0; side < SIDE_COUNT; side++) {
                rig.input.sea[side].precompression_m += (real)cases[i].creep_m;
                rig.command[side].precompression_m += (real)cases[i].creep_m;
            }
            swing(&rig);
            fault = tick(&rig);
        }
        ck_assert_msg((fault == SUPERVISOR_FAULT_SPRING) == cases[i].judged, "case %zu: %s", i,
                      supervisor_fault_name(fault));
    }
}
END_TEST

/* A drive that is not enabled yet holds no spring: what it says of a force is of no weight. */
START_TEST(a_drive_without_torque_is_not_judged_by_its_force)
{
    start(&rig, SUPERVISOR_ENGAGING);
    load(&rig, REAL(0.1), REAL(0.0));
    rig.input.sea[SIDE_LEFT].state = rig.input.sea[SIDE_RIGHT].state = DRIVE_STARTING;
    set_force_age(0);
    expect_none(400, true);
}
END_TEST

/* ---- ankle and latch ----------------------------------------------------------------------- */

/* Released from more than 10 mm, a motor still out by half, and the ankle not out by a twentieth of it: for 80 ms,
 * and then 20 of contradiction. */
START_TEST(a_released_spring_moves_its_ankle_by_a_twentieth)
{
    static const struct {
        double released_m, then_m, extension_m;
        bool wrong;
    } cases[] = {{0.1, 0.1, 0.0, true},      {0.1, 0.051, 0.0, true},
                 {0.1, 0.049, 0.0, false},   {0.1, 0.1, 0.0049, true},
                 {0.1, 0.1, 0.0051, false},  {0.0095, 0.0095, 0.0, false},
                 {0.0105, 0.0105, 0.0, true}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        start(&rig, SUPERVISOR_WALKING);
        load(&rig, (real)cases[i].released_m, (real)(100.0 * cases[i].released_m));
        rig.command[SIDE_LEFT].latch_armed = true;
        rig.input.leg[SIDE_LEFT].ankle_extension_m = (real)cases[i].extension_m;
        expect_none(50, true);
        rig.input.sea[SIDE_LEFT].latch = LATCH_OPEN;
        for (int k = 1; k <= 300; k++) {
            const double left = cases[i].then_m / cases[i].released_m;
            const double way = k < 50 ? 1.0 - (1.0 - left) * k / 50.0 : left;
            rig.input.sea[SIDE_LEFT].precompression_m = (real)(way * cases[i].released_m);
            rig.command[SIDE_LEFT].precompression_m = rig.input.sea[SIDE_LEFT].precompression_m;
            if (k == 1) {
                rig.input.sea[SIDE_LEFT].precompression_m = (real)cases[i].released_m;
            }
            swing(&rig);
            const enum supervisor_fault wanted =
                cases[i].wrong && k >= 102 ? SUPERVISOR_FAULT_SPRING : SUPERVISOR_FAULT_NONE;
            ck_assert_msg(tick(&rig) == wanted, "case %zu, tick %d", i, k);
        }
    }
}
END_TEST

/* 2 % of the leg: behind a closed latch, and beyond the motor of an open one. */
START_TEST(an_ankle_has_2_percent_of_slack)
{
    warm_up(&rig, SUPERVISOR_WALKING);
    rig.input.leg[SIDE_LEFT].ankle_extension_m = REAL(0.019);
    expect_none(300, true);
    start(&rig, SUPERVISOR_WALKING);
    load(&rig, REAL(0.1), REAL(10.0));
    rig.command[SIDE_LEFT].latch_armed = true;
    expect_none(50, true);
    rig.input.sea[SIDE_LEFT].latch = LATCH_OPEN;
    for (int i = 1; i <= 119; i++) {
        rig.input.leg[SIDE_LEFT].ankle_extension_m = REAL(0.001) * (real)i;
        expect_none(1, true);
    }
    expect_none(300, true);
    rig.params.engage_steps =
        REAL(4.0); /* somebody with a push-off of their own may go beyond it */
    rig.input.leg[SIDE_LEFT].ankle_extension_m = REAL(0.125);
    expect_none(300, true);
}
END_TEST

/* A latch that opens in the tenth tick after it was disarmed was on its way, in the eleventh not. */
START_TEST(a_latch_may_open_for_10_ms_after_it_was_disarmed)
{
    for (int last = 10; last <= 11; last++) {
        for (int side = 0; side < SIDE_COUNT; side++) {
            start(&rig, SUPERVISOR_WALKING);
            load(&rig, REAL(0.1), REAL(10.0));
            rig.command[side].latch_armed = true;
            expect_none(50, true);
            rig.command[side].latch_armed = false;
            expect_none(last - 1, true);
            rig.input.sea[side].latch = LATCH_OPEN;
            swing(&rig);
            ck_assert_int_eq(tick(&rig),
                             last > 10 ? SUPERVISOR_FAULT_SPRING : SUPERVISOR_FAULT_NONE);
            rig.input.sea[side].latch = LATCH_CLOSED;
            expect_none(30, true); /* closed, it is over */
        }
    }
}
END_TEST

/* Empty within 0.2 mm of a leg of 1 m, and sent to 0; a compass' latch may stay open. */
START_TEST(only_an_empty_spring_s_latch_must_close)
{
    static const struct {
        enum body_kind body;
        double motor_m, command_m;
        bool wrong;
    } cases[] = {{BODY_PERSON, 0.00019, 0.0, true},  {BODY_PERSON, -0.00019, 0.0, true},
                 {BODY_PERSON, 0.00021, 0.0, false}, {BODY_PERSON, -0.00021, 0.0, false},
                 {BODY_PERSON, 0.0, 0.001, false},   {BODY_COMPASS, 0.0, 0.0, false}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        start(&rig, SUPERVISOR_WALKING);
        rig.params.body = (real)cases[i].body;
        rig.command[SIDE_LEFT].latch_armed = true;
        expect_none(20, true);
        rig.input.sea[SIDE_LEFT].latch = LATCH_OPEN;
        rig.input.sea[SIDE_LEFT].precompression_m = (real)cases[i].motor_m;
        rig.command[SIDE_LEFT].precompression_m = (real)cases[i].command_m;
        if (cases[i].wrong) {
            expect(&rig, SUPERVISOR_FAULT_SPRING, 11, 11, true);
            rig.input.sea[SIDE_LEFT].latch = LATCH_CLOSED;
            expect_none(1, true);
        } else {
            expect_none(200, true);
        }
    }
}
END_TEST

/* ---- drives -------------------------------------------------------------------------------- */

/* Behind by a tenth of the leg for 25 ms, by a hundredth for 250 ms: to either side. */
START_TEST(a_motor_is_behind_by_a_tenth_or_long_by_a_hundredth)
{
    static const struct {
        double command_m;
        int ticks; /* with those that a command takes to the drive and back */
    } cases[] = {{0.101, 30},   {-0.101, 30},  {0.099, 255},
                 {-0.099, 255}, {-0.011, 255}, {-0.009, 0}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        for (int side = 0; side < SIDE_COUNT; side++) {
            warm_up(&rig, SUPERVISOR_WALKING);
            rig.command[side].precompression_m = (real)cases[i].command_m;
            if (cases[i].ticks > 0) {
                expect(&rig, SUPERVISOR_FAULT_FOLLOWING, cases[i].ticks, cases[i].ticks, true);
            } else {
                expect_none(600, true);
            }
        }
    }
}
END_TEST

/* A drive that is not enabled, or is not to be, follows nothing. */
START_TEST(a_drive_without_torque_need_not_follow)
{
    warm_up(&rig, SUPERVISOR_ENGAGING);
    start(&rig, SUPERVISOR_ENGAGING);
    for (int side = 0; side < SIDE_COUNT; side++) {
        rig.input.sea[side].state = DRIVE_STARTING;
        rig.command[side].precompression_m = REAL(0.2);
    }
    expect_none(400, true);
    warm_up(&rig, SUPERVISOR_UNLOADING);
    for (int side = 0; side < SIDE_COUNT; side++) {
        rig.command[side] = (struct sea_request){REAL(0.2), false, false};
    }
    expect_none(400, true);
}
END_TEST

/* Enabled again after a rest, drives have their 500 ms again; one that left stays a fault until then. */
START_TEST(a_new_walk_gives_the_drives_their_time_again)
{
    warm_up(&rig, SUPERVISOR_WALKING);
    rig.input.sea[SIDE_LEFT].state = DRIVE_DISABLED;
    for (int i = 0; i < 700; i++) {
        swing(&rig);
        ck_assert_int_eq(tick(&rig), SUPERVISOR_FAULT_DRIVE);
    }
    rig.state = SUPERVISOR_STANDBY;
    for (int side = 0; side < SIDE_COUNT; side++) {
        rig.input.sea[side].state = DRIVE_DISABLED;
        rig.command[side].enable = false;
    }
    expect_none(100, false);
    rig.state = SUPERVISOR_ENGAGING;
    rig.command[SIDE_LEFT].enable = rig.command[SIDE_RIGHT].enable = true;
    expect(&rig, SUPERVISOR_FAULT_DRIVE, 501, 501, false);
}
END_TEST

/* ---- at once ------------------------------------------------------------------------------- */

START_TEST(what_is_just_within_its_range_is_none)
{
    static const struct {
        enum supervisor_state state;
        double angle_rad, extension_m, motor_m;
        enum supervisor_fault fault;
    } cases[] = {{SUPERVISOR_WALKING, -1.19, 0.0, 0.0, SUPERVISOR_FAULT_NONE},
                 {SUPERVISOR_WALKING, 0.0, 0.0, -0.049, SUPERVISOR_FAULT_NONE},
                 {SUPERVISOR_WALKING, 0.0, 0.0, 0.399, SUPERVISOR_FAULT_NONE},
                 {SUPERVISOR_STANDBY, 3.14, 0.0, 0.0, SUPERVISOR_FAULT_NONE},
                 {SUPERVISOR_STANDBY, -3.14, 0.0, 0.0, SUPERVISOR_FAULT_NONE},
                 {SUPERVISOR_STANDBY, 3.15, 0.0, 0.0, SUPERVISOR_FAULT_SENSOR_RANGE},
                 {SUPERVISOR_STANDBY, -3.15, 0.0, 0.0, SUPERVISOR_FAULT_SENSOR_RANGE},
                 {SUPERVISOR_STANDBY, 0.0, 0.51, 0.0, SUPERVISOR_FAULT_SENSOR_RANGE},
                 {SUPERVISOR_STANDBY, 0.0, 0.0, 0.41, SUPERVISOR_FAULT_SENSOR_RANGE}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        for (int side = 0; side < SIDE_COUNT; side++) {
            start(&rig, cases[i].state);
            rig.input.leg[side].leg_angle_rad = (real)cases[i].angle_rad;
            rig.input.leg[side].ankle_extension_m = (real)cases[i].extension_m;
            rig.input.sea[side].precompression_m = (real)cases[i].motor_m;
            ck_assert_msg(tick(&rig) == cases[i].fault, "case %zu", i);
        }
    }
    for (int side = 0; side < SIDE_COUNT; side++) {
        warm_up(&rig, SUPERVISOR_WALKING);
        rig.input.sea[side].force_age_ticks = 350;
        expect_none(1, true);
    }
}
END_TEST

/* Where nothing can be released a jump is no danger. An ankle's counts while the spring is unloaded, too. */
START_TEST(a_jump_counts_while_something_may_be_released)
{
    warm_up(&rig, SUPERVISOR_ENGAGING);
    rig.input.leg[SIDE_LEFT].leg_angle_rad -= REAL(0.6);
    expect_none(300, true);
    warm_up(&rig, SUPERVISOR_UNLOADING);
    rig.input.leg[SIDE_LEFT].ankle_extension_m = REAL(0.45);
    expect(&rig, SUPERVISOR_FAULT_SENSOR_RATE, 11, 11, true);
}
END_TEST

/* A motor's jump counts wherever its drive may load a spring: else the wrong place would be taken for true after
 * 120 ms. With torque off somebody may move it by hand. */
START_TEST(a_motor_s_jump_counts_where_a_drive_has_torque)
{
    for (int state = 0; state < SUPERVISOR_STATES; state++) {
        for (int side = 0; side < SIDE_COUNT; side++) {
            warm_up(&rig, (enum supervisor_state)state);
            rig.input.sea[side].precompression_m += REAL(0.017);
            if (state == SUPERVISOR_ENGAGING || state == SUPERVISOR_WALKING ||
                state == SUPERVISOR_UNLOADING || state == SUPERVISOR_COMMISSIONING) {
                expect(&rig, SUPERVISOR_FAULT_SENSOR_RATE, 11, 11, true);
            } else {
                expect_none(60, true);
            }
        }
    }
}
END_TEST

/* Slack: within the motor's tolerance of 1 mm, to either side, and known. */
START_TEST(springs_are_slack_within_the_tolerance)
{
    static const struct {
        double motor_m;
        bool slack;
    } cases[] = {{0.00099, true}, {-0.00099, true}, {0.00101, false}, {-0.00101, false}};
    for (int side = 0; side < SIDE_COUNT; side++) {
        for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
            start(&rig, SUPERVISOR_STANDBY);
            rig.input.sea[side].precompression_m = (real)cases[i].motor_m;
            ck_assert_int_eq(checks_springs_slack(&rig.params, &rig.input), cases[i].slack);
        }
        rig.input.sea[side].precompression_m = (real)(__builtin_nanf(""));
        ck_assert(!checks_springs_slack(&rig.params, &rig.input));
    }
}
END_TEST

/* Nothing of a walk before is remembered. */
START_TEST(checks_begin_with_nothing_remembered)
{
    memset(&rig.checks, 0xA5, sizeof rig.checks);
    const struct checks none = {0};
    checks_init(&rig.checks);
    ck_assert_uint_eq(rig.checks.standstill_ticks, none.standstill_ticks);
    ck_assert_uint_eq(rig.checks.tilted_ticks, 0);
    ck_assert_uint_eq(rig.checks.state_contradiction_count, 0);
    ck_assert(!rig.checks.was_enabled && !rig.checks.has_left);
    for (int side = 0; side < SIDE_COUNT; side++) {
        ck_assert_uint_eq(rig.checks.leg[side].still_ticks, 0);
        ck_assert_uint_eq(rig.checks.leg[side].force_contradiction_count, 0);
        ck_assert(!rig.checks.leg[side].opened_unarmed);
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("checks' limits");
    TCase *tests = tcase_create("all");
    tcase_add_test(tests, who_leans_is_not_upright_after_200_ms);
    tcase_add_test(tests, who_hangs_is_not_upright_after_500_ms);
    tcase_add_test(tests, a_compass_is_always_upright);
    tcase_add_test(tests, who_moves_by_more_than_0_02_rad_does_not_stand);
    tcase_add_test(tests, an_angle_is_stuck_after_100_ms_and_0_06_rad_of_the_other);
    tcase_add_test(tests, a_leg_is_stuck_only_while_the_other_is_heard);
    tcase_add_test(tests, a_force_is_explained_by_its_spring_up_to_its_tolerance);
    tcase_add_test(tests, a_force_is_judged_20_ms_after_its_motor_came_to_rest);
    tcase_add_test(tests, one_wrong_force_is_none);
    tcase_add_test(tests, only_a_motor_at_rest_where_it_was_sent_is_judged_by_its_force);
    tcase_add_test(tests, a_drive_without_torque_is_not_judged_by_its_force);
    tcase_add_test(tests, a_released_spring_moves_its_ankle_by_a_twentieth);
    tcase_add_test(tests, an_ankle_has_2_percent_of_slack);
    tcase_add_test(tests, a_latch_may_open_for_10_ms_after_it_was_disarmed);
    tcase_add_test(tests, only_an_empty_spring_s_latch_must_close);
    tcase_add_test(tests, a_motor_is_behind_by_a_tenth_or_long_by_a_hundredth);
    tcase_add_test(tests, a_drive_without_torque_need_not_follow);
    tcase_add_test(tests, a_new_walk_gives_the_drives_their_time_again);
    tcase_add_test(tests, what_is_just_within_its_range_is_none);
    tcase_add_test(tests, a_jump_counts_while_something_may_be_released);
    tcase_add_test(tests, a_motor_s_jump_counts_where_a_drive_has_torque);
    tcase_add_test(tests, springs_are_slack_within_the_tolerance);
    tcase_add_test(tests, checks_begin_with_nothing_remembered);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
