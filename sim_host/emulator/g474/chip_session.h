/* A walk with the emulated chip as its control task, and the faults that it can meet. */
#ifndef SIM_HOST_EMULATOR_G474_CHIP_SESSION_H
#define SIM_HOST_EMULATOR_G474_CHIP_SESSION_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "controller/supervisor/supervisor.h"
#include "hal/storage/crash_record.h"
#include "sim_host/emulator/g474/chip_bridge.h"
#include "sim_host/emulator/g474/chip_cuts.h"
#include "sim_host/loop/walk_record.h"

enum chip_fault {
    CHIP_FAULT_NONE,
    CHIP_FAULT_EMERGENCY_STOP,
    CHIP_FAULT_LOST_SENSOR,
    CHIP_FAULT_LOST_DRIVE,
    CHIP_FAULT_DRIVE_HANGS,
    CHIP_FAULT_DESTROYED_FRAMES,
    CHIP_FAULT_HANG,
    CHIP_FAULT_CRYSTAL_STOPS,
    CHIP_FAULT_NO_CRYSTAL,
    CHIP_FAULT_TORN_SETTINGS,
    CHIP_FAULT_ECC,
    CHIP_FAULT_SAVE_CUT,
    CHIP_FAULT_LOAD_CUT,
    CHIP_FAULT_LOST_WRITE,
    CHIP_FAULT_HALF_WRITTEN,
    CHIP_FAULT_DAMAGED_PROGRAM,
    CHIP_FAULT_STUCK_RAM,
    CHIP_FAULT_FIRST_START,
    CHIP_FAULT_OPTIONS_CUT,
    CHIP_FAULT_SUPPLY_LOW,
    CHIP_FAULT_BROWN_OUT,
    CHIP_FAULT_RAM_SLICE,
    CHIP_FAULT_RAM_PARITY,
    CHIP_FAULT_CORE_REGISTER,
    CHIP_FAULT_FLOAT_REGISTER,
    CHIP_FAULT_SLOW_OSCILLATOR,
    CHIP_FAULT_FAST_OSCILLATOR,
    CHIP_FAULT_DEEP_STACK,
    CHIP_FAULT_FLASH_CORRECTED,
    CHIP_FAULT_EARLY_FEED,
    CHIP_FAULT_RUN_RAM,
    CHIP_FAULT_WRITE_PROGRAM,
    CHIP_FAULT_FIRST_STORE,
    CHIP_FAULT_DIRTY_RAM,
    CHIP_FAULT_MARK,
    CHIP_FAULT_UPDATE,
    CHIP_FAULT_UPDATE_OLDER,
    CHIP_FAULT_UPDATE_OTHER_BOARD,
    CHIP_FAULT_UPDATE_WALKING,
    CHIP_FAULT_UPDATE_CUT,
    CHIP_FAULT_COUNT
};

struct chip_fault_kind {
    const char *name;
    /* What the image must say in the end; others that are as right are bits of `or_latched`. */
    enum supervisor_fault latched;
    uint32_t or_latched;
    enum crash_cause crash; /* the record it must leave; likewise bits of `or_crash` */
    const char
        *says; /* it does not run in the end, and the virtual COM port says so; NULL: it runs */
    uint32_t or_crash;
};

/* By enum chip_fault. */
extern const struct chip_fault_kind chip_faults[CHIP_FAULT_COUNT];

/* The pulses given for marks: their number, and the least and the most of each time. */
struct chip_marks {
    uint32_t count;
    uint32_t delay_us[2]; /* from the end of the mark's frame to the rising edge */
    uint32_t pulse_us[2]; /* to the falling one */
};

struct chip_session {
    /* Before chip_session_start: what to do. */
    uint32_t steps, fault_step;
    double seconds;    /* walks at least this long */
    bool is_recording; /* a recorded person walks: to the last step or the recording's end */
    enum chip_fault fault;
    struct chip_cuts cuts;              /* its `every` and `at` */
    uint32_t old_crc, new_crc, cut_crc; /* of programs: at first, ordered and running, sent */
    uint32_t params_crc;                /* of the settings in force before a cut */
    uint32_t lose;                      /* the register whose writes are lost */
    void (*on_step)(void *context, uint32_t steps); /* NULL = nobody */
    void *context;
    /* Its parts. */
    struct loop *loop;
    struct chip chip;
    struct chip_bridge bridge;
    struct walk_record record;
    struct can_bus tool; /* a port of its own, to ask the image over SDO */
    /* Results. */
    struct crash_record crash; /* as fetched over SDO at the end of a fault */
    struct chip_marks marks;
    uint64_t brought_ns, noticed_ns; /* the fault, and the reset that it led to; 0 = none */
    uint32_t told_corrected;         /* flash errors, as the image says at 0x2020:29 */
    uint32_t told_cycles;            /* of the worst tick, as the image says at 0x2020:28 */
    bool started, reached, fell, crash_known;
    char trouble[256];
};

/* Builds loop and chip; the settings of the loop's control task are in its parameter memory. The other
 * arguments as in chip_start and loop_init. Returns 0, or -1 with the reason in message
 * (LOOP_MESSAGE_MAX bytes). chip_session_free afterwards in either case. */
int chip_session_start(struct chip_session *session, const struct loop_config *config,
                       const char *core, const char *image, FILE *log, char *message);
void chip_session_free(struct chip_session *session);

/* To the last step, or to where the fault comes. */
void chip_session_walk(struct chip_session *session);
/* Lets so many periods pass. */
void chip_session_pass(struct chip_session *session, unsigned ticks);
/* Notes what is wrong; the first counts. */
void chip_session_complain(struct chip_session *session, const char *text);
/* Whether the fault is power that fails while the image writes its flash. */
bool chip_fault_is_cut(enum chip_fault fault);
/* Whether a new program is sent to the image, with or without a cut. */
bool chip_fault_is_update(enum chip_fault fault);
/* Length of the program in flash, as its header says. */
uint32_t chip_session_image_bytes(const struct chip *chip);

/* True when both springs are unloaded. */
bool chip_session_is_safe(const struct chip_session *session);
/* Walked, or reached the safe state; no frame differed, no peripheral was misused. */
bool chip_session_is_good(const struct chip_session *session);

#endif
