#include "controller/supervisor/step_monitor.h"

/* A step may differ from the ones before by one part in so many. */
enum { TOLERANCE_DIVISOR = 3 };

static bool is_alike(uint32_t a, uint32_t b)
{
    const uint32_t greater = a > b ? a : b;
    const uint32_t smaller = a > b ? b : a;
    return greater - smaller <= greater / TOLERANCE_DIVISOR;
}

static uint32_t counted(uint32_t count)
{
    return count < UINT32_MAX ? count + 1 : count;
}

void step_monitor_init(struct step_monitor *monitor)
{
    *monitor = (struct step_monitor){0};
}

bool step_monitor_update(struct step_monitor *monitor, const struct gait_state *gait, uint32_t tick)
{
    const struct gait_event *apex = &gait->event[GAIT_APEX];
    const struct gait_event *strike = &gait->event[GAIT_HEEL_STRIKE];
    if (strike->happened && monitor->seen && strike->side != monitor->side &&
        monitor->strikes < UINT8_MAX) {
        monitor->strikes++;
    }
    if (gait->walk_denied) {
        monitor->steady = 0;
        monitor->unsteady = STEP_MONITOR_IRREGULAR;
    }
    if (!apex->happened) {
        return false;
    }
    const uint32_t lasted = monitor->seen ? apex->tick - monitor->apex_tick : 0;
    const uint32_t *before = monitor->step_ticks;
    monitor->same_side = monitor->seen && apex->side == monitor->side;
    const bool steady = gait->walk_shown && lasted > 0 && !monitor->same_side &&
                        monitor->strikes == 1 && before[0] > 0 && is_alike(lasted, before[0]) &&
                        (before[1] == 0 || is_alike(lasted, before[1]));
    monitor->steady = steady ? counted(monitor->steady) : 0;
    monitor->unsteady = steady ? 0 : counted(monitor->unsteady);
    monitor->step_ticks[1] = before[0];
    monitor->step_ticks[0] = lasted;
    monitor->apex_tick = apex->tick;
    monitor->known_tick = tick;
    monitor->side = apex->side;
    monitor->strikes = 0;
    monitor->seen = true;
    return true;
}
