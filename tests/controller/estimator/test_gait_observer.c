/* The observer in the closed loop, against the plant's truth: a 3-DOF walker from its
 * Lagrangian, integrated in double, which shares no equation with model/. */
#include <check.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sim_host/cli/walk_options.h"
#include "sim_host/loop/loop.h"
#include "tests/support/assert_close.h"

struct quality {
    int apexes, events, false_apexes, missed_apexes;
    double speed_rms, speed_worst; /* relative */
    double swing_angle_rms_rad, swing_rate_rms_rad_s;
    double time_worst_s;
    double strike_worst_s, lift_off_worst_s;
    double confidence; /* mean */
    bool fell;
};

struct truth {
    double time_s, speed, swing_angle, swing_rate;
    enum side side;
    bool open;
};

static struct loop loop;

static void configure(double speed_rad_s, enum sensor_preset_kind sensors, double latency_s,
                      uint64_t seed, struct loop_config *config)
{
    struct walk_options options;
    struct subject subject;
    struct control_params params;
    double speed;
    char message[LOOP_MESSAGE_MAX];
    walk_options_init(&options);
    options.speed.apex_rad_s = speed_rad_s;
    ck_assert_int_eq(walk_options_resolve(&options, &subject, &params, &speed, message), 0);
    ck_assert_int_eq(loop_configure(config, &subject, &params, speed, sensors, seed, message), 0);
    for (int side = 0; side < SIDE_COUNT; side++) {
        config->plant.sensors[side].latency_s = latency_s;
    }
    config->params.sensor_latency_s = (real)latency_s;
}

/* The state at an apex, by a straight line back from the tick after it: the swing rate is
 * off by up to a tick of its acceleration, 2e-3 rad/s. */
static struct truth truth_at(const struct walk_event *event)
{
    struct plant_truth now;
    plant_truth(&loop.nodes.plant, &now);
    const double back_s = now.time_s - event->time_s;
    const enum side swing = side_other(event->side);
    return (struct truth){event->time_s,
                          event->value,
                          now.leg_angle_rad[swing] - back_s * now.leg_rate_rad_s[swing],
                          now.leg_rate_rad_s[swing],
                          event->side,
                          true};
}

/* Controller times: SYNCs are numbered from 1, and a tick's samples are one SYNC old. */
static double event_time_s(const struct gait_event *event)
{
    return ((double)event->tick - 2.0) * 1e-3 - (double)event->before_tick_s;
}

static void compare_apex(struct quality *q, const struct truth *truth, bool counts)
{
    const struct gait_state *gait = &loop.rig.task.controller.observer.state;
    const struct gait_event *apex = &gait->event[GAIT_APEX];
    if (!truth->open || apex->side != truth->side) {
        q->false_apexes++;
        return;
    }
    if (!counts) {
        return;
    }
    const double speed = ((double)apex->speed_rad_s - truth->speed) / truth->speed;
    const double angle = (double)gait->apex.swing_angle_rad - truth->swing_angle;
    const double rate = (double)gait->apex.swing_rate_rad_s - truth->swing_rate;
    q->apexes++;
    q->speed_rms += speed * speed;
    q->speed_worst = fmax(q->speed_worst, fabs(speed));
    q->swing_angle_rms_rad += angle * angle;
    q->swing_rate_rms_rad_s += rate * rate;
    q->confidence += (double)gait->apex.confidence;
    q->time_worst_s = fmax(q->time_worst_s, fabs(event_time_s(apex) - truth->time_s));
    ck_assert((double)gait->apex.stance_rate_rad_s == -(double)apex->speed_rad_s);
}

static void compare_time(double *worst_s, const struct gait_event *event, double truth_s)
{
    if (event->happened) {
        *worst_s = fmax(*worst_s, fabs(event_time_s(event) - truth_s));
    }
}

static struct quality walk(const struct loop_config *config, int steps, int settle)
{
    struct quality q = {0};
    struct truth apex = {0};
    struct walk_event event;
    double strike_s = 0.0, lift_off_s = 0.0;
    int passed = 0;
    char message[LOOP_MESSAGE_MAX];
    ck_assert_int_eq(loop_init(&loop, config, NULL, message), 0);
    for (long tick = 0; tick < 2000L * steps && passed < steps; tick++) {
        loop_tick(&loop);
        while (plant_next_event(&loop.nodes.plant, &event)) {
            if (event.kind == WALK_EVENT_APEX) {
                q.missed_apexes += apex.open;
                apex = truth_at(&event);
                passed++;
            } else if (event.kind == WALK_EVENT_HEEL_STRIKE) {
                strike_s = event.time_s;
            } else if (event.kind == WALK_EVENT_LIFT_OFF) {
                lift_off_s = event.time_s;
            }
        }
        const struct gait_event *seen = loop.rig.task.controller.observer.state.event;
        if (seen[GAIT_APEX].happened) {
            compare_apex(&q, &apex, passed > settle);
            apex.open = false;
        }
        if (passed > 2) {
            compare_time(&q.strike_worst_s, &seen[GAIT_HEEL_STRIKE], strike_s);
            compare_time(&q.lift_off_worst_s, &seen[GAIT_LIFT_OFF], lift_off_s);
        }
        if (plant_fault(&loop.nodes.plant) != WALK_FAULT_NONE) {
            q.fell = true;
            break;
        }
    }
    loop_free(&loop);
    q.speed_rms = sqrt(q.speed_rms / q.apexes);
    q.swing_angle_rms_rad = sqrt(q.swing_angle_rms_rad / q.apexes);
    q.swing_rate_rms_rad_s = sqrt(q.swing_rate_rms_rad_s / q.apexes);
    q.confidence /= q.apexes;
    return q;
}

static void no_event_wrong(const struct quality *q, int steps)
{
    ck_assert(!q->fell);
    ck_assert_int_eq(q->false_apexes, 0);
    ck_assert_int_eq(q->missed_apexes, 0);
    ck_assert_int_ge(q->apexes, steps - 10);
}

/* Bounds: three to four times below what is required of it (0.05 % with 17 bit, 0.3 %
 * with 14 bit, noise of one count, 2 ms latency), 1.5 times above what was measured. */
static const struct {
    enum sensor_preset_kind sensors;
    double latency_s, speed, speed_rms, angle_rms, rate_rms, time_s;
} cases[] = {
    {SENSORS_IDEAL, 0.0, 0.8, 2e-5, 5e-5, 2e-3, 5e-6},
    {SENSORS_17BIT, 0.002, 0.8, 1e-4, 1e-4, 2e-3, 5e-5},
    {SENSORS_17BIT, 0.002, 0.45, 1.5e-4, 1e-4, 2e-3, 1e-4},
    {SENSORS_14BIT, 0.002, 0.8, 6e-4, 3e-4, 2e-3, 3e-4},
    {SENSORS_14BIT, 0.005, 0.8, 6e-4, 3e-4, 2e-3, 3e-4},
    {SENSORS_14BIT, 0.002, 1.0, 6e-4, 3e-4, 2e-3, 3e-4},
    {SENSORS_12BIT, 0.002, 0.8, 2.5e-3, 1.2e-3, 4e-3, 1.2e-3},
};

START_TEST(the_apex_state_is_known)
{
    struct loop_config config;
    configure(cases[_i].speed, cases[_i].sensors, cases[_i].latency_s, 7, &config);
    const struct quality q = walk(&config, 120, 8);
    no_event_wrong(&q, 120);
    ck_assert(q.speed_rms < cases[_i].speed_rms);
    ck_assert(q.swing_angle_rms_rad < cases[_i].angle_rms);
    ck_assert(q.swing_rate_rms_rad_s < cases[_i].rate_rms);
    ck_assert(q.time_worst_s < cases[_i].time_s);
    ck_assert(q.strike_worst_s < 0.003);
    ck_assert(q.lift_off_worst_s < 0.006);
    ck_assert(q.confidence > 0.9);
}
END_TEST

START_TEST(lost_samples_are_bridged)
{
    struct loop_config config;
    configure(0.8, SENSORS_17BIT, 0.0001, 3, &config);
    for (int side = 0; side < SIDE_COUNT; side++) {
        config.plant.sensors[side].drop_probability = 0.05;
    }
    const struct quality q = walk(&config, 100, 8);
    no_event_wrong(&q, 100);
    ck_assert(q.speed_rms < 3e-4);
}
END_TEST

/* A controller with the wrong walker in its head: it learns the difference, or says
 * that it does not believe its model; either way the speed stays known. */
START_TEST(wrong_parameters_do_not_mislead)
{
    static const struct {
        double length, torso, leg;
    } wrong[] = {{0.9, 1, 1}, {1.1, 1, 1}, {1, 0.9, 1}, {1, 1, 1.1}};
    struct loop_config config;
    configure(0.6, SENSORS_17BIT, 0.0001, 5, &config);
    config.params.leg_length_m *= (real)wrong[_i].length;
    config.params.torso_mass_kg *= (real)wrong[_i].torso;
    config.params.leg_mass_kg *= (real)wrong[_i].leg;
    const struct quality q = walk(&config, 140, 60);
    no_event_wrong(&q, 80);
    ck_assert(q.speed_rms < 2e-3);
}
END_TEST

/* Mounting errors of both sensors: the apex is where the leg reads zero, but its speed
 * has an extremum there and hardly changes. */
START_TEST(offsets_do_not_mislead)
{
    struct loop_config config;
    configure(0.6, SENSORS_17BIT, 0.0001, 5, &config);
    config.plant.sensors[SIDE_LEFT].angle_offset_rad = _i == 0 ? 0.005 : 0.005;
    config.plant.sensors[SIDE_RIGHT].angle_offset_rad = _i == 0 ? 0.005 : -0.005;
    const struct quality q = walk(&config, 120, 8);
    ck_assert(!q.fell);
    ck_assert_int_eq(q.false_apexes, 0);
    ck_assert(q.speed_rms < 5e-3);
}
END_TEST

/* Noise that stays for tens of samples, as of a strap that gives: neither model nor samples can
 * tell it from motion, so the bound is what it does to a slope, 0.5 mrad within some 0.1 s. */
START_TEST(slow_noise_is_not_taken_for_motion)
{
    struct loop_config config;
    configure(0.6, SENSORS_17BIT, 0.002, 5, &config);
    for (int side = 0; side < SIDE_COUNT; side++) {
        config.plant.sensors[side].angle_coloured_rad = 5e-4;
        config.plant.sensors[side].angle_coloured_hz = 5.0;
    }
    const struct quality q = walk(&config, 120, 8);
    no_event_wrong(&q, 120);
    ck_assert(q.speed_rms < 5e-3);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("gait_observer");
    TCase *tcase = tcase_create("closed loop");
    tcase_set_timeout(tcase, 120);
    tcase_add_loop_test(tcase, the_apex_state_is_known, 0, (int)(sizeof cases / sizeof cases[0]));
    tcase_add_test(tcase, lost_samples_are_bridged);
    tcase_add_loop_test(tcase, wrong_parameters_do_not_mislead, 0, 4);
    tcase_add_loop_test(tcase, offsets_do_not_mislead, 0, 2);
    tcase_add_test(tcase, slow_noise_is_not_taken_for_motion);
    suite_add_tcase(suite, tcase);
    return run_suite(suite);
}
