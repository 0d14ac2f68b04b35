#include "controller/actuation/push_watch.h"

static void count(uint32_t *counter)
{
    if (*counter < UINT32_MAX) {
        (*counter)++;
    }
}

static void forget(struct push_leg *leg)
{
    leg->prescribed = leg->waited = leg->armed = leg->full = false;
    leg->opened = leg->struck = leg->loaded = false;
}

void push_watch_begin(struct push_watch *watch)
{
    for (int side = 0; side < SIDE_COUNT; side++) {
        forget(&watch->leg[side]);
    }
    watch->leg[SIDE_LEFT].dragged = watch->leg[SIDE_RIGHT].dragged = false;
    watch->leg[SIDE_LEFT].told = watch->leg[SIDE_RIGHT].told = 0;
    watch->leg[SIDE_LEFT].unchanged_in_row = watch->leg[SIDE_RIGHT].unchanged_in_row = 0;
    watch->missed_in_row = 0;
    watch->dragged_in_row = 0;
}

static void count_up(uint8_t *number)
{
    if (*number < UINT8_MAX) {
        (*number)++;
    }
}

void push_watch_prescribe(struct push_watch *watch, enum side side)
{
    struct push_leg *leg = &watch->leg[side];
    (void)push_watch_end(watch, side);
    if (!leg->dragged && leg->last == PUSH_GIVEN) {
        watch->dragged_in_row = 0;
    }
    leg->dragged = false;
    leg->prescribed = true;
}

bool push_watch_drag(struct push_watch *watch, enum side side)
{
    struct push_leg *leg = &watch->leg[side];
    if (leg->dragged) {
        return false;
    }
    leg->dragged = true;
    leg->last = (uint8_t)PUSH_DRAGS;
    count(&leg->count[PUSH_DRAGS]);
    count_up(&watch->dragged_in_row);
    return true;
}

void push_watch_tick(struct push_watch *watch, enum side side, const struct push_view *view,
                     uint32_t tick)
{
    struct push_leg *leg = &watch->leg[side];
    if (view->behind) {
        count(&leg->behind_ticks);
    }
    if (view->latch != LATCH_UNKNOWN) {
        leg->told = (uint8_t)(leg->told |
                              (view->latch == LATCH_CLOSED ? PUSH_WATCH_CLOSED : PUSH_WATCH_OPEN));
    }
    if (!leg->prescribed) {
        return;
    }
    leg->waited = view->waits;
    leg->armed = leg->armed || view->armed;
    if (view->full && !leg->full) {
        leg->full = true;
        leg->full_tick = tick;
    }
    /* A drive that does not tell of its latch is believed. */
    leg->opened = leg->opened || (leg->armed && view->latch != LATCH_CLOSED);
}

void push_watch_strike(struct push_watch *watch, enum side side, uint32_t strike_tick)
{
    struct push_leg *leg = &watch->leg[side];
    if (leg->prescribed && !leg->struck) {
        leg->struck = true;
        leg->loaded = leg->full && leg->full_tick <= strike_tick;
    }
}

static enum push_outcome judge(const struct push_leg *leg)
{
    if (!leg->prescribed) {
        return PUSH_NONE;
    }
    if (leg->opened) {
        return PUSH_GIVEN;
    }
    if (leg->waited) {
        return PUSH_LATCH_OPEN;
    }
    return leg->loaded ? PUSH_NOT_RELEASED : PUSH_NOT_LOADED;
}

/* A stance is over in which the latch should have opened; what it told since the one before. */
static void judge_report(struct push_leg *leg)
{
    if (leg->prescribed && leg->armed && leg->loaded) {
        if (leg->told == PUSH_WATCH_CLOSED || leg->told == PUSH_WATCH_OPEN) {
            count_up(&leg->unchanged_in_row);
        } else {
            leg->unchanged_in_row = 0;
        }
        leg->told = 0;
    }
}

enum push_outcome push_watch_end(struct push_watch *watch, enum side side)
{
    struct push_leg *leg = &watch->leg[side];
    const enum push_outcome outcome = judge(leg);
    judge_report(leg);
    /* A stance whose end was not seen says nothing, unless it was given. */
    if (outcome != PUSH_NONE && (leg->struck || outcome == PUSH_GIVEN)) {
        count(&leg->count[outcome]);
        leg->last = (uint8_t)outcome;
        if (outcome == PUSH_GIVEN) {
            watch->missed_in_row = 0;
        } else {
            count_up(&watch->missed_in_row);
        }
        forget(leg);
        return outcome;
    }
    forget(leg);
    return PUSH_NONE;
}
