/* Object dictionary of the SEA drive (CiA 402-2 / IEC 61800-7-201 for 0x6000 and
 * above; 0x2100 to 0x2110 are the maker's). */
#include "sim_host/nodes/drive_node_type.h"

#define OWNER struct drive_objects
#define RO CO_READ
#define RW (CO_READ | CO_WRITE)
#define FIXED (CO_READ | CO_CONST)
#define TX CO_MAP_TX
#define RX CO_MAP_RX

const struct co_entry drive_object_table[] = {
    CO_ANY(OWNER, temperature_0_1_degC, 0x2100, 0, CO_INTEGER16, RO | TX, "Temperature 0.1 degC"),
    CO_ANY(OWNER, latch_closed, 0x2101, 0, CO_UNSIGNED8, RO | TX, "Latch closed"),
    CO_ANY(OWNER, unload_rate, 0x2102, 0, CO_UNSIGNED32, FIXED, "Unload rate counts/s"),
    CO_ANY(OWNER, state, 0x2110, 0, CO_UNSIGNED8, RO | TX, "State machine"),
    CO_OBJECT(OWNER, abort_connection_option, 0x6007, 0, CO_INTEGER16, RW, 0, 3,
              "Abort connection option code"),
    CO_ANY(OWNER, error_code, 0x603F, 0, CO_UNSIGNED16, RO | TX, "Error code"),
    CO_ANY(OWNER, controlword, 0x6040, 0, CO_UNSIGNED16, RW | RX, "Controlword"),
    CO_ANY(OWNER, statusword, 0x6041, 0, CO_UNSIGNED16, RO | TX, "Statusword"),
    CO_OBJECT(OWNER, quick_stop_option, 0x605A, 0, CO_INTEGER16, RW, 0, 6,
              "Quick stop option code"),
    CO_OBJECT(OWNER, shutdown_option, 0x605B, 0, CO_INTEGER16, RW, 0, 1, "Shutdown option code"),
    CO_OBJECT(OWNER, disable_option, 0x605C, 0, CO_INTEGER16, RW, 0, 1,
              "Disable operation option code"),
    CO_OBJECT(OWNER, fault_reaction_option, 0x605E, 0, CO_INTEGER16, RW, 0, 2,
              "Fault reaction option code"),
    CO_ANY(OWNER, mode, 0x6060, 0, CO_INTEGER8, RW | RX, "Modes of operation"),
    CO_ANY(OWNER, mode_display, 0x6061, 0, CO_INTEGER8, RO | TX, "Modes of operation display"),
    CO_ANY(OWNER, position_demand, 0x6062, 0, CO_INTEGER32, RO | TX, "Position demand value"),
    CO_ANY(OWNER, position_actual, 0x6064, 0, CO_INTEGER32, RO | TX, "Position actual value"),
    CO_ANY(OWNER, following_window, 0x6065, 0, CO_UNSIGNED32, RW, "Following error window"),
    CO_ANY(OWNER, following_timeout_ms, 0x6066, 0, CO_UNSIGNED16, RW, "Following error time out"),
    CO_ANY(OWNER, velocity_actual, 0x606C, 0, CO_INTEGER32, RO | TX, "Velocity actual value"),
    CO_ANY(OWNER, rated_torque_mNm, 0x6076, 0, CO_UNSIGNED32, FIXED, "Motor rated torque mNm"),
    CO_ANY(OWNER, torque_actual, 0x6077, 0, CO_INTEGER16, RO | TX, "Torque actual value"),
    CO_ANY(OWNER, dc_link_mV, 0x6079, 0, CO_UNSIGNED32, RO | TX, "DC link circuit voltage"),
    CO_ANY(OWNER, target_position, 0x607A, 0, CO_INTEGER32, RW | RX, "Target position"),
    CO_ANY(OWNER, pair_count, 0x607D, 0, CO_UNSIGNED8, FIXED, "Software position limit"),
    CO_ANY(OWNER, limit_min, 0x607D, 1, CO_INTEGER32, RW, "Min position limit"),
    CO_ANY(OWNER, limit_max, 0x607D, 2, CO_INTEGER32, RW, "Max position limit"),
    CO_ANY(OWNER, max_speed, 0x6080, 0, CO_UNSIGNED32, RW, "Max motor speed counts/s"),
    CO_ANY(OWNER, pair_count, 0x608F, 0, CO_UNSIGNED8, FIXED, "Position encoder resolution"),
    CO_ANY(OWNER, encoder_increments, 0x608F, 1, CO_UNSIGNED32, FIXED, "Encoder increments"),
    CO_ANY(OWNER, encoder_revolutions, 0x608F, 2, CO_UNSIGNED32, FIXED, "Motor revolutions"),
    CO_ANY(OWNER, pair_count, 0x6091, 0, CO_UNSIGNED8, FIXED, "Gear ratio"),
    CO_ANY(OWNER, gear_motor, 0x6091, 1, CO_UNSIGNED32, FIXED, "Motor revolutions"),
    CO_ANY(OWNER, gear_shaft, 0x6091, 2, CO_UNSIGNED32, FIXED, "Shaft revolutions"),
    CO_ANY(OWNER, pair_count, 0x6092, 0, CO_UNSIGNED8, FIXED, "Feed constant"),
    CO_ANY(OWNER, feed, 0x6092, 1, CO_UNSIGNED32, FIXED, "Feed nm"),
    CO_ANY(OWNER, feed_revolutions, 0x6092, 2, CO_UNSIGNED32, FIXED, "Shaft revolutions"),
    CO_ANY(OWNER, data_count, 0x60C1, 0, CO_UNSIGNED8, FIXED, "Interpolation data record"),
    CO_ANY(OWNER, target_position, 0x60C1, 1, CO_INTEGER32, RW | RX, "Interpolated position"),
    CO_ANY(OWNER, pair_count, 0x60C2, 0, CO_UNSIGNED8, FIXED, "Interpolation time period"),
    CO_OBJECT(OWNER, interpolation_value, 0x60C2, 1, CO_UNSIGNED8, RW, 1, 255,
              "Interpolation time period value"),
    CO_OBJECT(OWNER, interpolation_exponent, 0x60C2, 2, CO_INTEGER8, RW, -6, 0,
              "Interpolation time index"),
    CO_ANY(OWNER, following_error, 0x60F4, 0, CO_INTEGER32, RO | TX,
           "Following error actual value"),
    CO_ANY(OWNER, digital_inputs, 0x60FD, 0, CO_UNSIGNED32, RO | TX, "Digital inputs"),
    CO_ANY(OWNER, pair_count, 0x60FE, 0, CO_UNSIGNED8, FIXED, "Digital outputs"),
    CO_ANY(OWNER, outputs, 0x60FE, 1, CO_UNSIGNED32, RW | RX, "Physical outputs"),
    CO_ANY(OWNER, output_mask, 0x60FE, 2, CO_UNSIGNED32, RW, "Bit mask"),
    CO_ANY(OWNER, supported_modes, 0x6502, 0, CO_UNSIGNED32, FIXED, "Supported drive modes"),
};

const uint16_t drive_object_count =
    (uint16_t)(sizeof drive_object_table / sizeof drive_object_table[0]);
