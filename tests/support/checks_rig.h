/* What the tests of the checks share: a leg with its sensors and drives, ticks, and the first fault. */
#ifndef TESTS_SUPPORT_CHECKS_RIG_H
#define TESTS_SUPPORT_CHECKS_RIG_H

#include <string.h>

#include "controller/screening/checks.h"
#include "tests/support/assert_close.h"

/* A leg of 1 m, a spring of 100 N/m, everything well: legs swing, motors at zero. */
struct rig {
    struct control_params params;
    struct samples samples;
    struct checks checks;
    struct controller_input input;
    struct sea_request command[SIDE_COUNT];
    enum supervisor_state state;
};

static inline void start(struct rig *rig, enum supervisor_state state)
{
    memset(rig, 0, sizeof *rig);
    rig->params.leg_length_m = REAL(1.0);
    rig->params.gravity_m_s2 = REAL(9.81);
    rig->params.spring_stiffness_n_m = REAL(100.0);
    rig->params.r0_max_m = REAL(0.3);
    rig->params.sea_speed_max_m_s = REAL(1.5);
    rig->params.sea_tolerance_m = REAL(0.001);
    rig->params.sensor_age_max_s = REAL(0.01);
    rig->params.fall_angle_rad = REAL(1.2);
    rig->params.body = (real)BODY_COMPASS;
    rig->state = state;
    rig->input.desired_speed_rad_s = REAL(0.5);
    rig->input.nodes_operational = true;
    for (int side = 0; side < SIDE_COUNT; side++) {
        rig->input.sea[side] = (struct sea_measurement){
            .state = supervisor_may_enable(state) ? DRIVE_ENABLED : DRIVE_DISABLED,
            .latch = LATCH_CLOSED,
            .force_age_ticks = 1};
        rig->command[side].enable = supervisor_may_enable(state);
    }
    samples_init(&rig->samples);
    checks_init(&rig->checks);
}

static inline enum supervisor_fault tick(struct rig *rig)
{
    struct controller_input screened = rig->input;
    const struct checks_view view = {&screened, &rig->samples, rig->state, rig->command};
    samples_screen(&rig->samples, &rig->params, &screened);
    checks_update(&rig->checks, &rig->params, &view);
    return checks_find(&rig->checks, &rig->params, &view);
}

/* Legs that swing against each other, 1 rad/s. */
static inline void swing(struct rig *rig)
{
    rig->input.leg[SIDE_LEFT].leg_angle_rad += REAL(0.001);
    rig->input.leg[SIDE_RIGHT].leg_angle_rad -= REAL(0.001);
}

/* Ticks until the first fault, which is *fault; limit if there is none. */
static inline int ticks_until(struct rig *rig, int limit, bool swinging,
                              enum supervisor_fault *fault)
{
    for (int i = 1; i <= limit; i++) {
        if (swinging) {
            swing(rig);
        }
        *fault = tick(rig);
        if (*fault != SUPERVISOR_FAULT_NONE) {
            return i;
        }
    }
    return limit;
}

static inline void warm_up(struct rig *rig, enum supervisor_state state)
{
    enum supervisor_fault fault;
    start(rig, state);
    ck_assert_int_eq(ticks_until(rig, 50, true, &fault), 50);
}

static inline void expect(struct rig *rig, enum supervisor_fault wanted, int from, int to,
                          bool swinging)
{
    enum supervisor_fault fault;
    const int ticks = ticks_until(rig, 4 * to, swinging, &fault);
    ck_assert_msg(fault == wanted, "%s, not %s", supervisor_fault_name(fault),
                  supervisor_fault_name(wanted));
    ck_assert_msg(ticks >= from && ticks <= to, "%s after %d ticks, not %d to %d",
                  supervisor_fault_name(fault), ticks, from, to);
}

static inline void load(struct rig *rig, real motor_m, real force_N)
{
    for (int side = 0; side < SIDE_COUNT; side++) {
        rig->input.sea[side].precompression_m = motor_m;
        rig->input.sea[side].force_N = force_N;
        rig->command[side].precompression_m = motor_m;
    }
}

/* Force samples come every 100 ticks. */
static inline enum supervisor_fault two_force_samples(struct rig *rig)
{
    enum supervisor_fault fault = SUPERVISOR_FAULT_NONE;
    for (int i = 1; i <= 240 && fault == SUPERVISOR_FAULT_NONE; i++) {
        for (int side = 0; side < SIDE_COUNT; side++) {
            rig->input.sea[side].force_age_ticks = (uint16_t)(i % 100);
        }
        swing(rig);
        fault = tick(rig);
    }
    return fault;
}

#endif
