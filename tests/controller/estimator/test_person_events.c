/* Events of a person's legs, on a made-up walker whose events are known: in stance a
 * leg turns backwards at a constant rate; in swing its rate rises smoothly to a peak
 * and falls back to the stance rate, which it reaches when the foot is planted. */
#include <check.h>
#include <math.h>
#include <stdlib.h>

#include "controller/estimator/gait_observer.h"
#include "tests/support/assert_close.h"
#include "tests/support/swinging_legs.h"

enum { EVENTS_MAX = 400 };

struct heard {
    int count[GAIT_EVENT_KINDS][SIDE_COUNT];
    double time_s[GAIT_EVENT_KINDS][SIDE_COUNT][EVENTS_MAX];
    double worst_delay_s;
    double share_error;
};

static struct control_params person_params(void)
{
    return (struct control_params){.gravity_m_s2 = 9.81f,
                                   .leg_length_m = 0.9f,
                                   .apex_window_s = 0.03f,
                                   .angle_hysteresis_rad = 0.01f,
                                   .body = (real)BODY_PERSON};
}

static double ankle_m[SIDE_COUNT]; /* what feed() shows of the ankles */

static void feed(struct gait_observer *observer, const struct control_params *params, uint32_t tick,
                 double left_rad, double right_rad, struct heard *heard)
{
    struct controller_input input = {.tick = tick};
    input.leg[SIDE_LEFT].leg_angle_rad = (real)left_rad;
    input.leg[SIDE_RIGHT].leg_angle_rad = (real)right_rad;
    input.leg[SIDE_LEFT].ankle_extension_m = (real)ankle_m[SIDE_LEFT];
    input.leg[SIDE_RIGHT].ankle_extension_m = (real)ankle_m[SIDE_RIGHT];
    gait_observer_update(observer, params, &input);
    for (int kind = 0; kind < GAIT_EVENT_KINDS; kind++) {
        const struct gait_event *event = &observer->state.event[kind];
        if (event->happened) {
            int *count = &heard->count[kind][event->side];
            const double time_s = 1e-3 * event->tick - (double)event->before_tick_s;
            ck_assert_int_lt(*count, EVENTS_MAX);
            heard->time_s[kind][event->side][(*count)++] = time_s;
            heard->worst_delay_s = fmax(heard->worst_delay_s, 1e-3 * tick - time_s);
        }
    }
}

static double noise(void)
{
    return (double)rand() / RAND_MAX + (double)rand() / RAND_MAX - 1.0; /* sd 0.41 */
}

static void walk(const struct person *person, double seconds, struct heard *heard)
{
    static struct gait_observer observer;
    const struct control_params params = person_params();
    gait_observer_init(&observer, &params);
    *heard = (struct heard){0};
    srand(1);
    for (uint32_t tick = 0; tick < (uint32_t)(seconds * 1000.0); tick++) {
        const double strides = 1e-3 * tick / person->stride_s;
        double angle[SIDE_COUNT];
        for (int side = 0; side < SIDE_COUNT; side++) {
            const double at = strides + 0.3 + 0.5 * side;
            angle[side] = leg_angle(person, at - floor(at)) + person->offset_rad[side] +
                          person->noise_rad * noise();
        }
        feed(&observer, &params, tick, angle[SIDE_LEFT], angle[SIDE_RIGHT], heard);
        const double truth = strides + 0.3;
        const double share = (double)observer.state.stride_share[SIDE_LEFT];
        if (strides > 4.0) {
            const double off = share - truth;
            heard->share_error = fmax(heard->share_error, fabs(off - floor(off + 0.5)));
        }
    }
}

/* Each event once a stride, at the same share of the stride up to a tolerance. */
static void once_a_stride(const struct person *person, const struct heard *heard, double seconds)
{
    const double shares[GAIT_EVENT_KINDS] = {
        [GAIT_APEX] = 0.3, [GAIT_HEEL_STRIKE] = 1.0, [GAIT_LIFT_OFF] = 0.6 + 0.4 * 0.25};
    const double tolerance[GAIT_EVENT_KINDS] = {
        [GAIT_APEX] = 0.002, [GAIT_HEEL_STRIKE] = 0.06, [GAIT_LIFT_OFF] = 0.06};
    for (int kind = 0; kind < GAIT_EVENT_KINDS; kind++) {
        for (int side = 0; side < SIDE_COUNT; side++) {
            const int count = heard->count[kind][side];
            ck_assert_int_ge(count, (int)(seconds / person->stride_s) - 2);
            for (int i = 0; i < count; i++) {
                const double share =
                    heard->time_s[kind][side][i] / person->stride_s + 0.3 + 0.5 * side;
                const double off = share - shares[kind];
                assert_close(off - floor(off + 0.5), 0.0, tolerance[kind], 0.0);
                if (i > 0) {
                    assert_close(heard->time_s[kind][side][i] - heard->time_s[kind][side][i - 1],
                                 person->stride_s, 0.05 * person->stride_s, 0.0);
                }
            }
        }
    }
}

static const struct person people[] = {
    {1.1, 1.3, {0, 0}, 0}, {0.9, 1.9, {0, 0}, 0},    {1.4, 0.8, {0, 0}, 0},
    {1.8, 0.5, {0, 0}, 0}, {1.1, 1.3, {0, 0}, 4e-4}, {1.1, 1.3, {0, 0}, 2e-3},
};

START_TEST(every_event_once_a_stride)
{
    struct heard heard;
    walk(&people[_i], 40.0, &heard);
    once_a_stride(&people[_i], &heard, 40.0);
    ck_assert(heard.worst_delay_s < 0.06);
    ck_assert(heard.share_error < 0.05);
}
END_TEST

START_TEST(a_common_offset_moves_no_heel_strike)
{
    struct heard plain, shifted;
    const struct person person = {1.1, 1.3, {0.05, 0.05}, 0};
    walk(&people[0], 20.0, &plain);
    walk(&person, 20.0, &shifted);
    ck_assert_int_eq(plain.count[GAIT_HEEL_STRIKE][0], shifted.count[GAIT_HEEL_STRIKE][0]);
    for (int i = 0; i < plain.count[GAIT_HEEL_STRIKE][0]; i++) {
        assert_close(shifted.time_s[GAIT_HEEL_STRIKE][0][i], plain.time_s[GAIT_HEEL_STRIKE][0][i],
                     0.003, 0.0);
    }
}
END_TEST

/* The ankle's push: a raised cosine whose rate is down to half of its peak at 5/12 of it. */
#define PUSH_BEGINS 0.54
#define PUSH_LASTS 0.22

static double push_m(double height_m, double u)
{
    const double s = (u - PUSH_BEGINS) / PUSH_LASTS;
    return s > 0.0 && s < 1.0 ? 0.5 * height_m * (1.0 - cos(2.0 * M_PI * s)) : 0.0;
}

/* Toe-off lies a constant before the mean of the leg's turn and the end of the ankle's push;
 * without a push (none, or a twitch), another constant before the turn. */
START_TEST(toe_off_by_leg_and_ankle)
{
    static const double heights_m[] = {0.04, 0.02, 0.0, 0.003};
    static struct gait_observer observer;
    const struct control_params params = person_params();
    const struct person *person = &people[0];
    struct heard heard = {0};
    gait_observer_init(&observer, &params);
    for (uint32_t tick = 0; tick < 20000; tick++) {
        double angle[SIDE_COUNT];
        for (int side = 0; side < SIDE_COUNT; side++) {
            const double at = 1e-3 * tick / person->stride_s + 0.5 * side;
            angle[side] = leg_angle(person, at - floor(at));
            ankle_m[side] = push_m(heights_m[_i], at - floor(at));
        }
        feed(&observer, &params, tick, angle[SIDE_LEFT], angle[SIDE_RIGHT], &heard);
    }
    ankle_m[SIDE_LEFT] = ankle_m[SIDE_RIGHT] = 0.0;
    /* The rate -1 + 2.5 (1 - cos 2 pi s), in walking speeds, is 0.3. */
    const double turn =
        1.0 - SWING_SHARE_OF_STRIDE + SWING_SHARE_OF_STRIDE * acos(0.48) / (2.0 * M_PI);
    const double over = PUSH_BEGINS + PUSH_LASTS * 5.0 / 12.0;
    const double expected = heights_m[_i] > 0.01 ? 0.5 * (turn + over) - 0.019 / person->stride_s
                                                 : turn - 0.0145 / person->stride_s;
    ck_assert_int_ge(heard.count[GAIT_LIFT_OFF][SIDE_LEFT], 16);
    for (int i = 4; i < heard.count[GAIT_LIFT_OFF][SIDE_LEFT]; i++) {
        const double share = heard.time_s[GAIT_LIFT_OFF][SIDE_LEFT][i] / person->stride_s;
        assert_close(share - floor(share), expected, 0.004, 0.0);
    }
    ck_assert(heard.worst_delay_s < 0.06);
}
END_TEST

static int all_events(const struct heard *heard)
{
    int sum = 0;
    for (int kind = 0; kind < GAIT_EVENT_KINDS; kind++) {
        sum += heard->count[kind][SIDE_LEFT] + heard->count[kind][SIDE_RIGHT];
    }
    return sum;
}

/* Both legs move alike (a sway, a bow) or a little against each other (shuffling on
 * the spot, weight shifted from leg to leg): nothing of it is a step. */
/* What the observer finds misplaced in 12 s of walking, where the ankles of these legs push off: from the last
 * third of stance on they extend by 3 cm, and come back in swing. */
static unsigned misplaced(bool left_moves, bool right_moves)
{
    static struct gait_observer observer;
    const struct person person = {.stride_s = 1.1, .speed_rad_s = 0.9};
    const struct control_params params = person_params();
    const bool moves[SIDE_COUNT] = {left_moves, right_moves};
    struct heard heard = {0};
    gait_observer_init(&observer, &params);
    for (uint32_t tick = 0; tick < 12000; tick++) {
        double angle[SIDE_COUNT];
        for (int side = 0; side < SIDE_COUNT; side++) {
            const double at = 1e-3 * tick / person.stride_s + 0.3 + 0.5 * side;
            const double u = at - floor(at);
            angle[side] = leg_angle(&person, u);
            ankle_m[side] =
                moves[side] && u > 0.4 && u < 0.8 ? 0.03 * sin((u - 0.4) / 0.4 * M_PI) : 0.0;
        }
        feed(&observer, &params, tick, angle[SIDE_LEFT], angle[SIDE_RIGHT], &heard);
    }
    ankle_m[SIDE_LEFT] = ankle_m[SIDE_RIGHT] = 0.0;
    return observer.state.misplaced;
}

START_TEST(an_ankle_that_never_moves_is_found_while_walking)
{
    ck_assert_uint_eq(misplaced(true, true), 0);
    ck_assert_uint_eq(misplaced(false, true), PLACEMENT_STUCK);
    ck_assert_uint_eq(misplaced(true, false), PLACEMENT_STUCK << 1);
}
END_TEST

START_TEST(standing_makes_no_events)
{
    const struct {
        double common_rad, against_rad, hz;
    } moves[] = {
        {0.02, 0, 0.4}, {0.15, 0, 0.5}, {0.25, 0, 0.25}, {0.01, 0.02, 1.0}, {0, 0.028, 2.0}};
    static struct gait_observer observer;
    const struct control_params params = person_params();
    struct heard heard = {0};
    gait_observer_init(&observer, &params);
    for (uint32_t tick = 0; tick < 20000; tick++) {
        const double phase = 2.0 * M_PI * moves[_i].hz * 1e-3 * tick;
        const double common = moves[_i].common_rad * sin(phase);
        const double against = moves[_i].against_rad * cos(phase);
        feed(&observer, &params, tick, common + against, common - against, &heard);
    }
    ck_assert_int_eq(all_events(&heard), 0);
}
END_TEST

/* Stand, walk some strides with both ends faded, stand again, twice. */
START_TEST(starting_and_stopping)
{
    static struct gait_observer observer;
    const struct control_params params = person_params();
    const struct person *person = &people[0];
    struct heard heard = {0};
    int at_rest = 0;
    gait_observer_init(&observer, &params);
    for (uint32_t tick = 0; tick < 40000; tick++) {
        const double t = fmod(1e-3 * tick, 20.0);
        const double fade = fmin(1.0, fmax(0.0, fmin((t - 4.0) / 1.5, (16.0 - t) / 1.5)));
        const double at = t / person->stride_s;
        const int before = all_events(&heard);
        feed(&observer, &params, tick, fade * leg_angle(person, at - floor(at)),
             fade * leg_angle(person, at + 0.5 - floor(at + 0.5)), &heard);
        if (t < 4.0 || t > 16.1) {
            at_rest += all_events(&heard) - before;
        }
    }
    ck_assert_int_eq(at_rest, 0);
    const int strides = (int)(2.0 * 10.0 / person->stride_s);
    for (int side = 0; side < SIDE_COUNT; side++) {
        ck_assert_int_ge(heard.count[GAIT_APEX][side], strides - 3);
        ck_assert_int_le(heard.count[GAIT_APEX][side], strides + 4);
        ck_assert_int_ge(heard.count[GAIT_HEEL_STRIKE][side], strides - 3);
        ck_assert_int_le(heard.count[GAIT_HEEL_STRIKE][side], strides + 4);
    }
}
END_TEST

/* A leg put forward and taken back without a step, while the other stands. */
START_TEST(a_step_given_up)
{
    static struct gait_observer observer;
    const struct control_params params = person_params();
    struct heard heard = {0};
    gait_observer_init(&observer, &params);
    for (uint32_t tick = 0; tick < 10000; tick++) {
        const double swing = 0.04 * (1.0 - cos(2.0 * M_PI * 1e-3 * tick));
        feed(&observer, &params, tick, swing, 0.0, &heard);
    }
    ck_assert_int_eq(heard.count[GAIT_HEEL_STRIKE][SIDE_LEFT], 0);
    ck_assert_int_eq(heard.count[GAIT_LIFT_OFF][SIDE_LEFT], 0);
}
END_TEST

/* Two people with the same angles, one seen 5 ms late: the events are the same. */
START_TEST(latency_is_allowed_for)
{
    static struct gait_observer observer;
    struct control_params params = person_params();
    struct heard late = {0}, prompt;
    walk(&people[0], 20.0, &prompt);
    params.sensor_latency_s = 0.005f;
    gait_observer_init(&observer, &params);
    for (uint32_t tick = 0; tick < 20000; tick++) {
        const double at = 1e-3 * ((double)tick - 5.0) / people[0].stride_s + 0.3;
        feed(&observer, &params, tick, leg_angle(&people[0], at - floor(at)),
             leg_angle(&people[0], at + 0.5 - floor(at + 0.5)), &late);
    }
    for (int kind = 0; kind < GAIT_EVENT_KINDS; kind++) {
        for (int i = 2; i < 10; i++) {
            assert_close(late.time_s[kind][0][i], prompt.time_s[kind][0][i], 1e-4, 0.0);
        }
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("person_events");
    TCase *tcase = tcase_create("events");
    tcase_set_timeout(tcase, 60);
    tcase_add_loop_test(tcase, every_event_once_a_stride, 0,
                        (int)(sizeof people / sizeof people[0]));
    tcase_add_test(tcase, a_common_offset_moves_no_heel_strike);
    tcase_add_test(tcase, an_ankle_that_never_moves_is_found_while_walking);
    tcase_add_loop_test(tcase, standing_makes_no_events, 0, 5);
    tcase_add_test(tcase, starting_and_stopping);
    tcase_add_test(tcase, a_step_given_up);
    tcase_add_test(tcase, latency_is_allowed_for);
    tcase_add_loop_test(tcase, toe_off_by_leg_and_ankle, 0, 4);
    suite_add_tcase(suite, tcase);
    return run_suite(suite);
}
