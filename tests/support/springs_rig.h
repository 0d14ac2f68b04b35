/* What the tests of the springs share: a person of 0.9 m, whose left leg is loaded, pushes and swings. */
#ifndef TESTS_SUPPORT_SPRINGS_RIG_H
#define TESTS_SUPPORT_SPRINGS_RIG_H

#include "controller/actuation/springs.h"
#include "controller/estimator/body_table.h"
#include "tests/support/assert_close.h"

static struct control_params params;
static struct springs springs;
static struct controller_input input;
static struct gait_state gait;
static struct step_decision decision;
static struct sea_request request[SIDE_COUNT];
static enum push_outcome outcome;

static inline void setup(void)
{
    params = (struct control_params){.sea_speed_max_m_s = 0.6f,
                                     .sea_acceleration_m_s2 = 8.0f,
                                     .sea_tolerance_m = 0.001f,
                                     .sensor_age_max_s = 0.01f,
                                     .leg_length_m = 0.9f,
                                     .start_r0_m = 0.04f,
                                     .r0_max_m = 0.042f,
                                     .body = (float)BODY_PERSON};
    input = (struct controller_input){.tick = 1000};
    gait = (struct gait_state){.phase = PHASE_SINGLE_SUPPORT, .strike_near = true};
    decision = (struct step_decision){.load_m = 0.04f, .side = SIDE_LEFT, .assists = true};
    springs = (struct springs){0};
    for (int side = 0; side < SIDE_COUNT; side++) {
        input.sea[side] = (struct sea_measurement){.state = DRIVE_ENABLED, .latch = LATCH_CLOSED};
    }
    springs_begin(&springs, &params, &input);
}

static inline void tick(void)
{
    input.tick++;
    const enum push_outcome now = springs_follow(&springs, &decision, &input, &gait, false);
    outcome = now != PUSH_NONE ? now : outcome;
    springs_command(&springs, &params, &input, SUPERVISOR_WALKING, &gait, request);
    for (int kind = 0; kind < GAIT_EVENT_KINDS; kind++) {
        gait.event[kind].happened = false;
    }
    decision.new_step = decision.improved = false;
    input.sea[SIDE_LEFT].precompression_m = request[SIDE_LEFT].precompression_m; /* follows */
}

static inline void ticks(int count)
{
    for (int i = 0; i < count; i++) {
        tick();
    }
}

static inline void event(enum gait_event_kind kind, enum side side)
{
    gait.event[kind] = (struct gait_event){.happened = true, .side = side, .tick = input.tick + 1};
    tick();
}

/* The left leg's stance up to where its latch is armed. */
static inline void load_left(void)
{
    outcome = PUSH_NONE;
    event(GAIT_HEEL_STRIKE, SIDE_LEFT);
    ticks(100);
    decision.new_step = true;
    ticks(300);
}

static inline void swing_left(void)
{
    event(GAIT_LIFT_OFF, SIDE_LEFT);
    input.leg[SIDE_LEFT].ankle_extension_m = 0.0f;
    ticks(200);
    input.sea[SIDE_LEFT].latch = LATCH_CLOSED;
    ticks(5);
}

/* And its push: toe-off so long after the latch has opened. */
static inline void push_left(int toe_off_ticks)
{
    load_left();
    ck_assert(request[SIDE_LEFT].latch_armed);
    event(GAIT_HEEL_STRIKE, SIDE_RIGHT);
    input.sea[SIDE_LEFT].latch = LATCH_OPEN;
    for (int i = 0; i < toe_off_ticks; i++) {
        input.leg[SIDE_LEFT].ankle_extension_m = 0.0001f * (float)i;
        tick();
    }
    swing_left();
}

/* Pushes that lasted long: the spring may be loaded to the full. */
static inline void know_long_pushes(void)
{
    push_left(250);
    push_left(250);
}

#endif
