/* A person who walks by reflexes as a plant: signs and sides as everybody's, forces that carry the body, and springs
 * that do to the ankle what they are there for. Held against statics, energy and what walking is. */
#include "sim_host/plant/plant.h"
#include "tests/support/assert_close.h"

#include <math.h>
#include <string.h>

enum { START_TICK = 100, EVENTS = 12 };

static struct plant plant;
static struct plant_config config;
static char message[PLANT_ERROR_MAX];

static void configure(void)
{
    const struct walker3_params adult = {65.0, 2.5, 0.93, 9.80665};
    plant_config_for(&adult, 7000.0, SEA_REAL, SENSORS_IDEAL, &config);
    config.kind = PLANT_REFLEX_PERSON;
    config.recording_start_tick = START_TICK;
    reflex_person_default(70.0, 0.93, &config.reflex);
    for (int side = 0; side < SIDE_COUNT; side++) {
        foot_switch_preset(FOOT_SWITCH_EXACT, 1, (uint64_t)side, &config.foot_switch[side]);
        config.sea[side].release_on = SEA_RELEASE_CONTACT;
    }
}

static void begin(void)
{
    ck_assert_msg(plant_init(&plant, &config, message) == PLANT_OK, "%s", message);
}

/* A tick in which both motors hold at the precompression where they may be loaded. */
static void tick(double precompression_m)
{
    struct plant_truth truth;
    struct sensor_sample sample;
    plant_truth(&plant, &truth);
    for (int i = 0; i < SIDE_COUNT; i++) {
        const enum side side = (enum side)i;
        const bool late = truth.contact[side] && truth.leg_angle_rad[side] < 0.0;
        const bool pushes = plant.sea[side].latch == SEA_LATCH_RELEASED;
        const struct sea_command command = {SEA_POSITION, late || pushes ? precompression_m : 0.0,
                                            late && precompression_m > 0.0};
        plant_set_command(&plant, side, &command);
        plant_sample(&plant, side, &sample);
    }
    plant_advance(&plant);
}

START_TEST(it_stands_until_it_may_walk)
{
    struct plant_truth before, after;
    configure();
    begin();
    plant_truth(&plant, &before);
    ck_assert(before.leg_angle_rad[SIDE_LEFT] > 0.1); /* ahead of the hip, as it is of a walker */
    ck_assert(before.leg_angle_rad[SIDE_RIGHT] < -0.1);
    for (int i = 0; i < START_TICK; i++) {
        tick(0.0);
    }
    plant_truth(&plant, &after);
    ck_assert_mem_eq(before.leg_angle_rad, after.leg_angle_rad, sizeof before.leg_angle_rad);
    ck_assert(before.hip_m[0] == after.hip_m[0]);
}
END_TEST

START_TEST(it_walks_towards_minus_x_and_its_feet_carry_it)
{
    struct walk_event event;
    struct plant_truth truth;
    int count[EVENTS] = {0};
    double carried_Ns = 0.0, start_m = 0.0, highest_m = 0.0;
    enum side last = SIDE_RIGHT;
    configure();
    begin();
    for (int i = 0; i < 10000; i++) {
        tick(0.0);
        plant_truth(&plant, &truth);
        start_m = i == 4000 ? truth.hip_m[0] : start_m;
        for (int side = 0; side < SIDE_COUNT; side++) {
            carried_Ns += i >= 4000 ? 0.001 * truth.ground_force_N[side][1] : 0.0;
            ck_assert(truth.contact[side] == (truth.ground_force_N[side][1] > 20.0));
            highest_m = truth.toe_m[side][1] > highest_m ? truth.toe_m[side][1] : highest_m;
        }
        while (plant_next_event(&plant, &event)) {
            count[event.kind]++;
            if (event.kind == WALK_EVENT_HEEL_STRIKE && count[event.kind] > 2) {
                ck_assert(event.value > 0.1 &&
                          event.side != last); /* ahead, left and right in turn */
            }
            last = event.kind == WALK_EVENT_HEEL_STRIKE ? event.side : last;
            ck_assert(event.kind != WALK_EVENT_TOE_OFF || event.value < 0.0);
            ck_assert(event.kind != WALK_EVENT_APEX || event.value > 0.5);
        }
    }
    ck_assert_int_eq(plant_fault(&plant), WALK_FAULT_NONE);
    assert_close(truth.hip_m[0] - start_m, -6.0 * 1.23, 0.0, 0.05);
    assert_close(carried_Ns / 6.0, 70.0 * 9.80665, 0.0,
                 0.02); /* what it weighs, over its strides */
    ck_assert_int_ge(count[WALK_EVENT_HEEL_STRIKE], 13);
    ck_assert_int_ge(count[WALK_EVENT_APEX], count[WALK_EVENT_HEEL_STRIKE] - 2);
    ck_assert(highest_m > 0.02 && highest_m < 0.4); /* the foot that swings */
}
END_TEST

/* A loaded spring that is let go presses the foot down: its energy goes into the person, not out of them. */
START_TEST(a_spring_pushes_the_person_off)
{
    struct plant_energy energy;
    struct walk_event event;
    const double precompression_m = 0.02;
    int releases = 0;
    configure();
    begin();
    for (int i = 0; i < 4000; i++) {
        tick(i < 1500 ? 0.0 : precompression_m);
        while (plant_next_event(&plant, &event)) {
            releases += event.kind == WALK_EVENT_RELEASE;
        }
    }
    plant_energy(&plant, &energy);
    const double stored_J = 0.5 * 7000.0 * precompression_m * precompression_m * releases;
    const double given_J = energy.device_work_J[SIDE_LEFT] + energy.device_work_J[SIDE_RIGHT];
    ck_assert_int_ge(releases, 3);
    ck_assert_msg(given_J > 0.3 * stored_J && given_J < 1.1 * stored_J, "%g of %g J", given_J,
                  stored_J);
}
END_TEST

static double ankle_rad(enum side side)
{
    struct joint_angles joints;
    muscles_joint_angles(&plant.reflex.body, side, &joints);
    return joints.angle_rad[JOINT_ANKLE];
}

static double rise_m(int ticks)
{
    struct plant_truth truth;
    double highest_m[2] = {-10.0, -10.0};
    for (int i = 0; i < ticks; i++) {
        tick(0.0);
        plant_truth(&plant, &truth);
        double *highest = &highest_m[i > ticks - 1200];
        if (i < 1200 || i > ticks - 1200) { /* a stride at the begin and at the end */
            *highest = truth.hip_m[1] > *highest ? truth.hip_m[1] : *highest;
        }
    }
    return highest_m[1] - highest_m[0];
}

/* The whole of it rises by the slope and its way, up and down; both feet stand on the line. */
START_TEST(a_slope_is_climbed)
{
    struct plant_truth start, end;
    const double slope_rad = _i == 0 ? 0.01 : -0.01;
    configure();
    begin();
    for (int i = 0; i < 5000; i++) {
        tick(0.0);
    }
    plant.walk.params.slope_rad = slope_rad;
    plant_truth(&plant, &start);
    const double risen_m = rise_m(10000);
    plant_truth(&plant, &end);
    ck_assert_int_eq(plant_fault(&plant), WALK_FAULT_NONE);
    assert_close(plant.slope_line.slope, tan(slope_rad), 1e-12, 0.0);
    const double way_m = start.hip_m[0] - end.hip_m[0];
    ck_assert(way_m > 5.0);
    assert_close(risen_m, way_m * slope_rad, 0.03,
                 0.0); /* a stride's way at either end: 1.3 m * slope */
    assert_close(plant.slope_line.height_m +
                     plant.slope_line.slope * plant.reflex.body.q[MULTIBODY_X],
                 way_m * slope_rad, 0.02, 0.0);
}
END_TEST

/* Footholds are as high as they were laid out, one a step, and what stands on them is as deep in them as on level
 * ground. */
START_TEST(footholds_have_their_heights)
{
    static const double heights_m[] = {0.001, -0.001, 0.002, 0.0, -0.002, 0.001};
    enum { HEIGHTS = sizeof heights_m / sizeof heights_m[0] };
    struct plant_truth truth;
    uint64_t laid = 0;
    configure();
    config.heights_m = heights_m;
    config.heights_count = HEIGHTS;
    begin();
    for (int i = 0; i < 8000; i++) {
        tick(0.0);
        plant_truth(&plant, &truth);
        if (plant_steps(&plant) != laid) {
            laid = plant_steps(&plant);
            const enum side side = truth.contact[SIDE_LEFT] ? SIDE_RIGHT : SIDE_LEFT;
            const double height_m = laid <= HEIGHTS ? heights_m[laid - 1] : 0.0;
            ck_assert(!truth.contact[side] && truth.leg_angle_rad[side] > 0.0);
            ck_assert(plant.reflex.ground[side][FOOT_BALL].height_m == height_m);
            ck_assert(truth.toe_m[side][1] > height_m);
        }
        for (int side = 0; side < SIDE_COUNT; side++) {
            const double over_m =
                truth.toe_m[side][1] - plant.reflex.ground[side][FOOT_BALL].height_m;
            ck_assert_msg(over_m > -0.025, "%g m", over_m);
        }
    }
    ck_assert_int_eq(plant_fault(&plant), WALK_FAULT_NONE);
    ck_assert_uint_ge(laid, 8);
}
END_TEST

/* No heel and no ball is inside the stair: behind its edge they are as deep in it as in level ground at most. What is
 * stopped there begins anew in every tick, and creeps. */
static void check_edge(double edge_m, double rise_m)
{
    for (int side = 0; side < SIDE_COUNT; side++) {
        for (int point = 0; point < FOOT_POINTS; point++) {
            const struct vector2 at_m =
                reflex_person_place(&plant.reflex, (enum side)side, (enum foot_point)point);
            ck_assert_msg(at_m.x < edge_m + 0.03 || at_m.y > rise_m - 0.025, "%g m behind, at %g m",
                          at_m.x - edge_m, at_m.y);
        }
    }
}

/* Walks to a stair and goes on for 6 s, or to a fall. */
static void walk_over_stair(double rise_m)
{
    configure();
    begin();
    for (int i = 0; i < 4000; i++) {
        tick(0.0);
    }
    plant_lay_stair(&plant, rise_m);
    const double edge_m = plant.stair.edge_m;
    ck_assert(edge_m > reflex_person_ball(&plant.reflex, SIDE_LEFT).x);
    ck_assert(edge_m > reflex_person_ball(&plant.reflex, SIDE_RIGHT).x);
    for (int i = 0; i < 6000 && plant_fault(&plant) == WALK_FAULT_NONE; i++) {
        tick(0.0);
        check_edge(edge_m, rise_m);
    }
}

/* Up and down, within what a sole clears: one stair, and then level ground that stays as high. */
START_TEST(a_low_stair_is_one_step)
{
    const double rise_m = _i == 0 ? 0.005 : -0.005;
    walk_over_stair(rise_m);
    ck_assert_int_eq(plant_fault(&plant), WALK_FAULT_NONE);
    ck_assert(plant.slope_line.height_m == rise_m && plant.stair.rise_m == 0.0);
    for (int side = 0; side < SIDE_COUNT; side++) {
        for (int point = 0; point < FOOT_POINTS; point++) {
            ck_assert(plant.reflex.ground[side][point].height_m == rise_m);
        }
    }
}
END_TEST

/* A foot in swing clears the ground by some 20 mm, and no reflex lifts it higher: it is stopped, and the body goes on. */
START_TEST(a_stair_above_the_sole_trips)
{
    walk_over_stair(0.1);
    ck_assert_int_eq(plant_fault(&plant), WALK_FAULT_FALLEN_FORWARD);
    ck_assert(plant.stair.rise_m == 0.1); /* nobody climbed it */
}
END_TEST

START_TEST(a_second_stair_waits_for_the_first_to_be_climbed)
{
    configure();
    begin();
    plant_lay_stair(&plant, 0.005);
    const struct plant_stair first = plant.stair;
    plant_lay_stair(&plant, 0.01);
    ck_assert_mem_eq(&plant.stair, &first, sizeof first);
}
END_TEST

START_TEST(rough_ground_is_drawn_by_the_seed)
{
    double height_m[3][SIDE_COUNT];
    for (int i = 0; i < 3; i++) {
        configure();
        config.roughness_m = 0.0005;
        config.seed = i == 2 ? 2 : 1;
        begin();
        for (int k = 0; k < 4000; k++) {
            tick(0.0);
        }
        for (int side = 0; side < SIDE_COUNT; side++) {
            height_m[i][side] = plant.reflex.ground[side][FOOT_BALL].height_m;
            ck_assert(height_m[i][side] != 0.0 && fabs(height_m[i][side]) < 0.003);
        }
    }
    ck_assert_mem_eq(height_m[0], height_m[1], sizeof height_m[0]);
    ck_assert(height_m[0][SIDE_LEFT] != height_m[2][SIDE_LEFT]);
}
END_TEST

/* The same walk without the device: as if its springs had no force, and nothing of them in the energy. */
START_TEST(who_does_not_wear_it_feels_nothing)
{
    struct plant_energy energy;
    double alone_m[2];
    for (int broken = 0; broken < 2; broken++) {
        configure();
        config.unworn = broken == 0;
        begin();
        for (int i = 0; i < 3000; i++) {
            for (int side = 0; side < SIDE_COUNT; side++) {
                plant_set_spring_scale(&plant, (enum side)side, broken ? 0.0 : 1.0);
            }
            tick(0.02);
        }
        plant_energy(&plant, &energy);
        ck_assert(energy.device_work_J[SIDE_LEFT] == 0.0 &&
                  energy.device_work_J[SIDE_RIGHT] == 0.0);
        alone_m[broken] = plant.reflex.body.q[MULTIBODY_X];
    }
    ck_assert(alone_m[0] == alone_m[1]);
    configure();
    begin();
    for (int i = 0; i < 3000; i++) {
        tick(0.02);
    }
    ck_assert(plant.reflex.body.q[MULTIBODY_X] != alone_m[0]);
}
END_TEST

START_TEST(who_has_fallen_lies_still)
{
    struct plant_truth before, after;
    configure();
    begin();
    for (int i = 0; i < 2000; i++) {
        tick(0.0);
    }
    plant_push(&plant, -250.0, 0.0);
    for (int i = 0; i < 5000 && plant_fault(&plant) == WALK_FAULT_NONE; i++) {
        tick(0.0);
    }
    ck_assert_int_ne(plant_fault(&plant), WALK_FAULT_NONE);
    plant_truth(&plant, &before);
    for (int i = 0; i < 1000; i++) {
        tick(0.0);
    }
    plant_truth(&plant, &after);
    ck_assert_mem_eq(before.hip_m, after.hip_m, sizeof before.hip_m);
    ck_assert_mem_eq(before.contact, after.contact, sizeof before.contact);
}
END_TEST

/* The same moment of a push twice, once with a spring that breaks: with it whole the ankle extends further. */
START_TEST(the_spring_extends_the_ankle)
{
    static struct plant copy;
    double extended_rad[2];
    configure();
    begin();
    int i = 0;
    while (plant.sea[SIDE_LEFT].latch != SEA_LATCH_RELEASED && i < 5000) {
        tick(i++ < 1500 ? 0.0 : 0.03);
    }
    ck_assert_int_eq(plant.sea[SIDE_LEFT].latch, SEA_LATCH_RELEASED);
    memcpy(&copy, &plant, sizeof plant);
    for (int broken = 0; broken < 2; broken++) {
        memcpy(&plant, &copy, sizeof plant);
        plant_set_spring_scale(&plant, SIDE_LEFT, broken ? 0.0 : 1.0);
        for (int k = 0; k < 20; k++) {
            tick(0.03);
        }
        extended_rad[broken] = ankle_rad(SIDE_LEFT);
    }
    ck_assert_msg(extended_rad[0] > extended_rad[1] + 0.01, "%g rad, without %g", extended_rad[0],
                  extended_rad[1]);
}
END_TEST

/* What a sensor is told of the ankle's speed is how its way changes. */
START_TEST(the_ankle_has_its_rate)
{
    struct plant_truth before, now, after;
    double fastest_m_s = 0.0;
    configure();
    begin();
    for (int i = 0; i < 3000; i++) {
        tick(0.0);
        plant_truth(&plant, &before);
        tick(0.0);
        plant_truth(&plant, &now);
        tick(0.0);
        plant_truth(&plant, &after);
        for (int side = 0; side < SIDE_COUNT; side++) {
            const double rate_m_s =
                (after.ankle_m[side] - before.ankle_m[side]) / (2.0 * config.tick_s);
            if (before.ankle_m[side] > 0.0 && now.ankle_m[side] > 0.0 &&
                after.ankle_m[side] > 0.0) {
                ck_assert_msg(fabs(now.ankle_rate_m_s[side] - rate_m_s) <
                                  0.05 + 0.2 * fabs(rate_m_s),
                              "%g m/s, not %g", now.ankle_rate_m_s[side], rate_m_s);
                fastest_m_s = fmax(fastest_m_s, fabs(rate_m_s));
            }
        }
    }
    ck_assert(fastest_m_s > 0.1);
}
END_TEST

/* Pushed backwards (+x) and forwards, alike. */
START_TEST(a_push_is_the_worlds)
{
    configure();
    begin();
    for (int i = 0; i < 2000; i++) {
        tick(0.0);
    }
    const double before_m_s = plant.reflex.body.dq[MULTIBODY_X];
    plant_push(&plant, 10.0, 0.0);
    ck_assert(plant.reflex.body.dq[MULTIBODY_X] < before_m_s); /* its own x is ahead */
    plant_push(&plant, -10.0, 0.0);
    assert_close(plant.reflex.body.dq[MULTIBODY_X], before_m_s, 1e-12, 0.0);
}
END_TEST

/* A knock against the walk and one with it: it goes down on the side it was knocked to. */
START_TEST(a_fall_has_its_direction)
{
    configure();
    begin();
    for (int i = 0; i < 2000; i++) {
        tick(0.0);
    }
    plant_push(&plant, _i == 0 ? 250.0 : -250.0, 0.0);
    for (int i = 0; i < 5000 && plant_fault(&plant) == WALK_FAULT_NONE; i++) {
        tick(0.0);
    }
    ck_assert_int_eq(plant_fault(&plant),
                     _i == 0 ? WALK_FAULT_FALLEN_BACKWARD : WALK_FAULT_FALLEN_FORWARD);
}
END_TEST

START_TEST(a_copy_has_the_same_future)
{
    static struct plant copy;
    configure();
    begin();
    for (int i = 0; i < 1500; i++) {
        tick(0.02);
    }
    memcpy(&copy, &plant, sizeof plant);
    for (int i = 0; i < 500; i++) {
        tick(0.02);
    }
    const struct reflex_person one = plant.reflex;
    memcpy(&plant, &copy, sizeof plant);
    for (int i = 0; i < 500; i++) {
        tick(0.02);
    }
    ck_assert_mem_eq(&one.body, &plant.reflex.body, sizeof one.body);
    ck_assert_mem_eq(&one.muscle, &plant.reflex.muscle, sizeof one.muscle);
}
END_TEST

START_TEST(a_person_out_of_range_is_refused_by_name)
{
    configure();
    config.reflex.mass_kg = (double)NAN;
    ck_assert_int_eq(plant_init(&plant, &config, message), PLANT_BAD_PERSON);
    ck_assert_ptr_nonnull(strstr(message, "mass_kg"));
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("reflex_plant");
    TCase *tests = tcase_create("all");
    tcase_set_timeout(tests, 240);
    tcase_add_test(tests, it_stands_until_it_may_walk);
    tcase_add_test(tests, it_walks_towards_minus_x_and_its_feet_carry_it);
    tcase_add_test(tests, a_spring_pushes_the_person_off);
    tcase_add_loop_test(tests, a_slope_is_climbed, 0, 2);
    tcase_add_test(tests, footholds_have_their_heights);
    tcase_add_loop_test(tests, a_low_stair_is_one_step, 0, 2);
    tcase_add_test(tests, a_stair_above_the_sole_trips);
    tcase_add_test(tests, a_second_stair_waits_for_the_first_to_be_climbed);
    tcase_add_test(tests, rough_ground_is_drawn_by_the_seed);
    tcase_add_test(tests, who_does_not_wear_it_feels_nothing);
    tcase_add_test(tests, who_has_fallen_lies_still);
    tcase_add_test(tests, the_spring_extends_the_ankle);
    tcase_add_test(tests, the_ankle_has_its_rate);
    tcase_add_test(tests, a_push_is_the_worlds);
    tcase_add_loop_test(tests, a_fall_has_its_direction, 0, 2);
    tcase_add_test(tests, a_copy_has_the_same_future);
    tcase_add_test(tests, a_person_out_of_range_is_refused_by_name);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
