/* Object dictionary of the leg sensor (CiA 406; data types and access as in the
 * manuals of TR-Electronic LA-46 and Pepperl+Fuchs CANopen encoders). */
#include "sim_host/nodes/leg_sensor_node.h"

#define OWNER struct leg_sensor_objects
#define RO CO_READ
#define RW (CO_READ | CO_WRITE)
#define FIXED (CO_READ | CO_CONST)
#define TX CO_MAP_TX

const struct co_entry leg_sensor_object_table[] = {
    CO_ANY(OWNER, channel_count, 0x2020, 0, CO_UNSIGNED8, FIXED, "Compact position values"),
    CO_ANY(OWNER, leg_angle, 0x2020, 1, CO_INTEGER24, RO | TX, "Leg angle 2pi/2^24 rad"),
    CO_ANY(OWNER, ankle, 0x2020, 2, CO_INTEGER16, RO | TX, "Ankle 10 um or 2pi/2^16 rad"),
    CO_ANY(OWNER, ankle_is_lever, 0x2021, 0, CO_UNSIGNED8, FIXED, "Ankle is a lever"),
    CO_ANY(OWNER, foot_contact, 0x2022, 0, CO_UNSIGNED8, RO | TX, "Foot contact"),
    CO_OBJECT(OWNER, operating_parameters, 0x6000, 0, CO_UNSIGNED16, RW, 0, 1,
              "Operating parameters"),
    CO_ANY(OWNER, steps_per_turn, 0x6001, 0, CO_UNSIGNED32, FIXED,
           "Measuring units per revolution"),
    CO_ANY(OWNER, total_range, 0x6002, 0, CO_UNSIGNED32, FIXED, "Total measuring range"),
    CO_ANY(OWNER, preset, 0x6003, 0, CO_INTEGER32, RW, "Preset value"),
    CO_ANY(OWNER, position, 0x6004, 0, CO_INTEGER32, RO | TX, "Position value"),
    CO_ANY(OWNER, channel_count, 0x6010, 0, CO_UNSIGNED8, FIXED, "Preset values multi-sensor"),
    CO_ANY(OWNER, preset, 0x6010, 1, CO_INTEGER32, RW, "Preset leg angle"),
    CO_ANY(OWNER, ankle_preset, 0x6010, 2, CO_INTEGER32, RW, "Preset ankle"),
    CO_ANY(OWNER, channel_count, 0x6020, 0, CO_UNSIGNED8, FIXED, "Position values multi-sensor"),
    CO_ANY(OWNER, position, 0x6020, 1, CO_INTEGER32, RO | TX, "Position leg angle"),
    CO_ANY(OWNER, ankle_wide, 0x6020, 2, CO_INTEGER32, RO | TX, "Position ankle"),
    CO_ANY(OWNER, speed_count, 0x6030, 0, CO_UNSIGNED8, FIXED, "Speed values"),
    CO_ANY(OWNER, speed, 0x6030, 1, CO_INTEGER16, RO | TX, "Speed leg angle"),
    CO_ANY(OWNER, cyclic_timer_ms, 0x6200, 0, CO_UNSIGNED16, RW, "Cyclic timer"),
    CO_ANY(OWNER, operating_status, 0x6500, 0, CO_UNSIGNED16, RO, "Operating status"),
    CO_ANY(OWNER, resolution, 0x6501, 0, CO_UNSIGNED32, FIXED, "Single-turn resolution"),
    CO_ANY(OWNER, turns, 0x6502, 0, CO_UNSIGNED16, FIXED, "Number of revolutions"),
    CO_ANY(OWNER, alarms, 0x6503, 0, CO_UNSIGNED16, RO | TX, "Alarms"),
    CO_ANY(OWNER, supported_alarms, 0x6504, 0, CO_UNSIGNED16, FIXED, "Supported alarms"),
    CO_ANY(OWNER, warnings, 0x6505, 0, CO_UNSIGNED16, RO | TX, "Warnings"),
    CO_ANY(OWNER, supported_warnings, 0x6506, 0, CO_UNSIGNED16, FIXED, "Supported warnings"),
    CO_ANY(OWNER, profile_version, 0x6507, 0, CO_UNSIGNED32, FIXED, "Profile and software version"),
    CO_ANY(OWNER, operating_time, 0x6508, 0, CO_UNSIGNED32, FIXED, "Operating time"),
    CO_ANY(OWNER, offset, 0x6509, 0, CO_INTEGER32, RO, "Offset value"),
};

const uint16_t leg_sensor_object_count =
    (uint16_t)(sizeof leg_sensor_object_table / sizeof leg_sensor_object_table[0]);
