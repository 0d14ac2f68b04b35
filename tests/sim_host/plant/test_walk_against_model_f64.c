/* The plant's three-degree-of-freedom walk against the reduced model's stride. Two derivations: the
 * plant keeps r and both toes by constraint forces in one set of coordinates, the model has closed
 * forms per phase. SHOW=1 CK_FORK=no prints the differences. */
#include <stdio.h>
#include <stdlib.h>

#include "model/stride.h"
#include "sim_host/gait/gait_curve.h"
#include "sim_host/plant/walk.h"
#include "tests/support/assert_close.h"

static const struct walker3_params PAPER = {
    .hip_mass_kg = 1.0, .leg_mass_kg = 0.01, .leg_length_m = 1.0, .gravity_m_s2 = 9.80665};

static struct walker paper_walker(void)
{
    struct walker walker;
    struct walker_params params = walker_paper_params();
    ck_assert_int_eq(walker_init(&walker, &params), WALKER_OK);
    return walker;
}

static void ideal_seas(struct sea sea[SIDE_COUNT])
{
    const struct sea_subject subject = {.total_mass_kg = 1.02,
                                        .leg_length_m = 1.0,
                                        .gravity_m_s2 = 9.80665,
                                        .spring_N_per_m = 100.0};
    struct sea_params params;
    sea_preset(SEA_IDEAL, &subject, &params);
    ck_assert_ptr_null(sea_params_check(&params));
    sea_init(&sea[SIDE_LEFT], &params, 1);
    sea_init(&sea[SIDE_RIGHT], &params, 2);
}

/* Starts the plant at the model's apex: a pose is any instant of single support. */
static void start_at(struct walk *walk, const struct apex *apex)
{
    struct walk_params params;
    const struct walk_pose pose = {.stance = SIDE_LEFT,
                                   .theta_s_rad = 0.0,
                                   .theta_n_rad = apex->swing_angle_rad,
                                   .theta_s_rate_rad_s = apex->stance_rate_rad_s,
                                   .theta_n_rate_rad_s = apex->swing_rate_rad_s};
    walk_params_default(&PAPER, &params);
    ck_assert_ptr_null(walk_params_check(&params));
    walk_init(walk, &params, &pose);
    walk_let_go(walk);
}

static bool walk_until(struct walk *walk, struct sea sea[SIDE_COUNT], double r0_m,
                       enum walk_event_kind kind, struct walk_event *event)
{
    const struct sea_command command = {
        .mode = SEA_POSITION, .target_position_m = r0_m, .latch_armed = true};
    for (int tick = 0; tick < 5000; tick++) {
        sea_set_command(&sea[SIDE_LEFT], &command, walk->time_s);
        sea_set_command(&sea[SIDE_RIGHT], &command, walk->time_s);
        walk_advance(walk, sea, 0.001);
        while (walk_next_event(walk, event)) {
            if (event->kind == kind) {
                return true;
            }
        }
    }
    return false;
}

static void compare_strides(double r0_m, int strides, bool clamped)
{
    const struct walker walker = paper_walker();
    const struct stride_settings settings = stride_settings_fixed(&walker, 1e-4);
    const struct gait_walker subject = gait_walker_of_paper();
    struct gait_point gait;
    ck_assert_int_eq(gait_curve(&subject, r0_m, 0.0, 1, &gait, NULL), GAIT_CURVE_OK);
    /* Next to the gait, so that the strides differ from each other. */
    struct apex x = {gait.apex[0] * (1.0 + 1e-4), gait.apex[1], gait.apex[2]};
    for (int i = 0; i < strides; i++) {
        struct stride_result result;
        struct walk walk;
        struct sea sea[SIDE_COUNT];
        struct walk_event event;
        struct walk_step step;
        ideal_seas(sea);
        start_at(&walk, &x);
        ck_assert_int_eq(stride(&walker, &settings, &x, r0_m, &result), STRIDE_OK);
        ck_assert(walk_until(&walk, sea, r0_m, WALK_EVENT_APEX, &event));
        ck_assert(walk_next_step(&walk, &step));
        const struct walk_step *now = &walk.current;
        if (getenv("SHOW") != NULL) {
            printf("%g strike %.3g ds %.3g apex t %.3g v %.3g tn %.3g tn' %.3g clamped %d\n", r0_m,
                   step.heel_strike_time_s - result.apex_to_strike_s,
                   step.lift_off_time_s - step.heel_strike_time_s - result.double_support_s,
                   now->apex_time_s - (result.apex_to_strike_s + result.double_support_s +
                                       result.lift_off_to_apex_s),
                   now->apex_speed_rad_s + result.next.stance_rate_rad_s,
                   now->apex_theta_n_rad - result.next.swing_angle_rad,
                   now->apex_theta_n_rate_rad_s - result.next.swing_rate_rad_s, result.clamped);
        }
        assert_close(step.heel_strike_time_s, result.apex_to_strike_s, 1e-10, 0.0);
        assert_close(step.step_length_m, result.step_length_m, 1e-10, 0.0);
        assert_close(step.lift_off_extension_m, r0_m, 1e-12, 0.0);
        assert_close(step.lift_off_time_s - step.heel_strike_time_s, result.double_support_s, 1e-10,
                     0.0);
        assert_close(now->apex_speed_rad_s, -result.next.stance_rate_rad_s, 1e-10, 0.0);
        assert_close(now->apex_theta_n_rad, result.next.swing_angle_rad, 1e-10, 0.0);
        assert_close(now->apex_theta_n_rate_rad_s, result.next.swing_rate_rad_s, 1e-10, 0.0);
        ck_assert_int_eq(result.clamped, clamped);
        x = result.next;
    }
}

static const struct {
    double r0_m;
    bool clamped;
} GAITS[] = {{0.01, false}, {0.05, false}, {0.09, false}, {0.15, false}, {0.22, false},
             {0.25, false}, {0.27, true},  {0.28, true},  {0.29, true}};

START_TEST(agrees_over_strides)
{
    compare_strides(GAITS[_i].r0_m, 2, GAITS[_i].clamped);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("walk_against_model");
    TCase *tcase = tcase_create("stride");
    tcase_add_loop_test(tcase, agrees_over_strides, 0, sizeof GAITS / sizeof GAITS[0]);
    suite_add_tcase(suite, tcase);
    return run_suite(suite);
}
