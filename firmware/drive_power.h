/* Whether the drives may have power, from what a tick was: the board and the simulated board ask here alike.
 *
 * The power may stay while the watchdog is fed and the drives can be trusted (drive_watch.h). Where one cannot, the
 * line that must toggle stands still, and the line that takes the torque at once rises. It is set anew in each such tick:
 * a write that was lost is made up for.
 */
#ifndef FIRMWARE_DRIVE_POWER_H
#define FIRMWARE_DRIVE_POWER_H

#include <stdbool.h>

#include "firmware/control_task.h"
#include "hal/drive_power_enable.h"

struct drive_power {
    const struct drive_power_enable *lines; /* the caller's; NULL: the board has none */
    bool is_cut;
};

static inline void drive_power_init(struct drive_power *power,
                                    const struct drive_power_enable *lines)
{
    power->lines = lines;
    power->is_cut = false;
}

/* Once behind each control_task_poll() that ticked; `fed`: the watchdog's gate let a feed through. Loop only;
 * O(1). */
void drive_power_update(struct drive_power *power, const struct control_task *task, bool fed);

#endif
