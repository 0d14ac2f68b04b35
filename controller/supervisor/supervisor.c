#include "controller/supervisor/supervisor.h"

#define IN(state) ((uint16_t)(1u << SUPERVISOR_##state))
#define IF(condition) ((uint16_t)SUPERVISOR_IF_##condition)
#define ASSISTING ((uint16_t)(IN(ENGAGING) | IN(WALKING)))
#define COMMISSIONING ((uint16_t)IN(COMMISSIONING))

const struct supervisor_row supervisor_rows[SUPERVISOR_ROWS] = {
    /* stop rules */
    {ASSISTING, IF(FAULT), 0, SUPERVISOR_UNLOADING},
    {COMMISSIONING, IF(FAULT), 0, SUPERVISOR_UNLOADING},
    {IN(SELF_TEST) | IN(STANDBY), IF(FAULT), 0, SUPERVISOR_FAULT},
    {IN(UNLOADING), IF(LATCHED) | IF(UNLOADED), 0, SUPERVISOR_FAULT},
    {ASSISTING, 0, IF(WALK_REQUESTED), SUPERVISOR_UNLOADING},
    {IN(WALKING), 0, IF(STEPPING), SUPERVISOR_UNLOADING},
    {IN(WALKING), 0, IF(REGULAR), SUPERVISOR_UNLOADING},
    {COMMISSIONING, 0, IF(MOTION_REQUESTED), SUPERVISOR_UNLOADING},
    {COMMISSIONING, IF(WALK_REQUESTED), 0, SUPERVISOR_UNLOADING},
    /* state rules */
    {IN(UNLOADING), IF(UNLOADED), 0, SUPERVISOR_STANDBY},
    {IN(INIT), IF(NODES), IF(FAULT), SUPERVISOR_SELF_TEST},
    {IN(SELF_TEST), IF(PLAUSIBLE), 0, SUPERVISOR_STANDBY},
    {IN(STANDBY), IF(MOTION_REQUESTED) | IF(PLAUSIBLE), IF(WALK_REQUESTED),
     SUPERVISOR_COMMISSIONING},
    {IN(STANDBY), IF(WALK_REQUESTED) | IF(PLAUSIBLE), 0, SUPERVISOR_ENGAGING},
    {IN(ENGAGING), IF(ENABLED) | IF(STEADY), 0, SUPERVISOR_WALKING},
    {IN(FAULT), IF(RESET) | IF(STANDSTILL), IF(FAULT), SUPERVISOR_INIT},
    /* what took too long */
    {IN(UNLOADING), IF(TIMEOUT), 0, SUPERVISOR_FAULT},
    {IN(ENGAGING), IF(TIMEOUT), 0, SUPERVISOR_UNLOADING},
    {IN(SELF_TEST), IF(TIMEOUT), 0, SUPERVISOR_FAULT},
    {IN(INIT), IF(NODES) | IF(TIMEOUT), 0, SUPERVISOR_FAULT},
};

enum supervisor_state supervisor_next(const struct supervisor_row *rows, int count,
                                      enum supervisor_state state, uint16_t conditions)
{
    for (int i = 0; i < count; i++) {
        const struct supervisor_row *row = &rows[i];
        if ((row->from & (1u << state)) != 0 && (conditions & row->require) == row->require &&
            (conditions & row->forbid) == 0) {
            return row->to;
        }
    }
    return state;
}

void supervisor_init(struct supervisor *supervisor)
{
    *supervisor = (struct supervisor){SUPERVISOR_INIT, SUPERVISOR_FAULT_NONE, 0, 0};
}

/* What is latched when FAULT is entered because something took too long. */
static enum supervisor_fault overdue(enum supervisor_state state)
{
    return state == SUPERVISOR_SELF_TEST ? SUPERVISOR_FAULT_SELF_TEST : SUPERVISOR_FAULT_UNLOAD;
}

bool supervisor_update(struct supervisor *supervisor, uint32_t tick, uint16_t conditions,
                       enum supervisor_fault fault)
{
    const enum supervisor_state from = supervisor->state;
    uint16_t all = (uint16_t)(conditions & ~IF(LATCHED));
    if (from == SUPERVISOR_INIT && (conditions & IF(NODES)) == 0) {
        supervisor->since_tick = tick;
    }
    if ((conditions & IF(FAULT)) != 0 && from != SUPERVISOR_INIT &&
        supervisor->latched == SUPERVISOR_FAULT_NONE) {
        supervisor->latched = fault;
    }
    if (supervisor->latched != SUPERVISOR_FAULT_NONE) {
        all = (uint16_t)(all | IF(LATCHED));
    }
    const enum supervisor_state to = supervisor_next(supervisor_rows, SUPERVISOR_ROWS, from, all);
    supervisor->updated_tick = tick;
    if (to == from) {
        return false;
    }
    supervisor->state = to;
    supervisor->since_tick = tick;
    if (to == SUPERVISOR_INIT) {
        supervisor->latched = SUPERVISOR_FAULT_NONE;
    } else if (to == SUPERVISOR_FAULT && supervisor->latched == SUPERVISOR_FAULT_NONE) {
        supervisor->latched = (conditions & IF(FAULT)) != 0 ? fault : overdue(from);
    }
    return true;
}

void supervisor_force_fault(struct supervisor *supervisor, enum supervisor_fault fault)
{
    supervisor->state = SUPERVISOR_FAULT;
    supervisor->latched = fault;
}

const char *supervisor_fault_name(enum supervisor_fault fault)
{
    static const char *const names[SUPERVISOR_FAULTS] = {"none",
                                                         "emergency stop",
                                                         "node lost",
                                                         "leg sensor silent",
                                                         "drive silent",
                                                         "drive fault",
                                                         "sensor out of range",
                                                         "leg beyond the fall angle",
                                                         "bad parameters",
                                                         "sensor jumps",
                                                         "sensor stuck",
                                                         "spring implausible",
                                                         "self test",
                                                         "drive does not follow",
                                                         "legs disagree",
                                                         "value not finite",
                                                         "spring not unloaded in time",
                                                         "restarted by itself",
                                                         "foreign node on the bus",
                                                         "a tool wrote to a drive or sensor",
                                                         "a drive's setting has changed",
                                                         "the left latch's report does not change",
                                                         "the right latch's report does not change",
                                                         "sensors or latches misplaced"};
    return (unsigned)fault < SUPERVISOR_FAULTS ? names[fault] : "unknown";
}
