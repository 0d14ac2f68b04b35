/* The inside of a leg sensor node, public only so that its owner can allocate it. */
#ifndef SIM_HOST_NODES_LEG_SENSOR_NODE_TYPE_H
#define SIM_HOST_NODES_LEG_SENSOR_NODE_TYPE_H

#include "hal/canopen/co_device.h"
#include "hal/canopen/co_pdo_objects.h"
#include "sim_host/nodes/leg_sensor_node.h"

/* Values of the objects 0x2000 and above (table: leg_sensor_objects.c). */
struct leg_sensor_objects {
    uint8_t channel_count;
    int32_t leg_angle;             /* 0x2020:01 */
    int16_t ankle;                 /* 0x2020:02 */
    uint8_t ankle_is_lever;        /* 0x2021 */
    uint8_t foot_contact;          /* 0x2022: bit 0 down, bit 1 fault or no switch */
    uint16_t operating_parameters; /* 0x6000: bit 0 code sequence of the leg angle */
    uint32_t steps_per_turn;       /* 0x6001 */
    uint32_t total_range;          /* 0x6002 */
    int32_t preset;                /* 0x6003, 0x6010:01 */
    int32_t ankle_preset;          /* 0x6010:02 */
    int32_t position;              /* 0x6004, 0x6020:01 */
    int32_t ankle_wide;            /* 0x6020:02 */
    int16_t speed;                 /* 0x6030:01, counts a tick / 256 */
    uint8_t speed_count;
    uint16_t cyclic_timer_ms;    /* 0x6200: event timer of TPDO1 */
    uint16_t operating_status;   /* 0x6500 */
    uint32_t resolution;         /* 0x6501 */
    uint16_t turns;              /* 0x6502 */
    uint16_t alarms;             /* 0x6503 */
    uint16_t supported_alarms;   /* 0x6504 */
    uint16_t warnings;           /* 0x6505 */
    uint16_t supported_warnings; /* 0x6506 */
    uint32_t profile_version;    /* 0x6507 */
    uint32_t operating_time;     /* 0x6508, 0.1 h; all ones: not counted */
    int32_t offset;              /* 0x6509 */
};

struct leg_sensor_node {
    struct co_device device;
    struct co_pdo_four pdos;
    struct leg_sensor_node_config config;
    struct leg_sensor_objects objects;
    struct co_dictionary dictionary;
    bool sync_seen;
    bool silent;
    int32_t raw_angle; /* before preset and direction */
    int32_t raw_ankle;
    int32_t last_angle;
    int32_t ankle_offset;
};

/* The table of objects 0x2000 and above; base is struct leg_sensor_objects. */
extern const struct co_entry leg_sensor_object_table[];
extern const uint16_t leg_sensor_object_count;

#endif
