/* Faults of a person and of what they wear: assembly, latches, foot switches, the person. */
#include "sim_host/faults/injector_internal.h"

static const double LEG_M = 0.9; /* of impulses and stairs, as angles of a leg */
static const double SLIP_RAD_S = 1.0;
static const double KNOCK_NS_PER_KG = 3.0; /* nobody stays up */

static bool is_person(const struct loop *loop)
{
    return loop->config.plant.kind != PLANT_WALKER;
}

static bool is_reflex(const struct loop *loop)
{
    return loop->config.plant.kind == PLANT_REFLEX_PERSON;
}

static unsigned choice_of(const struct fault_shot *shot)
{
    return (unsigned)shot->magnitude;
}

/* ---- assembly ------------------------------------------------------------------------ */

enum { SWAP_LEGS, SWAP_BOTH, SWAP_FEET };
enum { BACK_LEGS, BACK_LEG, BACK_ANKLES, BACK_ANKLE };

static void swap(const struct fault_shot *shot, struct assembly *assembly, bool on)
{
    const unsigned what = choice_of(shot);
    assembly->legs_swapped = on && what != SWAP_FEET;
    assembly->feet_swapped = on && what != SWAP_LEGS;
}

static void turn_round(const struct fault_shot *shot, struct assembly *assembly, double gain)
{
    const unsigned what = choice_of(shot);
    double *gains =
        what == BACK_ANKLES || what == BACK_ANKLE ? assembly->ankle_gain : assembly->leg_gain;
    const bool both = what == BACK_LEGS || what == BACK_ANKLES;
    for (int side = 0; side < SIDE_COUNT; side++) {
        gains[side] = both || side == (int)injector_side(shot) ? gain : gains[side];
    }
}

static void assemble(const struct shot_state *state, struct loop *loop, bool on)
{
    const struct fault_shot *shot = &state->shot;
    struct assembly *assembly = &loop->nodes.assembly;
    const enum side side = injector_side(shot);
    switch (shot->kind) {
    case FAULT_LEGS_SWAPPED:
        swap(shot, assembly, on);
        break;
    case FAULT_DRIVES_CROSSED:
        assembly->drives_crossed = on;
        break;
    case FAULT_SENSORS_BACKWARDS:
        turn_round(shot, assembly, on ? -1.0 : 1.0);
        break;
    case FAULT_ANKLE_STUCK_AT_START:
        assembly->ankle_stuck[side] = on;
        assembly->ankle_stuck_m[side] = loop->nodes.plant.person.ankle_m[side];
        break;
    case FAULT_ANKLE_SLIPPED:
    case FAULT_NEUTRAL_OFF:
        assembly->ankle_slip_m[side] = !on ? 0.0
                                       : shot->kind == FAULT_ANKLE_SLIPPED
                                           ? shot->magnitude
                                           : injector_neutral_m(loop, shot->magnitude);
        break;
    case FAULT_LEG_SCALE:
        assembly->leg_gain[side] = on ? shot->magnitude : 1.0;
        break;
    case FAULT_ANKLE_SCALE:
        assembly->ankle_gain[side] = on ? shot->magnitude : 1.0;
        break;
    case FAULT_MOTOR_SCALE:
        assembly->motor_scale[side] = on ? shot->magnitude : 1.0;
        break;
    case FAULT_SENSOR_LATE:
        assembly->late_ticks[side] = on ? (uint8_t)TICKS_OF_MS(choice_of(shot)) : 0;
        break;
    case FAULT_CLOCK_SKEW:
        assembly->clock_skew[shot->node] = on ? shot->magnitude : 0.0;
        assembly->skewed_ns[shot->node] = loop->tick * (uint64_t)TICK_PERIOD_US * 1000u;
        break;
    default:
        break;
    }
}

double injector_neutral_m(const struct loop *loop, double degrees)
{
    return loop->nodes.plant.config.recording_format.ankle[SIDE_LEFT].lever_m * degrees *
           0.017453292519943295;
}

/* ---- latches and foot switches ---------------------------------------------------------- */

static void break_contact(const struct fault_shot *shot, struct plant *plant, bool on)
{
    const enum side side = injector_side(shot);
    struct foot_switch_params *foot = &plant->foot_switch[side].params;
    switch (shot->kind) {
    case FAULT_LATCH_OPENS:
    case FAULT_LATCH_STAYS_OPEN:
    case FAULT_LATCH_STAYS_CLOSED:
        plant->latch_broken[side] =
            on ? (enum plant_latch_fault)(PLANT_LATCH_OPENS + (shot->kind - FAULT_LATCH_OPENS))
               : PLANT_LATCH_WELL;
        break;
    case FAULT_FOOT_LATE:
        foot->close_bias_s += on ? shot->magnitude : -shot->magnitude;
        foot->open_bias_s += on ? shot->magnitude : -shot->magnitude;
        break;
    default:
        foot->fault =
            on ? (enum foot_switch_fault)(FOOT_SWITCH_STUCK_UP + (shot->kind - FAULT_FOOT_STUCK_UP))
               : FOOT_SWITCH_WELL;
        foot->fault_from_s = 0.0;
        break;
    }
}

/* ---- the person ----------------------------------------------------------------------------- */

static enum side swing_side(const struct plant *plant)
{
    return plant->person.contact[SIDE_LEFT] ? SIDE_RIGHT : SIDE_LEFT;
}

static void befall(struct shot_state *state, struct plant *plant)
{
    const struct fault_shot *shot = &state->shot;
    struct person_motion *motion = &plant->motion;
    const enum side swing = swing_side(plant);
    switch (shot->kind) {
    case FAULT_PUSH: /* an impulse in body masses times m/s, over the leg */
        motion->bump_rad[SIDE_LEFT] += 0.5 * shot->magnitude / LEG_M;
        motion->bump_rad[SIDE_RIGHT] += 0.5 * shot->magnitude / LEG_M;
        break;
    case FAULT_STAIRS:
        motion->bump_rad[swing] += shot->magnitude / LEG_M;
        break;
    case FAULT_TRIP:
        person_motion_hold(motion, swing, &plant->person);
        state->held[0] = (double)swing;
        break;
    case FAULT_PERSON_STOPS:
        motion->rate = 0.0;
        break;
    case FAULT_PERSON_TURNS_BACK:
        motion->rate = -1.0;
        break;
    case FAULT_PERSON_HURRIES:
        motion->rate = shot->magnitude;
        break;
    case FAULT_PERSON_FALLS:
        motion->rate = 0.0;
        motion->tilt_to_rad = shot->magnitude;
        break;
    default:
        break;
    }
}

/* Somebody whose own body answers; a push is the plant's (injector_nodes.c), and so is a stair. */
static void befall_reflex(struct shot_state *state, struct plant *plant)
{
    const double knock_Ns = KNOCK_NS_PER_KG * plant->reflex.params.mass_kg;
    switch (state->shot.kind) {
    case FAULT_SLIP:
        plant->reflex.params.contact.friction = state->shot.magnitude;
        break;
    case FAULT_TRIP:
        reflex_person_trip(&plant->reflex, swing_side(plant), FOOT_BALL);
        break;
    case FAULT_PERSON_FALLS:
        plant_push(plant, state->shot.magnitude > 0.0 ? -knock_Ns : knock_Ns, 0.0);
        break;
    default:
        break;
    }
}

static bool is_contact_fault(const struct shot_state *state)
{
    return fault_kinds[state->shot.kind].group == FAULT_GROUP_CONTACT;
}

static void stand_firm(const struct shot_state *state, struct plant *plant)
{
    if (state->shot.kind == FAULT_SLIP) {
        plant->reflex.params.contact.friction = plant->config.reflex.contact.friction;
    }
}

void injector_person_start(struct shot_state *state, struct loop *loop)
{
    if (!is_person(loop)) {
        return;
    }
    if (is_contact_fault(state)) {
        break_contact(&state->shot, &loop->nodes.plant, true);
    }
    assemble(state, loop, true);
    if (is_reflex(loop)) {
        befall_reflex(state, &loop->nodes.plant);
    } else {
        befall(state, &loop->nodes.plant);
    }
    state->changed++;
}

void injector_person_stop(struct shot_state *state, struct loop *loop)
{
    const bool lasts = fault_kinds[state->shot.kind].group == FAULT_GROUP_PERSON &&
                       state->shot.kind != FAULT_PERSON_HURRIES;
    if (!is_person(loop) || lasts) {
        return; /* who has stopped, fallen or turned does not walk on */
    }
    if (is_contact_fault(state)) {
        break_contact(&state->shot, &loop->nodes.plant, false);
    }
    assemble(state, loop, false);
    if (is_reflex(loop)) {
        stand_firm(state, &loop->nodes.plant);
        return;
    }
    if (state->shot.kind == FAULT_TRIP) {
        loop->nodes.plant.motion.held[(int)state->held[0]] = false;
    }
    if (state->shot.kind == FAULT_PERSON_HURRIES) {
        loop->nodes.plant.motion.rate = 1.0;
    }
}

void injector_person_hold(struct shot_state *state, struct loop *loop)
{
    struct plant *plant = &loop->nodes.plant;
    if (loop->config.plant.kind != PLANT_RECORDED_PERSON || state->shot.kind != FAULT_SLIP) {
        return;
    }
    for (int side = 0; side < SIDE_COUNT; side++) { /* the standing foot slides ahead */
        if (plant->person.contact[side]) {
            plant->motion.bump_rad[side] += SLIP_RAD_S * TICK_PERIOD_US / 1e6;
        }
    }
}
