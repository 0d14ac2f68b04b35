#include "controller/supervisor.h"

#define IN(state) ((uint16_t)(1u << SUPERVISOR_##state))
#define IF(condition) ((uint16_t)SUPERVISOR_IF_##condition)
#define ASSISTING ((uint16_t)(IN(ENGAGING) | IN(WALKING)))

const struct supervisor_row supervisor_rows[SUPERVISOR_ROWS] = {
    /* stop rules */
    {ASSISTING, IF(FAULT), 0, SUPERVISOR_UNLOADING},
    {IN(SELF_TEST) | IN(STANDBY), IF(FAULT), 0, SUPERVISOR_FAULT},
    {IN(UNLOADING), IF(LATCHED) | IF(UNLOADED), 0, SUPERVISOR_FAULT},
    {IN(UNLOADING), IF(TIMEOUT), 0, SUPERVISOR_FAULT},
    {ASSISTING, 0, IF(WALK_REQUESTED), SUPERVISOR_UNLOADING},
    {IN(WALKING), 0, IF(STEPPING), SUPERVISOR_UNLOADING},
    /* state rules */
    {IN(UNLOADING), IF(UNLOADED), 0, SUPERVISOR_STANDBY},
    {IN(INIT), IF(NODES), IF(FAULT), SUPERVISOR_SELF_TEST},
    {IN(SELF_TEST), IF(PLAUSIBLE), IF(FAULT), SUPERVISOR_STANDBY},
    {IN(STANDBY), IF(WALK_REQUESTED) | IF(PLAUSIBLE) | IF(NODES), IF(FAULT), SUPERVISOR_ENGAGING},
    {IN(ENGAGING), IF(ENABLED) | IF(STEPPING), 0, SUPERVISOR_WALKING},
    {IN(FAULT), IF(RESET) | IF(STANDSTILL), IF(FAULT), SUPERVISOR_INIT},
};

void supervisor_init(struct supervisor *supervisor)
{
    *supervisor = (struct supervisor){SUPERVISOR_INIT, SUPERVISOR_FAULT_NONE, 0};
}

bool supervisor_update(struct supervisor *supervisor, uint32_t tick, uint16_t conditions,
                       enum supervisor_fault fault)
{
    const bool faulty = (conditions & IF(FAULT)) != 0;
    const bool counts = supervisor->state != SUPERVISOR_INIT;
    if (faulty && counts && supervisor->latched == SUPERVISOR_FAULT_NONE) {
        supervisor->latched = fault;
    }
    uint16_t all = (uint16_t)(conditions & ~IF(LATCHED));
    if (supervisor->latched != SUPERVISOR_FAULT_NONE) {
        all = (uint16_t)(all | IF(LATCHED));
    }
    for (int i = 0; i < SUPERVISOR_ROWS; i++) {
        const struct supervisor_row *row = &supervisor_rows[i];
        if ((row->from & (1u << supervisor->state)) != 0 &&
            (all & row->require) == row->require && (all & row->forbid) == 0) {
            supervisor->state = row->to;
            supervisor->since_tick = tick;
            if (row->to == SUPERVISOR_INIT) {
                supervisor->latched = SUPERVISOR_FAULT_NONE;
            }
            return true;
        }
    }
    return false;
}

bool supervisor_may_enable(enum supervisor_state state)
{
    return (ASSISTING | IN(UNLOADING)) & (1u << state);
}

bool supervisor_may_assist(enum supervisor_state state)
{
    return ASSISTING & (1u << state);
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
                                                         "bad parameters"};
    return (unsigned)fault < SUPERVISOR_FAULTS ? names[fault] : "unknown";
}
