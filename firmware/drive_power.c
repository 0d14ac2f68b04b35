#include "firmware/drive_power.h"

void drive_power_update(struct drive_power *power, const struct control_task *task, bool fed)
{
    const struct drive_power_enable *lines = power->lines;
    const bool must_go = control_task_power_must_go(task);

    if (lines == NULL) {
        return;
    }
    if (must_go || power->is_cut) {
        power->is_cut = must_go;
        drive_power_enable_cut(lines, must_go);
    }
    if (fed && !must_go) {
        drive_power_enable_toggle(lines);
    }
}
