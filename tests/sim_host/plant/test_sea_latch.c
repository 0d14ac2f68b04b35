/* The latch as built: how much it holds, wear, slip, re-latching, its faults; and an actuator as built
 * seen through sea.h like any other. */
#include <math.h>
#include <string.h>

#include "sim_host/plant/plant.h"
#include "tests/support/assert_close.h"
#include "tests/support/round_actuator.h"

static struct sea_config config;
static struct sea_params params;
static struct sea sea;

static void setup(void)
{
    round_actuator(&config);
    config.speed_integral_rad_s = 20.0;
    sea_params_as_built(&config, &params);
    ck_assert_ptr_null(sea_params_check(&params));
}

static void begin(void)
{
    sea_init(&sea, &params, 1);
}

static void run_ms(double target_m, bool armed, int ms)
{
    const struct sea_command command = {SEA_POSITION, target_m, armed};
    for (int i = 0; i < ms; i++) {
        sea_set_command(&sea, &command, 0.0);
        for (int k = 0; k < 10; k++) {
            sea_drive_period(&sea, 0.0);
            sea_finish_period(&sea);
            (void)sea_reclose(&sea, 0.0);
        }
    }
}

START_TEST(an_actuator_as_built_is_a_sea_like_any_other)
{
    struct sea_output out;
    begin();
    run_ms(0.04, false, 400);
    sea_read(&sea, 0.0, &out);
    assert_close(out.position_m, 0.04, 2e-5, 0.0);
    assert_close(out.reported_position_m, out.position_m, 1e-6, 0.0);
    assert_close(out.spring_force_N, 400.0, 0.5, 0.0);
    assert_close(out.motor_force_N, 400.0, 3.0, 0.0);
    assert_close(out.current_A, 8.0, 0.06, 0.0);
    assert_close(out.torque_per_mille, 1600.0, 12.0, 0.0); /* of 5 A for ever */
    assert_close(out.ankle_force_N, 0.0, 0.0, 0.0);
    ck_assert(out.temperature_degC > 25.0 && out.dc_link_V > 40.0);
    ck_assert(!out.latch_slipping && !out.at_end_stop && !out.force_limited);
    assert_close(sea_spring_energy_now_J(&sea, 0.0), 8.0, 0.02, 0.0);
    ck_assert(sea_release_now(&sea));
    assert_close(sea_ankle_force_N(&sea, 0.01), 300.0, 0.5, 0.0);
    double stiffness, play_m;
    sea_spring_at(&sea, 0.01, &stiffness, &play_m);
    assert_close(stiffness * (sea.position_m - play_m - 0.01), 300.0, 0.5, 0.0);
}
END_TEST

START_TEST(between_the_ends_of_a_period_the_motor_is_on_its_way)
{
    begin();
    run_ms(0.04, false, 25);
    for (int i = 0; i < 100; i++) {
        const double from_m = sea.position_m;
        sea_drive_period(&sea, 0.0);
        assert_close(sea_position_at_m(&sea, 0.0), from_m, 0.0, 0.0);
        assert_close(sea_position_at_m(&sea, params.drive_period_s), sea.built.next.position_m,
                     1e-15, 0.0);
        sea_finish_period(&sea);
        assert_close(sea.position_m, sea.built.motor.position_m, 0.0, 0.0);
    }
}
END_TEST

START_TEST(an_overloaded_latch_opens)
{
    params.holding_N = 300.0;
    begin();
    run_ms(0.02, false, 300);
    ck_assert(!sea_lets_go(&sea));
    run_ms(0.04, false, 300);
    ck_assert(sea_lets_go(&sea));
    ck_assert(sea_release_now(&sea) && !sea_lets_go(&sea));
    ck_assert_uint_eq(sea.overloads, 1);
    ck_assert_int_eq(sea.latch, SEA_LATCH_RELEASED);
}
END_TEST

START_TEST(a_slipping_latch_creeps_until_it_holds)
{
    /* 400 N over 300 N: it creeps 10 mm, at 0.1 m/s. */
    params.holding_N = 300.0;
    params.slip_m_s = 0.1;
    begin();
    run_ms(0.04, false, 500);
    struct sea_output out;
    sea_read(&sea, 0.0, &out);
    ck_assert(!sea_lets_go(&sea) && sea.latch == SEA_LATCH_CLOSED);
    assert_close(sea.output_m, 0.01, 2e-4, 0.0);
    assert_close(out.spring_force_N, 300.0, 1.0, 0.0);
}
END_TEST

START_TEST(every_release_wears_it)
{
    params.holding_N = 401.0;
    params.wear_per_release = 1e-3;
    begin();
    sea.releases = 2;
    run_ms(0.04, false, 400); /* 400.198 N are left, less than the drive's overshoot */
    sea.lets_go = false;
    sea.overloads = 0;
    sea.releases = 20;
    run_ms(0.04, false, 10);
    ck_assert(sea_lets_go(&sea));
}
END_TEST

START_TEST(it_takes_its_time_to_close)
{
    begin();
    run_ms(0.03, true, 300);
    ck_assert(sea_release_now(&sea));
    sea_lift_off(&sea);
    run_ms(0.0, false, 300); /* home long since: closed */
    ck_assert_int_eq(sea.latch, SEA_LATCH_CLOSED);
    begin();
    (void)sea_release_now(&sea);
    sea_lift_off(&sea);
    int periods = 0;
    while (!sea_reclose(&sea, 0.0)) {
        periods++;
        ck_assert_int_lt(periods, 1000);
    }
    assert_close(periods * params.drive_period_s, config.latch_reclose_s, 1.01e-4, 0.0);
    /* Away in between: it begins anew. */
    begin();
    (void)sea_release_now(&sea);
    sea_lift_off(&sea);
    for (int i = 0; i < 40; i++) {
        ck_assert(!sea_reclose(&sea, 0.0));
    }
    ck_assert(!sea_reclose(&sea, 0.01));
    for (int i = 0; i < 49; i++) {
        ck_assert(!sea_reclose(&sea, 0.0));
    }
}
END_TEST

START_TEST(faults_of_the_latch)
{
    begin();
    run_ms(0.03, false, 300);
    sea_set_latch_fault(&sea, SEA_LATCH_OPENS); /* though nobody armed it */
    ck_assert(sea_lets_go(&sea));
    run_ms(0.03, false, 1); /* a command does not talk it out of it */
    ck_assert(sea_lets_go(&sea) && sea_release_now(&sea));
    begin();
    sea_set_latch_fault(&sea, SEA_LATCH_STUCK_SHUT);
    ck_assert(!sea_release_now(&sea));
    ck_assert_int_eq(sea.latch, SEA_LATCH_CLOSED);
    sea_set_latch_fault(&sea, SEA_LATCH_WHOLE);
    ck_assert(sea_release_now(&sea));
    sea_lift_off(&sea);
    sea_set_latch_fault(&sea, SEA_LATCH_STUCK_OPEN);
    run_ms(0.0, false, 100);
    ck_assert_int_eq(sea.latch, SEA_LATCH_SLACK);
    sea_set_latch_fault(&sea, SEA_LATCH_WHOLE);
    run_ms(0.0, false, 100);
    ck_assert_int_eq(sea.latch, SEA_LATCH_CLOSED);
}
END_TEST

START_TEST(a_latch_that_opens_in_single_support_is_seen_by_the_walk)
{
    static struct plant plant;
    struct plant_config plant_config;
    char message[PLANT_ERROR_MAX];
    struct walk_event event;
    int releases = 0;
    plant_config_default(&plant_config);
    ck_assert_int_eq(plant_init(&plant, &plant_config, message), PLANT_OK);
    walk_let_go(&plant.walk);
    plant.walk.contact.ankle_locked = true;
    for (int i = 0; i < 50; i++) {
        plant_advance(&plant);
    }
    sea_set_latch_fault(&plant.sea[plant.walk.stance], SEA_LATCH_OPENS);
    for (int i = 0; i < 3; i++) {
        plant_advance(&plant);
    }
    while (plant_next_event(&plant, &event)) {
        releases += event.kind == WALK_EVENT_RELEASE;
    }
    ck_assert_int_eq(releases, 1);
    plant_free(&plant);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("sea_latch");
    TCase *latch = tcase_create("latch");
    tcase_add_checked_fixture(latch, setup, NULL);
    tcase_add_test(latch, an_actuator_as_built_is_a_sea_like_any_other);
    tcase_add_test(latch, between_the_ends_of_a_period_the_motor_is_on_its_way);
    tcase_add_test(latch, an_overloaded_latch_opens);
    tcase_add_test(latch, a_slipping_latch_creeps_until_it_holds);
    tcase_add_test(latch, every_release_wears_it);
    tcase_add_test(latch, it_takes_its_time_to_close);
    tcase_add_test(latch, faults_of_the_latch);
    tcase_add_test(latch, a_latch_that_opens_in_single_support_is_seen_by_the_walk);
    suite_add_tcase(suite, latch);
    return run_suite(suite);
}
