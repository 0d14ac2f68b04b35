#include "controller/estimator/placement.h"

/* A leg turns by more in every step of walking: 6 cm on a 0.9 m leg, as in walk_proof.c. */
#define TURN_LEAST_RAD REAL(0.07)
/* An ankle that keeps its value within this is stuck, if the other one moves by so much: sensors
 * resolve 0.01 mm, and a push-off of 3 degrees moves a heel 12 cm behind the joint by 6 mm. */
#define STUCK_M REAL(0.0003)
#define MOVES_M REAL(0.006)
/* In a step that turns the leg by less, some 18 cm on a 0.9 m leg, a foot may never push off. */
#define FULL_TURN_RAD REAL(0.2)
/* Extended further in stance than at its end, by more than a cuff gives way. */
#define EARLY_M REAL(0.002)
/* Of a stance: own landing, the other foot leaves, lands, and this one leaves. */
enum { INSTANTS_BEFORE_LEAVING = 3 };

static uint8_t count_while(uint8_t count, bool wrong)
{
    return (uint8_t)(!wrong ? 0 : count < UINT8_MAX ? count + 1 : count);
}

/* forwards_rad: how far a leg turned the way it should. */
static void judge_turn(struct placement_leg *leg, real forwards_rad)
{
    if (real_abs(forwards_rad) > TURN_LEAST_RAD) {
        leg->turns = count_while(leg->turns, forwards_rad < REAL(0.0));
    }
}

static void note(struct placement_leg *leg, real extension_m)
{
    leg->low_m = extension_m < leg->low_m ? extension_m : leg->low_m;
    leg->high_m = extension_m > leg->high_m ? extension_m : leg->high_m;
    leg->instants++;
}

static void begin_stance(struct placement_leg *leg, real extension_m)
{
    leg->low_m = leg->high_m = extension_m;
    leg->instants = 1;
    leg->pushed = false;
}

/* An ankle is stuck if the other one moves, or if neither ever did in full steps: both sensors dead, or both
 * mounted backwards. Of two that hardly move nobody knows, and small steps leave both still. */
static bool says_stuck(const struct placement *placement, int side)
{
    const real other_m = placement->moved_m[1 - side];
    return other_m > MOVES_M || (other_m < STUCK_M && placement->moved_m[side] < STUCK_M &&
                                 real_abs(placement->leg[side].turned_rad) > FULL_TURN_RAD);
}

static void end_stance(struct placement *placement, int side, real extension_m)
{
    struct placement_leg *leg = &placement->leg[side];
    if (leg->instants == INSTANTS_BEFORE_LEAVING) {
        if (!leg->pushed) {
            leg->early = count_while(leg->early, extension_m < leg->high_m - EARLY_M);
        }
        note(leg, extension_m);
        const real moved_m = leg->high_m - leg->low_m;
        if (moved_m > placement->moved_m[side]) {
            placement->moved_m[side] = moved_m;
        }
        leg->stuck = count_while(leg->stuck, moved_m < STUCK_M && says_stuck(placement, side));
    }
    leg->instants = 0;
}

static void leaves(struct placement *placement, const struct placement_view *view, int side)
{
    const int standing = 1 - side;
    for (int i = 0; i < SIDE_COUNT; i++) {
        placement->leg[i].from_rad = view->angle_rad[i];
    }
    placement->single[standing] = true;
    placement->single[side] = false;
    end_stance(placement, side, view->extension_m[side]);
    if (placement->leg[standing].instants == 1) {
        note(&placement->leg[standing], view->extension_m[standing]);
    }
}

static void lands(struct placement *placement, const struct placement_view *view, int side)
{
    const int standing = 1 - side;
    struct placement_leg *leg = placement->leg;
    if (placement->single[standing]) {
        leg[standing].turned_rad = leg[standing].from_rad - view->angle_rad[standing];
        judge_turn(&leg[standing], leg[standing].turned_rad);
        judge_turn(&leg[side], view->angle_rad[side] - leg[side].from_rad);
        placement->single[standing] = false;
    }
    if (leg[standing].instants == 2) {
        note(&leg[standing], view->extension_m[standing]);
    }
    begin_stance(&leg[side], view->extension_m[side]);
}

void placement_edges(struct placement *placement, const struct placement_view *view)
{
    for (int side = 0; side < SIDE_COUNT; side++) {
        if (view->leaves[side]) {
            leaves(placement, view, side);
        }
        if (view->lands[side]) {
            lands(placement, view, side);
        }
    }
}

void placement_wires(struct placement *placement, const struct controller_input *input)
{
    for (int side = 0; side < SIDE_COUNT; side++) {
        const enum foot_contact at_latch = input->sea[side].contact;
        const enum foot_contact foot = input->leg[1 - side].foot;
        uint16_t *ticks = &placement->leg[side].wire_ticks;
        if (input->sea[side].latch == LATCH_OPEN) {
            placement->leg[side].pushed = true;
        }
        if (at_latch == foot || at_latch == FOOT_UNKNOWN || foot == FOOT_UNKNOWN) {
            *ticks = 0;
        } else if (*ticks < UINT16_MAX) {
            (*ticks)++;
        }
    }
}

uint8_t placement_found(const struct placement *placement)
{
    unsigned found = 0;
    for (unsigned side = 0; side < SIDE_COUNT; side++) {
        const struct placement_leg *leg = &placement->leg[side];
        found |= leg->turns >= PLACEMENT_STEPS ? (unsigned)PLACEMENT_ANGLE << side : 0u;
        found |= leg->stuck >= PLACEMENT_STANCES ? (unsigned)PLACEMENT_STUCK << side : 0u;
        found |= leg->early >= PLACEMENT_STANCES ? (unsigned)PLACEMENT_ANKLE << side : 0u;
        found |= leg->wire_ticks >= PLACEMENT_WIRE_TICKS ? (unsigned)PLACEMENT_WIRE << side : 0u;
    }
    return (uint8_t)found;
}
