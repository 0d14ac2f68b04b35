/* A device file's [plant] sections: whose key wins, and what is refused. */
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "sim_host/subjects/subject.h"
#include "tests/support/assert_close.h"

#define DEVICE "sim_host/devices/exo50.ini"
#define PERSON "sim_host/persons/adult70.ini"

static char path[64], message[SUBJECT_MESSAGE_MAX];
static struct subject subject;
static struct control_params params;

/* The shipped device with further lines at its end: a section may be opened again. */
static int read_with(const char *lines)
{
    char text[16384];
    FILE *file = fopen(DEVICE, "rb");
    ck_assert_ptr_nonnull(file);
    const size_t length = fread(text, 1, sizeof text, file);
    ck_assert_int_eq(fclose(file), 0);
    ck_assert_uint_lt(length, sizeof text);
    (void)snprintf(path, sizeof path, "/tmp/test_actuators_%ld.ini", (long)getpid());
    file = fopen(path, "wb");
    ck_assert_ptr_nonnull(file);
    ck_assert_uint_eq(fwrite(text, 1, length, file), length);
    ck_assert_int_ge(fputs(lines, file), 0);
    ck_assert_int_eq(fclose(file), 0);
    message[0] = '\0';
    const int result = subject_read(&subject, PERSON, path, message);
    (void)unlink(path);
    return result;
}

static int params_of(double r0_m, double r0_max_m)
{
    subject.is_person = true;
    person_override(&subject.person, "start_r0_m", r0_m);
    if (r0_max_m > 0.0) {
        person_override(&subject.person, "r0_max_m", r0_max_m);
    }
    return subject_control_params(&subject, &params, message);
}

START_TEST(a_leg_s_own_section_goes_before_that_of_both)
{
    ck_assert_msg(
        read_with(
            "[right.plant]\nsupply_shared = 0\n[left.plant]\nsupply_shared = 0\nsupply_V = 24\n") ==
            0,
        "%s", message);
    ck_assert(subject.actuators.as_built);
    assert_close(subject.actuators.config[SIDE_LEFT].supply_V, 24.0, 0.0, 0.0);
    assert_close(subject.actuators.config[SIDE_RIGHT].supply_V, 36.0, 0.0, 0.0);
    assert_close(subject.actuators.config[SIDE_LEFT].torque_constant_Nm_A, 0.0136, 0.0, 0.0);
}
END_TEST

START_TEST(tables_are_read)
{
    ck_assert_msg(read_with("[right.plant]\nlever_table = -0.5 0.08, 0 0.12, 0.6 0.1\n") == 0, "%s",
                  message);
    ck_assert_int_eq(subject.actuators.config[SIDE_RIGHT].lever_table.count, 3);
    ck_assert_int_eq(subject.actuators.config[SIDE_LEFT].lever_table.count, 0);
}
END_TEST

static const struct {
    const char *lines, *says;
} REFUSED[] = {
    {"[left.plant]\nsupply_V = 24\n", "one battery has one supply_V"},
    {"[right.plant]\nsupply_shared = 0\n", "supply_shared is 1 at the left leg and 0 at the right"},
    {"[plant]\nsupply_V = 24\n", "key \"supply_V\" is given twice"},
    {"[left.plant]\ntorque = 1\n", "[left.plant]: unknown key \"torque\""},
    {"[right.plant]\nsupply_V = 0\n",
     "[right.plant]: key \"supply_V\" (without load): 0 is out of range"},
    {"[left.plant]\nspring_table = 0.01 100\n", "[left.plant]: the spring is told 2 times"},
};

START_TEST(what_is_wrong_is_refused_with_leg_and_key)
{
    ck_assert_int_eq(read_with(REFUSED[_i].lines), -1);
    ck_assert_msg(strstr(message, REFUSED[_i].says) != NULL, "said: %s", message);
}
END_TEST

/* Everything that cannot be built together is refused before anything moves. */
static const struct {
    const char *lines, *says;
    double r0_m;
} UNFIT[] = {
    {"", "", 0.035},
    {"[left.plant]\ncurrent_peak_A = 12\n", "left leg: spring over motor", 0.04},
    {"[right.plant]\nlever_m = 0.05\n", "right leg: stroke over lever", 0.035},
    {"[left.plant]\nmotor_speed_max_rad_s = 300\n", "left leg: speed over motor", 0.035},
    {"[right.plant]\nsupply_shared = 0\n[left.plant]\nsupply_shared = 0\nsupply_current_max_A = 1\n",
     "left leg: energy over supply", 0.035},
    {"[left.plant]\nlatch_holding_N = 300\n", "left leg: spring over latch", 0.035},
    {"", "precompression over stroke", 0.06},
};

START_TEST(what_cannot_be_built_is_refused_before_anything_moves)
{
    ck_assert_msg(read_with(UNFIT[_i].lines) == 0, "%s", message);
    const int result = params_of(UNFIT[_i].r0_m, 0.0);
    ck_assert_msg((result == 0) == (UNFIT[_i].says[0] == '\0'), "%s", message);
    ck_assert_msg(strstr(message, UNFIT[_i].says) != NULL, "said: %s", message);
}
END_TEST

START_TEST(an_idealised_device_s_own_numbers_must_fit_too)
{
    /* A force limit below k r0, and a stroke that the lever cannot make. */
    subject_default(&subject);
    ck_assert_msg(params_of(0.05, 0.3) == 0, "%s", message);
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        device_file_set(&subject.device, (enum side)leg, DEVICE_LEG_force_max_N, 20.0);
    }
    ck_assert_int_eq(params_of(0.05, 0.3), -1);
    ck_assert_msg(
        strstr(message, "spring over motor: at r0_max_m, 0.3 m, the spring pushes with 30 N") !=
            NULL,
        "said: %s", message);
    subject_default(&subject);
    subject.device.description.leg[SIDE_RIGHT].ankle = DEVICE_ANKLE_LEVER;
    device_file_set(&subject.device, SIDE_RIGHT, DEVICE_LEG_stroke_max_m, 0.33);
    device_file_set(&subject.device, SIDE_RIGHT, DEVICE_LEG_ankle_lever_m, 0.08);
    ck_assert_int_eq(params_of(0.05, 0.0), -1);
    ck_assert_msg(strstr(message, "right leg: stroke over lever") != NULL, "said: %s", message);
    subject_default(&subject);
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        device_file_set(&subject.device, (enum side)leg, DEVICE_LEG_speed_max_m_s, 0.08);
    }
    ck_assert_int_eq(params_of(0.04, 0.0), -1);
    ck_assert_msg(strstr(message, "speed over drive: 0.04 m in 0.369 s") != NULL, "said: %s",
                  message);
}
END_TEST

START_TEST(a_person_s_spring_need_not_suit_a_compass)
{
    /* 1 kN/m and 90 kN/m lie outside what the compass' gaits bear. */
    const double springs_N_per_m[] = {1000.0, 90000.0};
    for (int i = 0; i < 2; i++) {
        subject_default(&subject);
        ck_assert_int_eq(subject_read(&subject, PERSON, NULL, message), 0);
        for (int leg = 0; leg < SIDE_COUNT; leg++) {
            device_file_set(&subject.device, (enum side)leg, DEVICE_LEG_spring_N_per_m,
                            springs_N_per_m[i]);
            device_file_set(&subject.device, (enum side)leg, DEVICE_LEG_force_max_N, 50000.0);
        }
        subject.is_person = false;
        ck_assert_int_eq(subject_control_params(&subject, &params, message), -1);
        ck_assert_msg(params_of(0.02, 0.0) == 0, "%s", message);
        assert_close(params.spring_stiffness_n_m, springs_N_per_m[i], 0.0, 1e-6);
    }
}
END_TEST

START_TEST(the_shipped_device_describes_the_parts_that_it_is_made_of)
{
    /* What the controller is told against what the plant's parts give. */
    ck_assert_msg(subject_read(&subject, PERSON, DEVICE, message) == 0, "%s", message);
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        const struct sea_config *config = &subject.actuators.config[leg];
        const double *number = subject.device.number[leg];
        assert_close(number[DEVICE_LEG_counts_per_m],
                     config->encoder_counts_per_turn * sea_config_rad_per_m(config) /
                         6.283185307179586,
                     0.0, 1e-9);
        assert_close(number[DEVICE_LEG_rated_force_N],
                     sea_config_force_N(config, config->current_continuous_A), 0.0, 0.01);
        assert_close(number[DEVICE_LEG_force_max_N],
                     sea_config_force_N(config, config->current_peak_A), 0.0, 0.01);
        assert_close(number[DEVICE_LEG_spring_N_per_m], sea_config_stiffness_N_per_m(config), 0.0,
                     0.02);
        assert_close(number[DEVICE_LEG_stroke_max_m], config->stroke_max_m, 0.0, 1e-9);
        assert_close(number[DEVICE_LEG_speed_max_m_s], config->speed_limit_m_s, 0.0, 1e-9);
        assert_close(number[DEVICE_LEG_ankle_lever_m], config->lever_m, 0.0, 1e-6);
        assert_close(number[DEVICE_LEG_current_max_A], config->current_peak_A, 0.0, 1e-9);
        assert_close(number[DEVICE_LEG_latch_delay_s],
                     config->latch_release_s + 0.5 * config->latch_jitter_s, 0.0, 1e-6);
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("actuators");
    TCase *tests = tcase_create("actuators");
    tcase_add_test(tests, a_leg_s_own_section_goes_before_that_of_both);
    tcase_add_test(tests, tables_are_read);
    tcase_add_test(tests, the_shipped_device_describes_the_parts_that_it_is_made_of);
    tcase_add_loop_test(tests, what_is_wrong_is_refused_with_leg_and_key, 0,
                        sizeof REFUSED / sizeof REFUSED[0]);
    tcase_add_loop_test(tests, what_cannot_be_built_is_refused_before_anything_moves, 0,
                        sizeof UNFIT / sizeof UNFIT[0]);
    tcase_add_test(tests, an_idealised_device_s_own_numbers_must_fit_too);
    tcase_add_test(tests, a_person_s_spring_need_not_suit_a_compass);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
