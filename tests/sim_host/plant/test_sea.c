/* The actuator against closed forms: ramps, oscillation, friction, limits, the latch's rules. */
#include <math.h>
#include <string.h>

#include "sim_host/plant/sea.h"
#include "tests/support/assert_close.h"

static const struct sea_subject PAPER = {
    .total_mass_kg = 1.02, .leg_length_m = 1.0, .gravity_m_s2 = 9.80665, .spring_N_per_m = 100.0};
static const struct sea_subject ADULT = {
    .total_mass_kg = 70.0, .leg_length_m = 0.93, .gravity_m_s2 = 9.80665, .spring_N_per_m = 7000.0};

static struct sea_params real_params(void)
{
    struct sea_params params;
    sea_preset(SEA_REAL, &PAPER, &params);
    return params;
}

static void command(struct sea *sea, enum sea_mode mode, double target_m, bool armed)
{
    const struct sea_command c = {mode, target_m, armed};
    sea_set_command(sea, &c, 0.0);
}

static void run_ms(struct sea *sea, int ms)
{
    const int periods = (int)(ms * 1e-3 / sea->params.drive_period_s + 0.5);
    for (int i = 0; i < periods; i++) {
        sea_drive_period(sea, 0.0);
        sea_finish_period(sea);
    }
}

START_TEST(presets_are_in_range_and_named)
{
    struct sea_params params;
    enum sea_preset_kind kind;
    const struct sea_subject subjects[] = {PAPER, ADULT};
    for (int i = 0; i < 2; i++) {
        sea_preset(SEA_IDEAL, &subjects[i], &params);
        ck_assert_ptr_null(sea_params_check(&params));
        ck_assert(params.ideal_motor && params.ideal_foot);
        sea_preset(SEA_REAL, &subjects[i], &params);
        ck_assert_ptr_null(sea_params_check(&params));
        ck_assert(!params.ideal_motor && !params.ideal_foot);
        assert_close(params.release_latency_s, 1e-4, 0.0, 0.0);
    }
    ck_assert(sea_preset_from_name("ideal", &kind) && kind == SEA_IDEAL);
    ck_assert(sea_preset_from_name("real", &kind) && kind == SEA_REAL);
    ck_assert(!sea_preset_from_name("Real", &kind));
}
END_TEST

START_TEST(bad_parameters_are_named)
{
    struct sea_params params = real_params();
    params.motor_mass_kg = (double)NAN;
    ck_assert_str_eq(sea_params_check(&params), "motor_mass_kg");
    params = real_params();
    params.stroke_max_m = -1.0;
    ck_assert_str_eq(sea_params_check(&params), "stroke_max_m");
    params = real_params();
    params.release_latency_s = 0.06;
    ck_assert_str_eq(sea_params_check(&params), "release_latency_s");
    params = real_params();
    params.release_on = (enum sea_release)9;
    ck_assert_str_eq(sea_params_check(&params), "release_on");
}
END_TEST

START_TEST(it_loads_the_spring_and_stands_there)
{
    struct sea sea;
    struct sea_output out;
    const struct sea_params params = real_params();
    sea_init(&sea, &params, 1);
    command(&sea, SEA_POSITION, 0.1, false);
    run_ms(&sea, 400);
    sea_read(&sea, 0.0, &out);
    assert_close(out.position_m, 0.1, 2e-6, 0.0);
    assert_close(out.spring_force_N, 10.0, 1e-3, 0.0);
    assert_close(out.ankle_force_N, 0.0, 0.0, 0.0); /* latched */
    assert_close(out.position_counts, 0.1 * params.counts_per_m, 40.0, 0.0);
    ck_assert(!out.unloaded && !out.target_clamped && !out.at_end_stop);
    /* At rest the motor carries the spring, up to what friction holds. */
    assert_close(out.motor_force_N, 10.0, params.coulomb_N, 0.0);
    assert_close(out.torque_per_mille, 1000.0 * out.motor_force_N / params.rated_force_N, 1e-9,
                 0.0);
}
END_TEST

START_TEST(a_big_step_keeps_speed_acceleration_and_force_limits)
{
    struct sea sea;
    const struct sea_params params = real_params();
    double fastest = 0.0, hardest = 0.0, farthest = 0.0;
    sea_init(&sea, &params, 1);
    command(&sea, SEA_POSITION, 0.3, false);
    for (int i = 0; i < 10000; i++) {
        sea_drive_period(&sea, 0.0);
        sea_finish_period(&sea);
        fastest = fmax(fastest, fabs(sea.speed_m_s));
        hardest = fmax(hardest, fabs(sea.motor_force_N));
        farthest = fmax(farthest, sea.position_m);
    }
    ck_assert(fastest <= 1.02 * params.speed_limit_m_s);
    ck_assert(hardest <= params.force_limit_N);
    ck_assert(farthest < 0.303);
    assert_close(sea.position_m, 0.3, 2e-6, 0.0);
}
END_TEST

START_TEST(it_moves_the_full_stroke_within_a_step)
{
    /* Loaded from 0 to 0.28 m in less than the 0.47 s between apex and heel strike of the paper's walker;
     * back in less than the swing's first half. */
    struct sea sea;
    const struct sea_params params = real_params();
    sea_init(&sea, &params, 1);
    command(&sea, SEA_POSITION, 0.28, false);
    run_ms(&sea, 345);
    assert_close(sea.position_m, 0.28, 1e-4, 0.0);
    command(&sea, SEA_POSITION, 0.0, false);
    run_ms(&sea, 345);
    assert_close(sea.position_m, 0.0, 1e-4, 0.0);
}
END_TEST

START_TEST(stroke_and_zero_offset)
{
    struct sea sea;
    struct sea_output out;
    struct sea_params params = real_params();
    params.zero_offset_m = 0.01;
    sea_init(&sea, &params, 1);
    command(&sea, SEA_POSITION, 0.05, false);
    run_ms(&sea, 400);
    sea_read(&sea, 0.0, &out);
    assert_close(out.reported_position_m, 0.05, 2e-6, 0.0);
    assert_close(out.position_m, 0.04, 2e-6, 0.0);
    command(&sea, SEA_POSITION, 1.0, false);
    run_ms(&sea, 1);
    sea_read(&sea, 0.0, &out);
    ck_assert(out.target_clamped);
    run_ms(&sea, 800);
    sea_read(&sea, 0.0, &out);
    assert_close(out.reported_position_m, params.stroke_max_m, 5e-6, 0.0);
    /* The drive unloads to its own zero: a wrong one stays as a load. */
    params.zero_offset_m = -0.01;
    sea_init(&sea, &params, 1);
    command(&sea, SEA_POSITION, 0.05, false);
    run_ms(&sea, 400);
    command(&sea, SEA_UNLOAD, 0.0, false);
    run_ms(&sea, 1000);
    sea_read(&sea, 0.0, &out);
    assert_close(out.reported_position_m, 0.0, 5e-6, 0.0);
    assert_close(out.spring_force_N, 1.0, 1e-3, 0.0);
}
END_TEST

START_TEST(a_target_that_is_no_number_changes_nothing)
{
    struct sea sea;
    struct sea_output out;
    const struct sea_params params = real_params();
    sea_init(&sea, &params, 1);
    command(&sea, SEA_POSITION, 0.05, false);
    run_ms(&sea, 400);
    command(&sea, SEA_POSITION, (double)NAN, false);
    run_ms(&sea, 100);
    sea_read(&sea, 0.0, &out);
    ck_assert(out.target_clamped);
    assert_close(out.position_m, 0.05, 2e-6, 0.0);
}
END_TEST

START_TEST(unload_has_its_rate)
{
    struct sea sea;
    struct sea_params params = real_params();
    params.unload_rate_m_s = 0.94; /* so that the way has a middle at full rate */
    sea_init(&sea, &params, 1);
    command(&sea, SEA_POSITION, 0.3, false);
    run_ms(&sea, 1000);
    command(&sea, SEA_UNLOAD, 0.123, false); /* the target is ignored */
    const double from = sea.position_m;
    run_ms(&sea, 100);
    const double middle = sea.position_m;
    run_ms(&sea, 100);
    assert_close(middle - sea.position_m, 0.1 * params.unload_rate_m_s, 1e-3, 0.01);
    ck_assert(from - middle < 0.1 * params.unload_rate_m_s);
    run_ms(&sea, 400);
    assert_close(sea.position_m, 0.0, 5e-6, 0.0);
}
END_TEST

START_TEST(torque_off_lets_the_spring_drive_the_motor_back)
{
    /* Without friction: x = x0 cos(w t), w = sqrt(k / m). */
    struct sea sea;
    struct sea_params params = real_params();
    params.viscous_N_per_m_s = 0.0;
    params.coulomb_N = 0.0;
    sea_init(&sea, &params, 1);
    sea.position_m = 0.1;
    const double w = sqrt(params.spring_N_per_m / params.motor_mass_kg);
    run_ms(&sea, 200);
    assert_close(sea.position_m, 0.1 * cos(w * 0.2), 1e-5, 0.0);
    assert_close(sea.motor_force_N, 0.0, 0.0, 0.0);
}
END_TEST

START_TEST(coulomb_friction_stops_and_holds)
{
    struct sea sea;
    struct sea_params params = real_params();
    params.viscous_N_per_m_s = 0.0;
    sea_init(&sea, &params, 1);
    sea.position_m = -0.004; /* slack: no spring force */
    sea.speed_m_s = 0.02;
    run_ms(&sea, 1000);
    const double way = 0.5 * 0.02 * 0.02 * params.motor_mass_kg / params.coulomb_N;
    assert_close(sea.position_m, -0.004 + way, 2e-6, 0.0);
    assert_close(sea.speed_m_s, 0.0, 0.0, 0.0);
    /* A spring force below it does not move the motor. */
    sea.position_m = 0.9 * params.coulomb_N / params.spring_N_per_m;
    const double held = sea.position_m;
    run_ms(&sea, 100);
    assert_close(sea.position_m, held, 0.0, 0.0);
}
END_TEST

START_TEST(end_stops_hold)
{
    struct sea sea;
    struct sea_output out;
    const struct sea_params params = real_params();
    sea_init(&sea, &params, 1);
    sea.position_m = 0.354;
    sea.speed_m_s = 3.0;
    run_ms(&sea, 1);
    sea_read(&sea, 0.0, &out);
    ck_assert(out.position_m <= params.end_stop_max_m);
    sea.position_m = 0.0;
    sea.speed_m_s = -3.0;
    sea_drive_period(&sea, 0.0);
    for (int i = 0; i < 30; i++) {
        sea_finish_period(&sea);
        sea_drive_period(&sea, 0.0);
    }
    assert_close(sea.position_m, params.end_stop_min_m, 1e-12, 0.0);
}
END_TEST

START_TEST(the_motor_yields_little_while_the_spring_lets_go)
{
    /* The load goes from k r0 to nothing in 0.15 s, as in a push-off. */
    const struct sea_subject subjects[] = {PAPER, ADULT};
    for (int i = 0; i < 2; i++) {
        struct sea sea;
        struct sea_params params;
        const double r0 = 0.05 * subjects[i].leg_length_m;
        sea_preset(SEA_REAL, &subjects[i], &params);
        sea_init(&sea, &params, 1);
        command(&sea, SEA_POSITION, r0, true);
        run_ms(&sea, 600);
        sea_release_now(&sea);
        double most = 0.0;
        for (int k = 0; k < 1500; k++) {
            sea_drive_period(&sea, r0 * (1.0 - cos(3.14159265 * k / 1500.0)) / 2.0);
            sea_finish_period(&sea);
            most = fmax(most, fabs(sea.position_m - r0));
        }
        ck_assert_msg(most < 1e-4 * r0, "yields %g of r0", most / r0);
    }
}
END_TEST

START_TEST(counts_saturate)
{
    const struct sea_params params = real_params();
    ck_assert_int_eq(sea_m_to_counts(&params, 1e9), INT32_MAX);
    ck_assert_int_eq(sea_m_to_counts(&params, -1e9), INT32_MIN);
    ck_assert_int_eq(sea_m_to_counts(&params, (double)NAN), INT32_MIN);
    ck_assert_int_eq(sea_m_to_counts(&params, 0.05), 655360);
    assert_close(sea_counts_to_m(&params, -655360), -0.05, 1e-15, 0.0);
}
END_TEST

START_TEST(only_an_armed_latch_releases)
{
    struct sea sea;
    const struct sea_params params = real_params();
    sea_init(&sea, &params, 1);
    command(&sea, SEA_POSITION, 0.05, false);
    ck_assert(!sea_may_release(&sea));
    sea_other_foot_contact(&sea, 1.0);
    sea_ankle_extends(&sea, 1.0);
    ck_assert(!sea.release_pending);
    command(&sea, SEA_POSITION, 0.05, true);
    ck_assert(sea_may_release(&sea));
    sea_other_foot_contact(&sea, 1.0);
    ck_assert(sea.release_pending);
    assert_close(sea.release_time_s, 1.0001, 1e-12, 0.0);
    sea_ankle_extends(&sea, 1.00005); /* a second cause does not postpone it */
    assert_close(sea.release_time_s, 1.0001, 1e-12, 0.0);
    command(&sea, SEA_POSITION, 0.05, false);
    ck_assert(!sea.release_pending); /* disarmed in time */
}
END_TEST

START_TEST(causes_are_chosen_by_name)
{
    static const struct {
        enum sea_release on;
        bool contact, extension, armed;
    } RULES[] = {{SEA_RELEASE_CONTACT_OR_EXTENSION, true, true, false},
                 {SEA_RELEASE_CONTACT, true, false, false},
                 {SEA_RELEASE_EXTENSION, false, true, false},
                 {SEA_RELEASE_COMMAND, false, false, true}};
    for (int i = 0; i < 4; i++) {
        struct sea sea;
        struct sea_params params = real_params();
        params.release_on = RULES[i].on;
        sea_init(&sea, &params, 1);
        command(&sea, SEA_POSITION, 0.05, true);
        ck_assert_int_eq(sea.release_pending, RULES[i].armed);
        sea.release_pending = false;
        sea_other_foot_contact(&sea, 1.0);
        ck_assert_int_eq(sea.release_pending, RULES[i].contact);
        sea.release_pending = false;
        sea_ankle_extends(&sea, 1.0);
        ck_assert_int_eq(sea.release_pending, RULES[i].extension);
    }
}
END_TEST

START_TEST(the_latch_goes_round)
{
    struct sea sea;
    const struct sea_params params = real_params();
    sea_init(&sea, &params, 1);
    command(&sea, SEA_POSITION, 0.05, true);
    run_ms(&sea, 400);
    assert_close(sea_ankle_force_N(&sea, 0.0), 0.0, 0.0, 0.0);
    ck_assert(!sea_reclose(&sea, 0.0));
    sea_lift_off(&sea); /* closed: nothing */
    ck_assert_int_eq(sea.latch, SEA_LATCH_CLOSED);
    sea_release_now(&sea);
    ck_assert_int_eq(sea.latch, SEA_LATCH_RELEASED);
    assert_close(sea_ankle_force_N(&sea, 0.02), 3.0, 1e-3, 0.0);
    assert_close(sea_ankle_force_N(&sea, 0.07), 0.0, 0.0, 0.0);
    sea_lift_off(&sea);
    ck_assert_int_eq(sea.latch, SEA_LATCH_SLACK);
    ck_assert(!sea_reclose(&sea, sea.position_m)); /* the foot is out */
    command(&sea, SEA_POSITION, 0.0, false);
    run_ms(&sea, 400);
    ck_assert(!sea_reclose(&sea, 0.01));
    ck_assert(sea_reclose(&sea, 0.0));
    ck_assert_int_eq(sea.latch, SEA_LATCH_CLOSED);
    ck_assert_uint_eq(sea.releases, 1);
}
END_TEST

START_TEST(jitter_is_bounded_and_seeded)
{
    struct sea_params params = real_params();
    params.release_jitter_s = 1e-3;
    double least = 1.0, most = 0.0;
    struct sea a, b;
    sea_init(&a, &params, 7);
    sea_init(&b, &params, 7);
    for (int i = 0; i < 1000; i++) {
        command(&a, SEA_POSITION, 0.05, true);
        command(&b, SEA_POSITION, 0.05, true);
        sea_other_foot_contact(&a, 0.0);
        sea_other_foot_contact(&b, 0.0);
        ck_assert(memcmp(&a.release_time_s, &b.release_time_s, sizeof(double)) == 0);
        least = fmin(least, a.release_time_s);
        most = fmax(most, a.release_time_s);
        command(&a, SEA_POSITION, 0.05, false);
        command(&b, SEA_POSITION, 0.05, false);
    }
    ck_assert(least >= 1e-4 && least < 1.1e-4 && most < 1.1e-3 && most > 1.09e-3);
}
END_TEST

START_TEST(ideal_motor_is_where_it_is_told)
{
    struct sea sea;
    struct sea_params params;
    sea_preset(SEA_IDEAL, &PAPER, &params);
    sea_init(&sea, &params, 1);
    command(&sea, SEA_POSITION, 0.28, true);
    assert_close(sea.position_m, 0.28, 0.0, 0.0);
    run_ms(&sea, 1);
    assert_close(sea.position_m, 0.28, 0.0, 0.0);
    sea_release_now(&sea);
    sea_lift_off(&sea);
    ck_assert_int_eq(sea.latch, SEA_LATCH_CLOSED); /* the foot is back at once */
    command(&sea, SEA_UNLOAD, 0.0, false);
    run_ms(&sea, 100);
    assert_close(sea.position_m, 0.28 - 0.1 * params.unload_rate_m_s, 1e-9, 0.0);
}
END_TEST

START_TEST(work_and_friction_balance)
{
    /* Motor work = spring energy + friction + kinetic energy. */
    struct sea sea;
    const struct sea_params params = real_params();
    sea_init(&sea, &params, 1);
    command(&sea, SEA_POSITION, 0.2, false);
    run_ms(&sea, 150);
    const double held = 0.5 * params.spring_N_per_m * sea.position_m * sea.position_m +
                        0.5 * params.motor_mass_kg * sea.speed_m_s * sea.speed_m_s +
                        sea.friction_loss_J;
    ck_assert(sea.speed_m_s > 0.1);
    assert_close(sea.motor_work_J, held, 0.0, 1e-3);
}
END_TEST

START_TEST(at_constant_speed_the_force_is_constant)
{
    /* A new target every tick, on a straight line: nothing accelerates, so the force has no
     * business to change but by the spring's, k v t. */
    const struct sea_subject subjects[] = {PAPER, ADULT};
    for (int i = 0; i < 2; i++) {
        struct sea sea;
        struct sea_params params;
        sea_preset(SEA_REAL, &subjects[i], &params);
        sea_init(&sea, &params, 1);
        const double speed_m_s = 0.5 * params.speed_limit_m_s;
        const double full_N = params.spring_N_per_m * params.stroke_max_m;
        double squares = 0.0;
        int count = 0;
        for (int tick = 1; tick < 250; tick++) {
            command(&sea, SEA_POSITION, tick * 1e-3 * speed_m_s, false);
            for (int k = 0; k < 10; k++) {
                sea_drive_period(&sea, 0.0);
                if (tick > 180) {
                    const double steady_N = sea.spring_force_N + params.coulomb_N +
                                            params.viscous_N_per_m_s * sea.speed_m_s;
                    const double off_N = sea.motor_force_N - steady_N;
                    squares += off_N * off_N;
                    count++;
                }
                sea_finish_period(&sea);
            }
        }
        const double ripple = sqrt(squares / count) / full_N;
        ck_assert_msg(ripple < 0.02, "ripple of %g of the full force", ripple);
    }
}
END_TEST

START_TEST(it_warms_up_under_load)
{
    struct sea sea;
    struct sea_params params = real_params();
    params.thermal_time_s = 1.0;
    sea_init(&sea, &params, 1);
    command(&sea, SEA_POSITION, 0.2, false);
    run_ms(&sea, 8000);
    const double load = sea.motor_force_N / params.rated_force_N;
    assert_close(sea.temperature_degC, params.ambient_degC + load * load * params.thermal_rise_K,
                 0.5, 0.0);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("sea");
    TCase *motor = tcase_create("motor"), *latch = tcase_create("latch");
    tcase_add_test(motor, presets_are_in_range_and_named);
    tcase_add_test(motor, bad_parameters_are_named);
    tcase_add_test(motor, it_loads_the_spring_and_stands_there);
    tcase_add_test(motor, a_big_step_keeps_speed_acceleration_and_force_limits);
    tcase_add_test(motor, it_moves_the_full_stroke_within_a_step);
    tcase_add_test(motor, stroke_and_zero_offset);
    tcase_add_test(motor, a_target_that_is_no_number_changes_nothing);
    tcase_add_test(motor, unload_has_its_rate);
    tcase_add_test(motor, torque_off_lets_the_spring_drive_the_motor_back);
    tcase_add_test(motor, coulomb_friction_stops_and_holds);
    tcase_add_test(motor, end_stops_hold);
    tcase_add_test(motor, the_motor_yields_little_while_the_spring_lets_go);
    tcase_add_test(motor, counts_saturate);
    tcase_add_test(motor, ideal_motor_is_where_it_is_told);
    tcase_add_test(motor, work_and_friction_balance);
    tcase_add_test(motor, at_constant_speed_the_force_is_constant);
    tcase_add_test(motor, it_warms_up_under_load);
    tcase_add_test(latch, only_an_armed_latch_releases);
    tcase_add_test(latch, causes_are_chosen_by_name);
    tcase_add_test(latch, the_latch_goes_round);
    tcase_add_test(latch, jitter_is_bounded_and_seeded);
    suite_add_tcase(suite, motor);
    suite_add_tcase(suite, latch);
    return run_suite(suite);
}
