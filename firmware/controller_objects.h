/* The values that the controller's node shows and takes over CAN, and the tables that name
 * them: its object dictionary (controller_objects.c). Indices never change their meaning.
 */
#ifndef FIRMWARE_CONTROLLER_OBJECTS_H
#define FIRMWARE_CONTROLLER_OBJECTS_H

#include <stdint.h>

#include "controller/actuation/push_watch.h"
#include "controller/control_params.h"
#include "firmware/change_log.h"
#include "hal/canopen/co_od.h"
#include "hal/canopen/co_pdo_objects.h"
#include "hal/devices/device_description.h"
#include "hal/storage/black_box.h"
#include "model/side.h"

/* 0x2020: what was counted since the start; all saturate. */
struct controller_counters {
    /* The control task's. */
    uint32_t syncs_sent;    /* not in the dictionary */
    uint32_t syncs_refused; /* cycles whose SYNC the bus did not take: full or down */
    uint32_t
        send_failures; /* ticks with command frames that the bus did not take; those that a full queue
                               gave up later are in tx_refused */
    uint32_t error_frames;
    uint32_t foreign_frames;  /* received, nobody's */
    uint32_t late_answers;    /* operational legs, answers missing when their tick was processed */
    uint32_t forced_stops;    /* NMT stops: a drive stayed enabled, or a foreign node spoke */
    uint32_t foreign_uploads; /* SDO requests of others to drives and sensors that read */
    uint32_t foreign_downloads; /* ... and that write: a fault, once the node is set up */
    uint32_t audits_unanswered; /* read-backs of the drives' objects that were not answered */
    uint32_t missed_ticks; /* periods that ended while an earlier one waited: the main says so */
    /* Shown when they are asked for: the tick, and what others count. */
    uint32_t ticks, rx_malformed, tx_refused, rx_overflow, bus_off_count;
    uint32_t flash_corrected; /* single-bit errors that the flash's error correction mended */
    uint32_t worst_cycles;    /* of the processor in a tick; 0 where nobody counts them */
    /* The controller's: pushes by what became of them (enum push_outcome; [0] is not used), and ticks
     * in which a motor was far behind its reference. */
    uint32_t pushes[SIDE_COUNT][PUSH_OUTCOMES];
    uint32_t behind_ticks[SIDE_COUNT];
};

/* Objects of which something is brought up to date when they are read. */
enum {
    CONTROLLER_INDEX_STATE = 0x2001,
    CONTROLLER_INDEX_COUNTERS = 0x2020,
    CONTROLLER_INDEX_DRIVES = 0x2021
};

/* 0x2033: the board under the controller, as its main tells; all 0 where there is none. */
enum controller_board_bits {
    BOARD_BOOST = 1 << 0,        /* the core's regulator is in its boost mode */
    BOARD_SUPPLY_LOW = 1 << 1,   /* the chip's supply is below its detector's threshold */
    BOARD_STOP_CLOSED = 1 << 2,  /* the emergency stop's contact feeds its input */
    BOARD_PERMIT_MOVES = 1 << 3, /* the line that lets the drives have power toggles */
    BOARD_POWER_CUT = 1 << 4     /* the line that takes their torque at once is high */
};
struct controller_board {
    uint32_t clock_Hz, watchdog_clock_Hz; /* the latter measured by the former; 0 = not yet */
    uint32_t option_bytes, wanted_option_bytes;
    uint32_t reset_flags; /* RCC_CSR, bits 25 to 31 */
    uint8_t bits;
    uint32_t supply_dips, ram_rounds, program_rounds; /* tests that went through all of it */
};

/* Values of the dictionary's entries 0x2000 and above. */
struct controller_objects {
    uint8_t command_count, state_count, step_count, record_count, param_count, counter_count;
    uint8_t identity_count, setup_count;
    /* 0x2000: commands */
    float desired_speed_rad_s;
    uint8_t walk_requested;
    uint8_t reset_requested;
    uint8_t zero_requested;
    uint32_t unlock;       /* settings_lock.h; reads 0 */
    uint32_t mark;         /* the last one written, by number; each gives a sync pulse */
    uint8_t wearer_button; /* 1: pressed, beside the button at a pin, */
    uint8_t wearer_pin;    /* which is not in the dictionary but in the state's bit 6 */
    /* 0x2001: state, TPDO2: of the first, bit 7 is the emergency stop and bit 6 the wearer's pin */
    uint8_t state;
    uint8_t fault;
    uint8_t zeroing;               /* enum zeroing_state */
    uint8_t last_push[SIDE_COUNT]; /* enum push_outcome of the last stance */
    uint32_t input_digest; /* over every frame obeyed so far: a replay must come to the same */
    uint8_t unlocked_by;   /* client number; 0 = the parameters are locked */
    uint8_t unlocked_s;    /* for so long still */
    uint8_t misplaced;     /* enum placement_finding of the last walk */
    uint8_t cue;           /* enum wearer_cue */
    /* 0x2002: last step as in TPDO1 */
    uint16_t step_measured;  /* 0.1 mrad/s */
    uint16_t step_commanded; /* 0.1 mrad/s */
    uint16_t step_r0;        /* 10 um */
    uint8_t step_number;     /* modulo 256 */
    uint8_t
        step_side_fault; /* bit 7: right; bit 6: eq. (16) for the search; bits 0-5: latched fault */
    /* 0x2003: the same step in full */
    uint32_t record_number;
    float record_measured_rad_s, record_commanded_rad_s, record_r0_m;
    /* 0x2004: the last change of a parameter over SDO */
    uint8_t change_count, change_client, change_place; /* sub-index of 0x2010 */
    uint32_t change_number;                            /* changes since the start */
    float change_before, change_after;
    /* 0x2005: the changes before it, too, and those of the description */
    uint8_t log_count;
    struct change_log changes;
    struct co_domain change_records; /* all of the ring */
    /* 0x2010: the parameters, in the order of CONTROL_PARAM_TABLE */
    struct control_params params;
    /* 0x2020: counters */
    struct controller_counters counters;
    /* 0x2021: the drives, left and right, as they tell of themselves; 0 V = not told */
    uint8_t drive_count;
    int16_t drive_temperature_0_1_degC[SIDE_COUNT];
    uint16_t drive_supply_10_mV[SIDE_COUNT];
    uint8_t drive_warnings;                               /* bit 0 left, bit 1 right */
    uint8_t push_share_percent, spared_cause[SIDE_COUNT]; /* enum derate_cause */
    uint8_t withdrawn, withdrew_cause, withdrew_leg;      /* the last two: of the last time */
    uint8_t loaded_without_link; /* bit 0 left, bit 1 right: nothing unloads it on link loss */
    /* 0x2022: the object of a drive or sensor that somebody else wrote last; node 0 = none yet */
    uint8_t tool_count, tool_node, tool_sub;
    uint16_t
        tool_index; /* 0: by a segment or a block of a transfer that the controller did not hear begin */
    /* 0x2030: identity */
    char version[32];
    uint32_t build_id;
    uint32_t params_crc;
    /* 0x2032: what the last crash left */
    uint8_t crash_count, crash_cause; /* enum crash_cause; 0 = none, or seen */
    uint8_t crash_streak; /* crashes since a SYNC last came back, as at the start; saturates */
    struct co_domain crash_image;
    /* 0x2033: the board */
    uint8_t board_count;
    struct controller_board board;
    /* 0x2040: the black box */
    uint8_t black_box_count, black_box_state; /* enum black_box_state, 0 = there is none */
    uint32_t black_box_reason;
    struct co_domain black_box_image; /* while it is frozen */
    /* 0x2050 to 0x2052: what hangs on the bus. Written here it holds from the next start on, once it is
     * stored (0x1010); what runs now is as it was at this start. 0x2053: why it could not be stored */
    uint8_t device_common_count, device_leg_count, device_refusal_count;
    struct device_description device;
    uint8_t device_verdict, device_refused_leg, device_refused_key;
    /* 0x2060: commissioning, what a tool asks for (controller/signals.h) and what became of it
     * (controller/commissioning/motion.h) */
    uint8_t commissioning_count, motion_order, motion_renewal, motion_kind, motion_side;
    float motion_share, motion_seconds, motion_frequency_Hz;
    uint8_t motion_phase, motion_outcome, motion_outcome_order;
    float motion_allowed_share, motion_bandwidth_Hz, motion_last_frequency_Hz;
    uint16_t motion_release_ms, motion_unload_ms; /* 65535: it did not */
    /* 0x2061: what is measured now, before the zero offsets of 0x2010; 0x2062: the forces, each with
     * the motor's position at its SYNC */
    uint8_t measured_count, sample_count;
    float measured_motor_m[SIDE_COUNT], measured_ankle_m[SIDE_COUNT];
    float measured_angle_rad[SIDE_COUNT];
    uint8_t measured_latch[SIDE_COUNT], measured_drive[SIDE_COUNT];
    uint8_t measured_foot[SIDE_COUNT]; /* enum foot_contact */
    float sample_force_N[SIDE_COUNT], sample_motor_m[SIDE_COUNT];
    uint8_t sample_number[SIDE_COUNT];
    /* 0x2031: why a node was refused at start */
    uint8_t refused_node, refused_sub, refused_verdict;
    uint16_t refused_index;
    uint32_t refused_expected, refused_found;
};

/* Of the communication area, what not every device has: storing (1 = it does) and the PDOs;
 * it sends two and listens to none. */
struct controller_comm {
    uint8_t subs, store_count, restore_count;
    uint32_t store, restore;
    struct co_pdo tpdo[2];
    /* CiA 302-3: a program over CAN (program_update.h). */
    uint8_t program_count, program_control;
    uint32_t program_identification, program_status;
    struct co_domain program_data; /* written only, and never kept here */
};

extern const struct co_entry controller_object_table[];
extern const uint16_t controller_object_count;
extern const struct co_entry controller_comm_table[];
extern const uint16_t controller_comm_count;

#endif
