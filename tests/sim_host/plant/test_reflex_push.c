/* What a push does to a person who walks by reflexes: their ankle takes what the spring had, and no more. What the spring
 * had is the textbook's, 1/2 k x^2, and what its motor did to it meanwhile. What the ankle takes is the integral of moment
 * and joint rate; and in the air, where no ground takes part, it is what the body's energy gains beside its muscles. */
#include "sim_host/persons/person.h"
#include "sim_host/plant/plant.h"
#include "tests/support/assert_close.h"

#include <math.h>

static const double PERIOD_S = 1e-4; /* tick and drive period */
static const double SPRING_N_PER_M = 7000.0, LEVER_M = 0.12;

/* The trapezium of a force over a period of h errs by less than k v^2 h / 2 a second: of a push of v = 0.5 m/s over 0.06 m
 * by 0.01 J. So a hundredth of a joule a push is allowed, and not a thousandth part of what the springs had. */
static const double TOLERANCE = 0.001, TOLERANCE_J = 0.01;

static struct plant plant;
static struct plant_config config;
static char message[PLANT_ERROR_MAX];

static void configure(const char *person_path)
{
    const struct walker3_params adult = {65.0, 2.5, 0.93, 9.80665};
    struct person person;
    char why[PERSON_MESSAGE_MAX];
    plant_config_for(&adult, SPRING_N_PER_M, SEA_REAL, SENSORS_IDEAL, &config);
    config.kind = PLANT_REFLEX_PERSON;
    config.tick_s = PERIOD_S;
    config.recording_start_tick = 1;
    ck_assert_msg(person_read(&person, person_path, why) == 0, "%s", why);
    reflex_person_default(70.0, 0.93, &config.reflex);
    person_muscles_apply(&person.muscles, &config.reflex);
    for (int side = 0; side < SIDE_COUNT; side++) {
        foot_switch_preset(FOOT_SWITCH_EXACT, 1, (uint64_t)side, &config.foot_switch[side]);
        config.sea[side].release_on = SEA_RELEASE_CONTACT;
        config.recording_format.ankle[side].lever_m = LEVER_M;
        ck_assert(config.sea[side].drive_period_s == PERIOD_S);
    }
    ck_assert_msg(plant_init(&plant, &config, message) == PLANT_OK, "%s", message);
}

/* Once a millisecond, as a bus would: loaded in late stance, held while it pushes. */
static void command(double precompression_m)
{
    struct plant_truth truth;
    plant_truth(&plant, &truth);
    for (int i = 0; i < SIDE_COUNT; i++) {
        const bool late = truth.contact[i] && truth.leg_angle_rad[i] < 0.0;
        const bool pushes = plant.sea[i].latch == SEA_LATCH_RELEASED;
        const struct sea_command asked = {SEA_POSITION, late || pushes ? precompression_m : 0.0,
                                          late && precompression_m > 0.0};
        plant_set_command(&plant, (enum side)i, &asked);
    }
}

/* From the right angle, below 0 when flexed. */
static double flexion_rad(enum side side)
{
    struct joint_angles joints;
    muscles_joint_angles(&plant.reflex.body, side, &joints);
    return joints.angle_rad[JOINT_ANKLE] - 1.57079632679489661923;
}

struct balance {
    double stored_J;  /* at the releases */
    double motor_J;   /* by the motors on released springs */
    double left_J;    /* in springs whose latch closes, or at the end */
    double taken_J;   /* by the ankles: moment times rate */
    double charged_J; /* by the ankles, as they flex against a spring: a part of taken_J, below 0 */
    int pushes, flexed;
};

struct moment {
    bool open;
    double force_N, motor_m, ankle_rad;
};

static void look(struct moment now[SIDE_COUNT])
{
    for (int i = 0; i < SIDE_COUNT; i++) {
        struct sea_output out;
        plant_sea_output(&plant, (enum side)i, &out);
        now[i] = (struct moment){out.latch != SEA_LATCH_CLOSED, out.ankle_force_N, out.position_m,
                                 flexion_rad((enum side)i)};
    }
}

static double energy_J(double force_N)
{
    return 0.5 * force_N * force_N / SPRING_N_PER_M;
}

/* A period of the drives. */
static void advance(struct balance *sum)
{
    struct moment from[SIDE_COUNT], to[SIDE_COUNT];
    look(from);
    plant_advance(&plant);
    look(to);
    for (int i = 0; i < SIDE_COUNT; i++) {
        if (to[i].open && !from[i].open) {
            const double lifted_m = LEVER_M * sin(from[i].ankle_rad);
            const double pressed_m = from[i].motor_m - (lifted_m > 0.0 ? lifted_m : 0.0);
            from[i].force_N = SPRING_N_PER_M * pressed_m;
            sum->stored_J += energy_J(from[i].force_N);
            sum->pushes++;
            sum->flexed += lifted_m < -0.01;
        }
        if (to[i].open) {
            const double before_Nm = from[i].force_N * LEVER_M * cos(from[i].ankle_rad);
            const double after_Nm = to[i].force_N * LEVER_M * cos(to[i].ankle_rad);
            const double taken_J =
                0.5 * (before_Nm + after_Nm) * (to[i].ankle_rad - from[i].ankle_rad);
            sum->taken_J += taken_J;
            sum->charged_J += taken_J < 0.0 ? taken_J : 0.0;
            sum->motor_J +=
                0.5 * (from[i].force_N + to[i].force_N) * (to[i].motor_m - from[i].motor_m);
        } else if (from[i].open) {
            sum->left_J += energy_J(from[i].force_N);
        }
    }
}

static const char *const PERSONS[] = {"adult70", "reflex-new", "reflex-used", "reflex-calf-left",
                                      "reflex-calf-both"};
static const double DOSES_M[] = {0.01, 0.03, 0.05};
enum { WALKS = 5 * 3 };

START_TEST(a_push_gives_what_its_spring_had)
{
    struct balance sum = {0};
    struct plant_energy energy;
    char path[64];
    struct moment end[SIDE_COUNT];
    const double dose_m = DOSES_M[_i % 3];
    snprintf(path, sizeof path, "sim_host/persons/%s.ini", PERSONS[_i / 3]);
    configure(path);
    for (int period = 0; period < 60000 && plant_fault(&plant) == WALK_FAULT_NONE; period++) {
        if (period % 10 == 0) {
            command(period < 15000 ? 0.0 : dose_m);
        }
        advance(&sum);
    }
    look(end);
    sum.left_J += energy_J(end[SIDE_LEFT].force_N) + energy_J(end[SIDE_RIGHT].force_N);
    const double given_J = sum.stored_J + sum.motor_J - sum.left_J;
    const double tolerance_J = TOLERANCE * sum.stored_J + TOLERANCE_J * sum.pushes;
    ck_assert_int_ge(sum.pushes, 2);
    ck_assert_int_ge(sum.flexed, 1); /* where the ankle is below its right angle */
    ck_assert_msg(fabs(sum.taken_J - given_J) < tolerance_J,
                  "%d pushes of %g m at %s: %g J of %g J (stored %g, motor %g, left %g)",
                  sum.pushes, dose_m, path, sum.taken_J, given_J, sum.stored_J, sum.motor_J,
                  sum.left_J);
    plant_energy(&plant, &energy);
    assert_close(energy.device_work_J[SIDE_LEFT] + energy.device_work_J[SIDE_RIGHT], sum.taken_J,
                 tolerance_J, 0.0);
}
END_TEST

/* Of the muscles in a period that begins here, once its step has told their moments. */
static double muscles_J(const struct joint_angles from[SIDE_COUNT])
{
    double work_J = 0.0;
    for (int side = 0; side < SIDE_COUNT; side++) {
        struct joint_angles to;
        muscles_joint_angles(&plant.reflex.body, (enum side)side, &to);
        for (int joint = 0; joint < JOINT_COUNT; joint++) {
            work_J += plant.reflex.torque_Nm[side][joint] *
                      (to.angle_rad[joint] - from[side].angle_rad[joint]);
        }
    }
    return work_J;
}

/* A latch that opens by itself, a metre above the ground, at an ankle that is flexed more or less. The body holds each
 * moment for a whole period: of the light foot's swings in the air that is 2 % of what the spring had. */
START_TEST(in_the_air_the_body_gains_what_the_spring_had)
{
    static const double angles_rad[] = {-0.2, -0.1, -0.03};
    struct balance sum = {0};
    struct moment end[SIDE_COUNT];
    double gained_J = 0.0;
    configure("sim_host/persons/adult70.ini");
    for (int period = 0; period < 5000; period++) {
        const struct sea_command hold = {SEA_POSITION, 0.02, false};
        plant_set_command(&plant, SIDE_RIGHT, &hold);
        plant.config.recording_start_tick = plant.tick + 2; /* stands until the motor is there */
        advance(&sum);
    }
    plant.reflex.body.q[MULTIBODY_Y] += 1.0;
    plant.reflex.body.q[MULTIBODY_RIGHT + PART_FOOT] += flexion_rad(SIDE_RIGHT) - angles_rad[_i];
    plant.config.recording_start_tick = plant.tick;
    advance(&sum); /* the muscles meet their new lengths */
    ck_assert(fabs(flexion_rad(SIDE_RIGHT) - angles_rad[_i]) < 0.01);
    plant.latch_broken[SIDE_RIGHT] = PLANT_LATCH_OPENS;
    for (int period = 0; period < 300; period++) {
        struct joint_angles from[SIDE_COUNT];
        for (int side = 0; side < SIDE_COUNT; side++) {
            muscles_joint_angles(&plant.reflex.body, (enum side)side, &from[side]);
        }
        gained_J -= multibody_energy_J(&config.reflex.segments, &plant.reflex.body);
        advance(&sum);
        gained_J +=
            multibody_energy_J(&config.reflex.segments, &plant.reflex.body) - muscles_J(from);
    }
    look(end);
    const double given_J = sum.stored_J + sum.motor_J - energy_J(end[SIDE_RIGHT].force_N);
    ck_assert_int_eq(sum.pushes, 1);
    assert_close(sum.stored_J, 0.5 * SPRING_N_PER_M * 0.02 * 0.02, 0.001, 0.0);
    ck_assert_msg(given_J > 0.5 && fabs(gained_J - given_J) < 0.02 * sum.stored_J, "%g J, not %g J",
                  gained_J, given_J);
}
END_TEST

/* Flexed further after the release, the person charges the spring, and gets it back. */
START_TEST(an_ankle_that_flexes_on_charges_its_spring)
{
    struct balance sum = {0};
    configure("sim_host/persons/reflex-calf-both.ini");
    for (int period = 0; period < 40000; period++) {
        if (period % 10 == 0) {
            command(period < 15000 ? 0.0 : 0.01);
        }
        advance(&sum);
    }
    ck_assert_msg(sum.charged_J < -0.1, "%g J", sum.charged_J);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("reflex_push");
    TCase *tests = tcase_create("all");
    tcase_set_timeout(tests, 240);
    tcase_add_loop_test(tests, a_push_gives_what_its_spring_had, 0, WALKS);
    tcase_add_loop_test(tests, in_the_air_the_body_gains_what_the_spring_had, 0, 3);
    tcase_add_test(tests, an_ankle_that_flexes_on_charges_its_spring);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
