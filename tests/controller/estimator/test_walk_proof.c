/* What shows forward walking, and what denies it, switch by switch. */
#include "controller/estimator/walk_proof.h"
#include "tests/support/assert_close.h"

struct feet {
    struct walk_proof proof;
    enum foot_contact foot[SIDE_COUNT];
    real angle_rad[SIDE_COUNT];
    uint32_t tick;
    int shown, denied;
};

static void start(struct feet *feet)
{
    *feet = (struct feet){.tick = 1000, .foot = {FOOT_DOWN, FOOT_DOWN}};
}

/* So long with both legs turning at these rates. */
static void pass(struct feet *feet, uint32_t ms, double left_rad_s, double right_rad_s)
{
    for (uint32_t i = 0; i < ms; i++) {
        feet->angle_rad[SIDE_LEFT] += (real)(left_rad_s * 1e-3);
        feet->angle_rad[SIDE_RIGHT] += (real)(right_rad_s * 1e-3);
        const enum walk_sign sign =
            walk_proof_update(&feet->proof, feet->foot, feet->angle_rad, feet->tick++);
        feet->shown += sign == WALK_STEP_SHOWN;
        feet->denied += sign == WALK_STEP_DENIED;
    }
}

/* A step of this leg's swing: both feet down for double_ms, then this one up for swing_ms. way_rad:
 * how far the standing leg turns back meanwhile. */
static void swing(struct feet *feet, enum side side, uint32_t double_ms, uint32_t swing_ms,
                  double way_rad)
{
    const double back_rad_s = -way_rad / (1e-3 * swing_ms);
    const double rates[SIDE_COUNT] = {side == SIDE_LEFT ? -back_rad_s : back_rad_s,
                                      side == SIDE_RIGHT ? -back_rad_s : back_rad_s};
    feet->foot[side] = FOOT_DOWN;
    pass(feet, double_ms, 0.0, 0.0);
    feet->foot[side] = FOOT_UP;
    pass(feet, swing_ms, rates[SIDE_LEFT], rates[SIDE_RIGHT]);
    feet->foot[side] = FOOT_DOWN;
}

static void walk(struct feet *feet, int steps, uint32_t double_ms, uint32_t swing_ms,
                 double way_rad)
{
    feet->angle_rad[SIDE_LEFT] = (real)(-0.5 * way_rad);
    feet->angle_rad[SIDE_RIGHT] = (real)(0.5 * way_rad);
    for (int i = 0; i < steps; i++) {
        swing(feet, i % 2 == 0 ? SIDE_LEFT : SIDE_RIGHT, double_ms, swing_ms, way_rad);
    }
    pass(feet, 50, 0.0, 0.0);
}

START_TEST(steps_of_walking_are_shown)
{
    static const struct {
        uint32_t double_ms, swing_ms;
        double way_rad;
    } ways[] = {{120, 430, 0.5}, {60, 350, 0.6}, {300, 700, 0.25}, {150, 400, 0.12}};
    struct feet feet;
    start(&feet);
    walk(&feet, 10, ways[_i].double_ms, ways[_i].swing_ms, ways[_i].way_rad);
    ck_assert_int_eq(feet.shown, 10);
    ck_assert_int_eq(feet.denied, 0);
    ck_assert_uint_eq(feet.proof.steps, 10);
}
END_TEST

START_TEST(backwards_is_denied)
{
    struct feet feet;
    start(&feet);
    walk(&feet, 6, 120, 430, -0.5);
    ck_assert_int_eq(feet.shown, 0);
    ck_assert_int_eq(feet.denied, 6);
}
END_TEST

START_TEST(on_the_spot_is_denied)
{
    struct feet feet;
    start(&feet);
    walk(&feet, 6, 120, 430, 0.02);
    ck_assert_int_eq(feet.shown, 0);
    ck_assert_int_eq(feet.denied, 6);
}
END_TEST

/* Running: each foot leaves before the other lands. */
START_TEST(flight_is_denied)
{
    struct feet feet;
    start(&feet);
    walk(&feet, 4, 120, 430, 0.5);
    ck_assert_uint_eq(feet.proof.steps, 4);
    feet.foot[SIDE_LEFT] = FOOT_UP;
    pass(&feet, 200, 1.0, -1.0);
    feet.foot[SIDE_RIGHT] = FOOT_UP; /* in flight */
    pass(&feet, 60, 1.0, -1.0);
    ck_assert_int_eq(feet.denied, 1);
    feet.foot[SIDE_LEFT] = FOOT_DOWN;
    pass(&feet, 100, -1.0, 0.5);
    ck_assert_int_eq(feet.denied, 2);
    ck_assert_uint_eq(feet.proof.steps, 0);
}
END_TEST

START_TEST(both_feet_down_or_none_show_nothing)
{
    for (int both = FOOT_UNKNOWN; both <= FOOT_DOWN; both++) {
        struct feet feet;
        start(&feet);
        feet.foot[SIDE_LEFT] = feet.foot[SIDE_RIGHT] = (enum foot_contact)both;
        for (int i = 0; i < 20; i++) {
            pass(&feet, 500, i % 2 == 0 ? 0.6 : -0.6, i % 2 == 0 ? -0.6 : 0.6);
        }
        ck_assert_int_eq(feet.shown, 0);
        ck_assert_uint_eq(feet.proof.steps, 0);
    }
}
END_TEST

START_TEST(bounce_and_chatter_are_no_steps)
{
    struct feet feet;
    start(&feet);
    for (int i = 0; i < 3000; i++) {
        feet.foot[SIDE_LEFT] = (i * 7 / 3) % 2 == 0 ? FOOT_UP : FOOT_DOWN;
        pass(&feet, 1, -0.5, 0.5);
    }
    ck_assert_int_eq(feet.shown, 0);
    ck_assert_uint_eq(feet.proof.foot[SIDE_LEFT].raw_edge_tick, 0);
}
END_TEST

START_TEST(a_switch_that_falls_silent_ends_what_was_shown)
{
    struct feet feet;
    start(&feet);
    walk(&feet, 4, 120, 430, 0.5);
    feet.foot[SIDE_LEFT] = FOOT_UNKNOWN;
    pass(&feet, 30, 0.0, 0.0);
    ck_assert_uint_eq(feet.proof.steps, 0);
}
END_TEST

/* It is heard last in the air: where the foot came down nobody saw. */
START_TEST(a_switch_that_falls_silent_in_swing_shows_no_step)
{
    struct feet feet;
    start(&feet);
    walk(&feet, 4, 120, 430, 0.5);
    const int shown = feet.shown, denied = feet.denied;
    swing(&feet, SIDE_LEFT, 120, 430, 0.5);
    feet.foot[SIDE_LEFT] = FOOT_UNKNOWN;
    pass(&feet, 30, 0.0, 0.0);
    ck_assert_int_eq(feet.shown, shown);
    ck_assert_int_eq(feet.denied, denied);
    ck_assert_uint_eq(feet.proof.steps, 0);
}
END_TEST

/* The device does not know the switches' biases: up to 40 ms each way. */
START_TEST(biased_switches_show_walking_too)
{
    struct feet feet;
    start(&feet);
    walk(&feet, 10, 70 - 40, 350 + 40, 0.5);
    ck_assert_int_eq(feet.shown, 10);
    ck_assert_int_eq(feet.denied, 0);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("walk_proof");
    TCase *all = tcase_create("all");
    tcase_add_loop_test(all, steps_of_walking_are_shown, 0, 4);
    tcase_add_test(all, backwards_is_denied);
    tcase_add_test(all, on_the_spot_is_denied);
    tcase_add_test(all, flight_is_denied);
    tcase_add_test(all, both_feet_down_or_none_show_nothing);
    tcase_add_test(all, bounce_and_chatter_are_no_steps);
    tcase_add_test(all, a_switch_that_falls_silent_ends_what_was_shown);
    tcase_add_test(all, a_switch_that_falls_silent_in_swing_shows_no_step);
    tcase_add_test(all, biased_switches_show_walking_too);
    suite_add_tcase(suite, all);
    return run_suite(suite);
}
