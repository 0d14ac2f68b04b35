/* A made walk with foot switches, from the legs' samples to the window in which a latch may be armed: it opens in every
 * step, near the other foot's landing, and not where the own foot's switch says that it has left or says nothing. */
#include "controller/estimator/gait_observer.h"
#include "tests/support/assert_close.h"
#include "tests/support/swinging_legs.h"

enum { WALK_TICKS = 20000, LEARNED_TICKS = 8000 };

static const struct person person = {1.1, 1.3, {0.0, 0.0}, 0.0};

struct seen {
    int steps[SIDE_COUNT];  /* in which this leg's latch might be armed */
    double worst_s;         /* its beginning, from the other foot's landing */
    int armed_ticks_in_air; /* of the own foot */
};

/* Which foot's switch shows another than where the foot is, from LEARNED_TICKS on; SIDE_COUNT: none. */
static struct seen walk(int spoiled, enum foot_contact shown)
{
    static struct gait_observer observer;
    const struct control_params params = {.gravity_m_s2 = 9.81f,
                                          .leg_length_m = 0.9f,
                                          .apex_window_s = 0.03f,
                                          .angle_hysteresis_rad = 0.01f,
                                          .foot_switches = 1.0f,
                                          .body = (real)BODY_PERSON};
    struct seen seen = {{0, 0}, 0.0, 0};
    bool was_near = false;
    gait_observer_init(&observer, &params);
    for (uint32_t tick = 1; tick < WALK_TICKS; tick++) {
        struct controller_input input = {.tick = tick};
        double at[SIDE_COUNT];
        for (int side = 0; side < SIDE_COUNT; side++) {
            const double strides = 1e-3 * tick / person.stride_s + 0.3 + 0.5 * side;
            at[side] = strides - floor(strides);
            input.leg[side].leg_angle_rad = (real)leg_angle(&person, at[side]);
            input.leg[side].foot = at[side] < 1.0 - SWING_SHARE_OF_STRIDE ? FOOT_DOWN : FOOT_UP;
            if (side == spoiled && tick > LEARNED_TICKS) {
                input.leg[side].foot = shown;
            }
        }
        gait_observer_update(&observer, &params, &input);
        const int own = (int)observer.state.stance;
        if (tick > LEARNED_TICKS && observer.state.strike_near) {
            const double landing = at[1 - own] > 0.5 ? at[1 - own] - 1.0 : at[1 - own];
            seen.steps[own] += was_near ? 0 : 1;
            seen.worst_s =
                was_near ? seen.worst_s : fmax(seen.worst_s, fabs(landing) * person.stride_s);
            seen.armed_ticks_in_air += at[own] > 1.0 - SWING_SHARE_OF_STRIDE ? 1 : 0;
        }
        was_near = observer.state.strike_near;
    }
    return seen;
}

START_TEST(a_window_opens_in_every_step_near_the_landing)
{
    const struct seen seen = walk(SIDE_COUNT, FOOT_UNKNOWN);
    const int strides = (int)(1e-3 * (WALK_TICKS - LEARNED_TICKS) / person.stride_s);
    for (int side = 0; side < SIDE_COUNT; side++) {
        ck_assert_int_ge(seen.steps[side], strides - 1);
        ck_assert_int_le(seen.steps[side], strides + 1);
    }
    ck_assert_double_le(seen.worst_s, 0.03); /* 20 ms ahead of the contact's mean time */
    ck_assert_int_eq(seen.armed_ticks_in_air, 0);
}
END_TEST

/* Open, or not heard: that leg's latch stays, the other's goes on. */
START_TEST(a_foot_that_is_not_down_is_not_pushed)
{
    static const enum foot_contact shown[] = {FOOT_UP, FOOT_UNKNOWN};
    for (int side = 0; side < SIDE_COUNT; side++) {
        for (int i = 0; i < 2; i++) {
            const struct seen seen = walk(side, shown[i]);
            ck_assert_int_eq(seen.steps[side], 0);
            ck_assert_int_ge(seen.steps[1 - side], 1);
        }
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("person's window");
    TCase *tests = tcase_create("all");
    tcase_add_test(tests, a_window_opens_in_every_step_near_the_landing);
    tcase_add_test(tests, a_foot_that_is_not_down_is_not_pushed);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
