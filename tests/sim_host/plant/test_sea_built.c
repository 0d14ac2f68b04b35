/* An actuator as it is built, against closed forms: step, sine, stall, run-down, torque and speed,
 * efficiency, play, sag, heat, the balance of its energy; and against what is published of series
 * elastic actuators. Unless said otherwise to 2 %. */
#include <complex.h>
#include <math.h>
#include <string.h>

#include "sim_host/plant/sea_built.h"
#include "tests/support/assert_close.h"
#include "tests/support/round_actuator.h"

#define PI 3.14159265358979323846

static struct sea_config config;
static struct sea_motor motor;
static struct sea_built built;

static void setup(void)
{
    round_actuator(&config);
}

/* Steps of 10 us with a load that does not move. */
static void run_motor(double asked_A, bool powered, double load_N, double seconds)
{
    const int steps = (int)(seconds / 1e-5 + 0.5);
    for (int i = 0; i < steps; i++) {
        sea_motor_step(&motor, &config, asked_A, powered, load_N, 1e-5);
    }
}

/* Ticks of 1 ms, a target each, the spring's end held at 0. */
static void run_ticks(double (*target_m)(double), double from_s, double seconds)
{
    const int periods = (int)(1e-3 / config.drive_period_s + 0.5);
    for (int tick = 0; tick < (int)(seconds * 1e3 + 0.5); tick++) {
        sea_loop_target(&built.loop, target_m(from_s + tick * 1e-3));
        for (int i = 0; i < periods; i++) {
            sea_built_period(&built, SEA_LOOP_FOLLOW, true, 0.0);
            sea_built_finish(&built);
        }
    }
}

/* ---- motor ------------------------------------------------------------------ */

START_TEST(current_follows_its_command_as_a_first_order_lag)
{
    sea_motor_init(&motor, &config);
    motor.mass_kg = 1e9; /* stands */
    for (int i = 1; i <= 60; i++) {
        sea_motor_step(&motor, &config, 10.0, true, 0.0, 1e-5);
        const double expected = 10.0 * (1.0 - exp(-config.current_bandwidth_rad_s * i * 1e-5));
        assert_close(motor.current_A, expected, 1e-3, 0.001);
    }
}
END_TEST

START_TEST(a_stalled_motor_draws_voltage_over_resistance)
{
    sea_motor_init(&motor, &config);
    motor.mass_kg = 1e9;
    config.supply_ohm = 0.1;
    config.resistance_per_K = 0.0;
    run_motor(1000.0, true, 0.0, 0.05);
    ck_assert(motor.voltage_limited);
    /* 48 V over winding and supply, and back at the bus: 48 V less what the supply's 0.1 ohm takes. */
    assert_close(motor.current_A, 48.0 / 0.6, 0.0, 1e-6);
    assert_close(motor.bus_V, 48.0 - 0.1 * 80.0, 0.0, 1e-6);
    /* Its rise is that of the winding: R / L = 5000 1/s. */
    config.supply_ohm = 0.0;
    sea_motor_init(&motor, &config);
    motor.mass_kg = 1e9;
    run_motor(1000.0, true, 0.0, 2e-4);
    assert_close(motor.current_A, 96.0 * (1.0 - exp(-1.0)), 0.0, 0.002);
}
END_TEST

START_TEST(speed_falls_with_torque_along_the_line_of_the_voltage)
{
    /* v = (u - R F / kt N) / (kt N): without load 0.96 m/s, with 400 N and 8 A 0.88 m/s. */
    const double loads_N[] = {0.0, 200.0, 400.0};
    config.end_stop_m = 1e6;
    for (int i = 0; i < 3; i++) {
        sea_motor_init(&motor, &config);
        motor.end_max_m = 1e9;
        run_motor(1000.0, true, loads_N[i], 2.0);
        const double expected = (48.0 - 0.5 * loads_N[i] / 50.0) / 50.0;
        assert_close(motor.speed_m_s, expected, 0.0, 1e-4);
        assert_close(motor.current_A, loads_N[i] / 50.0, 1e-3, 1e-3);
    }
}
END_TEST

START_TEST(it_runs_down_by_its_friction)
{
    config.transmission_viscous_Ns_m = 20.0;
    sea_motor_init(&motor, &config);
    motor.end_max_m = 1e9;
    motor.speed_m_s = 0.5;
    run_motor(0.0, false, 0.0, 0.5);
    assert_close(motor.speed_m_s, 0.5 * exp(-20.0 / 10.0 * 0.5), 0.0, 1e-4);
    /* Dry friction of 0.01 N m at the shaft is 10 N: v^2 m / (2 F) = 0.125 m. */
    setup();
    config.motor_coulomb_Nm = 0.01;
    sea_motor_init(&motor, &config);
    motor.end_max_m = 1e9;
    motor.speed_m_s = 0.5;
    run_motor(0.0, false, 0.0, 1.0);
    assert_close(motor.position_m, 0.125, 0.0, 1e-3);
    assert_close(motor.speed_m_s, 0.0, 0.0, 0.0);
}
END_TEST

START_TEST(efficiencies_are_those_of_both_ways)
{
    /* 400 N: 400 / 0.8 / 50 = 10 A lift it, 400 * 0.6 / 50 = 4.8 A let it down; between it stands. */
    config.efficiency_forward = 0.8;
    config.efficiency_backward = 0.6;
    const struct {
        double current_A;
        int way;
    } CASES[] = {{10.1, 1}, {9.9, 0}, {5.0, 0}, {4.7, -1}};
    for (int i = 0; i < 4; i++) {
        sea_motor_init(&motor, &config);
        motor.position_m = 0.02;
        motor.current_A = CASES[i].current_A;
        const double from_m = motor.position_m;
        run_motor(CASES[i].current_A, true, 400.0, 0.02);
        const double way_m = motor.position_m - from_m;
        ck_assert_int_eq((way_m > 1e-9) - (way_m < -1e-9), CASES[i].way);
    }
    /* What arrives of the motor's work: 0.8 of it. */
    sea_motor_init(&motor, &config);
    motor.end_max_m = 1e9;
    run_motor(12.0, true, 400.0, 0.2);
    const double work_J =
        motor.load_J + motor.friction_J + 0.5 * motor.mass_kg * motor.speed_m_s * motor.speed_m_s;
    assert_close(motor.load_J / (motor.load_J + motor.friction_J), 0.8, 0.0, 0.001);
    assert_close(work_J, motor.supplied_J - motor.copper_J, 0.0, 0.002);
    /* A screw that holds by itself is not driven back. */
    config.efficiency_backward = -0.1;
    sea_motor_init(&motor, &config);
    motor.position_m = 0.02;
    run_motor(0.0, false, 400.0, 0.1);
    assert_close(motor.position_m, 0.02, 0.0, 0.0);
}
END_TEST

START_TEST(heat_goes_through_two_bodies)
{
    /* 10 W: 10 K over the winding's way, 40 K over the housing's; time constants 20 s and 800 s. */
    sea_motor_init(&motor, &config);
    for (int i = 0; i < 2000; i++) {
        sea_motor_warm(&motor, &config, 10.0, 0.01);
    }
    /* Nothing has left the housing yet. Its 200 J/K and the winding's 20 J/K draw together, so the
     * difference ends at 200 / 220 of 10 K, and as much sooner. */
    const double share = 200.0 / 220.0;
    assert_close(motor.winding_degC - motor.housing_degC, 10.0 * share * (1.0 - exp(-1.0 / share)),
                 0.0, 0.01);
    for (int i = 0; i < 800000; i++) {
        sea_motor_warm(&motor, &config, 10.0, 0.01);
    }
    assert_close(motor.housing_degC, 65.0, 0.01, 0.0);
    assert_close(motor.winding_degC, 75.0, 0.01, 0.0);
    /* And copper's resistance with it: 0.5 ohm * (1 + 0.00393 * 50). */
    motor.mass_kg = 1e9;
    run_motor(1000.0, true, 0.0, 0.05);
    assert_close(motor.current_A, 48.0 / (0.5 * (1.0 + 0.00393 * 50.0)), 0.0, 1e-4);
}
END_TEST

START_TEST(a_loaded_supply_sags_by_its_power)
{
    /* 200 W at a constant speed: u^2 - 48 u + 0.2 * P = 0. */
    config.supply_ohm = 0.2;
    sea_motor_init(&motor, &config);
    motor.end_max_m = 1e9;
    motor.speed_m_s = 0.5;
    const double load_N = 400.0;
    for (int i = 0; i < 2000; i++) {
        motor.speed_m_s = 0.5;
        sea_motor_step(&motor, &config, 8.0, true, load_N, 1e-5);
    }
    const double power_W = 400.0 * 0.5 + 8.0 * 8.0 * 0.5;
    assert_close(motor.bus_V, 24.0 + sqrt(24.0 * 24.0 - 0.2 * power_W), 0.0, 1e-4);
}
END_TEST

START_TEST(two_legs_on_one_battery_sag_by_what_both_draw)
{
    /* Both stand at 20 A: 200 W each, u^2 - 48 u + 0.2 * 400 = 0. With a battery each, 200 W. */
    const double together[] = {400.0, 200.0};
    config.supply_ohm = 0.2;
    config.resistance_per_K = 0.0;
    for (int i = 0; i < 2; i++) {
        struct sea_built leg[2];
        config.supply_shared = i == 0 ? 1.0 : 0.0;
        for (int k = 0; k < 2; k++) {
            sea_built_init(&leg[k], &config);
            leg[k].motor.mass_kg = 1e9;
        }
        for (int tick = 0; tick < 30; tick++) {
            sea_built_share(&leg[0], &leg[1], 1e-3);
            for (int step = 0; step < 200; step++) {
                sea_motor_step(&leg[step % 2].motor, &config, 20.0, true, 0.0, 1e-5);
            }
        }
        for (int k = 0; k < 2; k++) {
            assert_close(leg[k].motor.bus_V, 24.0 + sqrt(24.0 * 24.0 - 0.2 * together[i]), 0.0,
                         1e-6);
        }
    }
}
END_TEST

/* ---- drive ------------------------------------------------------------------ */

static double wave_rad_s, wave_m;

static double sine_m(double t)
{
    return 0.02 + wave_m * sin(wave_rad_s * t);
}

/* Amplitude of the motor's motion at wave_rad_s, over whole waves after the start's transient. */
static double answer_to_sine(void)
{
    const double periods = 4.0, wait_s = 0.6;
    const double span_s = periods * 2.0 * PI / wave_rad_s;
    sea_built_init(&built, &config);
    built.motor.position_m = 0.02;
    built.next = built.motor;
    sea_loop_start(&built.loop, 0.02, 0.0);
    run_ticks(sine_m, 0.0, wait_s);
    double in = 0.0, across = 0.0;
    const int ticks = (int)(span_s * 1e3 + 0.5);
    for (int i = 0; i < ticks; i++) {
        const double t = wait_s + i * 1e-3;
        run_ticks(sine_m, t, 1e-3);
        in += built.motor.position_m * sin(wave_rad_s * (t + 1e-3));
        across += built.motor.position_m * cos(wave_rad_s * (t + 1e-3));
    }
    return 2.0 * hypot(in, across) / ticks;
}

START_TEST(the_drive_answers_a_sine_as_its_gains_say)
{
    /* Position gain p around a speed loop of bandwidth w, whose speed is filtered (lag f) and whose
     * current lags (c): x/r = p L / (s + p L) with the closed speed loop L = w c / (s + w c f). The
     * spring is the load: L's motor is 1 / (s + k / (m s)). */
    const double waves_rad_s[] = {2.0 * PI * 2.0, 2.0 * PI * 5.0, 2.0 * PI * 10.0, 2.0 * PI * 20.0};
    config.feed_forward_speed = 0.0;
    config.feed_forward_acceleration = 0.0;
    wave_m = 0.001;
    for (int i = 0; i < 4; i++) {
        wave_rad_s = waves_rad_s[i];
        const double complex s = wave_rad_s * (double complex)I;
        const double h = config.drive_period_s;
        const double complex f = 0.3 / (1.0 - 0.7 * cexp(-s * h)) * (1.0 - cexp(-s * h)) / (s * h);
        const double complex c = 1.0 / (1.0 + s / config.current_bandwidth_rad_s);
        const double complex hold = cexp(-0.5 * s * h);
        const double w = 400.0, p = 80.0;
        /* m s v = m w c (p (r - x) - f v) - k x */
        const double complex drive = w * c * hold;
        const double complex x = drive * p / (s * s + drive * f * s + drive * p + 1000.0);
        const double complex spline = csin(0.5e-3 * wave_rad_s) / (0.5e-3 * wave_rad_s);
        assert_close(answer_to_sine(), wave_m * cabs(x * spline * spline), 0.0, 0.02);
    }
}
END_TEST

START_TEST(feed_forward_removes_the_lag)
{
    wave_m = 0.005;
    wave_rad_s = 2.0 * PI * 3.0;
    config.spring_N_per_m = 10.0; /* no load to speak of */
    assert_close(answer_to_sine(), wave_m, 0.0, 0.02);
    config.feed_forward_speed = 0.0;
    ck_assert(answer_to_sine() < 0.98 * wave_m);
}
END_TEST

static double parabola_m(double t)
{
    return 0.5 * 10.0 * t * t;
}

START_TEST(an_even_acceleration_takes_an_even_force)
{
    /* 10 m/s^2 for 60 ms, 100 N, and the spring's k x on top. What comes back every tick is the
     * difference to the mean of half a tick before and after. */
    double force_N[300];
    sea_built_init(&built, &config);
    sea_loop_start(&built.loop, 0.0, 0.0);
    run_ticks(parabola_m, 0.0, 0.03);
    for (int tick = 0; tick < 30; tick++) {
        sea_loop_target(&built.loop, parabola_m((tick + 30) * 1e-3));
        for (int i = 0; i < 10; i++) {
            sea_built_period(&built, SEA_LOOP_FOLLOW, true, 0.0);
            sea_built_finish(&built);
            force_N[10 * tick + i] = built.motor.force_N;
        }
    }
    double squares = 0.0;
    for (int i = 5; i < 295; i++) {
        const double off_N = force_N[i] - 0.5 * (force_N[i - 5] + force_N[i + 5]);
        squares += off_N * off_N;
    }
    ck_assert_msg(sqrt(squares / 290.0) < 0.02 * 100.0, "%g N", sqrt(squares / 290.0));
    assert_close(force_N[299] - 10000.0 * built.motor.position_m, 100.0, 10.0, 0.0);
}
END_TEST

static double far_m(double t)
{
    (void)t;
    return 0.04;
}

START_TEST(a_jump_keeps_the_limits_and_arrives)
{
    config.speed_integral_rad_s = 20.0;
    sea_built_init(&built, &config);
    sea_loop_start(&built.loop, 0.0, 0.0);
    run_ticks(far_m, 0.0, 0.5);
    ck_assert(built.load.peak_current_A <= 20.0 + 1e-9);
    ck_assert(built.load.peak_speed_m_s < 1.05 * 0.9);
    ck_assert(built.load.current_limited_s > 0.0);
    assert_close(built.motor.position_m, 0.04, 2e-5, 0.0);
    assert_close(built.motor.current_A, 8.0, 0.05, 0.0); /* 400 N at 50 N/A */
}
END_TEST

START_TEST(the_peak_current_is_lent_and_not_given)
{
    /* I^2 t: one second at the peak; then the continuous current, until half is paid back. */
    struct sea_loop loop;
    config.speed_bandwidth_rad_s = 4000.0;
    sea_loop_init(&loop, &config);
    sea_loop_start(&loop, 0.0, 0.0);
    int at_peak = 0;
    for (int i = 0; i < 20000; i++) {
        if (i % 10 == 0) {
            sea_loop_target(&loop, 0.05);
        }
        const double asked_A = sea_loop_period(&loop, &config, SEA_LOOP_FOLLOW, 0.0);
        at_peak += asked_A == 20.0;
        ck_assert(asked_A <= 20.0);
    }
    assert_close(at_peak * 1e-4, SEA_LOOP_PEAK_S, 0.01, 0.0);
    ck_assert(loop.folded_back);
}
END_TEST

START_TEST(the_drive_unloads_by_itself_at_its_rate)
{
    config.speed_integral_rad_s = 20.0;
    sea_built_init(&built, &config);
    sea_loop_start(&built.loop, 0.0, 0.0);
    run_ticks(far_m, 0.0, 0.5);
    for (int i = 0; i < 400; i++) {
        sea_built_period(&built, SEA_LOOP_UNLOAD, true, 0.0);
        sea_built_finish(&built);
    }
    const double middle_m = built.motor.position_m;
    for (int i = 0; i < 400; i++) {
        sea_built_period(&built, SEA_LOOP_UNLOAD, true, 0.0);
        sea_built_finish(&built);
    }
    assert_close(middle_m - built.motor.position_m, 0.04 * 0.3, 0.0, 0.05);
}
END_TEST

/* ---- all together ------------------------------------------------------------ */

START_TEST(the_supply_s_energy_is_all_accounted_for)
{
    /* Losses of every kind: what the supply gave went into copper, friction, spring and motion. */
    config.efficiency_forward = 0.85;
    config.efficiency_backward = 0.75;
    config.motor_coulomb_Nm = 0.004;
    config.motor_viscous_Nms_rad = 2e-6;
    config.transmission_viscous_Ns_m = 10.0;
    config.supply_ohm = 0.1;
    sea_built_init(&built, &config);
    sea_loop_start(&built.loop, 0.0, 0.0);
    wave_m = 0.012;
    wave_rad_s = 2.0 * PI * 3.0;
    run_ticks(sine_m, 0.0, 1.23);
    const struct sea_motor *m = &built.motor;
    const double sum_J =
        m->copper_J + m->friction_J + m->load_J + m->end_stop_J + sea_motor_energy_J(m, &config);
    ck_assert(m->copper_J > 1.0 && m->friction_J > 1.0 && m->supplied_J > 5.0);
    assert_close(sum_J, m->supplied_J, 0.0, 0.001);
    assert_close(m->load_J, sea_built_energy_J(&built, true, m->position_m), 1e-3, 0.002);
}
END_TEST

START_TEST(play_is_free_way)
{
    config.backlash_m = 0.001;
    sea_built_init(&built, &config);
    assert_close(sea_built_compression_m(&built, 0.011, 0.0), 0.010, 1e-15, 0.0);
    assert_close(sea_built_compression_m(&built, 0.0007, 0.0), 0.0, 0.0, 0.0);
    assert_close(sea_built_compression_m(&built, 0.0, 0.002), -0.002, 1e-15, 0.0);
}
END_TEST

START_TEST(the_cuff_takes_its_share_at_the_release)
{
    /* k_s = 10000 * 40000 / 50000 = 8000 N/m: a fifth of 8 J is lost where the cuff takes its load. */
    config.cuff_N_per_m = 40000.0;
    sea_built_init(&built, &config);
    built.motor.position_m = 0.04;
    sea_built_release(&built, 0.0);
    assert_close(built.snap_J, 0.2 * 8.0, 0.0, 1e-9);
    assert_close(sea_built_force_N(&built, false, 0.04), 320.0, 1e-9, 0.0);
}
END_TEST

START_TEST(the_same_bits_everywhere)
{
    /* A walk of all parts; its bits are told once and hold for every compiler and machine. */
    config.efficiency_forward = 0.85;
    config.efficiency_backward = 0.75;
    config.spring_hysteresis = 0.05;
    config.cuff_N_per_m = 40000.0;
    config.supply_ohm = 0.1;
    config.motor_coulomb_Nm = 0.004;
    sea_built_init(&built, &config);
    sea_loop_start(&built.loop, 0.0, 0.0);
    uint64_t digest = 14695981039346656037u;
    for (int tick = 0; tick < 300; tick++) {
        sea_loop_target(&built.loop, 1e-6 * ((tick * 7919) % 40009));
        for (int i = 0; i < 10; i++) {
            uint64_t bits;
            sea_built_period(&built, SEA_LOOP_FOLLOW, tick % 100 < 60, 1e-5 * (tick % 50));
            sea_built_finish(&built);
            memcpy(&bits, &built.motor.position_m, sizeof bits);
            digest = (digest ^ bits) * 1099511628211u;
        }
    }
    ck_assert_msg(digest == 0x341d7e1316ece957u, "%016llx", (unsigned long long)digest);
}
END_TEST

/* ---- published ---------------------------------------------------------------- */

START_TEST(pratt_and_williamson_s_output_impedance)
{
    /* Pratt, Williamson: Series elastic actuators, IROS 1995. A motor of mass m without force behind a
     * spring k shows a shaken load F / X = m w^2 / (1 - m w^2 / k): the motor's mass far below
     * sqrt(k / m), the spring far above. Here sqrt(k / m) = 31.6 rad/s. */
    const double parts[] = {0.2, 0.5, 2.0, 5.0};
    config.two_way = 1.0;
    for (int i = 0; i < 4; i++) {
        const double w = parts[i] * sqrt(1000.0), shake_m = 0.001;
        /* Starts on the solution: motor at X / (1 - m w^2 / k), in phase, at its crest. */
        const double ratio = 1.0 / (1.0 - parts[i] * parts[i]);
        sea_built_init(&built, &config);
        built.motor.position_m = shake_m * ratio;
        double most_N = 0.0;
        for (int k = 0; k < (int)(4.0 * PI / w / 1e-4); k++) {
            const double end_m = shake_m * cos(w * (k + 0.5) * 1e-4);
            sea_built_period(&built, SEA_LOOP_OFF, false, end_m);
            most_N = fmax(most_N, fabs(sea_built_force_N(&built, false, built.pushing.at_m)));
            sea_built_finish(&built);
        }
        assert_close(most_N, shake_m * fabs(10.0 * w * w * ratio), 0.0, 0.02);
    }
}
END_TEST

START_TEST(robinson_s_limit_of_large_forces)
{
    /* Robinson, Pratt, Paluska, Pratt: Series elastic actuator development for a biomimetic walking
     * robot, AIM 1999. A motor that gives F_sat standing and nothing at V_sat reaches, against a held
     * load, F / F_sat = |k / (m s^2 + (F_sat / V_sat) s + k)|. The voltage's limit follows a sine
     * here, so that the motor is on that line all the time. */
    const double parts[] = {0.3, 1.0, 2.0};
    config.resistance_per_K = 0.0;
    config.inductance_H = 1e-6; /* the published form has none */
    config.two_way = 1.0;
    config.resistance_ohm = 5.0;
    config.end_stop_m = 0.1;
    const double sat_N = 50.0 * 48.0 / 5.0, sat_m_s = 48.0 / 50.0;
    for (int i = 0; i < 3; i++) {
        const double w = parts[i] * sqrt(1000.0);
        const double complex s = w * (double complex)I;
        const double expected_N =
            sat_N * cabs(10000.0 / (10.0 * s * s + sat_N / sat_m_s * s + 10000.0));
        sea_built_init(&built, &config);
        sea_motor_init(&motor, &config);
        motor.end_min_m = -1.0;
        double most_N = 0.0;
        const int steps = (int)(16.0 * PI / w / 1e-5);
        for (int k = 0; k < steps; k++) {
            const double volt = 48.0 * sin(w * (k + 0.5) * 1e-5);
            motor.bus_V = fabs(volt);
            const double load_N =
                sea_built_force_N(&built, true, motor.position_m + 0.5e-5 * motor.speed_m_s);
            sea_motor_step(&motor, &config, volt > 0.0 ? 1e5 : -1e5, true, load_N, 1e-5);
            most_N = k > steps / 2 ? fmax(most_N, fabs(load_N)) : 0.0;
        }
        assert_close(most_N, expected_N, 0.0, 0.02);
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("sea_built");
    TCase *parts = tcase_create("motor"), *drive = tcase_create("drive");
    TCase *whole = tcase_create("whole"), *published = tcase_create("published");
    tcase_add_checked_fixture(parts, setup, NULL);
    tcase_add_checked_fixture(drive, setup, NULL);
    tcase_add_checked_fixture(whole, setup, NULL);
    tcase_add_checked_fixture(published, setup, NULL);
    tcase_add_test(parts, current_follows_its_command_as_a_first_order_lag);
    tcase_add_test(parts, a_stalled_motor_draws_voltage_over_resistance);
    tcase_add_test(parts, speed_falls_with_torque_along_the_line_of_the_voltage);
    tcase_add_test(parts, it_runs_down_by_its_friction);
    tcase_add_test(parts, efficiencies_are_those_of_both_ways);
    tcase_add_test(parts, heat_goes_through_two_bodies);
    tcase_add_test(parts, a_loaded_supply_sags_by_its_power);
    tcase_add_test(parts, two_legs_on_one_battery_sag_by_what_both_draw);
    tcase_add_test(drive, the_drive_answers_a_sine_as_its_gains_say);
    tcase_add_test(drive, feed_forward_removes_the_lag);
    tcase_add_test(drive, an_even_acceleration_takes_an_even_force);
    tcase_add_test(drive, a_jump_keeps_the_limits_and_arrives);
    tcase_add_test(drive, the_peak_current_is_lent_and_not_given);
    tcase_add_test(drive, the_drive_unloads_by_itself_at_its_rate);
    tcase_add_test(whole, the_supply_s_energy_is_all_accounted_for);
    tcase_add_test(whole, play_is_free_way);
    tcase_add_test(whole, the_cuff_takes_its_share_at_the_release);
    tcase_add_test(whole, the_same_bits_everywhere);
    tcase_add_test(published, pratt_and_williamson_s_output_impedance);
    tcase_add_test(published, robinson_s_limit_of_large_forces);
    suite_add_tcase(suite, parts);
    suite_add_tcase(suite, drive);
    suite_add_tcase(suite, whole);
    suite_add_tcase(suite, published);
    return run_suite(suite);
}
