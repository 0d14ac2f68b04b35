/* Slopes and steps of the ground in the return map: against geometry, energy, and the plant's
 * three-degree-of-freedom walk on the same ground (another derivation: forces that pin both toes). */
#include "model/ground.h"

#include <math.h>

#include "model/double_support.h"
#include "model/stride.h"
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

START_TEST(incline_is_geometry)
{
    const struct ground level = {0.0, 0.0}, slope = {0.05, 0.0}, both = {0.05, 0.02};
    ck_assert(ground_incline_rad(&level, 0.5) == 0.0);
    ck_assert(ground_incline_rad(&slope, 0.5) == 0.05);
    for (double opening = 0.2; opening < 1.5; opening += 0.3) {
        const double e = ground_incline_rad(&both, opening), d = 2.0 * sin(opening / 2.0);
        assert_close(d * sin(e), d * cos(e) * tan(0.05) + 0.02, 1e-14, 0.0);
    }
}
END_TEST

START_TEST(toe_lands_on_the_ground)
{
    const struct walker walker = paper_walker();
    const struct stride_settings settings = stride_settings_accurate(&walker);
    const struct apex from = {-0.407, -0.0596, 1.757};
    static const struct ground grounds[] = {{0.02, 0.0},   {-0.03, 0.0}, {0.0, 0.01},
                                            {0.0, -0.015}, {0.02, 0.01}, {-0.02, -0.004}};
    for (int i = 0; i < 6; i++) {
        struct stride_result r;
        (void)stride_on_ground(&walker, &settings, &from, 0.05, &grounds[i], &r);
        const struct point toe = single_support_swing_toe(&walker, r.strike);
        assert_close(toe.y_m, -toe.x_m * tan(grounds[i].slope_rad) + grounds[i].height_rise, 1e-12,
                     0.0);
        assert_close(r.step_length_m, hypot(toe.x_m, toe.y_m), 1e-12, 0.0);
    }
}
END_TEST

static double next_random(uint64_t *seed)
{
    *seed = *seed * 6364136223846793005u + 1442695040888963407u;
    return (double)(*seed >> 11) * 0x1p-53;
}

/* However the toe comes down: fast or grazing, at a step's beginning or end, with any step. */
START_TEST(toe_lands_on_any_ground)
{
    const struct walker walker = paper_walker();
    uint64_t seed = 40;
    int strikes = 0;
    for (int i = 0; i < 4000; i++) {
        const struct apex from = {-0.2 - 0.9 * next_random(&seed), -0.4 + 0.5 * next_random(&seed),
                                  0.6 + 3.0 * next_random(&seed)};
        const struct ground ground = {0.16 * (next_random(&seed) - 0.5),
                                      0.06 * (next_random(&seed) - 0.5)};
        const struct stride_settings settings =
            stride_settings_fixed(&walker, i % 2 == 0 ? 0.03 : 0.002 + 0.05 * next_random(&seed));
        struct stride_result r = {.fault = STRIDE_OK};
        if (stride_to_strike_on_ground(&walker, &settings, &from, &ground, &r) != STRIDE_OK ||
            r.strike[SWING_ANGLE] < r.strike[STANCE_ANGLE]) {
            continue; /* no strike, or the legs cross again in a fall: a rise is one ahead */
        }
        const struct point toe = single_support_swing_toe(&walker, r.strike);
        assert_close(toe.y_m, -toe.x_m * tan(ground.slope_rad) + ground.height_rise, 1e-14, 0.0);
        strikes++;
    }
    ck_assert_int_gt(strikes, 2000);
}
END_TEST

START_TEST(energy_of_an_inclined_double_support_is_kept)
{
    const struct walker walker = paper_walker();
    struct double_support phase = {
        .walker = &walker, .toe_distance_m = 0.54, .spring_rest_m = 0.06};
    double_support_incline(&phase, 0.04);
    const struct ode ode = {double_support_rates, &phase, DOUBLE_SUPPORT_STATES};
    double state[2] = {0.0, 0.1};
    const double before = double_support_energy_J(&phase, state);
    for (int i = 0; i < 100; i++) {
        ode_step(&ode, ODE_RK8, 0.001, state, state);
    }
    assert_close(double_support_energy_J(&phase, state), before, 1e-11, 0.0);
    /* and the angles it ends with are those of the masses: hip over the trailing toe */
    const struct chain_angles a = double_support_angles(&phase, state[0]);
    const double hip_y = (1.0 + state[0]) * cos(a.trailing_rad);
    const double toe_y = 0.54 * sin(0.04);
    assert_close(hip_y, toe_y + cos(a.leading_rad), 1e-12, 0.0);
}
END_TEST

START_TEST(level_ground_keeps_every_bit)
{
    const struct walker walker = paper_walker();
    const struct stride_settings settings = stride_settings_accurate(&walker);
    const struct apex from = {-0.407, -0.0596, 1.757};
    const struct ground level = {0.0, 0.0};
    struct stride_result a, b;
    ck_assert_int_eq(stride(&walker, &settings, &from, 0.05, &a), STRIDE_OK);
    ck_assert_int_eq(stride_on_ground(&walker, &settings, &from, 0.05, &level, &b), STRIDE_OK);
    ck_assert(a.next.stance_rate_rad_s == b.next.stance_rate_rad_s);
    ck_assert(a.next.swing_rate_rad_s == b.next.swing_rate_rad_s);
}
END_TEST

/* A foothold a little lower is a stride a little longer: however finely the swing is looked at, the toe's dip
 * as it passes the stance foot (half a millimetre on a leg of 1 m) is no heel strike. */
START_TEST(a_lower_foothold_is_not_met_in_mid_swing)
{
    const struct walker walker = paper_walker();
    const struct gait_walker subject = gait_walker_of_paper();
    struct gait_point gait;
    ck_assert_int_eq(gait_curve(&subject, 0.17, 0.0, 1, &gait, NULL), GAIT_CURVE_OK);
    const struct apex from = {gait.apex[0], gait.apex[1], gait.apex[2]};
    for (int step = 1; step <= 32; step *= 2) {
        const struct stride_settings settings = stride_settings_fixed(&walker, 0.001 * step);
        struct stride_result level, lower;
        ck_assert_int_eq(stride(&walker, &settings, &from, 0.17, &level), STRIDE_OK);
        for (double drop = 1e-5; drop < 0.02; drop *= 1.5) {
            const struct ground ground = {0.0, -drop};
            ck_assert_int_eq(stride_on_ground(&walker, &settings, &from, 0.17, &ground, &lower),
                             STRIDE_OK);
            assert_close(lower.apex_to_strike_s, level.apex_to_strike_s, 10.0 * drop, 0.0);
            assert_close(lower.next.stance_rate_rad_s, level.next.stance_rate_rad_s, 20.0 * drop,
                         0.0);
        }
    }
}
END_TEST

START_TEST(bad_ground_is_refused)
{
    const struct walker walker = paper_walker();
    const struct stride_settings settings = stride_settings_accurate(&walker);
    const struct apex from = {-0.407, -0.0596, 1.757};
    const struct ground steep = {1.6, 0.0}, nothing = {0.0, (real)NAN};
    struct stride_result r;
    ck_assert_int_eq(stride_on_ground(&walker, &settings, &from, 0.05, &steep, &r),
                     STRIDE_BAD_INPUT);
    ck_assert_int_eq(stride_on_ground(&walker, &settings, &from, 0.05, &nothing, &r),
                     STRIDE_BAD_INPUT);
}
END_TEST

/* ---- against the plant ------------------------------------------------------------------ */

static void ideal_seas(struct sea sea[SIDE_COUNT])
{
    const struct sea_subject subject = {.total_mass_kg = 1.02,
                                        .leg_length_m = 1.0,
                                        .gravity_m_s2 = 9.80665,
                                        .spring_N_per_m = 100.0};
    struct sea_params params;
    sea_preset(SEA_IDEAL, &subject, &params);
    sea_init(&sea[SIDE_LEFT], &params, 1);
    sea_init(&sea[SIDE_RIGHT], &params, 2);
}

static void start_on(struct walk *walk, const struct apex *apex, const struct ground *ground)
{
    struct walk_params params;
    const struct walk_pose pose = {.stance = SIDE_LEFT,
                                   .theta_n_rad = apex->swing_angle_rad,
                                   .theta_s_rate_rad_s = apex->stance_rate_rad_s,
                                   .theta_n_rate_rad_s = apex->swing_rate_rad_s};
    walk_params_default(&PAPER, &params);
    params.slope_rad = ground->slope_rad;
    ck_assert_ptr_null(walk_params_check(&params));
    walk_init(walk, &params, &pose);
    walk_set_next_height(walk, ground->height_rise);
    walk_let_go(walk);
}

/* The lowest footholds: in mid-swing the toe dips below their height, which is the scuff to be ignored. */
static const struct ground GROUNDS[] = {{0.02, 0.0},    {-0.03, 0.0},   {0.0, 0.01},
                                        {0.0, -0.015},  {0.02, -0.01},  {-0.02, 0.004},
                                        {0.0, -0.0003}, {0.0, -0.0001}, {0.0, 0.02}};

START_TEST(agrees_with_the_plant)
{
    const struct walker walker = paper_walker();
    const struct stride_settings settings = stride_settings_accurate(&walker);
    const struct gait_walker subject = gait_walker_of_paper();
    const struct sea_command command = {
        .mode = SEA_POSITION, .target_position_m = 0.1, .latch_armed = true};
    struct gait_point gait;
    ck_assert_int_eq(gait_curve(&subject, 0.1, 0.0, 1, &gait, NULL), GAIT_CURVE_OK);
    const struct apex from = {gait.apex[0], gait.apex[1], gait.apex[2]};
    struct stride_result r;
    struct walk walk;
    struct sea sea[SIDE_COUNT];
    struct walk_event event = {.kind = WALK_EVENT_FAULT};
    struct walk_step step;
    ck_assert_int_eq(stride_on_ground(&walker, &settings, &from, 0.1, &GROUNDS[_i], &r), STRIDE_OK);
    ideal_seas(sea);
    start_on(&walk, &from, &GROUNDS[_i]);
    bool there = false;
    for (int tick = 0; tick < 3000 && !there; tick++) {
        sea_set_command(&sea[SIDE_LEFT], &command, walk.time_s);
        sea_set_command(&sea[SIDE_RIGHT], &command, walk.time_s);
        walk_advance(&walk, sea, 0.001);
        while (!there && walk_next_event(&walk, &event)) {
            there = event.kind == WALK_EVENT_APEX;
        }
    }
    ck_assert(there);
    ck_assert(walk_next_step(&walk, &step));
    assert_close(step.heel_strike_time_s, r.apex_to_strike_s, 1e-8, 0.0);
    assert_close(step.step_length_m, r.step_length_m, 1e-8, 0.0);
    assert_close(step.lift_off_time_s - step.heel_strike_time_s, r.double_support_s, 1e-8, 0.0);
    assert_close(walk.current.apex_speed_rad_s, -r.next.stance_rate_rad_s, 1e-8, 0.0);
    assert_close(walk.current.apex_theta_n_rad, r.next.swing_angle_rad, 1e-8, 0.0);
    assert_close(walk.current.apex_theta_n_rate_rad_s, r.next.swing_rate_rad_s, 1e-8, 0.0);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("ground");
    TCase *tests = tcase_create("all");
    tcase_add_test(tests, incline_is_geometry);
    tcase_add_test(tests, toe_lands_on_the_ground);
    tcase_add_test(tests, toe_lands_on_any_ground);
    tcase_add_test(tests, energy_of_an_inclined_double_support_is_kept);
    tcase_add_test(tests, level_ground_keeps_every_bit);
    tcase_add_test(tests, a_lower_foothold_is_not_met_in_mid_swing);
    tcase_add_test(tests, bad_ground_is_refused);
    tcase_add_loop_test(tests, agrees_with_the_plant, 0, sizeof GROUNDS / sizeof GROUNDS[0]);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
