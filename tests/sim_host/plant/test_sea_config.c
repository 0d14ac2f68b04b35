/* An actuator's values: read, refused with their ranges, refused where they cannot be built together;
 * the spring's curve against its integrals. */
#include <math.h>
#include <string.h>

#include "sim_host/plant/sea_config.h"
#include "sim_host/plant/sea_spring.h"
#include "tests/support/assert_close.h"

static char message[512];

/* An actuator of round numbers: 1000 rad/m, 10 kg, 10 kN/m on a lever of 0.12 m. */
static void round_numbers(struct sea_config *config)
{
    static const char *const VALUES[][2] = {
        {"motor_inertia_kg_m2", "1e-5"},
        {"torque_constant_Nm_A", "0.05"},
        {"resistance_ohm", "0.5"},
        {"inductance_H", "1e-4"},
        {"current_continuous_A", "5"},
        {"current_peak_A", "20"},
        {"motor_speed_max_rad_s", "900"},
        {"winding_thermal_K_W", "1"},
        {"winding_thermal_time_s", "20"},
        {"housing_thermal_K_W", "4"},
        {"housing_thermal_time_s", "800"},
        {"travel_per_turn_m", "0.00628318530717958648"},
        {"efficiency_forward", "0.9"},
        {"efficiency_backward", "0.8"},
        {"spring_N_per_m", "10000"},
        {"spring_limit_m", "0.06"},
        {"lever_m", "0.12"},
        {"supply_V", "48"},
        {"supply_ohm", "0.1"},
        {"supply_current_max_A", "20"},
        {"position_gain_1_s", "80"},
        {"speed_bandwidth_rad_s", "400"},
        {"encoder_counts_per_turn", "65536"},
        {"speed_limit_m_s", "0.9"},
        {"stroke_max_m", "0.05"},
        {"unload_rate_m_s", "0.3"},
        {"latch_holding_N", "800"},
        {"latch_release_s", "0.004"},
        {"latch_jitter_s", "0.001"},
        {"latch_reclose_s", "0.005"},
        {"latch_reclose_m", "0.0005"},
    };
    sea_config_default(config);
    for (size_t i = 0; i < sizeof VALUES / sizeof VALUES[0]; i++) {
        ck_assert_int_eq(
            sea_config_set(config, VALUES[i][0], VALUES[i][1], message, sizeof message), SEA_SET);
    }
}

static const struct sea_duty DUTY = {.precompression_m = 0.04, .load_s = 0.2};

START_TEST(every_key_has_a_name_a_range_and_a_sense)
{
    struct sea_config config;
    sea_config_default(&config);
    for (int i = 0; i < SEA_KEYS; i++) {
        const struct sea_key *key = &sea_keys[i];
        ck_assert(key->minimum < key->maximum && key->meaning[0] != '\0');
        ck_assert_uint_eq(key->offset, (size_t)i * sizeof(double));
        ck_assert_msg(isnan(key->fallback) ||
                          (key->fallback >= key->minimum && key->fallback <= key->maximum),
                      "%s", key->name);
        for (int k = 0; k < i; k++) {
            ck_assert_str_ne(key->name, sea_keys[k].name);
        }
    }
    ck_assert_int_eq(sea_config_check(&config, message, sizeof message), -1);
    ck_assert_str_eq(message, "key \"motor_inertia_kg_m2\" (of the rotor) is missing, allowed is "
                              "1e-09 to 1 kg m^2");
}
END_TEST

START_TEST(a_file_that_says_all_is_taken)
{
    struct sea_config config;
    round_numbers(&config);
    ck_assert_msg(sea_config_check(&config, message, sizeof message) == 0, "%s", message);
    ck_assert_msg(sea_config_can_be_built(&config, &DUTY, message, sizeof message) == 0, "%s",
                  message);
    assert_close(sea_config_rad_per_m(&config), 1000.0, 0.0, 1e-12);
    assert_close(sea_config_mass_kg(&config), 10.0, 0.0, 1e-12);
    /* 0.9 * 0.05 N m/A * 20 A * 1000 rad/m, and back. */
    assert_close(sea_config_force_N(&config, 20.0), 900.0, 0.0, 1e-12);
    assert_close(sea_config_current_A(&config, 900.0), 20.0, 0.0, 1e-12);
    assert_close(sea_config_no_load_m_s(&config, 48.0), 0.96, 0.0, 1e-12);
    /* 48 V less 10 A through 0.6 ohm. */
    assert_close(sea_config_speed_at_m_s(&config, 450.0), 42.0 / 0.05 / 1000.0, 0.0, 1e-12);
}
END_TEST

static const struct {
    const char *key, *text, *says;
} REFUSED[] = {
    {"travel_per_turn_m", "five", "\"five\" is not a number"},
    {"travel_per_turn_m", "0.005 m", "\"0.005 m\" is not a number"},
    {"travel_per_turn_m", "0", "is out of range, allowed is 1e-05 to 10 m"},
    {"efficiency_forward", "1.2", "allowed is 0.01 to 1"},
    {"supply_V", "nan", "is not a number"},
    {"spring_table", "", "is no table"},
    {"spring_table", "0.01 80, 0.005 90", "is no table"},
    {"spring_table", "0.01", "is no table"},
    {"spring_table", "0.01 80; 0.02 100", "is no table"},
    {"lever_table", "-0.2 0.1, 0 0.11, x", "is no table"},
    {"torque", "1", "unknown key \"torque\""},
};

START_TEST(values_are_refused_with_their_range)
{
    struct sea_config config, before;
    round_numbers(&config);
    before = config;
    ck_assert_int_ne(
        sea_config_set(&config, REFUSED[_i].key, REFUSED[_i].text, message, sizeof message),
        SEA_SET);
    ck_assert_msg(strstr(message, REFUSED[_i].says) != NULL, "said: %s", message);
    ck_assert_int_eq(memcmp(&config, &before, sizeof config), 0);
}
END_TEST

/* One value changed, and what is said of it. */
static const struct {
    const char *key, *text, *says;
} UNFIT[] = {
    {"spring_Nm_rad", "144", "the spring is told 2 times"},
    {"spring_table", "0.01 80, 0.02 200", "the spring is told 2 times"},
    {"drive_period_s", "0.0003", "does not divide 1 ms"},
    {"drive_period_s", "0.00001", ""},
    {"efficiency_backward", "0.95", "is above efficiency_forward, 0.9"},
    {"current_peak_A", "4", "is below current_continuous_A, 5 A"},
    {"current_peak_A", "8", "spring over motor: the spring needs 400 N at 0.04 m"},
    {"stroke_max_m", "0.33", "stroke over lever: stroke_max_m is 0.33 m, and a lever of 0.12 m"},
    {"lever_m", "0.05", "stroke over lever"},
    {"spring_limit_m", "0.045", "stroke over spring"},
    {"stroke_max_m", "0.03", "precompression over stroke"},
    {"motor_speed_max_rad_s", "250", "speed over motor: 0.04 m in 0.2 s needs 0.3 m/s"},
    {"supply_V", "15", "speed over supply"},
    {"speed_limit_m_s", "0.2", "speed over drive"},
    {"supply_current_max_A", "1", "energy over supply: loading 0.04 m in 0.2 s"},
    {"latch_holding_N", "350", "spring over latch: the spring pushes with 400 N"},
    /* 8 J / 0.9 in each 0.5 s: 2.96 W h in ten minutes. 0.04 m in 0.2 s: 4.5 m/s^2 of 100 kg. */
    {"supply_energy_Wh", "2.9",
     "energy over supply: ten minutes of pushes of 8.89 J take 2.96 W h"},
    {"supply_energy_Wh", "3", ""},
    {"motor_inertia_kg_m2", "0.0003", "rotor over motor: 0.04 m in 0.2 s needs 4.5 m/s^2"},
    {"cuff_N_per_m", "9000",
     "spring over cuff: cuff_N_per_m is 9000 N/m, softer than the spring's"},
    {"cuff_N_per_m", "11000", ""},
    {"two_way", "0.5", "0.5 is neither 0 nor 1"},
    {"supply_shared", "0.5", "0.5 is neither 0 nor 1"},
    {"speed_bandwidth_rad_s", "1100", "the loop would oscillate at 1100 rad/s"},
    {"current_bandwidth_rad_s", "300", "300 rad/s are allowed"},
    {"position_gain_1_s", "250", "the loop would oscillate at 250 1/s"},
};

START_TEST(what_cannot_be_built_is_refused_with_the_reason)
{
    struct sea_config config;
    round_numbers(&config);
    ck_assert_int_eq(
        sea_config_set(&config, UNFIT[_i].key, UNFIT[_i].text, message, sizeof message), SEA_SET);
    message[0] = '\0';
    const bool taken = sea_config_check(&config, message, sizeof message) == 0 &&
                       sea_config_can_be_built(&config, &DUTY, message, sizeof message) == 0;
    ck_assert_msg(taken == (UNFIT[_i].says[0] == '\0'), "%s", message);
    ck_assert_msg(strstr(message, UNFIT[_i].says) != NULL, "said: %s", message);
}
END_TEST

START_TEST(a_torsion_spring_is_a_linear_one_by_its_arm)
{
    struct sea_config config;
    struct sea_spring spring;
    round_numbers(&config);
    config.spring_N_per_m = 0.0;
    config.spring_Nm_rad = 144.0;
    ck_assert_int_eq(sea_config_check(&config, message, sizeof message), -1);
    config.spring_arm_m = 0.12;
    ck_assert_int_eq(sea_config_check(&config, message, sizeof message), 0);
    sea_spring_init(&spring, &config);
    assert_close(sea_spring_force_N(&spring, 0.04), 400.0, 0.0, 1e-12);
}
END_TEST

START_TEST(a_table_gives_force_energy_and_its_line)
{
    struct sea_config config;
    struct sea_spring spring;
    double stiffness, zero_m;
    round_numbers(&config);
    config.spring_N_per_m = 0.0;
    ck_assert_int_eq(sea_config_set(&config, "spring_table", "0.01 80, 0.02 200,0.04  600", message,
                                    sizeof message),
                     SEA_SET);
    sea_spring_init(&spring, &config);
    double integral_J = 0.0;
    for (int i = 0; i < 5000; i++) {
        const double c = (i + 0.5) * 1e-5;
        const double expected = c < 0.01   ? 8000.0 * c
                                : c < 0.02 ? 80.0 + 12000.0 * (c - 0.01)
                                           : 200.0 + 20000.0 * (c - 0.02);
        assert_close(sea_spring_force_N(&spring, c), expected, 1e-9, 0.0);
        sea_spring_line(&spring, c, &stiffness, &zero_m);
        assert_close(stiffness * (c - zero_m), expected, 1e-9, 0.0);
        integral_J += expected * 1e-5;
        assert_close(sea_spring_energy_J(&spring, c + 0.5e-5), integral_J, 1e-6, 1e-6);
    }
    assert_close(sea_spring_force_N(&spring, -0.01), 0.0, 0.0, 0.0);
    assert_close(sea_spring_energy_J(&spring, -0.01), 0.0, 0.0, 0.0);
    config.two_way = 1.0;
    sea_spring_init(&spring, &config);
    assert_close(sea_spring_force_N(&spring, -0.015), -140.0, 1e-9, 0.0);
}
END_TEST

START_TEST(a_cuff_stands_in_series)
{
    /* 1/k = 1/10000 + 1/40000. */
    struct sea_config config;
    struct sea_spring spring;
    round_numbers(&config);
    config.cuff_N_per_m = 40000.0;
    sea_spring_init_with_cuff(&spring, &config);
    assert_close(sea_spring_force_N(&spring, 0.04), 0.04 * 8000.0, 0.0, 1e-12);
}
END_TEST

START_TEST(a_cycle_loses_the_stated_share)
{
    struct sea_config config;
    struct sea_spring spring;
    round_numbers(&config);
    config.spring_hysteresis = 0.1;
    sea_spring_init(&spring, &config);
    double work_J = 0.0;
    const double step_m = 1e-6;
    sea_spring_move(&spring, 0.0);
    for (int i = 0; i < 80000; i++) {
        const double from_m = (i < 40000 ? i : 80000 - i) * step_m;
        const double to_m = (i < 40000 ? i + 1 : 79999 - i) * step_m;
        sea_spring_move(&spring, to_m);
        work_J += sea_spring_force_N(&spring, 0.5 * (from_m + to_m)) * (to_m - from_m);
    }
    assert_close(work_J, 0.1 * 0.5 * 10000.0 * 0.04 * 0.04, 0.0, 0.02);
}
END_TEST

START_TEST(the_lever_is_the_slope_of_the_way)
{
    struct sea_config config;
    round_numbers(&config);
    assert_close(sea_config_way_at_m(&config, 0.3), 0.12 * sin(0.3), 1e-12, 0.0);
    ck_assert_int_eq(sea_config_set(&config, "lever_table", "-0.4 0.08, 0 0.12, 0.3 0.1", message,
                                    sizeof message),
                     SEA_SET);
    ck_assert_int_eq(sea_config_check(&config, message, sizeof message), 0);
    assert_close(sea_config_way_at_m(&config, 0.3), 0.3 * 0.11, 1e-12, 0.0);
    assert_close(sea_config_way_at_m(&config, -0.4), -0.4 * 0.1, 1e-12, 0.0);
    for (double angle = -0.6; angle < 0.6; angle += 0.013) {
        const double slope = (sea_config_way_at_m(&config, angle + 1e-6) -
                              sea_config_way_at_m(&config, angle - 1e-6)) /
                             2e-6;
        assert_close(slope, sea_config_lever_at_m(&config, angle), 1e-6, 0.0);
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("sea_config");
    TCase *reading = tcase_create("reading"), *spring = tcase_create("spring");
    tcase_add_test(reading, every_key_has_a_name_a_range_and_a_sense);
    tcase_add_test(reading, a_file_that_says_all_is_taken);
    tcase_add_loop_test(reading, values_are_refused_with_their_range, 0,
                        sizeof REFUSED / sizeof REFUSED[0]);
    tcase_add_loop_test(reading, what_cannot_be_built_is_refused_with_the_reason, 0,
                        sizeof UNFIT / sizeof UNFIT[0]);
    tcase_add_test(spring, a_torsion_spring_is_a_linear_one_by_its_arm);
    tcase_add_test(spring, a_table_gives_force_energy_and_its_line);
    tcase_add_test(spring, a_cuff_stands_in_series);
    tcase_add_test(spring, a_cycle_loses_the_stated_share);
    tcase_add_test(spring, the_lever_is_the_slope_of_the_way);
    suite_add_tcase(suite, reading);
    suite_add_tcase(suite, spring);
    return run_suite(suite);
}
