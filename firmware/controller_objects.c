/* Object dictionary of the controller. Indices never change their meaning. */
#include "firmware/controller_objects.h"

#define OWNER struct controller_objects
#define RO CO_READ
#define RW (CO_READ | CO_WRITE)
#define FIXED (CO_READ | CO_CONST)
#define TX CO_MAP_TX

/* Ranges of REAL32 entries are in no table here: the validator of the parameters
 * checks them (write_rules.c), the same one that reads person files. */
enum param_sub {
    PARAM_SUB_COUNT = 0,
#define PARAM_SUB(field, unit, minimum, maximum, meaning) PARAM_SUB_##field,
    CONTROL_PARAM_TABLE(PARAM_SUB)
#undef PARAM_SUB
};

#define PARAM_ENTRY(field, unit, minimum, maximum, meaning) \
    CO_ANY(OWNER, params.field, 0x2010, PARAM_SUB_##field, CO_REAL32, RW, #field),

/* A key's CANopen type. */
#define CO_OF_FLOAT CO_REAL32
#define CO_OF_INT CO_INTEGER32
#define CO_OF_WORD CO_INTEGER32
#define CO_OF_FLAGS CO_INTEGER32
#define CO_OF_OBJECT CO_INTEGER32
#define COMMON_ENTRY(field, type, unit, low, high, fallback, when, meaning)            \
    CO_ANY(OWNER, device.common.field, DEVICE_INDEX_COMMON, DEVICE_COMMON_##field + 1, \
           CO_OF_##type, RW, #field),
#define LEFT_ENTRY(field, type, unit, low, high, fallback, when, meaning)                 \
    CO_ANY(OWNER, device.leg[SIDE_LEFT].field, DEVICE_INDEX_LEFT, DEVICE_LEG_##field + 1, \
           CO_OF_##type, RW, "Left " #field),
#define RIGHT_ENTRY(field, type, unit, low, high, fallback, when, meaning)                  \
    CO_ANY(OWNER, device.leg[SIDE_RIGHT].field, DEVICE_INDEX_RIGHT, DEVICE_LEG_##field + 1, \
           CO_OF_##type, RW, "Right " #field),

const struct co_entry controller_object_table[] = {
    CO_ANY(OWNER, command_count, 0x2000, 0, CO_UNSIGNED8, FIXED, "Commands"),
    CO_ANY(OWNER, desired_speed_rad_s, 0x2000, 1, CO_REAL32, RW, "Desired apex speed rad/s"),
    CO_OBJECT(OWNER, walk_requested, 0x2000, 2, CO_UNSIGNED8, RW, 0, 1, "Walk requested"),
    CO_OBJECT(OWNER, reset_requested, 0x2000, 3, CO_UNSIGNED8, RW, 0, 1, "Reset fault"),
    CO_OBJECT(OWNER, zero_requested, 0x2000, 4, CO_UNSIGNED8, RW, 0, 1, "Zero the leg sensors"),
    CO_ANY(OWNER, state_count, 0x2001, 0, CO_UNSIGNED8, FIXED, "State"),
    CO_ANY(OWNER, state, 0x2001, 1, CO_UNSIGNED8, RO | TX, "Supervisor state and emergency stop"),
    CO_ANY(OWNER, fault, 0x2001, 2, CO_UNSIGNED8, RO | TX, "Latched fault"),
    CO_ANY(OWNER, input_digest, 0x2001, 3, CO_UNSIGNED32, RO | TX, "Digest of the input"),
    CO_ANY(OWNER, zeroing, 0x2001, 4, CO_UNSIGNED8, RO, "Zeroing 1 runs 2 done 3 to 5 refused"),
    CO_ANY(OWNER, last_push[SIDE_LEFT], 0x2001, 5, CO_UNSIGNED8, RO,
           "Left push 1 given 2 latch open 3 not loaded 4 not released"),
    CO_ANY(OWNER, last_push[SIDE_RIGHT], 0x2001, 6, CO_UNSIGNED8, RO, "Right push likewise"),
    CO_ANY(OWNER, step_count, 0x2002, 0, CO_UNSIGNED8, FIXED, "Last step"),
    CO_ANY(OWNER, step_measured, 0x2002, 1, CO_UNSIGNED16, RO | TX, "Measured speed 0.1 mrad/s"),
    CO_ANY(OWNER, step_commanded, 0x2002, 2, CO_UNSIGNED16, RO | TX, "Commanded speed 0.1 mrad/s"),
    CO_ANY(OWNER, step_r0, 0x2002, 3, CO_UNSIGNED16, RO | TX, "Precompression 10 um"),
    CO_ANY(OWNER, step_number, 0x2002, 4, CO_UNSIGNED8, RO | TX, "Step number modulo 256"),
    CO_ANY(OWNER, step_side_fault, 0x2002, 5, CO_UNSIGNED8, RO | TX, "Side, fallback, fault"),
    CO_ANY(OWNER, record_count, 0x2003, 0, CO_UNSIGNED8, FIXED, "Last step in full"),
    CO_ANY(OWNER, record_number, 0x2003, 1, CO_UNSIGNED32, RO, "Step number"),
    CO_ANY(OWNER, record_measured_rad_s, 0x2003, 2, CO_REAL32, RO, "Measured speed rad/s"),
    CO_ANY(OWNER, record_commanded_rad_s, 0x2003, 3, CO_REAL32, RO, "Commanded speed rad/s"),
    CO_ANY(OWNER, record_r0_m, 0x2003, 4, CO_REAL32, RO, "Precompression m"),
    CO_ANY(OWNER, param_count, 0x2010, PARAM_SUB_COUNT, CO_UNSIGNED8, FIXED, "Parameters"),
    CONTROL_PARAM_TABLE(PARAM_ENTRY)
        CO_ANY(OWNER, counter_count, 0x2020, 0, CO_UNSIGNED8, FIXED, "Counters"),
    CO_ANY(OWNER, counters.ticks, 0x2020, 1, CO_UNSIGNED32, RO, "Ticks"),
    CO_ANY(OWNER, counters.syncs_refused, 0x2020, 2, CO_UNSIGNED32, RO, "SYNCs refused by the bus"),
    CO_ANY(OWNER, counters.send_failures, 0x2020, 3, CO_UNSIGNED32, RO,
           "Ticks with commands refused by the bus"),
    CO_ANY(OWNER, counters.error_frames, 0x2020, 4, CO_UNSIGNED32, RO, "Error frames"),
    CO_ANY(OWNER, counters.foreign_frames, 0x2020, 5, CO_UNSIGNED32, RO, "Foreign frames"),
    CO_ANY(OWNER, counters.late_answers, 0x2020, 6, CO_UNSIGNED32, RO, "Late answers"),
    CO_ANY(OWNER, counters.forced_stops, 0x2020, 7, CO_UNSIGNED32, RO, "Forced stops"),
    CO_ANY(OWNER, counters.missed_ticks, 0x2020, 8, CO_UNSIGNED32, RO, "Missed ticks"),
    CO_ANY(OWNER, counters.rx_malformed, 0x2020, 9, CO_UNSIGNED32, RO, "Malformed frames"),
    CO_ANY(OWNER, counters.tx_refused, 0x2020, 10, CO_UNSIGNED32, RO,
           "Frames refused by the queue"),
    CO_ANY(OWNER, counters.rx_overflow, 0x2020, 11, CO_UNSIGNED32, RO, "Frames lost on receive"),
    CO_ANY(OWNER, counters.bus_off_count, 0x2020, 12, CO_UNSIGNED32, RO, "Times bus-off"),
    CO_ANY(OWNER, counters.pushes[SIDE_LEFT][PUSH_GIVEN], 0x2020, 13, CO_UNSIGNED32, RO,
           "Left pushes given"),
    CO_ANY(OWNER, counters.pushes[SIDE_LEFT][PUSH_LATCH_OPEN], 0x2020, 14, CO_UNSIGNED32, RO,
           "Left pushes missed, latch open"),
    CO_ANY(OWNER, counters.pushes[SIDE_LEFT][PUSH_NOT_LOADED], 0x2020, 15, CO_UNSIGNED32, RO,
           "Left pushes missed, not loaded"),
    CO_ANY(OWNER, counters.pushes[SIDE_LEFT][PUSH_NOT_RELEASED], 0x2020, 16, CO_UNSIGNED32, RO,
           "Left pushes missed, not released"),
    CO_ANY(OWNER, counters.behind_ticks[SIDE_LEFT], 0x2020, 17, CO_UNSIGNED32, RO,
           "Left ticks with the motor behind"),
    CO_ANY(OWNER, counters.pushes[SIDE_RIGHT][PUSH_GIVEN], 0x2020, 18, CO_UNSIGNED32, RO,
           "Right pushes given"),
    CO_ANY(OWNER, counters.pushes[SIDE_RIGHT][PUSH_LATCH_OPEN], 0x2020, 19, CO_UNSIGNED32, RO,
           "Right pushes missed, latch open"),
    CO_ANY(OWNER, counters.pushes[SIDE_RIGHT][PUSH_NOT_LOADED], 0x2020, 20, CO_UNSIGNED32, RO,
           "Right pushes missed, not loaded"),
    CO_ANY(OWNER, counters.pushes[SIDE_RIGHT][PUSH_NOT_RELEASED], 0x2020, 21, CO_UNSIGNED32, RO,
           "Right pushes missed, not released"),
    CO_ANY(OWNER, counters.behind_ticks[SIDE_RIGHT], 0x2020, 22, CO_UNSIGNED32, RO,
           "Right ticks with the motor behind"),
    CO_ANY(OWNER, drive_count, 0x2021, 0, CO_UNSIGNED8, FIXED, "Drives"),
    CO_ANY(OWNER, drive_temperature_0_1_degC[SIDE_LEFT], 0x2021, 1, CO_INTEGER16, RO,
           "Left drive temperature 0.1 degC"),
    CO_ANY(OWNER, drive_temperature_0_1_degC[SIDE_RIGHT], 0x2021, 2, CO_INTEGER16, RO,
           "Right drive temperature 0.1 degC"),
    CO_ANY(OWNER, drive_supply_10_mV[SIDE_LEFT], 0x2021, 3, CO_UNSIGNED16, RO,
           "Left drive supply 10 mV"),
    CO_ANY(OWNER, drive_supply_10_mV[SIDE_RIGHT], 0x2021, 4, CO_UNSIGNED16, RO,
           "Right drive supply 10 mV"),
    CO_ANY(OWNER, drive_warnings, 0x2021, 5, CO_UNSIGNED8, RO, "Warning bit 0 left bit 1 right"),
    CO_ANY(OWNER, identity_count, 0x2030, 0, CO_UNSIGNED8, FIXED, "Firmware identity"),
    CO_STRING(OWNER, version, 0x2030, 1, FIXED, "Version"),
    CO_ANY(OWNER, build_id, 0x2030, 2, CO_UNSIGNED32, FIXED, "Build id"),
    CO_ANY(OWNER, params_crc, 0x2030, 3, CO_UNSIGNED32, RO, "Parameter CRC-32"),
    CO_ANY(OWNER, setup_count, 0x2031, 0, CO_UNSIGNED8, FIXED, "Refused node"),
    CO_ANY(OWNER, refused_node, 0x2031, 1, CO_UNSIGNED8, RO, "Node, 0 for none"),
    CO_ANY(OWNER, refused_verdict, 0x2031, 2, CO_UNSIGNED8, RO,
           "Verdict 1 differs 2 aborted 3 silent"),
    CO_ANY(OWNER, refused_index, 0x2031, 3, CO_UNSIGNED16, RO, "Object index"),
    CO_ANY(OWNER, refused_sub, 0x2031, 4, CO_UNSIGNED8, RO, "Object sub-index"),
    CO_ANY(OWNER, refused_expected, 0x2031, 5, CO_UNSIGNED32, RO, "Expected value"),
    CO_ANY(OWNER, refused_found, 0x2031, 6, CO_UNSIGNED32, RO, "Found value or abort code"),
    CO_ANY(OWNER, crash_count, 0x2032, 0, CO_UNSIGNED8, FIXED, "Last crash"),
    CO_OBJECT(OWNER, crash_cause, 0x2032, 1, CO_UNSIGNED8, RW, 0, 0, "Cause, write 0: seen"),
    CO_ANY(OWNER, crash_image, 0x2032, 2, CO_DOMAIN, RO, "Record (hal/storage/crash_record.h)"),
    CO_ANY(OWNER, crash_streak, 0x2032, 3, CO_UNSIGNED8, RO, "Crashes since a SYNC came back"),
    CO_ANY(OWNER, black_box_count, 0x2040, 0, CO_UNSIGNED8, FIXED, "Black box"),
    CO_OBJECT(OWNER, black_box_state, 0x2040, 1, CO_UNSIGNED8, RW, BLACK_BOX_RECORDING,
              BLACK_BOX_FROZEN, "State 1 records anew 2 closes 3 frozen"),
    CO_ANY(OWNER, black_box_reason, 0x2040, 2, CO_UNSIGNED32, RO, "Fault bits that froze it"),
    CO_ANY(OWNER, black_box_image, 0x2040, 3, CO_DOMAIN, RO, "Image while frozen"),
    CO_ANY(OWNER, device_common_count, DEVICE_INDEX_COMMON, 0, CO_UNSIGNED8, FIXED, "Device"),
    DEVICE_COMMON_KEYS(COMMON_ENTRY) CO_ANY(OWNER, device_leg_count, DEVICE_INDEX_LEFT, 0,
                                            CO_UNSIGNED8, FIXED, "Left leg's device"),
    DEVICE_LEG_KEYS(LEFT_ENTRY) CO_ANY(OWNER, device_leg_count, DEVICE_INDEX_RIGHT, 0, CO_UNSIGNED8,
                                       FIXED, "Right leg's device"),
    DEVICE_LEG_KEYS(RIGHT_ENTRY) CO_ANY(OWNER, device_refusal_count, 0x2053, 0, CO_UNSIGNED8, FIXED,
                                        "Why the device is refused"),
    CO_ANY(OWNER, device_verdict, 0x2053, 1, CO_UNSIGNED8, RO, "Verdict, 0 it fits"),
    CO_ANY(OWNER, device_refused_leg, 0x2053, 2, CO_UNSIGNED8, RO, "0 left 1 right 255 both"),
    CO_ANY(OWNER, device_refused_key, 0x2053, 3, CO_UNSIGNED8, RO, "Sub-index of the key"),
    CO_ANY(OWNER, commissioning_count, 0x2060, 0, CO_UNSIGNED8, FIXED, "Commissioning"),
    CO_ANY(OWNER, motion_order, 0x2060, 1, CO_UNSIGNED8, RW, "Order, a change begins a motion"),
    CO_ANY(OWNER, motion_renewal, 0x2060, 2, CO_UNSIGNED8, RW, "Renewal, a change each 0.5 s"),
    CO_OBJECT(OWNER, motion_kind, 0x2060, 3, CO_UNSIGNED8, RW, 0, 5,
              "Kind 0 none 1 move 2 chirp 3 release 4 cut 5 unload"),
    CO_OBJECT(OWNER, motion_side, 0x2060, 4, CO_UNSIGNED8, RW, 0, 1, "Leg 0 left 1 right"),
    CO_OBJECT(OWNER, motion_share, 0x2060, 5, CO_REAL32, RW, 0, 1000, "Share of the largest load"),
    CO_OBJECT(OWNER, motion_seconds, 0x2060, 6, CO_REAL32, RW, 10, 20000, "Time s"),
    CO_OBJECT(OWNER, motion_frequency_Hz, 0x2060, 7, CO_REAL32, RW, 1000, 32000,
              "Highest frequency Hz"),
    CO_ANY(OWNER, motion_phase, 0x2060, 8, CO_UNSIGNED8, RO,
           "Phase 0 idle 1 waits 2 loads 3 holds 4 returns"),
    CO_ANY(OWNER, motion_outcome, 0x2060, 9, CO_UNSIGNED8, RO,
           "Outcome 0 none 1 done 2 refused 3 beyond 4 not reached 5 interrupted"),
    CO_ANY(OWNER, motion_outcome_order, 0x2060, 10, CO_UNSIGNED8, RO, "Outcome of this order"),
    CO_ANY(OWNER, motion_share_allowed, 0x2060, 11, CO_REAL32, RO, "Allowed share"),
    CO_ANY(OWNER, motion_bandwidth_Hz, 0x2060, 12, CO_REAL32, RO, "Bandwidth Hz"),
    CO_ANY(OWNER, motion_last_frequency_Hz, 0x2060, 13, CO_REAL32, RO, "Frequency reached Hz"),
    CO_ANY(OWNER, motion_release_ms, 0x2060, 14, CO_UNSIGNED16, RO, "Time to the release ms"),
    CO_ANY(OWNER, motion_unload_ms, 0x2060, 15, CO_UNSIGNED16, RO, "Time to unload by itself ms"),
    CO_ANY(OWNER, measured_count, 0x2061, 0, CO_UNSIGNED8, FIXED, "Measured"),
    CO_ANY(OWNER, measured_motor_m[SIDE_LEFT], 0x2061, 1, CO_REAL32, RO, "Left motor m"),
    CO_ANY(OWNER, measured_motor_m[SIDE_RIGHT], 0x2061, 2, CO_REAL32, RO, "Right motor m"),
    CO_ANY(OWNER, measured_ankle_m[SIDE_LEFT], 0x2061, 3, CO_REAL32, RO, "Left ankle m"),
    CO_ANY(OWNER, measured_ankle_m[SIDE_RIGHT], 0x2061, 4, CO_REAL32, RO, "Right ankle m"),
    CO_ANY(OWNER, measured_angle_rad[SIDE_LEFT], 0x2061, 5, CO_REAL32, RO, "Left leg angle rad"),
    CO_ANY(OWNER, measured_angle_rad[SIDE_RIGHT], 0x2061, 6, CO_REAL32, RO, "Right leg angle rad"),
    CO_ANY(OWNER, measured_latch[SIDE_LEFT], 0x2061, 7, CO_UNSIGNED8, RO,
           "Left latch 0 unknown 1 closed 2 open"),
    CO_ANY(OWNER, measured_latch[SIDE_RIGHT], 0x2061, 8, CO_UNSIGNED8, RO,
           "Right latch 0 unknown 1 closed 2 open"),
    CO_ANY(OWNER, measured_drive[SIDE_LEFT], 0x2061, 9, CO_UNSIGNED8, RO,
           "Left drive 0 unknown 1 off 2 starts 3 on 4 stops 5 fault"),
    CO_ANY(OWNER, measured_drive[SIDE_RIGHT], 0x2061, 10, CO_UNSIGNED8, RO,
           "Right drive 0 unknown 1 off 2 starts 3 on 4 stops 5 fault"),
    CO_ANY(OWNER, sample_count, 0x2062, 0, CO_UNSIGNED8, FIXED, "Force samples"),
    CO_ANY(OWNER, sample_force_N[SIDE_LEFT], 0x2062, 1, CO_REAL32, RO, "Left force N"),
    CO_ANY(OWNER, sample_motor_m[SIDE_LEFT], 0x2062, 2, CO_REAL32, RO, "Left motor then m"),
    CO_ANY(OWNER, sample_number[SIDE_LEFT], 0x2062, 3, CO_UNSIGNED8, RO, "Left sample number"),
    CO_ANY(OWNER, sample_force_N[SIDE_RIGHT], 0x2062, 4, CO_REAL32, RO, "Right force N"),
    CO_ANY(OWNER, sample_motor_m[SIDE_RIGHT], 0x2062, 5, CO_REAL32, RO, "Right motor then m"),
    CO_ANY(OWNER, sample_number[SIDE_RIGHT], 0x2062, 6, CO_UNSIGNED8, RO, "Right sample number"),
};

const uint16_t controller_object_count =
    (uint16_t)(sizeof controller_object_table / sizeof controller_object_table[0]);

const struct co_entry controller_comm_table[] = {
    CO_ANY(struct controller_comm, store_count, 0x1010, 0, CO_UNSIGNED8, FIXED, "Store parameters"),
    CO_ANY(struct controller_comm, store, 0x1010, 1, CO_UNSIGNED32, RW, "Save all parameters"),
    CO_ANY(struct controller_comm, restore_count, 0x1011, 0, CO_UNSIGNED8, FIXED,
           "Restore default parameters"),
    CO_ANY(struct controller_comm, restore, 0x1011, 1, CO_UNSIGNED32, RW,
           "Restore all default parameters"),
    CO_PDO_TPDO(struct controller_comm, 0, 0x1800),
    CO_PDO_TPDO(struct controller_comm, 1, 0x1801),
    CO_PDO_MAPPING(struct controller_comm, tpdo[0], 0x1A00, "TPDO mapping parameter"),
    CO_PDO_MAPPING(struct controller_comm, tpdo[1], 0x1A01, "TPDO mapping parameter"),
    CO_ANY(struct controller_comm, program_count, 0x1F50, 0, CO_UNSIGNED8, FIXED, "Program data"),
    CO_ANY(struct controller_comm, program_data, 0x1F50, 1, CO_DOMAIN, CO_WRITE, "Program"),
    CO_ANY(struct controller_comm, program_count, 0x1F51, 0, CO_UNSIGNED8, FIXED,
           "Program control"),
    CO_ANY(struct controller_comm, program_control, 0x1F51, 1, CO_UNSIGNED8, RW,
           "1 start 3 clear 128 start older"),
    CO_ANY(struct controller_comm, program_count, 0x1F56, 0, CO_UNSIGNED8, FIXED,
           "Program software identification"),
    CO_ANY(struct controller_comm, program_identification, 0x1F56, 1, CO_UNSIGNED32, RO,
           "CRC-32 of the program"),
    CO_ANY(struct controller_comm, program_count, 0x1F57, 0, CO_UNSIGNED8, FIXED,
           "Flash status identification"),
    CO_ANY(struct controller_comm, program_status, 0x1F57, 1, CO_UNSIGNED32, RO, "Flash status"),
};

const uint16_t controller_comm_count =
    (uint16_t)(sizeof controller_comm_table / sizeof controller_comm_table[0]);
