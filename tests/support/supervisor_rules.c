#include "tests/support/supervisor_rules.h"

#include <stdbool.h>
#include <stddef.h>

#define HAS(condition) ((conditions & SUPERVISOR_IF_##condition) != 0)

enum supervisor_state supervisor_rule(enum supervisor_state state, unsigned conditions)
{
    switch (state) {
    case SUPERVISOR_INIT:
        /* Waits for the nodes; what is wrong meanwhile only makes it wait, but not for
         * ever once they are there. */
        if (!HAS(NODES)) {
            return state;
        }
        if (!HAS(FAULT)) {
            return SUPERVISOR_SELF_TEST;
        }
        return HAS(TIMEOUT) ? SUPERVISOR_FAULT : state;
    case SUPERVISOR_SELF_TEST:
        if (HAS(FAULT)) {
            return SUPERVISOR_FAULT;
        }
        if (HAS(PLAUSIBLE)) {
            return SUPERVISOR_STANDBY;
        }
        return HAS(TIMEOUT) ? SUPERVISOR_FAULT : state;
    case SUPERVISOR_STANDBY:
        if (HAS(FAULT)) {
            return SUPERVISOR_FAULT;
        }
        if (!HAS(PLAUSIBLE)) {
            return state;
        }
        if (HAS(WALK_REQUESTED)) {
            return SUPERVISOR_ENGAGING;
        }
        return HAS(MOTION_REQUESTED) ? SUPERVISOR_COMMISSIONING : state;
    case SUPERVISOR_ENGAGING:
        if (HAS(FAULT) || !HAS(WALK_REQUESTED)) {
            return SUPERVISOR_UNLOADING;
        }
        if (HAS(ENABLED) && HAS(STEADY)) {
            return SUPERVISOR_WALKING;
        }
        return HAS(TIMEOUT) ? SUPERVISOR_UNLOADING : state;
    case SUPERVISOR_WALKING:
        return HAS(FAULT) || !HAS(WALK_REQUESTED) || !HAS(STEPPING) || !HAS(REGULAR)
                   ? SUPERVISOR_UNLOADING
                   : state;
    case SUPERVISOR_UNLOADING:
        if (HAS(UNLOADED)) {
            return HAS(LATCHED) ? SUPERVISOR_FAULT : SUPERVISOR_STANDBY;
        }
        return HAS(TIMEOUT) ? SUPERVISOR_FAULT : state;
    case SUPERVISOR_COMMISSIONING:
        return HAS(FAULT) || !HAS(MOTION_REQUESTED) || HAS(WALK_REQUESTED) ? SUPERVISOR_UNLOADING
                                                                           : state;
    case SUPERVISOR_FAULT:
        return HAS(RESET) && HAS(STANDSTILL) && !HAS(FAULT) ? SUPERVISOR_INIT : state;
    default:
        return state;
    }
}

static enum supervisor_state go(const struct supervisor_row *rows, int count, int state, unsigned c)
{
    return supervisor_next(rows, count, (enum supervisor_state)state, (uint16_t)c);
}

unsigned supervisor_reachable(const struct supervisor_row *rows, int count, unsigned *pairs)
{
    unsigned reached = 1u << SUPERVISOR_INIT, before = 0;
    *pairs = 0;
    while (reached != before) {
        before = reached;
        *pairs = 0;
        for (int state = 0; state < SUPERVISOR_STATES; state++) {
            if ((before & (1u << state)) == 0) {
                continue;
            }
            for (unsigned c = 0; c < SUPERVISOR_INPUTS; c++) {
                reached |= 1u << go(rows, count, state, c);
                (*pairs)++;
            }
        }
    }
    return reached;
}

/* Properties of one transition; they hold whatever the prose says in detail. */
static const char *judge(int from, int to, unsigned conditions)
{
    const bool fault = HAS(FAULT) || HAS(LATCHED);
    if (to < 0 || to >= SUPERVISOR_STATES) {
        return "leaves the states there are";
    }
    if (HAS(FAULT) && supervisor_may_assist((enum supervisor_state)to)) {
        return "loads springs while something is wrong";
    }
    if (supervisor_may_assist((enum supervisor_state)from) && to != from &&
        to != SUPERVISOR_WALKING && to != SUPERVISOR_UNLOADING) {
        return "leaves a loaded spring without unloading it";
    }
    if (to == SUPERVISOR_WALKING && from != to && from != SUPERVISOR_ENGAGING) {
        return "walks without engaging";
    }
    if (to == SUPERVISOR_WALKING && from != to && !(HAS(ENABLED) && HAS(STEADY))) {
        return "walks without enabled drives or verified steps";
    }
    if (to == SUPERVISOR_ENGAGING && from != to &&
        !(from == SUPERVISOR_STANDBY && HAS(PLAUSIBLE) && HAS(WALK_REQUESTED))) {
        return "engages without being asked, or without the checks";
    }
    if (to == SUPERVISOR_COMMISSIONING &&
        (HAS(FAULT) || HAS(WALK_REQUESTED) || !HAS(MOTION_REQUESTED))) {
        return "moves for a tool that is not there, for a walk, or with a fault";
    }
    if (to == SUPERVISOR_COMMISSIONING && from != to &&
        !(from == SUPERVISOR_STANDBY && HAS(PLAUSIBLE))) {
        return "commissions without the checks";
    }
    if (from == SUPERVISOR_COMMISSIONING && to != from && to != SUPERVISOR_UNLOADING) {
        return "leaves a motion without unloading";
    }
    if (to == SUPERVISOR_STANDBY && from == SUPERVISOR_UNLOADING && fault && HAS(LATCHED)) {
        return "forgets a fault";
    }
    if (from == SUPERVISOR_FAULT && to != from &&
        !(to == SUPERVISOR_INIT && HAS(RESET) && HAS(STANDSTILL) && !HAS(FAULT))) {
        return "leaves a fault without a reset at standstill";
    }
    if (from == SUPERVISOR_UNLOADING && to == from && (HAS(TIMEOUT) || HAS(UNLOADED))) {
        return "unloads for ever";
    }
    if (from == SUPERVISOR_ENGAGING && to == from && HAS(TIMEOUT)) {
        return "engages for ever";
    }
    return NULL;
}

/* From every state, under inputs in which nothing is wrong and everybody does what is
 * asked, WALKING is reached in a bounded number of ticks; with a fault that stays, a state
 * without torque is. */
static const char *judge_progress(const struct supervisor_row *rows, int count)
{
    const unsigned good = (unsigned)(SUPERVISOR_INPUTS - 1) &
                          ~(unsigned)(SUPERVISOR_IF_FAULT | SUPERVISOR_IF_LATCHED);
    const unsigned bad = SUPERVISOR_IF_FAULT | SUPERVISOR_IF_LATCHED | SUPERVISOR_IF_TIMEOUT;
    for (int from = 0; from < SUPERVISOR_STATES; from++) {
        int well = from, ill = from;
        for (int tick = 0; tick < 2 * SUPERVISOR_STATES; tick++) {
            well = (int)go(rows, count, well, good);
            ill = (int)go(rows, count, ill, bad);
        }
        if (well != SUPERVISOR_WALKING) {
            return "locks up";
        }
        if (supervisor_may_enable((enum supervisor_state)ill)) {
            return "keeps the torque on with a fault";
        }
    }
    return NULL;
}

const char *supervisor_examine(const struct supervisor_row *rows, int count)
{
    unsigned pairs;
    for (int state = 0; state < SUPERVISOR_STATES; state++) {
        for (unsigned conditions = 0; conditions < SUPERVISOR_INPUTS; conditions++) {
            const enum supervisor_state to = go(rows, count, state, conditions);
            const char *wrong = judge(state, (int)to, conditions);
            if (wrong != NULL) {
                return wrong;
            }
            if (to != supervisor_rule((enum supervisor_state)state, conditions)) {
                return "differs from the prose";
            }
        }
    }
    if (supervisor_reachable(rows, count, &pairs) != (1u << SUPERVISOR_STATES) - 1) {
        return "a state is never reached";
    }
    return judge_progress(rows, count);
}
