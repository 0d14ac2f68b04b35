/* What the walk does besides the model's stride: every fault by its name, the latch's rules at heel
 * strike, ground, pushes, the own push-off, an unretracted foot. */
#include <math.h>
#include <string.h>

#include "sim_host/plant/walk.h"
#include "tests/support/assert_close.h"

static const struct walker3_params PAPER = {
    .hip_mass_kg = 1.0, .leg_mass_kg = 0.01, .leg_length_m = 1.0, .gravity_m_s2 = 9.80665};
static const struct sea_subject SUBJECT = {
    .total_mass_kg = 1.02, .leg_length_m = 1.0, .gravity_m_s2 = 9.80665, .spring_N_per_m = 100.0};

/* The gait at r0 = 0.05 just after lift-off (model/README.md's fixed point followed there). */
static const struct walk_pose START = {
    .stance = SIDE_LEFT,
    .theta_s_rad = 0.17529902134350062,
    .theta_n_rad = -0.35460079438782355,
    .theta_s_rate_rad_s = -0.69159992981343854,
    .theta_n_rate_rad_s = -0.56833555573666439,
};
/* Its apex speed from the same source. */
static const double START_SPEED = 0.406960;

struct rig {
    struct walk_params params;
    struct sea_params sea_params;
    struct walk walk;
    struct sea sea[SIDE_COUNT];
    struct sea_command command[SIDE_COUNT];
    struct walk_event last[9]; /* of each kind */
    int count[9];
    double apex_speed[64];
};

static void rig_init(struct rig *rig, enum sea_preset_kind kind)
{
    memset(rig, 0, sizeof *rig);
    walk_params_default(&PAPER, &rig->params);
    sea_preset(kind, &SUBJECT, &rig->sea_params);
}

static void rig_start(struct rig *rig, const struct walk_pose *pose)
{
    ck_assert_ptr_null(walk_params_check(&rig->params));
    ck_assert_ptr_null(sea_params_check(&rig->sea_params));
    walk_init(&rig->walk, &rig->params, pose);
    for (int side = 0; side < SIDE_COUNT; side++) {
        sea_init(&rig->sea[side], &rig->sea_params, (uint64_t)side);
        rig->command[side] = (struct sea_command){SEA_POSITION, 0.05, true};
    }
}

static void rig_tick(struct rig *rig)
{
    struct walk_event event;
    for (int side = 0; side < SIDE_COUNT; side++) {
        sea_set_command(&rig->sea[side], &rig->command[side], rig->walk.time_s);
    }
    walk_advance(&rig->walk, rig->sea, 0.001);
    while (walk_next_event(&rig->walk, &event)) {
        if (event.kind == WALK_EVENT_APEX) {
            rig->apex_speed[rig->count[WALK_EVENT_APEX] % 64] = event.value;
        }
        rig->last[event.kind] = event;
        rig->count[event.kind]++;
    }
    for (int i = 0; i < WALKER3_DOF; i++) {
        ck_assert(isfinite(rig->walk.state.q[i]) && isfinite(rig->walk.state.dq[i]));
    }
}

/* Loads both springs in the hand, then lets go. */
static void rig_let_go(struct rig *rig)
{
    for (int i = 0; i < 600; i++) {
        rig_tick(rig);
    }
    walk_let_go(&rig->walk);
}

static void rig_run(struct rig *rig, int ticks)
{
    for (int i = 0; i < ticks && rig->walk.fault == WALK_FAULT_NONE; i++) {
        rig_tick(rig);
    }
}

/* Runs until the next event of this kind. */
static void rig_until(struct rig *rig, enum walk_event_kind kind)
{
    const int before = rig->count[kind];
    for (int i = 0; i < 5000 && rig->count[kind] == before; i++) {
        rig_tick(rig);
    }
    ck_assert_int_eq(rig->count[kind], before + 1);
}

/* The law of a person who always wants r0: load in stance, back in swing. */
static void rig_walk_steps(struct rig *rig, int steps, double r0_m)
{
    const int until = rig->count[WALK_EVENT_LIFT_OFF] + steps;
    while (rig->count[WALK_EVENT_LIFT_OFF] < until && rig->walk.fault == WALK_FAULT_NONE) {
        const enum side stance = rig->walk.stance;
        rig->command[stance].target_position_m = r0_m;
        rig->command[stance].latch_armed = true;
        rig->command[side_other(stance)].target_position_m = 0.0;
        rig->command[side_other(stance)].latch_armed = false;
        rig_tick(rig);
    }
}

START_TEST(the_start_hold_holds)
{
    struct rig rig;
    rig_init(&rig, SEA_REAL);
    rig_start(&rig, &START);
    rig_run(&rig, 300);
    ck_assert_int_eq(rig.walk.phase, WALK_HELD);
    assert_close(walk_leg_angle_rad(&rig.walk, SIDE_LEFT), START.theta_s_rad, 0.0, 0.0);
    assert_close(walk_leg_rate_rad_s(&rig.walk, SIDE_LEFT), 0.0, 0.0, 0.0);
    ck_assert(walk_on_ground(&rig.walk, SIDE_LEFT) && !walk_on_ground(&rig.walk, SIDE_RIGHT));
    const double push[2] = {5.0, 5.0};
    walk_push(&rig.walk, push);
    walk_let_go(&rig.walk);
    ck_assert_int_eq(rig.walk.phase, WALK_SINGLE);
    assert_close(walk_leg_rate_rad_s(&rig.walk, SIDE_LEFT), START.theta_s_rate_rad_s, 0.0, 0.0);
}
END_TEST

START_TEST(ideal_actuators_walk_the_papers_gait)
{
    struct rig rig;
    rig_init(&rig, SEA_IDEAL);
    rig_start(&rig, &START);
    rig_let_go(&rig);
    rig_walk_steps(&rig, 60, 0.05);
    ck_assert_int_eq(rig.walk.fault, WALK_FAULT_NONE);
    assert_close(rig.last[WALK_EVENT_APEX].value, START_SPEED, 1e-6, 0.0);
    ck_assert_int_eq(rig.count[WALK_EVENT_APEX], 60);
    ck_assert_int_eq(rig.count[WALK_EVENT_HEEL_STRIKE], 60);
    ck_assert_int_eq(rig.count[WALK_EVENT_RELEASE], 60);
}
END_TEST

START_TEST(real_actuators_cost_no_more_than_their_latency)
{
    struct rig rig;
    rig_init(&rig, SEA_REAL);
    rig.sea_params.release_latency_s = 0.0;
    rig_start(&rig, &START);
    rig_let_go(&rig);
    rig_walk_steps(&rig, 60, 0.05);
    ck_assert_int_eq(rig.walk.fault, WALK_FAULT_NONE);
    assert_close(rig.last[WALK_EVENT_APEX].value, START_SPEED, 0.0, 2e-4);
    /* 0.1 ms late: slower, by less than 0.1 %. */
    rig_init(&rig, SEA_REAL);
    rig_start(&rig, &START);
    rig_let_go(&rig);
    rig_walk_steps(&rig, 60, 0.05);
    ck_assert(rig.last[WALK_EVENT_APEX].value < START_SPEED);
    assert_close(rig.last[WALK_EVENT_APEX].value, START_SPEED, 0.0, 1e-3);
}
END_TEST

START_TEST(the_spring_is_released_after_its_latency)
{
    static const enum sea_release CAUSES[] = {SEA_RELEASE_CONTACT_OR_EXTENSION, SEA_RELEASE_CONTACT,
                                              SEA_RELEASE_EXTENSION};
    for (int i = 0; i < 3; i++) {
        struct rig rig;
        rig_init(&rig, SEA_REAL);
        rig.sea_params.release_on = CAUSES[i];
        rig.sea_params.release_latency_s = 3e-4;
        rig_start(&rig, &START);
        rig_let_go(&rig);
        rig.command[SIDE_RIGHT].target_position_m = 0.0;
        rig_until(&rig, WALK_EVENT_RELEASE);
        const double late =
            rig.last[WALK_EVENT_RELEASE].time_s - rig.last[WALK_EVENT_HEEL_STRIKE].time_s;
        if (CAUSES[i] == SEA_RELEASE_EXTENSION) {
            /* The trigger's way at the ankle's rate after impact comes on top. */
            ck_assert(late > 3e-4 && late < 3e-4 + 2e-3);
        } else {
            assert_close(late, 3e-4, 1e-11, 0.0);
        }
        ck_assert_int_eq(rig.last[WALK_EVENT_RELEASE].side, SIDE_LEFT);
        assert_close(rig.last[WALK_EVENT_RELEASE].value, 0.05, 1e-5, 0.0);
    }
}
END_TEST

START_TEST(unarmed_there_is_no_push_off)
{
    struct rig rig;
    rig_init(&rig, SEA_REAL);
    rig_start(&rig, &START);
    rig.command[SIDE_LEFT].latch_armed = false;
    rig_let_go(&rig);
    rig.command[SIDE_LEFT].latch_armed = false;
    rig_until(&rig, WALK_EVENT_LIFT_OFF);
    assert_close(rig.last[WALK_EVENT_LIFT_OFF].time_s, rig.last[WALK_EVENT_HEEL_STRIKE].time_s,
                 1e-9, 0.0);
    ck_assert_int_eq(rig.count[WALK_EVENT_RELEASE], 0);
    struct walk_step step;
    ck_assert(walk_next_step(&rig.walk, &step));
    assert_close(step.push_off_J, 0.0, 0.0, 0.0);
    assert_close(step.precompression_m, 0.0, 0.0, 0.0);
    rig.command[SIDE_RIGHT].latch_armed = false;
    rig_run(&rig, 20000);
    /* Without energy the walk dies. */
    ck_assert(rig.walk.fault == WALK_FAULT_BACKWARDS ||
              rig.walk.fault == WALK_FAULT_FALLEN_BACKWARD);
}
END_TEST

START_TEST(timed_by_the_controller_it_releases_on_command)
{
    struct rig rig;
    rig_init(&rig, SEA_REAL);
    rig.sea_params.release_on = SEA_RELEASE_COMMAND;
    rig.params.unarmed_hold_s = 0.01; /* the trailing foot waits for it */
    rig_start(&rig, &START);
    rig.command[SIDE_LEFT].latch_armed = rig.command[SIDE_RIGHT].latch_armed = false;
    rig_let_go(&rig);
    rig_until(&rig, WALK_EVENT_HEEL_STRIKE);
    const double armed_s = rig.walk.time_s;
    rig.command[SIDE_LEFT].latch_armed = true;
    rig_until(&rig, WALK_EVENT_RELEASE);
    assert_close(rig.last[WALK_EVENT_RELEASE].time_s, armed_s + 1e-4, 1e-11, 0.0);
    rig_until(&rig, WALK_EVENT_LIFT_OFF);
    assert_close(rig.last[WALK_EVENT_LIFT_OFF].value, 0.05, 1e-4, 0.0);
}
END_TEST

START_TEST(released_in_single_support_it_throws_the_walker_off)
{
    struct rig rig;
    rig_init(&rig, SEA_REAL);
    rig.sea_params.release_on = SEA_RELEASE_COMMAND;
    rig_start(&rig, &START);
    rig.command[SIDE_LEFT] = (struct sea_command){SEA_POSITION, 0.25, false};
    rig.command[SIDE_RIGHT] = (struct sea_command){SEA_POSITION, 0.0, false};
    rig_let_go(&rig);
    rig_run(&rig, 100);
    rig.command[SIDE_LEFT].latch_armed = true; /* 25 N against 10 N of weight */
    rig_run(&rig, 2000);
    ck_assert_int_eq(rig.count[WALK_EVENT_RELEASE], 1);
    ck_assert_int_eq(rig.walk.fault, WALK_FAULT_FLIGHT);
}
END_TEST

START_TEST(a_weak_spring_released_in_single_support_moves_nothing)
{
    struct rig rig;
    rig_init(&rig, SEA_REAL);
    rig.sea_params.release_on = SEA_RELEASE_COMMAND;
    rig_start(&rig, &START);
    rig.command[SIDE_LEFT] = (struct sea_command){SEA_POSITION, 0.05, false};
    rig.command[SIDE_RIGHT] = (struct sea_command){SEA_POSITION, 0.0, false};
    rig_let_go(&rig);
    rig_run(&rig, 100);
    rig.command[SIDE_LEFT].latch_armed = true; /* 5 N against 10 N: the heel stays down */
    rig_run(&rig, 200);
    ck_assert_int_eq(rig.walk.fault, WALK_FAULT_NONE);
    assert_close(walk_ankle_m(&rig.walk, rig.sea, SIDE_LEFT), 0.0, 0.0, 0.0);
    rig_until(&rig, WALK_EVENT_LIFT_OFF);
    assert_close(rig.last[WALK_EVENT_LIFT_OFF].value, 0.05, 1e-4, 0.0);
}
END_TEST

START_TEST(an_unretracted_foot_trips)
{
    struct rig rig;
    rig_init(&rig, SEA_REAL);
    rig_start(&rig, &START);
    rig_let_go(&rig);
    rig_run(&rig, 3000); /* both motors stay at 0.05 */
    ck_assert_int_eq(rig.walk.fault, WALK_FAULT_TRIPPED);
    ck_assert_int_eq(rig.count[WALK_EVENT_LIFT_OFF], 1);
}
END_TEST

START_TEST(a_foot_not_quite_back_lands_earlier_and_stands_on_its_spring)
{
    struct rig rig;
    rig_init(&rig, SEA_REAL);
    rig_start(&rig, &START);
    rig_let_go(&rig);
    rig.command[SIDE_RIGHT].target_position_m = 0.0;
    rig_until(&rig, WALK_EVENT_LIFT_OFF);
    rig.command[SIDE_LEFT].target_position_m = 0.01; /* 1 cm short of retracted */
    rig.command[SIDE_RIGHT].target_position_m = 0.05;
    rig_until(&rig, WALK_EVENT_HEEL_STRIKE);
    ck_assert_int_eq(rig.last[WALK_EVENT_HEEL_STRIKE].side, SIDE_LEFT);
    assert_close(walk_ankle_m(&rig.walk, rig.sea, SIDE_LEFT), 0.01, 1e-4, 0.0);
    rig_until(&rig, WALK_EVENT_LIFT_OFF);
    rig_run(&rig, 60);
    /* 1 cm of spring does not carry the weight: the heel came down. */
    assert_close(walk_ankle_m(&rig.walk, rig.sea, SIDE_LEFT), 0.0, 1e-12, 0.0);
    ck_assert_int_eq(rig.walk.fault, WALK_FAULT_NONE);
}
END_TEST

START_TEST(too_slow_it_turns_back)
{
    struct rig rig;
    struct walk_pose slow = START;
    rig_init(&rig, SEA_IDEAL);
    slow.theta_s_rate_rad_s = -0.4;
    rig_start(&rig, &slow);
    rig_let_go(&rig);
    rig_run(&rig, 3000);
    ck_assert_int_eq(rig.walk.fault, WALK_FAULT_BACKWARDS);
    ck_assert_int_eq(rig.walk.phase, WALK_DOWN);
    ck_assert_str_eq(walk_fault_name(rig.walk.fault), "backwards");
    rig.walk.fault = WALK_FAULT_NONE;
    rig_run(&rig, 100); /* the actuators run on, the state stays */
    assert_close(walk_leg_rate_rad_s(&rig.walk, SIDE_LEFT), 0.0, 0.0, 0.0);
}
END_TEST

START_TEST(without_a_foot_in_front_it_falls_forward)
{
    struct rig rig;
    struct walk_pose pose = START;
    rig_init(&rig, SEA_IDEAL);
    pose.theta_n_rate_rad_s = -12.0; /* the swing leg goes over backwards */
    pose.theta_s_rate_rad_s = -2.5;
    rig_start(&rig, &pose);
    rig_let_go(&rig);
    rig_run(&rig, 5000);
    ck_assert(rig.walk.fault == WALK_FAULT_FALLEN_FORWARD ||
              rig.walk.fault == WALK_FAULT_LEGS_CROSSED);
}
END_TEST

START_TEST(waiting_for_a_trigger_that_cannot_come_it_is_stuck)
{
    struct rig rig;
    /* Legs at right angles stop dead at impact (r' clamped): the ankle does not extend by itself. */
    struct walk_pose wide = {.stance = SIDE_LEFT,
                             .theta_s_rad = -0.80,
                             .theta_n_rad = 0.86,
                             .theta_s_rate_rad_s = -1.0,
                             .theta_n_rate_rad_s = -1.0};
    rig_init(&rig, SEA_REAL);
    rig.sea_params.release_on = SEA_RELEASE_EXTENSION;
    rig.params.stuck_s = 1.0;
    rig_start(&rig, &wide);
    rig_let_go(&rig);
    rig_run(&rig, 3000);
    ck_assert_int_eq(rig.walk.fault, WALK_FAULT_STUCK);
    ck_assert_int_eq(rig.count[WALK_EVENT_HEEL_STRIKE], 1);
    assert_close(rig.last[WALK_EVENT_FAULT].time_s - rig.last[WALK_EVENT_HEEL_STRIKE].time_s, 1.0,
                 1e-3, 0.0);
}
END_TEST

START_TEST(slippery_ground_ends_the_walk)
{
    struct rig rig;
    rig_init(&rig, SEA_IDEAL);
    rig.params.friction = 0.1;
    rig_start(&rig, &START);
    rig_let_go(&rig);
    rig_run(&rig, 3000);
    ck_assert_int_eq(rig.walk.fault, WALK_FAULT_SLIPPED);
    rig_init(&rig, SEA_IDEAL);
    rig.params.friction = 0.6;
    rig_start(&rig, &START);
    rig_let_go(&rig);
    rig_walk_steps(&rig, 10, 0.05);
    ck_assert_int_eq(rig.walk.fault, WALK_FAULT_NONE);
}
END_TEST

START_TEST(ground_carries_the_weight_on_average)
{
    /* Over a periodic gait the mean vertical force is the weight, the mean horizontal one zero. */
    struct rig rig;
    rig_init(&rig, SEA_IDEAL);
    rig_start(&rig, &START);
    rig_let_go(&rig);
    rig_walk_steps(&rig, 40, 0.05);
    const uint64_t from = rig.walk.current.index;
    double sum_x = 0.0, sum_y = 0.0, impulse_y = 0.0, impulse_x = 0.0, since = rig.walk.time_s;
    rig.command[0] = rig.command[1] = (struct sea_command){SEA_POSITION, 0.05, true};
    while (rig.walk.current.index < from + 20) {
        ck_assert_int_eq(rig.walk.fault, WALK_FAULT_NONE);
        double ground[SIDE_COUNT][2], lock;
        struct walk before = rig.walk;
        walk_forces(&rig.walk, rig.sea, ground, &lock);
        sum_x += (ground[0][0] + ground[1][0]) * 1e-3;
        sum_y += (ground[0][1] + ground[1][1]) * 1e-3;
        rig_tick(&rig);
        if (before.phase == WALK_SINGLE && rig.walk.phase == WALK_DOUBLE) {
            /* The impact's impulse is not in the forces: take it from a collision of the same state,
             * landed to the tick's precision. */
            struct walker3_impact impact;
            walker3_collide(&PAPER, &before.state, 0.0, &impact);
            impulse_x += impact.stance_toe_Ns[0] + impact.swing_toe_Ns[0];
            impulse_y += impact.stance_toe_Ns[1] + impact.swing_toe_Ns[1];
        }
    }
    since = rig.walk.time_s - since;
    assert_close((sum_y + impulse_y) / since, 1.02 * 9.80665, 0.05, 0.0);
    assert_close((sum_x + impulse_x) / since, 0.0, 0.05, 0.0);
}
END_TEST

START_TEST(energy_is_accounted_for)
{
    struct rig rig;
    rig_init(&rig, SEA_IDEAL);
    rig_start(&rig, &START);
    rig_let_go(&rig);
    const double before = walk_energy_J(&rig.walk);
    rig_walk_steps(&rig, 30, 0.07);
    const double work = rig.walk.device_work_J[0] + rig.walk.device_work_J[1];
    assert_close(walk_energy_J(&rig.walk) - before, work - rig.walk.collision_loss_J, 1e-6, 0.0);
    /* One push-off of a spring is k r0^2 / 2. */
    struct walk_step step;
    while (walk_next_step(&rig.walk, &step)) {
        assert_close(step.push_off_J, 0.5 * 100.0 * 0.07 * 0.07, 0.0, 1e-5);
        ck_assert(step.collision_loss_J > 0.0);
    }
}
END_TEST

START_TEST(downhill_it_walks_without_pushing)
{
    /* A compass walker goes down a gentle slope by gravity alone, once it is on the way. */
    struct rig rig;
    rig_init(&rig, SEA_IDEAL);
    rig.params.slope_rad = -0.02;
    rig_start(&rig, &START);
    rig_let_go(&rig);
    rig_walk_steps(&rig, 3, 0.02);
    const double height = rig.walk.foot_m[1], way = rig.walk.foot_m[0];
    ck_assert(way < 0.0 && height < 0.0);
    assert_close(height / way, tan(0.02), 1e-10, 0.0); /* towards -x it goes down */
    /* Energy stays accounted for with the height of the ground. */
    const double work = rig.walk.device_work_J[0] + rig.walk.device_work_J[1];
    struct walk fresh;
    walk_init(&fresh, &rig.params, &START);
    assert_close(walk_energy_J(&rig.walk) - walk_energy_J(&fresh), work - rig.walk.collision_loss_J,
                 1e-6, 0.0);
}
END_TEST

START_TEST(a_raised_foothold_is_met_at_its_height)
{
    struct rig rig;
    rig_init(&rig, SEA_IDEAL);
    rig_start(&rig, &START);
    rig_let_go(&rig);
    rig_until(&rig, WALK_EVENT_APEX);
    walk_set_next_height(&rig.walk, -0.01);
    rig_until(&rig, WALK_EVENT_LIFT_OFF);
    assert_close(rig.walk.foot_m[1], -0.01, 1e-12, 0.0);
    assert_close(rig.walk.next_height_m, 0.0, 0.0, 0.0);
}
END_TEST

START_TEST(pushes_change_the_speed)
{
    const double forward[2] = {-0.05, 0.0}, backward[2] = {0.05, 0.0};
    double speed[3];
    for (int i = 0; i < 3; i++) {
        struct rig rig;
        rig_init(&rig, SEA_IDEAL);
        rig_start(&rig, &START);
        rig_let_go(&rig);
        rig_run(&rig, 50);
        if (i > 0) {
            walk_push(&rig.walk, i == 1 ? forward : backward);
        }
        rig_until(&rig, WALK_EVENT_APEX);
        speed[i] = rig.last[WALK_EVENT_APEX].value;
    }
    ck_assert(speed[1] > speed[0] + 0.03 && speed[2] < speed[0] - 0.03);
}
END_TEST

START_TEST(the_own_push_off_walks_without_the_device)
{
    struct rig rig;
    rig_init(&rig, SEA_REAL);
    rig.params.own_push_N_per_m = 100.0;
    rig.params.own_push_rest_m = 0.05;
    rig_start(&rig, &START);
    rig.command[0] = rig.command[1] = (struct sea_command){SEA_TORQUE_OFF, 0.0, false};
    walk_let_go(&rig.walk);
    rig_run(&rig, 20000);
    ck_assert_int_eq(rig.walk.fault, WALK_FAULT_NONE);
    ck_assert(rig.count[WALK_EVENT_LIFT_OFF] > 18);
    /* The same spring, so the same gait. */
    assert_close(rig.last[WALK_EVENT_APEX].value, START_SPEED, 1e-6, 0.0);
    assert_close(rig.walk.own_work_J, 0.125 * rig.count[WALK_EVENT_LIFT_OFF], 0.0, 1e-2);
    assert_close(rig.walk.device_work_J[0], 0.0, 0.0, 0.0);
}
END_TEST

START_TEST(the_start_hold_takes_hold_again)
{
    struct rig rig;
    struct walk_pose slow = START;
    rig_init(&rig, SEA_REAL);
    slow.theta_s_rate_rad_s = -0.4;
    rig_start(&rig, &slow);
    rig_let_go(&rig);
    rig_run(&rig, 3000);
    ck_assert_int_ne(rig.walk.fault, WALK_FAULT_NONE);
    walk_hold(&rig.walk, &START);
    ck_assert_int_eq(rig.walk.fault, WALK_FAULT_NONE);
    rig_run(&rig, 400);
    walk_let_go(&rig.walk);
    rig_walk_steps(&rig, 5, 0.05);
    ck_assert_int_eq(rig.walk.fault, WALK_FAULT_NONE);
}
END_TEST

START_TEST(rings_drop_the_oldest_and_count)
{
    struct rig rig;
    struct walk_event event;
    struct walk_step step;
    rig_init(&rig, SEA_IDEAL);
    rig_start(&rig, &START);
    walk_let_go(&rig.walk);
    for (int i = 0; i < 20000; i++) {
        for (int side = 0; side < SIDE_COUNT; side++) {
            sea_set_command(&rig.sea[side], &rig.command[side], rig.walk.time_s);
        }
        walk_advance(&rig.walk, rig.sea, 0.001);
    }
    ck_assert_uint_eq(rig.walk.events_written, WALK_EVENT_RING + rig.walk.events_lost);
    ck_assert_uint_eq(rig.walk.steps_written, WALK_STEP_RING + rig.walk.steps_lost);
    int events = 0, steps = 0;
    double last = 0.0;
    while (walk_next_event(&rig.walk, &event)) {
        ck_assert(event.time_s >= last);
        last = event.time_s;
        events++;
    }
    uint64_t index = 0;
    while (walk_next_step(&rig.walk, &step)) {
        ck_assert(index == 0 || step.index == index + 1);
        index = step.index;
        steps++;
    }
    ck_assert_int_eq(events, WALK_EVENT_RING);
    ck_assert_int_eq(steps, WALK_STEP_RING);
}
END_TEST

START_TEST(bad_parameters_are_named)
{
    struct walk_params params;
    walk_params_default(&PAPER, &params);
    ck_assert_ptr_null(walk_params_check(&params));
    params.slope_rad = 1.0;
    ck_assert_str_eq(walk_params_check(&params), "slope_rad");
    walk_params_default(&PAPER, &params);
    params.single_step_s = (double)NAN;
    ck_assert_str_eq(walk_params_check(&params), "single_step_s");
    walk_params_default(&PAPER, &params);
    params.body.gravity_m_s2 = 0.0;
    ck_assert_str_eq(walk_params_check(&params), "gravity_m_s2");
}
END_TEST

START_TEST(every_fault_has_its_own_name)
{
    for (int i = WALK_FAULT_NONE; i <= WALK_FAULT_NOT_FINITE; i++) {
        for (int k = WALK_FAULT_NONE; k < i; k++) {
            ck_assert_str_ne(walk_fault_name((enum walk_fault)i),
                             walk_fault_name((enum walk_fault)k));
        }
        ck_assert_str_ne(walk_fault_name((enum walk_fault)i), "unknown");
    }
    ck_assert_str_eq(walk_fault_name((enum walk_fault)99), "unknown");
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("walk");
    TCase *gait = tcase_create("gait"), *faults = tcase_create("faults"),
          *ground = tcase_create("ground");
    tcase_add_test(gait, the_start_hold_holds);
    tcase_add_test(gait, ideal_actuators_walk_the_papers_gait);
    tcase_add_test(gait, real_actuators_cost_no_more_than_their_latency);
    tcase_add_test(gait, the_spring_is_released_after_its_latency);
    tcase_add_test(gait, unarmed_there_is_no_push_off);
    tcase_add_test(gait, timed_by_the_controller_it_releases_on_command);
    tcase_add_test(gait, a_weak_spring_released_in_single_support_moves_nothing);
    tcase_add_test(gait, a_foot_not_quite_back_lands_earlier_and_stands_on_its_spring);
    tcase_add_test(gait, the_own_push_off_walks_without_the_device);
    tcase_add_test(gait, the_start_hold_takes_hold_again);
    tcase_add_test(gait, energy_is_accounted_for);
    tcase_add_test(gait, rings_drop_the_oldest_and_count);
    tcase_add_test(faults, released_in_single_support_it_throws_the_walker_off);
    tcase_add_test(faults, an_unretracted_foot_trips);
    tcase_add_test(faults, too_slow_it_turns_back);
    tcase_add_test(faults, without_a_foot_in_front_it_falls_forward);
    tcase_add_test(faults, waiting_for_a_trigger_that_cannot_come_it_is_stuck);
    tcase_add_test(faults, slippery_ground_ends_the_walk);
    tcase_add_test(faults, bad_parameters_are_named);
    tcase_add_test(faults, every_fault_has_its_own_name);
    tcase_add_test(ground, ground_carries_the_weight_on_average);
    tcase_add_test(ground, downhill_it_walks_without_pushing);
    tcase_add_test(ground, a_raised_foothold_is_met_at_its_height);
    tcase_add_test(ground, pushes_change_the_speed);
    suite_add_tcase(suite, gait);
    suite_add_tcase(suite, faults);
    suite_add_tcase(suite, ground);
    return run_suite(suite);
}
