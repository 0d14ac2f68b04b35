/* The controller's word that the drives may have power.
 *
 * A line that must toggle: a charge pump behind it holds one channel of the safety relay in
 * the drives' safe torque off. Whatever ends the toggling lets the relay fall: a processor
 * that hangs or is in reset, a broken wire, and the firmware itself when a drive no
 * longer does what it is told and no frame can help (firmware/README.md).
 */
#ifndef HAL_DRIVE_POWER_ENABLE_H
#define HAL_DRIVE_POWER_ENABLE_H

struct drive_power_enable_ops {
    /* Turns the line over: once a tick that feeds the watchdog. Loop only; O(1). */
    void (*toggle)(void *context);
};

struct drive_power_enable {
    const struct drive_power_enable_ops *ops;
    void *context;
};

static inline void drive_power_enable_toggle(const struct drive_power_enable *enable)
{
    enable->ops->toggle(enable->context);
}

#endif
