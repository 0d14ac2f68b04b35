/* What the predictive law asks for, the motor can do: by force, by change from step to step, and by the time
 * left before heel strike. The limits are closed forms of this file; the time of the strike is the accurate
 * map's, not the law's. */
#include "controller/laws/step_law.h"

#include <math.h>

#include "sim_host/subjects/subject.h"
#include "tests/support/assert_close.h"

#define TICK_S 0.001

struct motor {
    double speed_m_s, acceleration_m_s2, change_m;
};

static struct subject subject;
static struct control_params params;
static struct walker walker;

static void prepare(double force_max_N)
{
    char message[SUBJECT_MESSAGE_MAX];
    subject_default(&subject);
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        device_file_set(&subject.device, (enum side)leg, DEVICE_LEG_force_max_N, force_max_N);
    }
    ck_assert_msg(subject_control_params(&subject, &params, message) == 0, "%s", message);
    params.law = (real)LAW_PREDICTIVE;
    const struct walker_params body = walker_paper_params();
    ck_assert_int_eq(walker_init(&walker, &body), WALKER_OK);
}

static void setup(void)
{
    prepare(90.0);
}

/* From rest to rest over a way, at most so fast and so accelerated: a triangle of speed, or a trapezium. */
static double time_of(double way_m, const struct motor *motor)
{
    const double ramps_m = motor->speed_m_s * motor->speed_m_s / motor->acceleration_m_s2;
    return way_m <= ramps_m
               ? 2.0 * sqrt(way_m / motor->acceleration_m_s2)
               : way_m / motor->speed_m_s + motor->speed_m_s / motor->acceleration_m_s2;
}

/* A set of apexes about the gaits from 0.25 to 0.97 rad/s: slower, faster, legs wider or closer. */
enum { APEXES = 7 * 3 * 3, COMMANDS = 4, STARTS = 3 };

static struct apex_estimate apex_of(int i)
{
    struct gait_branch_point gait;
    const float speed = 0.25f + 0.12f * (float)(i % 7);
    (void)gait_branch_at(params.branch, speed, &gait);
    return (struct apex_estimate){-speed * (1.0f + 0.06f * (float)(i / 7 % 3 - 1)),
                                  gait.swing_angle_rad * (1.0f + 0.05f * (float)(i / 21 - 1)),
                                  gait.swing_rate_rad_s, 1.0f};
}

/* Seconds from apex to heel strike; 0 when the walker does not get there. */
static double strike_after(const struct apex_estimate *estimate)
{
    const struct stride_settings fine = stride_settings_fixed(&walker, 0.001f);
    const struct apex apex = {estimate->stance_rate_rad_s, estimate->swing_angle_rad,
                              estimate->swing_rate_rad_s};
    struct stride_result result = {.fault = STRIDE_OK};
    return stride_to_strike(&walker, &fine, &apex, &result) == STRIDE_OK
               ? (double)result.apex_to_strike_s
               : 0.0;
}

/* One step of the law from a motor at from_m. The motor starts at the first answer of the search, which comes
 * *waited ticks after the apex was told. */
static double answer(const struct control_params *p, const struct apex_estimate *apex,
                     double from_m, double wanted_rad_s, int *waited, bool *searched)
{
    struct step_law law;
    step_law_init(&law, p);
    law.r0_m = (real)from_m;
    law.command_rad_s = (real)wanted_rad_s;
    *waited = 0;
    (void)step_law_update(&law, p, apex, (real)wanted_rad_s);
    for (int calls = 1; !law.is_final; calls++) {
        if (step_law_work(&law, p) && *waited == 0) {
            *waited = calls;
        }
    }
    *searched = !law.used_fallback;
    return (double)law.r0_m;
}

static const struct motor motors[] = {{1.52, 9.8, 0.3}, {0.5, 9.8, 0.3},  {0.2, 2.0, 0.3},
                                      {1.52, 1.0, 0.3}, {0.1, 0.5, 0.05}, {1.52, 9.8, 0.01}};

/* Every answer of the search can be reached in the time left; and the limit is felt, else this shows nothing. */
START_TEST(the_motor_can_be_there_at_heel_strike)
{
    const struct motor *motor = &motors[_i];
    struct control_params p = params;
    int answers = 0, at_a_limit = 0;
    p.sea_speed_max_m_s = (real)motor->speed_m_s;
    p.sea_acceleration_m_s2 = (real)motor->acceleration_m_s2;
    p.r0_change_max_m = (real)motor->change_m;
    for (int i = 0; i < APEXES * COMMANDS * STARTS; i++) {
        const struct apex_estimate apex = apex_of(i % APEXES);
        const double wanted_rad_s = 0.3 + 0.2 * (double)(i / APEXES % COMMANDS);
        const double from_m = 0.02 + 0.11 * (double)(i / APEXES / COMMANDS);
        int waited;
        bool searched;
        const double r0_m = answer(&p, &apex, from_m, wanted_rad_s, &waited, &searched);
        const double way_m = fabs(r0_m - from_m);
        ck_assert(way_m <= motor->change_m + 1e-7);
        if (!searched) {
            continue;
        }
        const double told_s = (double)(p.apex_window_s + p.sensor_latency_s) + 2.0 * TICK_S;
        const double left_s = strike_after(&apex) - told_s - TICK_S * waited;
        const double takes_s = time_of(way_m, motor);
        ck_assert_msg(way_m < 1e-7 || takes_s <= left_s,
                      "%g to %g m takes %g s of %g, apex %d, wanted %g", from_m, r0_m, takes_s,
                      left_s, i % APEXES, wanted_rad_s);
        answers++;
        at_a_limit += takes_s > 0.85 * left_s || way_m > 0.999 * motor->change_m;
    }
    ck_assert_int_ge(answers, 100);
    ck_assert(_i == 0 || at_a_limit >= 10);
}
END_TEST

/* A spring of k compressed by r0 pushes back with k r0. */
START_TEST(the_motor_can_hold_the_spring)
{
    static const double force_max_N[] = {90.0, 20.0, 12.0};
    prepare(force_max_N[_i]);
    double greatest_N = 0.0;
    for (int i = 0; i < APEXES; i++) {
        const struct apex_estimate apex = apex_of(i);
        int waited;
        bool searched;
        const double from_m = 0.9 * (double)params.r0_max_m;
        const double r0_m = answer(&params, &apex, from_m, 1.0, &waited, &searched);
        greatest_N = fmax(greatest_N, subject_spring_N_per_m(&subject) * r0_m);
        ck_assert(subject_spring_N_per_m(&subject) * r0_m <= force_max_N[_i] * (1.0 + 1e-6));
    }
    ck_assert(_i == 0 || greatest_N > 0.95 * force_max_N[_i]); /* it would push harder */
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("law limits");
    TCase *tests = tcase_create("all");
    tcase_add_checked_fixture(tests, setup, NULL);
    tcase_set_timeout(tests, 120);
    tcase_add_loop_test(tests, the_motor_can_be_there_at_heel_strike, 0,
                        (int)(sizeof motors / sizeof motors[0]));
    tcase_add_loop_test(tests, the_motor_can_hold_the_spring, 0, 3);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
