#include "controller/actuation/springs.h"

#include "controller/estimator/body_table.h"

/* The ankle comes back, and its push is over, when it is so far from its farthest; of the leg. */
#define COMES_BACK_RATIO REAL(0.003)
/* Of the mean time from release to toe-off, for each new one; a shorter one counts more. */
#define PUSH_MEAN_GAIN REAL(0.2)
#define PUSH_SHORTER_GAIN REAL(0.7)
/* Going back after a push there is no load to move against; of the references' limits. */
#define BACK_SPEED_RATIO REAL(1.2)
#define BACK_ACCELERATION_RATIO REAL(2.0)
/* So much compression may be left as the foot leaves, of the prescribed one: 1.4 % of its energy. */
#define HARMLESS_RATIO REAL(0.12)
/* A motor so far from its reference is at a limit of its own; of the leg. */
#define BEHIND_RATIO REAL(0.006)

/* Behind an open latch a spring that is loaded pushes at once. A compass' foot stands on it then, and
 * its device loads in every stance; a drive that does not tell of its latch is believed. */
static bool may_load(const struct control_params *params, enum latch_state latch)
{
    return latch != LATCH_OPEN || body_of(params->body)->ankle_is_held;
}

void springs_begin(struct springs *springs, const struct control_params *params,
                   const struct controller_input *input)
{
    springs->stop = sea_reference_stop_limits(params);
    for (int side = 0; side < SIDE_COUNT; side++) {
        sea_reference_init(&springs->sea[side], input->sea[side].precompression_m);
        springs->may_load[side] = may_load(params, input->sea[side].latch);
        springs->waits[side] = false;
        springs->open[side] = false;
        springs->push_s[side] = REAL(0.0);
        springs->left_m[side] = REAL(0.0);
        /* Nothing is known of this leg's pushes: a harmless one shows how they go. */
        springs->reach_m[side] = body_of(params->body)->ankle_is_held
                                     ? REAL_LARGEST
                                     : HARMLESS_RATIO * params->start_r0_m;
        springs->left[side] = true;
        springs->swings[side] = false;
    }
    springs->drags = false;
    push_watch_begin(&springs->watch);
}

void springs_stop(struct springs *springs, const struct controller_input *input)
{
    push_watch_begin(&springs->watch);
    for (int side = 0; side < SIDE_COUNT; side++) {
        springs->waits[side] = false;
        sea_reference_stop(&springs->sea[side], &springs->stop, input->sea[side].precompression_m);
    }
}

void springs_place(struct springs *springs, enum side side, real reference_m)
{
    sea_reference_init(&springs->sea[side], reference_m);
    sea_reference_begin_loading(&springs->sea[side], reference_m);
}

static real within_reach_m(const struct springs *springs, enum side side, real load_m)
{
    return load_m > springs->reach_m[side] ? springs->reach_m[side] : load_m;
}

/* A person's spring is loaded behind a closed latch only: open, it would push the foot while it is loaded. */
static void begin_loading(struct springs *springs, const struct step_decision *decision,
                          const struct controller_input *input, enum side side)
{
    if (!decision->assists || input->sea[side].absent) {
        return;
    }
    const real load_m = within_reach_m(springs, side, decision->load_m);
    springs->waits[side] = !springs->may_load[side];
    if (springs->waits[side]) {
        springs->waits_final[side] = false;
        springs->waiting_m[side] = load_m;
    } else {
        sea_reference_begin_loading(&springs->sea[side], load_m);
    }
}

static void decide_load(struct springs *springs, enum side side, real decided_m)
{
    const real load_m = within_reach_m(springs, side, decided_m);
    if (springs->waits[side]) {
        springs->waits_final[side] = true;
        springs->waiting_m[side] = load_m;
    } else {
        sea_reference_set_target(&springs->sea[side], load_m);
    }
}

static void learn_push(struct springs *springs, const struct gait_event *lift_off)
{
    const enum side side = lift_off->side;
    const uint32_t open_tick = springs->open_tick[side], up_tick = springs->up_tick[side];
    if (springs->watch.leg[side].opened && lift_off->tick > open_tick) {
        /* The switch's opening is a sign, too, and late if it is wrong: the earlier one counts. */
        const real found_s = seconds_since(lift_off->tick, open_tick) - lift_off->before_tick_s;
        const real up_s = up_tick > open_tick ? seconds_since(up_tick, open_tick) : found_s;
        const real lasted_s =
            real_clamp(up_s < found_s ? up_s : found_s, PUSH_LEAST_S, PUSH_MOST_S);
        real *mean_s = &springs->push_s[side];
        const real gain = lasted_s < *mean_s ? PUSH_SHORTER_GAIN : PUSH_MEAN_GAIN;
        *mean_s = *mean_s > REAL(0.0) ? *mean_s + gain * (lasted_s - *mean_s) : lasted_s;
    }
}

static real time_to_toe_off_s(const struct springs *springs, enum side side, uint32_t tick)
{
    const real push_s = springs->push_s[side] > REAL(0.0) ? springs->push_s[side] : PUSH_FIRST_S;
    return push_s - seconds_since(tick, springs->open_tick[side]);
}

/* How far the ankle is extended as the foot leaves: at the time at which it usually does. */
static void learn_extension(struct springs *springs, enum side side, real extension_m,
                            uint32_t tick)
{
    if (!springs->left[side] && time_to_toe_off_s(springs, side, tick) <= REAL(0.0)) {
        const real gain = extension_m < springs->left_m[side] ? PUSH_SHORTER_GAIN : PUSH_MEAN_GAIN;
        springs->left[side] = true;
        springs->left_m[side] += gain * (extension_m - springs->left_m[side]);
    }
}

static enum push_outcome end_stance(struct springs *springs, const struct gait_event *lift_off)
{
    const enum side side = lift_off->side;
    springs->waits[side] = false;
    springs->swings[side] = true;
    springs->toe_off_tick[side] = lift_off->tick;
    learn_push(springs, lift_off);
    sea_reference_unload(&springs->sea[side]);
    return push_watch_end(&springs->watch, side);
}

enum push_outcome springs_follow(struct springs *springs, const struct step_decision *decision,
                                 const struct controller_input *input,
                                 const struct gait_state *gait, bool first_stance)
{
    const struct gait_event *strike = &gait->event[GAIT_HEEL_STRIKE];
    const struct gait_event *lift_off = &gait->event[GAIT_LIFT_OFF];
    enum push_outcome outcome = springs->drags ? PUSH_DRAGS : PUSH_NONE;
    springs->drags = false;
    if (decision->improved) { /* not final yet: on the way there already, but not armed */
        begin_loading(springs, decision, input, decision->side);
    }
    if (decision->new_step) {
        decide_load(springs, decision->side, decision->load_m);
    }
    if (strike->happened) {
        const enum side other = side_other(strike->side);
        springs->swings[strike->side] = false;
        push_watch_strike(&springs->watch, other, strike->tick);
        if (decision->assists) {
            push_watch_prescribe(&springs->watch, strike->side);
        }
        begin_loading(springs, decision, input, strike->side);
    }
    if (lift_off->happened) {
        outcome = end_stance(springs, lift_off);
    }
    if (first_stance && gait->phase == PHASE_SINGLE_SUPPORT &&
        springs->sea[gait->stance].phase == SEA_UNLOADED) {
        begin_loading(springs, decision, input, gait->stance);
    }
    return outcome;
}

/* No push before the other foot can carry the person: their ankle can extend in midstance, too,
 * and an armed latch would take that for the push-off. */
static bool may_release(const struct gait_state *gait, enum side side)
{
    return gait->strike_near && gait->stance == side;
}

static void load_when_allowed(struct springs *springs, const struct control_params *params,
                              enum side side, enum latch_state latch)
{
    springs->may_load[side] = may_load(params, latch);
    if (!springs->waits[side] || !springs->may_load[side]) {
        return;
    }
    springs->waits[side] = false;
    sea_reference_begin_loading(&springs->sea[side], springs->waiting_m[side]);
    if (springs->waits_final[side]) {
        sea_reference_set_target(&springs->sea[side], springs->waiting_m[side]);
    }
}

static bool ankle_has_had_it(struct springs *springs, const struct control_params *params,
                             enum side side, real motor_m, real extension_m)
{
    if (extension_m > springs->farthest_m[side]) {
        springs->farthest_m[side] = extension_m;
    }
    return extension_m >= motor_m ||
           extension_m < springs->farthest_m[side] - COMES_BACK_RATIO * params->leg_length_m;
}

static real lead_s(const struct springs *springs, const struct control_params *params,
                   enum side side)
{
    const real bias_s =
        side == SIDE_LEFT ? params->toe_off_bias_left_s : params->toe_off_bias_right_s;
    return PUSH_SCATTER_RATIO * springs->push_s[side] +
           (bias_s != REAL(0.0) ? PUSH_LEAD_S : PUSH_LEAD_UNFITTED_S);
}

/* How far a motor comes back within a time, and what may be left. */
static real way_back_m(const struct control_params *params, real time_s)
{
    return HARMLESS_RATIO * params->start_r0_m +
           REAL(0.5) * BACK_ACCELERATION_RATIO * params->sea_acceleration_m_s2 * time_s * time_s;
}

/* From here on the motor needs all of the time that is left to be back with the ankle. */
static bool must_set_off(const struct springs *springs, const struct control_params *params,
                         enum side side, real motor_m, real extension_m, uint32_t tick)
{
    const real left_s = time_to_toe_off_s(springs, side, tick) - lead_s(springs, params, side);
    const real ankle_m = extension_m > springs->left_m[side] ? extension_m : springs->left_m[side];
    return left_s <= REAL(0.0) || motor_m - ankle_m >= way_back_m(params, left_s);
}

/* A push is over, and its latch has closed. */
static void learn_reach(struct springs *springs, const struct control_params *params,
                        enum side side)
{
    const real back_s = springs->push_s[side] - lead_s(springs, params, side);
    if (springs->push_s[side] > REAL(0.0) && !body_of(params->body)->ankle_is_held) {
        springs->reach_m[side] =
            springs->left_m[side] + way_back_m(params, back_s > REAL(0.0) ? back_s : REAL(0.0));
    }
}

static bool push_is_over(struct springs *springs, const struct control_params *params,
                         enum side side, const struct controller_input *input)
{
    const struct sea_measurement *sea = &input->sea[side];
    const real extension_m = input->leg[side].ankle_extension_m;
    const real motor_m = sea->precompression_m;
    learn_extension(springs, side, extension_m, input->tick);
    if (sea->latch != LATCH_OPEN) {
        if (springs->open[side]) {
            learn_reach(springs, params, side);
        }
        springs->open[side] = false;
        return false;
    }
    if (!springs->open[side]) {
        springs->open[side] = true;
        springs->open_tick[side] = input->tick;
        springs->farthest_m[side] = extension_m;
        springs->left[side] = false;
        springs->up_tick[side] = 0;
    }
    if (input->leg[side].foot == FOOT_UP && springs->up_tick[side] == 0) {
        springs->up_tick[side] = input->tick;
    }
    return springs->up_tick[side] != 0 ||
           ankle_has_had_it(springs, params, side, motor_m, extension_m) ||
           must_set_off(springs, params, side, motor_m, extension_m, input->tick);
}

/* What is left of a push drags at the foot in swing: back as soon as there is nothing to give. A
 * compass' push ends by itself, as it extends. */
static void take_back(struct springs *springs, const struct control_params *params, enum side side,
                      const struct controller_input *input)
{
    const bool over = push_is_over(springs, params, side, input);
    const bool loads =
        springs->sea[side].phase != SEA_UNLOADED && springs->sea[side].phase != SEA_UNLOADING;
    if (over && loads && !body_of(params->body)->ankle_is_held) {
        sea_reference_hurry_back(&springs->sea[side], BACK_SPEED_RATIO * params->sea_speed_max_m_s,
                                 BACK_ACCELERATION_RATIO * params->sea_acceleration_m_s2);
    }
}

/* The spring still pushes at a foot that is to be free. */
static void watch_swing(struct springs *springs, const struct control_params *params,
                        enum side side, const struct controller_input *input)
{
    const struct sea_measurement *sea = &input->sea[side];
    const real pushed_m = sea->precompression_m - input->leg[side].ankle_extension_m;
    if (springs->swings[side] && sea->latch == LATCH_OPEN && pushed_m > params->sea_tolerance_m &&
        !body_of(params->body)->ankle_is_held &&
        seconds_since(input->tick, springs->toe_off_tick[side]) > SWING_FREE_S) {
        springs->drags = push_watch_drag(&springs->watch, side) || springs->drags;
    }
}

/* A motor that has run past its target has more energy than was prescribed: 1.1 times at r0_max. */
static bool is_overloaded(const struct control_params *params, real motor_m)
{
    return motor_m > params->r0_max_m && !body_of(params->body)->ankle_is_held;
}

static bool is_behind(const struct springs *springs, const struct control_params *params,
                      enum side side, real measured_m)
{
    return real_abs(springs->sea[side].position_m - measured_m) >
           BEHIND_RATIO * params->leg_length_m;
}

void springs_command(struct springs *springs, const struct control_params *params,
                     const struct controller_input *input, enum supervisor_state state,
                     const struct gait_state *gait, struct sea_request request[SIDE_COUNT])
{
    const bool assists = supervisor_may_assist(state);
    for (int side = 0; side < SIDE_COUNT; side++) {
        const struct sea_measurement *sea = &input->sea[side];
        load_when_allowed(springs, params, (enum side)side, sea->latch);
        take_back(springs, params, (enum side)side, input);
        watch_swing(springs, params, (enum side)side, input);
        request[side] = sea_reference_update(&springs->sea[side], params, sea->precompression_m);
        /* A drive that is not heard while it is to unload does it by itself. */
        const bool silent = state == SUPERVISOR_UNLOADING &&
                            sea->age_ticks > ticks_from_seconds(params->sensor_age_max_s);
        request[side].enable = !silent;
        if (!assists || !may_release(gait, (enum side)side) ||
            is_overloaded(params, sea->precompression_m)) {
            request[side].latch_armed = false;
        }
        /*@ assert armed_near_strike: request[side].latch_armed == 0 ||
              (assists && gait->strike_near && gait->stance == side); */
        const struct push_view view = {
            .full = springs->sea[side].phase == SEA_ARMED,
            .armed = request[side].latch_armed,
            .waits = springs->waits[side],
            .behind = is_behind(springs, params, (enum side)side, sea->precompression_m),
            .latch = sea->latch};
        push_watch_tick(&springs->watch, (enum side)side, &view, input->tick);
    }
}
