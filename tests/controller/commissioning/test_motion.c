/* Commissioning's motions: what a tool may ask for, and that every one of them ends at zero. The motor
 * here is where its reference was three ticks ago, and its force is the spring's. */
#include "controller/commissioning/motion.h"

#include <math.h>
#include <string.h>

#include "controller/controller.h"
#include "tests/support/assert_close.h"

enum { DELAY = 3, LIMIT_TICKS = 60000, FORCE_EVERY = 100, DRIVE_UNLOADS_TICKS = 120 };

static struct motion motion;
static struct control_params params;
static struct controller_input input;
static float trace_m[DELAY];
static unsigned tick;
static float force_gain, travel_gain, sticks_at_m, largest_m, steepest_m;
static bool renews, unloads_by_itself;
static unsigned cut_ticks;

static void setup(void)
{
    memset(&input, 0, sizeof input);
    memset(trace_m, 0, sizeof trace_m);
    params = (struct control_params){.spring_stiffness_n_m = 1000.0f,
                                     .r0_max_m = 0.1f,
                                     .leg_length_m = 1.0f,
                                     .sea_speed_max_m_s = 1.5f,
                                     .sea_acceleration_m_s2 = 10.0f,
                                     .sea_tolerance_m = 0.0005f};
    for (int side = 0; side < SIDE_COUNT; side++) {
        input.sea[side].state = DRIVE_ENABLED;
        input.sea[side].latch = LATCH_CLOSED;
    }
    motion_init(&motion);
    motion_enter(&motion, &params, &input);
    force_gain = travel_gain = 1.0f;
    largest_m = steepest_m = sticks_at_m = 0.0f;
    renews = unloads_by_itself = true;
    tick = cut_ticks = 0;
}

/* One tick; gives back whether a motion is asked for by a tool that is there. */
static bool run_tick(void)
{
    const enum side side = motion.side;
    const float before_m = motion.reference_m[side];
    struct sea_measurement *sea = &input.sea[side];
    tick++;
    input.tick = tick;
    input.motion.renewal = (uint8_t)(input.motion.renewal + (renews && tick % 100 == 0 ? 1 : 0));
    sea->precompression_m = fmaxf(sticks_at_m, travel_gain * trace_m[tick % DELAY]);
    if (travel_gain < 0.0f) {
        sea->precompression_m = travel_gain * trace_m[tick % DELAY];
    }
    if (motion.cut) {
        cut_ticks++;
        sea->precompression_m =
            unloads_by_itself && cut_ticks > DRIVE_UNLOADS_TICKS ? 0.0f : motion.size_m;
    }
    sea->force_N = force_gain * params.spring_stiffness_n_m * sea->precompression_m;
    sea->force_age_ticks = (uint16_t)(tick % FORCE_EVERY);
    const bool asked = motion_watch(&motion, &input);
    motion_update(&motion, &params, &input);
    trace_m[tick % DELAY] = motion.reference_m[motion.side];
    largest_m = fmaxf(largest_m, motion.reference_m[motion.side]);
    if (motion.side == side) {
        steepest_m = fmaxf(steepest_m, fabsf(motion.reference_m[side] - before_m));
    }
    return asked;
}

static void order(enum motion_kind kind, enum side side, float share, float seconds)
{
    input.motion.kind = kind;
    input.motion.side = side;
    input.motion.share = share;
    input.motion.seconds = seconds;
    input.motion.frequency_Hz = 20.0f;
    input.motion.order++;
    largest_m = steepest_m = 0.0f;
}

/* The outcome of the motion that was ordered. */
static enum motion_outcome finish(void)
{
    unsigned ticks = 0;
    do {
        (void)run_tick();
        ck_assert_uint_lt(++ticks, LIMIT_TICKS);
    } while (motion.phase != MOTION_IDLE);
    ck_assert_uint_eq(motion.order, input.motion.order);
    ck_assert(motion.reference_m[motion.side] == 0.0f || motion.outcome == MOTION_NOT_REACHED);
    ck_assert(!motion.armed && !motion.cut);
    return motion.outcome;
}

static enum motion_outcome perform(enum motion_kind kind, enum side side, float share,
                                   float seconds)
{
    order(kind, side, share, seconds);
    return finish();
}

/* Both legs have moved a little, and then more. */
static void prove_both(float share)
{
    ck_assert_int_eq(perform(MOTION_KIND_MOVE, SIDE_LEFT, share, 0.5f), MOTION_DONE);
    ck_assert_int_eq(perform(MOTION_KIND_MOVE, SIDE_RIGHT, share, 0.5f), MOTION_DONE);
}

START_TEST(a_move_goes_there_and_back_without_a_step)
{
    ck_assert_int_eq(perform(MOTION_KIND_MOVE, SIDE_LEFT, 0.04f, 0.5f), MOTION_DONE);
    ck_assert(fabsf(largest_m - 0.004f) < 1e-7f);
    /* half a cosine: its steepest tick is pi/2 times the mean */
    ck_assert(steepest_m < 1.01f * 1.5708f * 0.004f / 500.0f);
    ck_assert(motion.reference_m[SIDE_RIGHT] == 0.0f);
}
END_TEST

/* Ticks that the way back took, of a motion that is ordered here. */
static unsigned return_ticks(enum motion_kind kind, float share, float seconds,
                             enum motion_outcome outcome)
{
    unsigned ticks = 0;
    order(kind, SIDE_LEFT, share, seconds);
    do {
        (void)run_tick();
        ticks += motion.phase == MOTION_RETURNS;
        ck_assert_uint_lt(tick, LIMIT_TICKS);
    } while (motion.phase != MOTION_IDLE || motion.order != input.motion.order);
    ck_assert_int_eq(motion.outcome, outcome);
    return ticks;
}

#define ASSERT_TAKES(ticks, milliseconds)                                \
    do {                                                                 \
        const unsigned taken = (ticks);                                  \
        ck_assert_uint_ge(taken + 1u, TICKS_OF_MS(milliseconds));        \
        ck_assert_uint_le(taken, TICKS_OF_MS(milliseconds) + DELAY + 1); \
    } while (0)

/* commissioning/motion.h: a move takes its seconds there and back; whatever else, and what was turned back, is
 * at zero after half a second. */
START_TEST(a_move_comes_back_as_slowly_as_it_went_and_all_else_in_half_a_second)
{
    ASSERT_TAKES(return_ticks(MOTION_KIND_MOVE, 0.04f, 2.0f, MOTION_DONE), 2000);
    ASSERT_TAKES(return_ticks(MOTION_KIND_RELEASE, 0.05f, 2.0f, MOTION_DONE), 500);
    force_gain = 4.0f;
    ASSERT_TAKES(return_ticks(MOTION_KIND_MOVE, 0.05f, 2.0f, MOTION_BEYOND), 500);
}
END_TEST

START_TEST(loads_grow_in_stages_that_both_legs_have_to_pass)
{
    ck_assert(motion_share_allowed(&motion) == 0.05f);
    ck_assert_int_eq(perform(MOTION_KIND_MOVE, SIDE_LEFT, 0.051f, 0.5f), MOTION_REFUSED);
    ck_assert(largest_m == 0.0f);
    ck_assert_int_eq(perform(MOTION_KIND_MOVE, SIDE_LEFT, 0.05f, 0.5f), MOTION_DONE);
    ck_assert(motion_share_allowed(&motion) == 0.05f); /* the right leg has not */
    ck_assert_int_eq(perform(MOTION_KIND_MOVE, SIDE_RIGHT, 0.02f, 0.5f), MOTION_DONE);
    ck_assert(motion_share_allowed(&motion) == 0.2f);
    ck_assert_int_eq(perform(MOTION_KIND_CUT, SIDE_LEFT, 0.21f, 0.4f), MOTION_REFUSED);
    prove_both(0.05f); /* again as small: no more than before */
    ck_assert(motion_share_allowed(&motion) == 0.2f);
    prove_both(0.15f);
    ck_assert(motion_share_allowed(&motion) == 1.0f);
    ck_assert_int_eq(perform(MOTION_KIND_MOVE, SIDE_LEFT, 1.0f, 2.0f), MOTION_DONE);
    ck_assert_int_eq(perform(MOTION_KIND_MOVE, SIDE_LEFT, 1.01f, 2.0f), MOTION_REFUSED);
}
END_TEST

/* One drive alone is a device, too: there is nothing to show of a leg without one, and nothing to move. */
START_TEST(a_leg_without_a_drive_is_not_waited_for)
{
    input.sea[SIDE_RIGHT].absent = true;
    (void)run_tick();
    ck_assert(motion_share_allowed(&motion) == 0.05f);
    ck_assert_int_eq(perform(MOTION_KIND_MOVE, SIDE_LEFT, 0.05f, 0.5f), MOTION_DONE);
    ck_assert(motion_share_allowed(&motion) == 0.2f);
    ck_assert_int_eq(perform(MOTION_KIND_MOVE, SIDE_LEFT, 0.15f, 0.5f), MOTION_DONE);
    ck_assert(motion_share_allowed(&motion) == 1.0f);
    ck_assert_int_eq(perform(MOTION_KIND_MOVE, SIDE_RIGHT, 0.05f, 0.5f), MOTION_REFUSED);
    motion_forget(&motion, true);
    input.motion.kind = MOTION_KIND_NONE;
    (void)run_tick();
    ck_assert(motion_share_allowed(&motion) == 0.05f);
}
END_TEST

START_TEST(a_fault_begins_with_small_loads_again_but_not_that_of_a_cut)
{
    prove_both(0.05f);
    prove_both(0.15f);
    ck_assert_int_eq(perform(MOTION_KIND_CUT, SIDE_LEFT, 0.1f, 0.4f), MOTION_DONE);
    motion_forget(&motion, true);
    ck_assert(motion_share_allowed(&motion) == 1.0f);
    motion_forget(&motion, false); /* as the tool asked for it */
    ck_assert(motion_share_allowed(&motion) == 1.0f);
    input.motion.kind = MOTION_KIND_NONE;
    (void)run_tick();
    order(MOTION_KIND_MOVE, SIDE_LEFT, 0.1f, 1.0f);
    for (int i = 0; i < 500; i++) {
        (void)run_tick();
    }
    motion_forget(&motion, true);
    ck_assert_int_eq(motion.outcome, MOTION_INTERRUPTED);
    ck_assert(motion_share_allowed(&motion) == 0.05f);
}
END_TEST

START_TEST(a_tool_that_is_lost_asks_for_nothing)
{
    unsigned silent = 0;
    ck_assert(!run_tick()); /* nothing was asked for yet */
    order(MOTION_KIND_MOVE, SIDE_LEFT, 0.04f, 10.0f);
    ck_assert(!run_tick()); /* an order alone is no sign of life */
    while (tick % 100 != 0) {
        (void)run_tick();
    }
    for (int i = 0; i < 2000; i++) {
        ck_assert(run_tick());
    }
    while (tick % 100 != 0) {
        (void)run_tick();
    }
    renews = false;
    while (run_tick()) {
        silent++;
    }
    ck_assert_uint_eq(silent + 1, TICKS_OF_MS(500));
}
END_TEST

START_TEST(after_a_fault_it_takes_a_new_request)
{
    order(MOTION_KIND_MOVE, SIDE_LEFT, 0.04f, 1.0f);
    for (int i = 0; i < 300; i++) {
        (void)run_tick();
    }
    motion_forget(&motion, true);
    for (int i = 0; i < 300; i++) {
        ck_assert(!run_tick());
    }
    input.motion.kind = MOTION_KIND_NONE;
    ck_assert(!run_tick());
    input.motion.kind = MOTION_KIND_MOVE;
    ck_assert(run_tick());
}
END_TEST

START_TEST(more_force_than_the_stage_allows_turns_it_back)
{
    force_gain = 4.0f; /* a torque constant four times as large as declared */
    ck_assert_int_eq(perform(MOTION_KIND_MOVE, SIDE_LEFT, 0.05f, 2.0f), MOTION_BEYOND);
    ck_assert(motion_share_allowed(&motion) == 0.05f);
    /* 5 % of 100 N and 10 % for friction: 15 N are reached at 3.75 mm; two force samples later at most */
    ck_assert(largest_m < 0.005f);
}
END_TEST

START_TEST(a_motor_that_runs_away_or_does_not_come_turns_it_back)
{
    travel_gain = 2.0f;
    ck_assert_int_eq(perform(MOTION_KIND_MOVE, SIDE_LEFT, 0.05f, 1.0f), MOTION_BEYOND);
    travel_gain = -2.0f;
    ck_assert_int_eq(perform(MOTION_KIND_MOVE, SIDE_LEFT, 0.05f, 1.0f), MOTION_BEYOND);
    travel_gain = 0.0f;
    ck_assert_int_eq(perform(MOTION_KIND_MOVE, SIDE_LEFT, 0.05f, 1.0f), MOTION_NOT_REACHED);
    travel_gain = 1.0f; /* and one that does not come back */
    order(MOTION_KIND_MOVE, SIDE_LEFT, 0.04f, 0.5f);
    while (motion.phase != MOTION_RETURNS) {
        (void)run_tick();
        ck_assert_uint_lt(tick, LIMIT_TICKS);
    }
    sticks_at_m = 0.003f;
    ck_assert_int_eq(finish(), MOTION_NOT_REACHED);
    ck_assert(motion_share_allowed(&motion) == 0.05f);
}
END_TEST

START_TEST(what_is_no_motion_is_refused)
{
    ck_assert_int_eq(perform((enum motion_kind)9, SIDE_LEFT, 0.01f, 1.0f), MOTION_REFUSED);
    ck_assert_int_eq(perform(MOTION_KIND_MOVE, (enum side)2, 0.01f, 1.0f), MOTION_REFUSED);
    ck_assert_int_eq(perform(MOTION_KIND_MOVE, SIDE_LEFT, 0.0f, 1.0f), MOTION_REFUSED);
    ck_assert_int_eq(perform(MOTION_KIND_MOVE, SIDE_LEFT, NAN, 1.0f), MOTION_REFUSED);
    ck_assert_int_eq(perform(MOTION_KIND_MOVE, SIDE_LEFT, 0.01f, NAN), MOTION_REFUSED);
    ck_assert_int_eq(perform(MOTION_KIND_MOVE, SIDE_LEFT, 0.01f, 21.0f), MOTION_REFUSED);
    order(MOTION_KIND_CHIRP, SIDE_LEFT, 0.01f, 1.0f);
    input.motion.frequency_Hz = NAN;
    ck_assert_int_eq(finish(), MOTION_REFUSED);
    ck_assert(largest_m == 0.0f);
}
END_TEST

START_TEST(the_end_can_be_asked_for)
{
    order(MOTION_KIND_MOVE, SIDE_LEFT, 0.05f, 1.0f);
    for (int i = 0; i < 900; i++) {
        (void)run_tick();
    }
    input.motion.kind = MOTION_KIND_UNLOAD;
    ck_assert_int_eq(finish(), MOTION_INTERRUPTED);
    input.motion.order++; /* where nothing is under way it is no motion */
    (void)run_tick();
    ck_assert_int_eq(motion.phase, MOTION_IDLE);
    ck_assert_uint_ne(motion.order, input.motion.order);
}
END_TEST

/* Enabled a little beside zero, it creeps there first. */
START_TEST(a_motor_beside_zero_is_not_made_to_jump)
{
    input.sea[SIDE_RIGHT].precompression_m = 0.0004f;
    motion_enter(&motion, &params, &input);
    ck_assert(motion.reference_m[SIDE_RIGHT] == 0.0004f);
    order(MOTION_KIND_MOVE, SIDE_LEFT, 0.05f, 0.5f);
    float before_m = motion.reference_m[SIDE_RIGHT];
    while (motion.phase != MOTION_LOADS) {
        (void)run_tick();
        ck_assert(before_m - motion.reference_m[SIDE_RIGHT] <= 5.1e-6f); /* 0.5 mm in 100 ticks */
        before_m = motion.reference_m[SIDE_RIGHT];
        ck_assert_uint_lt(tick, LIMIT_TICKS);
    }
    ck_assert(motion.reference_m[SIDE_RIGHT] == 0.0f);
    input.sea[SIDE_RIGHT].precompression_m = 0.1f; /* no further than the checks let it be */
    motion_enter(&motion, &params, &input);
    ck_assert(motion.reference_m[SIDE_RIGHT] == params.sea_tolerance_m);
}
END_TEST

START_TEST(it_waits_for_both_drives)
{
    input.sea[SIDE_RIGHT].state = DRIVE_STARTING;
    order(MOTION_KIND_MOVE, SIDE_LEFT, 0.05f, 0.5f);
    for (int i = 0; i < 100; i++) {
        (void)run_tick();
        ck_assert_int_eq(motion.phase, MOTION_WAITS);
    }
    input.sea[SIDE_RIGHT].state = DRIVE_ENABLED;
    ck_assert_int_eq(finish(), MOTION_DONE);
    input.sea[SIDE_LEFT].state = DRIVE_STARTING;
    order(MOTION_KIND_MOVE, SIDE_RIGHT, 0.05f, 0.5f);
    for (int i = 0; i < 1000; i++) {
        (void)run_tick();
        ck_assert_int_eq(motion.phase, MOTION_WAITS);
    }
}
END_TEST

/* The motor here is three ticks late, and that is all: it follows every frequency. */
START_TEST(an_oscillation_stays_within_the_references_limits_and_tells_how_far_it_came)
{
    ck_assert_int_eq(perform(MOTION_KIND_CHIRP, SIDE_LEFT, 0.05f, 5.0f), MOTION_DONE);
    ck_assert(motion.bandwidth_Hz == 0.0f);
    const float fastest_Hz = sqrtf(0.8f * 10.0f / (2.0f * 9.8696f * 0.005f));
    ck_assert(motion.last_frequency_Hz > 0.9f * fastest_Hz);
    ck_assert(motion.last_frequency_Hz <= fastest_Hz);
    ck_assert(steepest_m <= 0.5f * params.sea_speed_max_m_s * 0.001f);
    ck_assert(largest_m <= 0.005f * 1.000001f);
}
END_TEST

START_TEST(an_oscillation_is_no_faster_than_was_asked_or_the_speed_allows)
{
    order(MOTION_KIND_CHIRP, SIDE_LEFT, 0.05f, 5.0f);
    input.motion.frequency_Hz = 2.0f;
    ck_assert_int_eq(finish(), MOTION_DONE);
    ck_assert(motion.last_frequency_Hz > 1.5f && motion.last_frequency_Hz <= 2.0f);
    params.sea_speed_max_m_s = 0.1f;
    ck_assert_int_eq(perform(MOTION_KIND_CHIRP, SIDE_LEFT, 0.05f, 5.0f), MOTION_DONE);
    ck_assert(motion.last_frequency_Hz <= 0.05f / (3.1416f * 0.005f));
    ck_assert(steepest_m <= 0.05f * 0.001f);
}
END_TEST

START_TEST(a_motor_that_does_less_than_0707_has_its_bandwidth_there)
{
    travel_gain = 0.6f;
    ck_assert_int_eq(perform(MOTION_KIND_CHIRP, SIDE_LEFT, 0.05f, 5.0f), MOTION_DONE);
    ck_assert(motion.bandwidth_Hz > 1.0f &&
              motion.bandwidth_Hz < 4.0f); /* from the third cycle on */
}
END_TEST

START_TEST(a_release_is_armed_only_while_it_holds_and_timed)
{
    order(MOTION_KIND_RELEASE, SIDE_LEFT, 0.05f, 1.0f);
    while (!motion.armed) {
        (void)run_tick();
        ck_assert_uint_lt(tick, LIMIT_TICKS);
    }
    ck_assert_int_eq(motion.phase, MOTION_HOLDS);
    for (int i = 0; i < 200; i++) {
        (void)run_tick();
    }
    input.sea[SIDE_LEFT].latch = LATCH_OPEN;
    ck_assert_int_eq(finish(), MOTION_DONE);
    ck_assert_uint_eq(motion.release_ticks, 201);
    input.sea[SIDE_LEFT].latch = LATCH_CLOSED;
    ck_assert_int_eq(perform(MOTION_KIND_RELEASE, SIDE_LEFT, 0.05f, 0.5f), MOTION_DONE);
    ck_assert_uint_eq(motion.release_ticks, UINT16_MAX); /* it never opened */
}
END_TEST

START_TEST(a_cut_ends_with_the_drives_own_unload_or_its_time)
{
    ck_assert_int_eq(perform(MOTION_KIND_CUT, SIDE_LEFT, 0.05f, 0.4f), MOTION_DONE);
    ck_assert_uint_eq(motion.unload_ticks, DRIVE_UNLOADS_TICKS + 1);
    unloads_by_itself = false;
    cut_ticks = 0;
    ck_assert_int_eq(perform(MOTION_KIND_CUT, SIDE_LEFT, 0.05f, 10.0f), MOTION_DONE);
    ck_assert_uint_eq(motion.unload_ticks, UINT16_MAX);
    ck_assert_uint_le(cut_ticks, MOTION_CUT_TICKS + 1); /* however long was asked for */
}
END_TEST

/* ---- behind it, the gate ------------------------------------------------------------------ */

START_TEST(the_gate_lets_no_motion_out_of_its_stage)
{
    struct command_guard guard = {0};
    struct sea_request request[SIDE_COUNT] = {{0.004f, true, false}, {0.0f, true, false}};
    command_guard_begin_motions(&guard, &params, 0.05f);
    command_guard_limit(&guard, true, request);
    ck_assert(request[SIDE_LEFT].enable);
    request[SIDE_LEFT] = (struct sea_request){0.0052f, true, true};
    command_guard_limit(&guard, true, request);
    ck_assert(request[SIDE_LEFT].precompression_m <= 0.004f + 0.6f * 1.5f * 0.001f);
    for (int i = 0; i < 5; i++) { /* slowly it does not come further, either */
        request[SIDE_LEFT] = (struct sea_request){0.006f, true, true};
        command_guard_limit(&guard, true, request);
    }
    /* Held where it ends, not switched off: a drive would let its loaded spring go. */
    const float stage_m = 0.05f * params.r0_max_m + params.sea_tolerance_m;
    ck_assert(request[SIDE_LEFT].enable && !request[SIDE_LEFT].latch_armed);
    ck_assert(request[SIDE_LEFT].precompression_m <= stage_m && stage_m < 0.006f);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("motion");
    TCase *tcase = tcase_create("all");
    tcase_add_checked_fixture(tcase, setup, NULL);
    tcase_add_test(tcase, a_move_goes_there_and_back_without_a_step);
    tcase_add_test(tcase, a_move_comes_back_as_slowly_as_it_went_and_all_else_in_half_a_second);
    tcase_add_test(tcase, loads_grow_in_stages_that_both_legs_have_to_pass);
    tcase_add_test(tcase, a_leg_without_a_drive_is_not_waited_for);
    tcase_add_test(tcase, a_fault_begins_with_small_loads_again_but_not_that_of_a_cut);
    tcase_add_test(tcase, a_tool_that_is_lost_asks_for_nothing);
    tcase_add_test(tcase, after_a_fault_it_takes_a_new_request);
    tcase_add_test(tcase, more_force_than_the_stage_allows_turns_it_back);
    tcase_add_test(tcase, a_motor_that_runs_away_or_does_not_come_turns_it_back);
    tcase_add_test(tcase, what_is_no_motion_is_refused);
    tcase_add_test(tcase, the_end_can_be_asked_for);
    tcase_add_test(tcase, a_motor_beside_zero_is_not_made_to_jump);
    tcase_add_test(tcase, it_waits_for_both_drives);
    tcase_add_test(tcase,
                   an_oscillation_stays_within_the_references_limits_and_tells_how_far_it_came);
    tcase_add_test(tcase, an_oscillation_is_no_faster_than_was_asked_or_the_speed_allows);
    tcase_add_test(tcase, a_motor_that_does_less_than_0707_has_its_bandwidth_there);
    tcase_add_test(tcase, a_release_is_armed_only_while_it_holds_and_timed);
    tcase_add_test(tcase, a_cut_ends_with_the_drives_own_unload_or_its_time);
    tcase_add_test(tcase, the_gate_lets_no_motion_out_of_its_stage);
    suite_add_tcase(suite, tcase);
    return run_suite(suite);
}
