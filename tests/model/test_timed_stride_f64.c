/* The spring released before and after heel strike: accelerations and walks against the plant's
 * three-degree-of-freedom walker, energy, and stride() in the middle. */
#include "model/timed_stride.h"

#include <math.h>

#include "sim_host/gait/gait_curve.h"
#include "sim_host/plant/walk.h"
#include "tests/support/assert_close.h"

static const struct walker3_params PAPER = {
    .hip_mass_kg = 1.0, .leg_mass_kg = 0.01, .leg_length_m = 1.0, .gravity_m_s2 = 9.80665};

static struct walker paper_walker(void)
{
    struct walker walker;
    const struct walker_params params = walker_paper_params();
    ck_assert_int_eq(walker_init(&walker, &params), WALKER_OK);
    return walker;
}

START_TEST(accelerations_are_the_plants)
{
    const struct walker walker = paper_walker();
    const struct push_support push = {&walker, 0.2};
    for (int i = 0; i < 20; i++) {
        const double x[6] = {-0.3 + 0.02 * i, 0.4 - 0.03 * i, 0.01 * i,
                             -0.5 - 0.05 * i, 2.0 - 0.2 * i,  0.05 * i};
        const struct walker3_state state = {{x[0], x[1], x[2]}, {x[3], x[4], x[5]}};
        const struct walker3_contact contact = {false, false, 0.0};
        double rates[6], ddq[3];
        push_support_rates(&push, x, rates);
        walker3_accelerate(&PAPER, &state, &contact, 100.0 * (0.2 - x[2]), ddq, NULL);
        for (int k = 0; k < 3; k++) {
            assert_close(rates[3 + k], ddq[k], 1e-10, 1e-10);
        }
    }
}
END_TEST

START_TEST(at_the_strike_it_is_stride)
{
    const struct walker walker = paper_walker();
    const struct stride_settings settings = stride_settings_accurate(&walker);
    const struct gait_walker paper = gait_walker_of_paper();
    static const double r0s[] = {0.03, 0.05, 0.12, 0.2, 0.28};
    for (int i = 0; i < 5; i++) {
        struct gait_point gait;
        struct stride_result a, b;
        ck_assert_int_eq(gait_curve(&paper, r0s[i], 0.0, 1, &gait, NULL), GAIT_CURVE_OK);
        const struct apex from = {gait.apex[0], gait.apex[1], gait.apex[2]};
        ck_assert_int_eq(stride(&walker, &settings, &from, r0s[i], &a), STRIDE_OK);
        ck_assert_int_eq(timed_stride(&walker, &settings, &from, r0s[i], 0.0, &b), STRIDE_OK);
        assert_close(b.next.stance_rate_rad_s, a.next.stance_rate_rad_s, 1e-9, 0.0);
        assert_close(b.next.swing_rate_rad_s, a.next.swing_rate_rad_s, 1e-9, 0.0);
        ck_assert_int_eq(timed_stride(&walker, &settings, &from, r0s[i], -1e-18, &b), STRIDE_OK);
        /* and both sides of it join: a microsecond early or late changes by microseconds */
        for (int side = -1; side <= 1; side += 2) {
            ck_assert_int_eq(timed_stride(&walker, &settings, &from, r0s[i], 1e-6 * side, &b),
                             STRIDE_OK);
            assert_close(b.next.stance_rate_rad_s, a.next.stance_rate_rad_s, 1e-4, 0.0);
        }
    }
}
END_TEST

static void set_seas(struct sea sea[SIDE_COUNT], enum sea_release on, double latency_s)
{
    const struct sea_subject subject = {.total_mass_kg = 1.02,
                                        .leg_length_m = 1.0,
                                        .gravity_m_s2 = 9.80665,
                                        .spring_N_per_m = 100.0};
    struct sea_params params;
    sea_preset(SEA_IDEAL, &subject, &params);
    params.release_on = on;
    params.release_latency_s = latency_s;
    sea_init(&sea[SIDE_LEFT], &params, 1);
    sea_init(&sea[SIDE_RIGHT], &params, 2);
}

/* Walks the plant from an apex with the left latch armed from tick arm_tick on, until the next apex. */
static bool plant_stride(const struct gait_point *gait, double r0_m, enum sea_release on,
                         double latency_s, int arm_tick, struct walk *walk, struct walk_step *step)
{
    struct walk_params params;
    struct sea sea[SIDE_COUNT];
    struct walk_event event;
    const struct walk_pose pose = {.stance = SIDE_LEFT,
                                   .theta_n_rad = gait->apex[1],
                                   .theta_s_rate_rad_s = gait->apex[0],
                                   .theta_n_rate_rad_s = gait->apex[2]};
    walk_params_default(&PAPER, &params);
    set_seas(sea, on, latency_s);
    walk_init(walk, &params, &pose);
    walk_let_go(walk);
    for (int tick = 0; tick < 3000; tick++) {
        const struct sea_command left = {
            .mode = SEA_POSITION, .target_position_m = r0_m, .latch_armed = tick >= arm_tick};
        const struct sea_command right = {
            .mode = SEA_POSITION, .target_position_m = 0.0, .latch_armed = false};
        sea_set_command(&sea[SIDE_LEFT], &left, walk->time_s);
        sea_set_command(&sea[SIDE_RIGHT], &right, walk->time_s);
        walk_advance(walk, sea, 0.001);
        while (walk_next_event(walk, &event)) {
            if (event.kind == WALK_EVENT_APEX) {
                return walk_next_step(walk, step);
            }
        }
    }
    return false;
}

START_TEST(late_release_is_the_plants)
{
    const struct walker walker = paper_walker();
    const struct stride_settings settings = stride_settings_fixed(&walker, 1e-4);
    const struct gait_walker paper = gait_walker_of_paper();
    static const double late_s[] = {0.0005, 0.002, 0.005};
    struct gait_point gait;
    ck_assert_int_eq(gait_curve(&paper, 0.1, 0.0, 1, &gait, NULL), GAIT_CURVE_OK);
    const struct apex from = {gait.apex[0], gait.apex[1], gait.apex[2]};
    for (int i = 0; i < 3; i++) {
        struct stride_result r;
        struct walk walk;
        struct walk_step step;
        ck_assert_int_eq(timed_stride(&walker, &settings, &from, 0.1, late_s[i], &r), STRIDE_OK);
        ck_assert(plant_stride(&gait, 0.1, SEA_RELEASE_CONTACT, late_s[i], 0, &walk, &step));
        assert_close(step.heel_strike_time_s, r.apex_to_strike_s, 1e-8, 0.0);
        assert_close(walk.current.apex_speed_rad_s, -r.next.stance_rate_rad_s, 1e-6, 0.0);
        assert_close(walk.current.apex_theta_n_rad, r.next.swing_angle_rad, 1e-6, 0.0);
    }
}
END_TEST

START_TEST(early_release_is_the_plants)
{
    const struct walker walker = paper_walker();
    const struct stride_settings settings = stride_settings_fixed(&walker, 1e-4);
    const struct gait_walker paper = gait_walker_of_paper();
    struct gait_point gait;
    /* above r0 = 0.1 the spring lifts the heel at once */
    ck_assert_int_eq(gait_curve(&paper, 0.18, 0.0, 1, &gait, NULL), GAIT_CURVE_OK);
    const struct apex from = {gait.apex[0], gait.apex[1], gait.apex[2]};
    for (int i = 1; i <= 3; i++) {
        struct stride_result r;
        struct walk walk;
        struct walk_step step;
        const int arm_tick = (int)(gait.apex_to_strike_s * 1000.0) - 10 * i;
        ck_assert(plant_stride(&gait, 0.18, SEA_RELEASE_COMMAND, 0.0, arm_tick, &walk, &step));
        const double release_s = step.release_time_s - gait.apex_to_strike_s;
        ck_assert(release_s < -0.005);
        ck_assert_int_eq(timed_stride(&walker, &settings, &from, 0.18, release_s, &r), STRIDE_OK);
        assert_close(step.heel_strike_time_s, r.apex_to_strike_s, 1e-6, 0.0);
        assert_close(step.step_length_m, r.step_length_m, 1e-6, 0.0);
        assert_close(walk.current.apex_speed_rad_s, -r.next.stance_rate_rad_s, 1e-5, 0.0);
        assert_close(walk.current.apex_theta_n_rad, r.next.swing_angle_rad, 1e-5, 0.0);
    }
}
END_TEST

START_TEST(what_cannot_be_walked_has_a_name)
{
    const struct walker walker = paper_walker();
    const struct stride_settings settings = stride_settings_accurate(&walker);
    const struct apex from = {-0.8, -0.106, 2.985};
    struct stride_result r;
    ck_assert_int_eq(timed_stride(&walker, &settings, &from, (real)NAN, 0.0, &r), STRIDE_BAD_INPUT);
    ck_assert_int_eq(timed_stride(&walker, &settings, &from, 0.17, (real)NAN, &r),
                     STRIDE_BAD_INPUT);
    /* so early that the spring runs out in mid-air */
    ck_assert_int_ne(timed_stride(&walker, &settings, &from, 0.25, -0.4, &r), STRIDE_OK);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("timed_stride");
    TCase *tests = tcase_create("all");
    tcase_add_test(tests, accelerations_are_the_plants);
    tcase_add_test(tests, at_the_strike_it_is_stride);
    tcase_add_test(tests, late_release_is_the_plants);
    tcase_add_test(tests, early_release_is_the_plants);
    tcase_add_test(tests, what_cannot_be_walked_has_a_name);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
