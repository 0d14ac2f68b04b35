#include "controller/actuation/push_watch.h"

static void count(uint32_t *counter)
{
    if (*counter < UINT32_MAX) {
        (*counter)++;
    }
}

static void forget(struct push_leg *leg)
{
    leg->prescribed = leg->waited = leg->armed = false;
    leg->opened = leg->struck = leg->loaded = false;
}

void push_watch_begin(struct push_watch *watch)
{
    for (int side = 0; side < SIDE_COUNT; side++) {
        forget(&watch->leg[side]);
    }
    watch->missed_in_row = 0;
}

void push_watch_prescribe(struct push_watch *watch, enum side side)
{
    (void)push_watch_end(watch, side);
    watch->leg[side].prescribed = true;
}

void push_watch_tick(struct push_watch *watch, enum side side, bool armed, bool waits, bool behind,
                     enum latch_state latch)
{
    struct push_leg *leg = &watch->leg[side];
    if (behind) {
        count(&leg->behind_ticks);
    }
    if (!leg->prescribed) {
        return;
    }
    leg->waited = waits;
    leg->armed = leg->armed || armed;
    /* A drive that does not tell of its latch is believed. */
    leg->opened = leg->opened || (leg->armed && latch != LATCH_CLOSED);
}

void push_watch_strike(struct push_watch *watch, enum side side, bool loaded)
{
    struct push_leg *leg = &watch->leg[side];
    if (leg->prescribed && !leg->struck) {
        leg->struck = true;
        leg->loaded = loaded;
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
    return leg->loaded || leg->armed ? PUSH_NOT_RELEASED : PUSH_NOT_LOADED;
}

enum push_outcome push_watch_end(struct push_watch *watch, enum side side)
{
    struct push_leg *leg = &watch->leg[side];
    const enum push_outcome outcome = judge(leg);
    /* A stance whose end was not seen says nothing, unless it was given. */
    if (outcome != PUSH_NONE && (leg->struck || outcome == PUSH_GIVEN)) {
        count(&leg->count[outcome]);
        leg->last = (uint8_t)outcome;
        if (outcome == PUSH_GIVEN) {
            watch->missed_in_row = 0;
        } else if (watch->missed_in_row < UINT8_MAX) {
            watch->missed_in_row++;
        }
        forget(leg);
        return outcome;
    }
    forget(leg);
    return PUSH_NONE;
}
