/* The whole device but its board: settings, control task, black box, watchdog gate.
 *
 * Both boards run this; only their mains know which port is behind the interfaces.
 *   start:  orthosis_init
 *   tick:   orthosis_start_cycle, when the clock says so
 *   always: orthosis_poll
 */
#ifndef FIRMWARE_ORTHOSIS_H
#define FIRMWARE_ORTHOSIS_H

#include <stdbool.h>
#include <stdint.h>

#include "firmware/bus_recorder.h"
#include "firmware/bus_recovery.h"
#include "firmware/control_task.h"
#include "firmware/drive_power.h"
#include "firmware/program_update.h"
#include "firmware/settings.h"
#include "hal/clock.h"
#include "hal/devices/device_drives.h"
#include "hal/storage/param_store.h"
#include "hal/storage/program_slots.h"
#include "hal/sync_pulse.h"
#include "hal/watchdog.h"
#include "hal/wearer_panel.h"

/* Words of the program that a tick looks at: 260 instructions, 64 KiB in 9 s. */
enum { ORTHOSIS_PROGRAM_WORDS = 1 };

struct orthosis_config {
    struct can_bus bus;
    struct emergency_stop stop;
    const struct watchdog *watchdog;
    /* Its time is looked at while the loop is held up for long; NULL: nobody feeds then. */
    const struct clock *clock;
    const struct drive_power_enable *drive_power; /* NULL: the board has none */
    const struct wearer_panel *wearer;            /* NULL: the board has none */
    const struct sync_pulse *sync_pulse;          /* given at each mark (0x2000:7); NULL: none */
    const struct nv_store *nv;
    const struct program_slots *program; /* where the program lies; NULL: nobody looks after it */
    /* Called at the end of ticks with little to do; in INIT and FAULT after 14 others, too. Or NULL. */
    void (*in_quiet_ticks)(void);
    struct black_box *black_box; /* in memory that a reset does not clear */
    struct crash_record *crash;  /* as the last run left it, in such memory too; may be NULL */
    struct crash_streak *streak; /* likewise; NULL: no start is known to be power-on */
    bool restarted;              /* after a crash or by the watchdog: stay in the safe state */
};

struct orthosis {
    struct param_store store;
    enum param_store_result store_result; /* of reading the settings */
    enum settings_result settings_result; /* of checking them */
    struct settings settings;             /* as they were at the start */
    struct device_drives drives;
    struct control_task task;
    struct bus_recorder recorder;
    struct watchdog_gate gate;
    struct drive_power drive_power;
    const struct wearer_panel *wearer;
    struct crash_streak *streak;
    const struct watchdog *watchdog;
    const struct clock *clock;
    const struct program_slots *program;
    struct program_scan program_scan;
    void (*in_quiet_ticks)(void);
    uint32_t looked_at_tick; /* at the begin of the last cycle */
    uint32_t unlooked_ticks; /* since it looked after itself; wraps */
    bool program_damaged;
    uint32_t program_rounds; /* that found it whole; saturates */
    struct program_update update;
    uint64_t fed_ns;                    /* the watchdog, while settings are saved or forgotten */
    enum supervisor_fault forced_fault; /* keeps this fault latched for good; NONE = does not */
    struct bus_recovery recovery;
    uint32_t walk_at_start; /* of the settings; obeyed at power-on only */
};

/* Reads the settings and prepares everything; sends nothing. With no usable
 * settings the device runs, talks and stays in SUPERVISOR_FAULT with "bad parameters". So it
 * does with "restarted by itself", without reading them, after CRASH_STREAK_LIMIT crashes in a
 * row (0x2032:3, an emergency). After fewer it begins in SUPERVISOR_FAULT too, but a reset
 * request lifts that. Settings that ask for a walk are obeyed at power-on only, which is when the
 * streak's memory was not kept. *config is
 * copied, what it points to stays the caller's. Start-up only. */
void orthosis_init(struct orthosis *orthosis, const struct orthosis_config *config);

/* Queues the next SYNC; when the bus is off, asks for recovery now and then.
 * Loop only. */
void orthosis_start_cycle(struct orthosis *orthosis);

/* True once the program in flash was found to be another than the one that was written: nothing it
 * does can be trusted any more, and the main must reset into the starter. O(1). */
static inline bool orthosis_program_is_damaged(const struct orthosis *orthosis)
{
    return orthosis->program_damaged;
}

/* True once a new program was ordered and its answer has left: the main resets. O(1). */
static inline bool orthosis_wants_restart(const struct orthosis *orthosis)
{
    return orthosis->update.restart_now;
}

/* Runs what is due, records, feeds the watchdog when all made progress, and with it lets the
 * drives have power. Until the first own SYNC came back it feeds at every call, and they have
 * none. Returns what control_task_poll returns. Loop only. */
unsigned orthosis_poll(struct orthosis *orthosis);

#endif
