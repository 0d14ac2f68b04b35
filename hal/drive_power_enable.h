/* The controller's two words about the drives' power.
 *
 * A line that must toggle: a charge pump behind it holds one channel of the safety relay in
 * the drives' safe torque off. Whatever ends the toggling lets the relay fall: a processor
 * that hangs or is in reset, a broken wire, and the firmware itself when a drive no
 * longer does what it is told and no frame can help (firmware/README.md). The relay waits
 * before it falls, for the drives to unload by themselves.
 *
 * A line that is high to take the torque at once: for that last case alone, where nobody
 * unloads any more. In reset and at the start it is low, and a broken wire reads as low:
 * then only the relay's wait is added.
 */
#ifndef HAL_DRIVE_POWER_ENABLE_H
#define HAL_DRIVE_POWER_ENABLE_H

#include <stdbool.h>

struct drive_power_enable_ops {
    /* Turns the first line over: once a tick that feeds the watchdog. Loop only; O(1). */
    void (*toggle)(void *context);
    /* Sets the second line: true takes the torque now. Loop only; O(1). */
    void (*cut)(void *context, bool cut);
};

struct drive_power_enable {
    const struct drive_power_enable_ops *ops;
    void *context;
};

static inline void drive_power_enable_toggle(const struct drive_power_enable *enable)
{
    enable->ops->toggle(enable->context);
}

static inline void drive_power_enable_cut(const struct drive_power_enable *enable, bool cut)
{
    enable->ops->cut(enable->context, cut);
}

#endif
