/* The structs of a drive node: its configuration, what its axis measures and shall do, and its inside.
 *
 * The inside is public only so that its owner can allocate it.
 */
#ifndef SIM_HOST_NODES_DRIVE_NODE_TYPE_H
#define SIM_HOST_NODES_DRIVE_NODE_TYPE_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/canopen/co_device.h"
#include "hal/canopen/co_pdo_objects.h"
#include "model/side.h"

struct drive_node_config {
    enum side side;                /* which half of RPDO 0x201 */
    uint8_t node_id;               /* 1..127 */
    uint32_t counts_per_m;         /* motor counts per metre of spring, > 0 */
    int32_t zero_counts;           /* count at the unloaded spring */
    bool inverted;                 /* counts and torque fall when the spring is compressed */
    double stroke_m;               /* position limits 0x607D: 0..stroke, > 0 */
    double max_speed_m_per_s;      /* 0x6080: fastest demand; 0: the demand may jump */
    double rated_force_N;          /* 1000 per mille of 0x6077; by the gear: 0x6076; > 0 */
    double following_error_m;      /* 0x6065, > 0; for longer than 100 ms it is a fault */
    double unload_rate_m_per_s;    /* bounded rate of the safe reactions, > 0 */
    double temperature_limit_degC; /* above: fault 0x4310; 0: none */
    double dc_link_minimum_V;      /* below while enabled: fault 0x3220; 0: none */
    bool interpolated;             /* mode 7 with 0x60C1:01 is its only one, instead of mode 8 */
    uint32_t rated_torque_mNm;     /* 0x6076 of another gear than its own; 0: by its own */
};

struct drive_axis_feedback {
    double position_m; /* motor, metres of spring; 0 = unloaded */
    double velocity_m_per_s;
    double force_N; /* of the motor */
    double temperature_degC;
    double dc_link_V;
    bool latch_holds; /* the latch carries the spring's output */
    bool contact;     /* the other foot's switch, as it is wired to the latch, is closed */
};

struct drive_axis_command {
    bool powered; /* position loop closed; false: no torque */
    bool brake;   /* holding brake wanted, 0x60FE bit 0 */
    bool latch_armed;
    double target_m; /* position demand at the end of the period */
};

/* States of the CiA 402 machine, numbered for object 0x2110 and tests. */
enum drive_machine {
    DRIVE_NOT_READY = 0,
    DRIVE_SWITCH_ON_DISABLED = 1,
    DRIVE_READY_TO_SWITCH_ON = 2,
    DRIVE_SWITCHED_ON = 3,
    DRIVE_OPERATION_ENABLED = 4,
    DRIVE_QUICK_STOP_ACTIVE = 5,
    DRIVE_FAULT_REACTION = 6,
    DRIVE_IN_FAULT = 7
};

/* Values of the objects 0x2000 and above (table: drive_objects.c). */
struct drive_objects {
    int16_t temperature_0_1_degC;
    uint8_t latch_closed;
    uint32_t unload_rate; /* counts/s */
    uint8_t state;        /* enum drive_machine */
    int16_t abort_connection_option;
    uint16_t error_code;
    uint16_t controlword;
    uint16_t statusword;
    int16_t quick_stop_option;
    int16_t shutdown_option;
    int16_t disable_option;
    int16_t fault_reaction_option;
    int8_t mode;
    int8_t mode_display;
    int32_t position_demand;
    int32_t position_actual;
    uint32_t following_window;
    uint16_t following_timeout_ms;
    int32_t velocity_actual;
    uint32_t rated_torque_mNm; /* of the motor */
    int16_t torque_actual;
    uint32_t dc_link_mV;
    int32_t target_position;
    uint8_t data_count; /* highest sub-index 1 of 0x60C1 */
    uint8_t pair_count; /* highest sub-index 2 of the objects below */
    int32_t limit_min, limit_max;
    uint32_t max_speed;
    uint32_t encoder_increments, encoder_revolutions;
    uint32_t gear_motor, gear_shaft;
    uint32_t feed, feed_revolutions;
    uint8_t interpolation_value;
    int8_t interpolation_exponent;
    int32_t following_error;
    uint32_t digital_inputs;
    uint32_t outputs, output_mask;
    uint32_t supported_modes;
};

struct drive_node {
    struct co_device device;
    struct co_pdo_four pdos;
    struct drive_node_config config;
    struct drive_objects objects;
    struct drive_axis_feedback feedback;
    struct co_dictionary dictionary;
    enum drive_machine state;
    enum drive_machine after_unloading; /* where the machine goes when unloaded */
    bool unloading;
    bool sync_seen;
    uint16_t last_controlword;
    uint16_t injected_fault;
    uint64_t now_ns;
    uint64_t unloading_since_ns;
    uint64_t following_since_ns; /* 0: within the window */
    uint64_t last_sync_ns;
    double demand_counts;
};

/* The table of objects 0x2000 and above; base is struct drive_objects. */
extern const struct co_entry drive_object_table[];
extern const uint16_t drive_object_count;

#endif
