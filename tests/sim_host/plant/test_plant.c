/* The facade: the whole plant driven like nodes drive it, its bits, its snapshots, its refusals. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sim_host/plant/plant.h"
#include "tests/support/assert_close.h"

/* A controller that sees the truth: paper's law at a held push-off. */
struct pilot {
    struct sea_command command[SIDE_COUNT];
    double r0_m;
    double last_speed;
    int events[9];
    struct walk_step last_step;
};

static void pilot_init(struct pilot *pilot, double r0_m)
{
    memset(pilot, 0, sizeof *pilot);
    pilot->r0_m = r0_m;
    pilot->command[SIDE_LEFT] = (struct sea_command){SEA_POSITION, r0_m, false};
    pilot->command[SIDE_RIGHT] = (struct sea_command){SEA_POSITION, 0.0, false};
}

static void pilot_tick(struct pilot *pilot, struct plant *plant)
{
    struct walk_event event;
    struct sensor_sample sample;
    for (int i = 0; i < SIDE_COUNT; i++) {
        plant_set_command(plant, (enum side)i, &pilot->command[i]);
        plant_sample(plant, (enum side)i, &sample);
    }
    plant_advance(plant);
    while (plant_next_event(plant, &event)) {
        pilot->events[event.kind]++;
        struct sea_command *own = &pilot->command[event.side];
        switch (event.kind) {
        case WALK_EVENT_APEX:
            pilot->last_speed = event.value;
            *own = (struct sea_command){SEA_POSITION, pilot->r0_m, true};
            break;
        case WALK_EVENT_HEEL_STRIKE:
            own->target_position_m = pilot->r0_m;
            break;
        case WALK_EVENT_LIFT_OFF:
            *own = (struct sea_command){SEA_POSITION, 0.0, false};
            break;
        case WALK_EVENT_TAKE_HOLD:
            *own = (struct sea_command){SEA_POSITION, pilot->r0_m, false};
            pilot->command[side_other(event.side)] = (struct sea_command){SEA_POSITION, 0.0, false};
            break;
        default:
            break;
        }
    }
    while (plant_next_step(plant, &pilot->last_step)) {
    }
}

static struct plant plant, copy;
static char message[PLANT_ERROR_MAX];

START_TEST(the_default_plant_walks)
{
    struct plant_config config;
    struct pilot pilot;
    plant_config_default(&config);
    ck_assert_int_eq(plant_init(&plant, &config, message), PLANT_OK);
    pilot_init(&pilot, 0.05);
    for (int tick = 0; tick < 40000; tick++) {
        pilot_tick(&pilot, &plant);
    }
    ck_assert_int_eq(plant_fault(&plant), WALK_FAULT_NONE);
    ck_assert_int_eq(pilot.events[WALK_EVENT_LET_GO], 1);
    ck_assert_int_ge(pilot.events[WALK_EVENT_APEX], 38);
    assert_close(pilot.last_speed, 0.40696, 0.0, 1e-3);
    struct plant_truth truth;
    plant_truth(&plant, &truth);
    assert_close(truth.time_s, 40.0, 1e-9, 0.0);
    ck_assert(truth.hip_m[0] < -10.0); /* towards -x */
    /* Legs end where the hip is. */
    for (int side = 0; side < SIDE_COUNT; side++) {
        const double leg = 1.0 + truth.ankle_m[side];
        assert_close(truth.hip_m[0] - truth.toe_m[side][0], leg * sin(truth.leg_angle_rad[side]),
                     1e-9, 0.0);
        assert_close(truth.hip_m[1] - truth.toe_m[side][1], leg * cos(truth.leg_angle_rad[side]),
                     1e-9, 0.0);
    }
    plant_free(&plant);
}
END_TEST

START_TEST(it_lets_go_at_the_configured_tick)
{
    struct plant_config config;
    struct pilot pilot;
    plant_config_default(&config);
    config.start_hold.release_tick = 1500;
    ck_assert_int_eq(plant_init(&plant, &config, message), PLANT_OK);
    pilot_init(&pilot, 0.05);
    for (int tick = 0; tick <= 1500; tick++) {
        ck_assert_int_eq(plant.walk.phase, WALK_HELD);
        pilot_tick(&pilot, &plant);
    }
    ck_assert_int_eq(plant.walk.phase, WALK_SINGLE);
}
END_TEST

START_TEST(drives_without_torque_are_not_let_go)
{
    struct plant_config config;
    struct pilot pilot;
    plant_config_default(&config);
    ck_assert_int_eq(plant_init(&plant, &config, message), PLANT_OK);
    pilot_init(&pilot, 0.05);
    pilot.command[SIDE_RIGHT].mode = SEA_TORQUE_OFF;
    for (int tick = 0; tick <= 3000; tick++) {
        pilot_tick(&pilot, &plant);
    }
    ck_assert_int_eq(plant.walk.phase, WALK_HELD);
}
END_TEST

START_TEST(a_copy_has_the_same_future)
{
    struct plant_config config;
    struct pilot pilot, pilot_copy;
    plant_config_default(&config);
    config.roughness_m = 1e-4;
    ck_assert_int_eq(plant_init(&plant, &config, message), PLANT_OK);
    pilot_init(&pilot, 0.05);
    for (int tick = 0; tick < 5123; tick++) {
        pilot_tick(&pilot, &plant);
    }
    copy = plant;
    pilot_copy = pilot;
    for (int tick = 0; tick < 3000; tick++) {
        pilot_tick(&pilot, &plant);
        pilot_tick(&pilot_copy, &copy);
    }
    ck_assert(memcmp(&plant.walk.state, &copy.walk.state, sizeof plant.walk.state) == 0);
    ck_assert(memcmp(&plant.sensor, &copy.sensor, sizeof plant.sensor) == 0);
    ck_assert_int_eq(plant.walk.fault, copy.walk.fault);
}
END_TEST

static uint64_t mix(uint64_t hash, const void *data, size_t bytes)
{
    const unsigned char *at = data;
    for (size_t i = 0; i < bytes; i++) {
        hash = (hash ^ at[i]) * 0x100000001B3u;
    }
    return hash;
}

/* The plant at everything it can do, as one number. Bits, not tolerances: the literal below must come out
 * of every compiler and every optimisation level. When the plant's behaviour is changed on purpose,
 * the new number is the one printed by the failing test. */
START_TEST(same_bits_everywhere)
{
    static const uint64_t EXPECTED = 0x791AF30BB02F6ADCu;
    struct plant_config config;
    struct pilot pilot;
    uint64_t hash = 0xCBF29CE484222325u;
    plant_config_default(&config);
    config.seed = 42;
    config.start = (struct walk_pose){SIDE_LEFT, 0.175299, -0.354601, -0.6916, -0.568336};
    config.sea[0].release_jitter_s = config.sea[1].release_jitter_s = 1e-4;
    config.sensors[0].latency_s = config.sensors[1].latency_s = 1.3e-3;
    config.sensors[0].angle_coloured_rad = 1e-4;
    config.sensors[1].drop_probability = 0.01;
    config.sensors[1].ankle_is_lever = true;
    config.walk.slope_rad = -0.0005;
    config.roughness_m = 2e-5;
    config.start_hold.hold_after_fall = true;
    ck_assert_int_eq(plant_init(&plant, &config, message), PLANT_OK);
    pilot_init(&pilot, 0.05);
    for (int tick = 0; tick < 30000; tick++) {
        pilot_tick(&pilot, &plant);
        hash = mix(hash, plant.walk.state.q, sizeof plant.walk.state.q);
        hash = mix(hash, plant.walk.state.dq, sizeof plant.walk.state.dq);
        for (int side = 0; side < SIDE_COUNT; side++) {
            hash = mix(hash, &plant.sea[side].position_m, sizeof(double));
            hash = mix(hash, &plant.sensor[side].last.leg_angle_counts, sizeof(int32_t));
            hash = mix(hash, &plant.sensor[side].last.ankle_counts, sizeof(int16_t));
        }
        if (tick == 12000) {
            plant_push(&plant, -0.01, 0.0);
        }
        if (tick == 20000) {
            plant_set_spring_scale(&plant, SIDE_LEFT, 0.0);
        }
        if (tick == 22000) {
            plant_set_spring_scale(&plant, SIDE_LEFT, 1.0);
        }
    }
    ck_assert_int_ge(pilot.events[WALK_EVENT_LIFT_OFF], 15);
    ck_assert_msg(hash == EXPECTED, "hash is 0x%016llXu", (unsigned long long)hash);
}
END_TEST

START_TEST(a_broken_spring_and_a_stiffer_one)
{
    static const double SCALES[] = {0.0, 1.5, -3.0, 1e9};
    for (int i = 0; i < 4; i++) {
        struct plant_config config;
        struct pilot pilot;
        plant_config_default(&config);
        ck_assert_int_eq(plant_init(&plant, &config, message), PLANT_OK);
        pilot_init(&pilot, 0.05);
        for (int tick = 0; tick < 4000; tick++) {
            pilot_tick(&pilot, &plant);
        }
        plant_set_spring_scale(&plant, SIDE_LEFT, SCALES[i]);
        plant_set_spring_scale(&plant, SIDE_RIGHT, SCALES[i]);
        struct sea_output out;
        plant_sea_output(&plant, plant.walk.stance, &out);
        const double want = SCALES[i] < 0.0 ? 0.0 : (SCALES[i] > 100.0 ? 100.0 : SCALES[i]);
        assert_close(plant.sea[0].params.spring_N_per_m, 100.0 * want, 1e-9, 0.0);
        for (int tick = 0; tick < 6000; tick++) {
            pilot_tick(&pilot, &plant);
        }
        if (i == 0) {
            ck_assert_int_ne(plant_fault(&plant), WALK_FAULT_NONE);
        }
    }
}
END_TEST

START_TEST(own_push_hands_over)
{
    struct plant_config config;
    struct pilot pilot;
    plant_config_default(&config);
    config.walk.own_push_N_per_m = 100.0;
    config.walk.own_push_rest_m = 0.05;
    ck_assert_int_eq(plant_init(&plant, &config, message), PLANT_OK);
    pilot_init(&pilot, 0.05);
    for (int tick = 0; tick < 20000; tick++) {
        /* The person gives the work over to the device within ten seconds: two half springs in
         * parallel push like one. */
        const double own = tick < 6000 ? 1.0 : (tick < 16000 ? 1.0 - (tick - 6000) / 1e4 : 0.0);
        plant_set_own_push(&plant, 100.0 * own, 0.05);
        plant_set_spring_scale(&plant, SIDE_LEFT, 1.0 - own);
        plant_set_spring_scale(&plant, SIDE_RIGHT, 1.0 - own);
        pilot_tick(&pilot, &plant);
    }
    ck_assert_int_eq(plant_fault(&plant), WALK_FAULT_NONE);
    assert_close(pilot.last_speed, 0.40696, 0.0, 5e-3);
    struct plant_energy energy;
    plant_energy(&plant, &energy);
    ck_assert(energy.own_work_J > 0.3 && energy.device_work_J[0] + energy.device_work_J[1] > 0.5);
}
END_TEST

START_TEST(heights_are_laid_foot_by_foot)
{
    static const double HEIGHTS[] = {0.0003, 0.0005, -0.0004, 0.0};
    struct plant_config config;
    struct pilot pilot;
    plant_config_default(&config);
    config.heights_m = HEIGHTS;
    config.heights_count = 4;
    ck_assert_int_eq(plant_init(&plant, &config, message), PLANT_OK);
    pilot_init(&pilot, 0.05);
    int steps = 0;
    for (int tick = 0; tick < 9000 && steps < 6; tick++) {
        const int before = pilot.events[WALK_EVENT_LIFT_OFF];
        pilot_tick(&pilot, &plant);
        if (pilot.events[WALK_EVENT_LIFT_OFF] > before) {
            assert_close(plant.walk.foot_m[1], steps < 4 ? HEIGHTS[steps] : 0.0, 1e-12, 0.0);
            steps++;
        }
    }
    ck_assert_int_eq(steps, 6);
}
END_TEST

/* Behind a stair every foothold is as high as its first one, above or below what the ground has by itself. */
START_TEST(a_stair_lifts_all_ground_behind_it)
{
    static const double HEIGHTS[] = {0.0, 0.0, 0.0, 0.0003};
    const double rise_m = _i == 0 ? 0.0004 : -0.0004;
    struct plant_config config;
    struct pilot pilot;
    plant_config_default(&config);
    config.heights_m = HEIGHTS;
    config.heights_count = 4;
    ck_assert_int_eq(plant_init(&plant, &config, message), PLANT_OK);
    pilot_init(&pilot, 0.05);
    int steps = 0;
    for (int tick = 0; tick < 9000 && steps < 6; tick++) {
        const int before = pilot.events[WALK_EVENT_LIFT_OFF];
        pilot_tick(&pilot, &plant);
        if (pilot.events[WALK_EVENT_LIFT_OFF] > before) {
            steps++;
            assert_close(plant.walk.foot_m[1],
                         (steps > 2 ? rise_m : 0.0) + (steps == 4 ? HEIGHTS[3] : 0.0), 1e-12, 0.0);
            if (steps == 2) {
                plant_lay_stair(&plant, rise_m);
            }
        }
    }
    ck_assert_int_eq(steps, 6);
}
END_TEST

START_TEST(energy_of_motor_spring_and_walker)
{
    struct plant_config config;
    struct pilot pilot;
    struct plant_energy start, end;
    plant_config_default(&config);
    ck_assert_int_eq(plant_init(&plant, &config, message), PLANT_OK);
    pilot_init(&pilot, 0.05);
    for (int tick = 0; tick < 1001; tick++) {
        pilot_tick(&pilot, &plant);
    }
    plant_energy(&plant, &start);
    for (int tick = 0; tick < 20000; tick++) {
        pilot_tick(&pilot, &plant);
    }
    plant_energy(&plant, &end);
    const double work = end.device_work_J[0] + end.device_work_J[1];
    assert_close(end.walker_J - start.walker_J, work - end.collision_loss_J, 1e-5, 0.0);
    /* The motors put in at least what came out of the springs. */
    const double motor =
        end.motor_work_J[0] + end.motor_work_J[1] - start.motor_work_J[0] - start.motor_work_J[1];
    ck_assert(motor + start.springs_J >= work + end.springs_J - 1e-3);
}
END_TEST

/* Absurd commands, bodies and times: always a named end, never a NaN. */
START_TEST(whatever_is_commanded_the_state_stays_a_number)
{
    struct rng rng;
    rng_init(&rng, 2026, (uint64_t)_i);
    struct plant_config config;
    const struct walker3_params body = {
        .hip_mass_kg = 1.0 + 80.0 * rng_uniform(&rng),
        .leg_mass_kg = 0.01 + 5.0 * rng_uniform(&rng),
        .leg_length_m = 0.3 + rng_uniform(&rng),
        .gravity_m_s2 = 9.80665,
    };
    plant_config_for(&body, 50.0 + 20000.0 * rng_uniform(&rng),
                     rng_uniform(&rng) < 0.3 ? SEA_IDEAL : SEA_REAL, SENSORS_14BIT, &config);
    config.seed = (uint64_t)_i;
    config.start_hold.release_tick = 100;
    config.start_hold.least_load_m = 0.0;
    config.start_hold.settle_ticks = 0;
    config.start_hold.position_tolerance_m = 0.9;
    config.start_hold.hold_after_fall = true;
    config.start_hold.fall_ticks = 50;
    config.roughness_m = rng_uniform(&rng) < 0.5 ? 0.0 : 0.02;
    config.walk.slope_rad = 0.2 * (rng_uniform(&rng) - 0.5);
    config.walk.unarmed_hold_s = rng_uniform(&rng) < 0.5 ? 0.0 : 0.5;
    for (int side = 0; side < SIDE_COUNT; side++) {
        config.sea[side].release_on = (enum sea_release)(4.0 * rng_uniform(&rng));
    }
    ck_assert_msg(plant_init(&plant, &config, message) == PLANT_OK, "%s", message);
    for (int tick = 0; tick < 8000; tick++) {
        for (int i = 0; i < SIDE_COUNT; i++) {
            struct sensor_sample sample;
            struct sea_output out;
            if (rng_uniform(&rng) < 0.02) {
                const double target = 0.6 * (rng_uniform(&rng) - 0.3) * body.leg_length_m;
                const struct sea_command command = {
                    (enum sea_mode)(rng_uniform(&rng) < 0.9 ? 1 : 2.99 * rng_uniform(&rng)), target,
                    rng_uniform(&rng) < 0.7};
                plant_set_command(&plant, (enum side)i, &command);
            }
            plant_sample(&plant, (enum side)i, &sample);
            plant_sea_output(&plant, (enum side)i, &out);
            ck_assert(isfinite(out.position_m) && isfinite(out.motor_force_N));
            ck_assert(out.spring_force_N >= 0.0 && out.ankle_force_N >= 0.0);
        }
        if (rng_uniform(&rng) < 0.003) {
            plant_push(&plant, 3.0 * (rng_uniform(&rng) - 0.5), 3.0 * (rng_uniform(&rng) - 0.5));
        }
        if (rng_uniform(&rng) < 0.002) {
            plant_set_own_push(&plant, 5000.0 * rng_uniform(&rng), 0.2 * rng_uniform(&rng));
        }
        plant_advance(&plant);
        for (int i = 0; i < WALKER3_DOF; i++) {
            ck_assert(isfinite(plant.walk.state.q[i]) && isfinite(plant.walk.state.dq[i]));
        }
        ck_assert_int_ne(plant_fault(&plant), WALK_FAULT_NOT_FINITE);
        ck_assert(plant.walk.state.q[WALKER3_ANKLE] >= -1e-12);
    }
    plant_free(&plant);
}
END_TEST

START_TEST(bad_configurations_are_refused_by_name)
{
    struct plant_config config;
    plant_config_default(&config);
    config.walk.body.leg_mass_kg = 0.0;
    ck_assert_int_eq(plant_init(&plant, &config, message), PLANT_BAD_BODY);
    ck_assert_str_eq(message, "body: leg_mass_kg is out of range");
    plant_config_default(&config);
    config.walk.stuck_s = 0.0;
    ck_assert_int_eq(plant_init(&plant, &config, message), PLANT_BAD_WALK);
    plant_config_default(&config);
    config.start.theta_s_rad = (double)NAN;
    ck_assert_int_eq(plant_init(&plant, &config, message), PLANT_BAD_START);
    plant_config_default(&config);
    config.start_hold.release_grid_ticks = 0;
    ck_assert_int_eq(plant_init(&plant, &config, message), PLANT_BAD_START_HOLD);
    plant_config_default(&config);
    config.sea[SIDE_RIGHT].counts_per_m = 0.0;
    ck_assert_int_eq(plant_init(&plant, &config, message), PLANT_BAD_SEA);
    ck_assert_str_eq(message, "sea right: counts_per_m is out of range");
    plant_config_default(&config);
    config.sensors[SIDE_LEFT].latency_s = 1.0;
    ck_assert_int_eq(plant_init(&plant, &config, message), PLANT_BAD_SENSOR);
    plant_config_default(&config);
    config.roughness_m = -1.0;
    ck_assert_int_eq(plant_init(&plant, &config, message), PLANT_BAD_GROUND);
    plant_config_default(&config);
    config.heights_count = 3;
    ck_assert_int_eq(plant_init(&plant, &config, message), PLANT_BAD_GROUND);
    plant_config_default(&config);
    config.sea[SIDE_LEFT].drive_period_s = 1.5e-4;
    config.sea[SIDE_RIGHT].drive_period_s = 1.5e-4;
    ck_assert_int_eq(plant_init(&plant, &config, message), PLANT_BAD_TICK);
    plant_config_default(&config);
    config.sea[SIDE_LEFT].drive_period_s = 2e-4;
    ck_assert_int_eq(plant_init(&plant, &config, message), PLANT_BAD_TICK);
}
END_TEST

START_TEST(another_body_walks_too)
{
    struct plant_config config;
    struct pilot pilot;
    const struct walker3_params adult = {65.0, 2.5, 0.93, 9.80665};
    plant_config_for(&adult, 7000.0, SEA_REAL, SENSORS_17BIT, &config);
    ck_assert_int_eq(plant_init(&plant, &config, message), PLANT_OK);
    pilot_init(&pilot, 0.05 * 0.93);
    for (int tick = 0; tick < 30000; tick++) {
        pilot_tick(&pilot, &plant);
    }
    ck_assert_int_eq(plant_fault(&plant), WALK_FAULT_NONE);
    ck_assert_int_ge(pilot.events[WALK_EVENT_APEX], 25);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("plant");
    TCase *tcase = tcase_create("facade");
    tcase_set_timeout(tcase, 60);
    tcase_add_test(tcase, the_default_plant_walks);
    tcase_add_test(tcase, it_lets_go_at_the_configured_tick);
    tcase_add_test(tcase, drives_without_torque_are_not_let_go);
    tcase_add_test(tcase, a_copy_has_the_same_future);
    tcase_add_test(tcase, same_bits_everywhere);
    tcase_add_test(tcase, a_broken_spring_and_a_stiffer_one);
    tcase_add_test(tcase, own_push_hands_over);
    tcase_add_test(tcase, heights_are_laid_foot_by_foot);
    tcase_add_loop_test(tcase, a_stair_lifts_all_ground_behind_it, 0, 2);
    tcase_add_test(tcase, energy_of_motor_spring_and_walker);
    tcase_add_loop_test(tcase, whatever_is_commanded_the_state_stays_a_number, 0, 40);
    tcase_add_test(tcase, bad_configurations_are_refused_by_name);
    tcase_add_test(tcase, another_body_walks_too);
    suite_add_tcase(suite, tcase);
    return run_suite(suite);
}
