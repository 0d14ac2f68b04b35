/* The control task with its drives, as every host program sets it up: in the
 * loop, on SocketCAN, on a replayed log. One place, so that they cannot differ.
 */
#ifndef SIM_HOST_SUBJECTS_HOST_TASK_H
#define SIM_HOST_SUBJECTS_HOST_TASK_H

#include "firmware/control_task.h"
#include "firmware/drive_power.h"
#include "hal/devices/device_drives.h"
#include "hal/watchdog.h"
#include "sim_host/subjects/subject.h"

struct host_task {
    struct control_params params;
    struct device_drives drives;
    struct control_task task;
    bool stop_pressed;              /* what the task's emergency stop input reads */
    struct watchdog_gate gate;      /* before no watchdog */
    struct drive_power drive_power; /* without lines, until somebody wires it (drive_power_init) */
};

/* Whether all drives are CANopen nodes, whose frames are those of the frame table. */
bool host_task_configures(const struct subject *subject);

/* Sets up the task for a subject on a bus; the bus's context must outlive the
 * rig. Do not move the rig afterwards. Returns CONTROL_PARAMS_OK, or what
 * control_task_init says. */
int host_task_init(struct host_task *rig, const struct subject *subject,
                   const struct control_params *params, struct can_bus bus,
                   double desired_speed_rad_s, bool walk_requested);

/* control_task_poll(), and the drives' power lines behind it, as orthosis_poll() does on a board. */
unsigned host_task_poll(struct host_task *rig);

#endif
