/* The control task: one object code for the orthosis, the laptop, the emulator
 * and the replay.
 *
 * A tick, from the task's point of view:
 *   - control_task_start_cycle() queues SYNC k (a timer's doing, or lock-step's);
 *   - control_task_poll() fetches frames; at its own SYNC k, as seen on the bus, it
 *     runs the controller on exactly the frames between SYNC k-1 and SYNC k (the
 *     answers sampled at SYNC k-1) and sends the commands right behind SYNC k;
 *   - drives obey them at SYNC k+1.
 * So the order of frames in a log defines what the controller saw, and a replay
 * reproduces every command. Nothing here knows a clock or an operating system.
 */
#ifndef FIRMWARE_CONTROL_TASK_H
#define FIRMWARE_CONTROL_TASK_H

#include <stdbool.h>
#include <stdint.h>

#include "controller/controller.h"
#include "firmware/bring_up.h"
#include "firmware/controller_node.h"
#include "firmware/drive_audit.h"
#include "firmware/drive_care.h"
#include "firmware/drive_watch.h"
#include "firmware/tool_watch.h"
#include "hal/bus/can_bus.h"
#include "hal/canopen/network.h"
#include "hal/devices/leg_sensors.h"
#include "hal/devices/sea_drives.h"
#include "hal/emergency_stop.h"
#include "model/tick.h"

/* What control_task_poll did; the bits feed the watchdog's gate. */
enum control_task_progress {
    CONTROL_TASK_COMMANDED = 1 << 0,  /* the bus took a tick's commands for the drives */
    CONTROL_TASK_BUS_ALIVE = 1 << 1,  /* the own SYNC was seen on the bus */
    CONTROL_TASK_SUPERVISED = 1 << 2, /* the supervisor went through its rules for this tick */
    CONTROL_TASK_NEW_STEP = 1 << 3,   /* task->controller.last_step is new */
    CONTROL_TASK_TICKED = 1 << 4      /* a tick was run; feeds nothing */
};

struct control_task_config {
    const struct control_params *params; /* copied; in force are node.objects.params */
    struct can_bus bus;
    struct sea_drives drives;
    struct emergency_stop stop;
    struct leg_sensor_config leg_sensor[SIDE_COUNT];
    struct node_setup_config setup;          /* what the nodes are told, and must be like */
    struct derate_limits limits[SIDE_COUNT]; /* of the drives; control_task_describe fills them */
    bool configure_nodes;                    /* false: nodes of another protocol than CANopen */
    float desired_speed_rad_s;               /* at the start; forward apex speed */
    bool walk_requested;                     /* at the start */
};

struct control_task {
    struct control_task_config config;
    struct network network;
    struct bring_up bring_up; /* of the network's nodes */
    struct drive_watch watch;
    struct tool_watch tools;
    struct drive_audit audit;
    struct leg_sensors sensors;
    struct controller_node node; /* commands, parameters and telemetry over CAN */
    struct controller controller;
    struct controller_output output; /* of the last tick */
    uint32_t tick;       /* number of the last own SYNC seen; 0 = none yet; wraps after 49 days */
    uint64_t now_ns;     /* since the task's start, in periods of SYNC; does not wrap */
    uint16_t sync_waits; /* cycles the SYNC under way has been waited for; 0 = none is */
    bool foreign;        /* in this tick: another node sends with an identifier of ours */
    bool emergency_stop; /* as used in the last tick, and as sent */
};

/* Prepares the task; nothing is sent yet. *config is copied, what it points to
 * stays the caller's. Returns CONTROL_PARAMS_OK or what control_params_validate
 * says; then the task must not be used. */
int control_task_init(struct control_task *task, const struct control_task_config *config);

/* Tells an initialised task what hangs on the bus: shown in 0x2050 to 0x2053, with the limits of its
 * drives (drive_care.h). *device must have passed device_check; copied. Start-up only; O(1). */
void control_task_describe(struct control_task *task, const struct device_description *device);

/* Queues the SYNC of the next cycle. Loop only. Returns what the bus says; CAN_FULL, and
 * nothing is queued, while the last one has not been on the bus (for at most
 * CONTROL_TASK_SYNC_WAIT cycles, and not while the bus is off): after a blocked bus there must
 * be no burst of ticks. */
enum can_result control_task_start_cycle(struct control_task *task);
enum { CONTROL_TASK_SYNC_WAIT = TICKS_OF_MS(5000) };

/* A walk asked for at power-on begins no earlier than this tick. Setting up the nodes takes
 * longer on one bus than on another; from here on the same walk has the same frames. A number of
 * ticks, not a time: the set-up takes an SDO transfer a tick. */
enum { CONTROL_TASK_START_TICK = 600 };

/* Fetches waiting frames (at most CONTROL_TASK_POLL_FRAMES a call) and runs a tick
 * for each own SYNC among them. Returns bits of enum control_task_progress.
 * Never blocks. Loop only. */
unsigned control_task_poll(struct control_task *task);
enum { CONTROL_TASK_POLL_FRAMES = 64 };

/* True when the hardware must take the drives' power (drive_watch.h). */
static inline bool control_task_power_must_go(const struct control_task *task)
{
    return drive_watch_power_must_go(&task->watch);
}

/* How many ticks the main's clock has missed since the start, for object 0x2020. Loop only. */
static inline void control_task_show_missed(struct control_task *task, uint32_t missed_ticks)
{
    task->node.objects.counters.missed_ticks = missed_ticks;
}

/* True when all four answers to the last SYNC have arrived: lock-step may start
 * the next cycle. */
bool control_task_cycle_complete(const struct control_task *task);

/* Notes how many cycles of the processor a tick took, interrupts included and sleep left out; the
 * most is shown at 0x2020:28. Loop only; O(1). */
void control_task_show_cycles(struct control_task *task, uint32_t cycles);

/* True when the last tick had more to do than others. What can wait for a quieter one waits; what the wearer
 * asks for does not. That is so in a tick with one of these:
 *   - a gait event (apex, heel strike, lift-off), a step, or a part of the apex' work (gait_observer.h);
 *   - a node that is being set up, or that is asked for its settings (drive_audit.h);
 *   - the drives' temperature and supply looked through (drive_care.h);
 *   - the begin of a single support, as the model observer counts it. O(1). */
bool control_task_was_busy(const struct control_task *task);

#endif
