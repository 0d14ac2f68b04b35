/* Watches that the drives give up their torque when the supervisor says so.
 *
 * Two measures, the second without the bus: a drive that still follows its target is stopped
 * by NMT; when one stays silent or under torque, the hardware takes the drives' power.
 */
#ifndef FIRMWARE_DRIVE_WATCH_H
#define FIRMWARE_DRIVE_WATCH_H

#include <stdbool.h>
#include <stdint.h>

#include "controller/control_params.h"
#include "controller/signals.h"
#include "controller/supervisor/supervisor.h"
#include "hal/devices/sea_drives.h"
#include "model/tick.h"

/* Shares of the leg's length. So far behind its target a drive follows it, as tool_watch.h has it. By so little it
 * moves within DRIVE_WATCH_LED_TICKS: 4 mm/s at 1 m; 2 s at most for a spring of some cm ask for more. */
#define DRIVE_WATCH_BEHIND_RATIO 0.02f
#define DRIVE_WATCH_STILL_RATIO 0.0002f

enum {
    DRIVE_WATCH_HEARD_TICKS = TICKS_OF_MS(10), /* a drive that is led has answered so lately */
    DRIVE_WATCH_LED_TICKS = TICKS_OF_MS(50),  /* and has come nearer to an empty spring so lately */
    DRIVE_WATCH_STOP_TICKS = TICKS_OF_MS(50), /* enabled for so long in SUPERVISOR_FAULT */
    DRIVE_WATCH_POWER_TICKS = TICKS_OF_MS(500), /* longer than any unload by itself takes */
    /* A drive whose torque was taken reports that it is off. Its power stays away for so long, so that the safety
     * relay, which waits 400 ms, falls too, and comes back only when somebody starts it. */
    DRIVE_WATCH_HOLD_TICKS = TICKS_OF_MS(600)
};

struct drive_watch {
    uint16_t powered_ticks; /* a drive is silent or under torque for so long; then the hold's */
    uint8_t disobeys[SIDE_COUNT];    /* ticks a drive has been enabled in SUPERVISOR_FAULT */
    bool stops;                      /* the last tick was one of SUPERVISOR_UNLOADING or FAULT */
    uint8_t still_ticks[SIDE_COUNT]; /* ticks it has not come nearer to an empty spring */
    float nearest_m[SIDE_COUNT];     /* what it read then */
};

/* Once a tick, with the supervisor's state, what it asks of the drives, and the settings in force. Returns
 * the legs (bit 1 << side) whose drive must be stopped by NMT now: it still follows its target a while after
 * the torque was to be off, so it has not understood its controlword; stopped it unloads by itself (0x6007).
 * Loop only; O(1). */
unsigned drive_watch_update(struct drive_watch *watch, const struct sea_drives *drives,
                            enum supervisor_state state,
                            const struct sea_request request[SIDE_COUNT],
                            const struct control_params *params);

/* True when the hardware must take the drives' power: for DRIVE_WATCH_POWER_TICKS one has been silent in
 * SUPERVISOR_UNLOADING or FAULT, has held its spring in UNLOADING, or was under torque in FAULT; or it was so
 * less than DRIVE_WATCH_HOLD_TICKS ago, whatever the state is now. A tick in which each is off, or led, takes
 * one back from the count. O(1). */
static inline bool drive_watch_power_must_go(const struct drive_watch *watch)
{
    return watch->powered_ticks >= DRIVE_WATCH_POWER_TICKS;
}

#endif
