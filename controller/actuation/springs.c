#include "controller/actuation/springs.h"

#include "controller/estimator/body_table.h"

/* The ankle comes back, and its push is over, when it is so far from its farthest; of the leg. */
#define COMES_BACK_RATIO REAL(0.003)
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
        springs->open_ticks[side] = 0;
    }
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

static void begin_loading(struct springs *springs, const struct step_decision *decision,
                          enum side side)
{
    if (!decision->assists) {
        return;
    }
    springs->waits[side] = !springs->may_load[side];
    if (springs->waits[side]) {
        springs->waits_final[side] = false;
        springs->waiting_m[side] = decision->load_m;
    } else {
        sea_reference_begin_loading(&springs->sea[side], decision->load_m);
    }
}

static void decide_load(struct springs *springs, enum side side, real load_m)
{
    if (springs->waits[side]) {
        springs->waits_final[side] = true;
        springs->waiting_m[side] = load_m;
    } else {
        sea_reference_set_target(&springs->sea[side], load_m);
    }
}

static enum push_outcome end_stance(struct springs *springs, enum side side)
{
    springs->waits[side] = false;
    sea_reference_unload(&springs->sea[side]);
    return push_watch_end(&springs->watch, side);
}

enum push_outcome springs_follow(struct springs *springs, const struct step_decision *decision,
                                 const struct gait_state *gait, bool first_stance)
{
    const struct gait_event *strike = &gait->event[GAIT_HEEL_STRIKE];
    const struct gait_event *lift_off = &gait->event[GAIT_LIFT_OFF];
    enum push_outcome outcome = PUSH_NONE;
    if (decision->improved) { /* not final yet: on the way there already, but not armed */
        begin_loading(springs, decision, decision->side);
    }
    if (decision->new_step) {
        decide_load(springs, decision->side, decision->load_m);
    }
    if (strike->happened) {
        const enum side other = side_other(strike->side);
        push_watch_strike(&springs->watch, other, springs->sea[other].phase == SEA_ARMED);
        if (decision->assists) {
            push_watch_prescribe(&springs->watch, strike->side);
        }
        begin_loading(springs, decision, strike->side);
    }
    if (lift_off->happened) {
        outcome = end_stance(springs, lift_off->side);
    }
    if (first_stance && gait->phase == PHASE_SINGLE_SUPPORT &&
        springs->sea[gait->stance].phase == SEA_UNLOADED) {
        begin_loading(springs, decision, gait->stance);
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

/* What is left of a push drags at the foot in swing: back as soon as there is nothing to give. */
static bool push_is_over(struct springs *springs, const struct control_params *params,
                         enum side side, const struct controller_input *input)
{
    const struct sea_measurement *sea = &input->sea[side];
    const real extension_m = input->leg[side].ankle_extension_m;
    if (sea->latch != LATCH_OPEN) {
        springs->open_ticks[side] = 0;
        springs->farthest_m[side] = extension_m;
        return false;
    }
    if (springs->open_ticks[side] < UINT16_MAX) {
        springs->open_ticks[side]++;
    }
    if (extension_m > springs->farthest_m[side]) {
        springs->farthest_m[side] = extension_m;
    }
    return !body_of(params->body)->ankle_is_held &&
           (extension_m >= sea->precompression_m ||
            extension_m < springs->farthest_m[side] - COMES_BACK_RATIO * params->leg_length_m ||
            springs->open_ticks[side] > ticks_from_seconds(PUSH_MOST_S));
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
    for (int side = 0; side < SIDE_COUNT; side++) {
        const struct sea_measurement *sea = &input->sea[side];
        load_when_allowed(springs, params, (enum side)side, sea->latch);
        if (push_is_over(springs, params, (enum side)side, input)) {
            sea_reference_unload(&springs->sea[side]);
        }
        request[side] = sea_reference_update(&springs->sea[side], params, sea->precompression_m);
        /* A drive that is not heard while it is to unload does it by itself. */
        const bool silent = state == SUPERVISOR_UNLOADING &&
                            sea->age_ticks > ticks_from_seconds(params->sensor_age_max_s);
        request[side].enable = !silent;
        request[side].latch_armed = request[side].latch_armed && may_release(gait, (enum side)side);
        push_watch_tick(
            &springs->watch, (enum side)side, request[side].latch_armed, springs->waits[side],
            is_behind(springs, params, (enum side)side, sea->precompression_m), sea->latch);
    }
}
