/* The controller as a node of its own (16): what a person or a tool can read and
 * change over CAN while it walks. Object dictionary: controller_objects.c.
 *
 * It is the network's master, so it starts itself and NMT commands do not stop
 * its control loop. A value written over SDO takes effect at the next tick; it is
 * refused with an abort code when it is out of its range, does not fit the other
 * parameters, or describes the body or the spring while the drives are powered.
 * Everything here is driven by frames and ticks, so a log replays it.
 */
#ifndef FIRMWARE_CONTROLLER_NODE_H
#define FIRMWARE_CONTROLLER_NODE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "controller/controller.h"
#include "hal/bus/can_bus.h"
#include "hal/canopen/co_device.h"
#include "hal/devices/node_setup.h"
#include "hal/storage/black_box.h"
#include "hal/storage/crash_record.h"

/* 0x2020: what was counted since the start; all saturate. */
struct controller_counters {
    /* The control task's. */
    uint32_t syncs_sent;    /* not in the dictionary */
    uint32_t syncs_refused; /* cycles whose SYNC the bus did not take: full or down */
    uint32_t
        send_failures; /* ticks with command frames that the bus did not take; those that a full queue
                               gave up later are in tx_refused */
    uint32_t error_frames;
    uint32_t foreign_frames; /* received, nobody's */
    uint32_t late_answers;   /* operational legs, answers missing when their tick was processed */
    uint32_t forced_stops;   /* NMT stops: a drive stayed enabled, or a foreign node spoke */
    uint32_t missed_ticks;   /* periods that ended while an earlier one waited: the main says so */
    /* Shown when they are asked for: the tick, and what others count. */
    uint32_t ticks, rx_malformed, tx_refused, rx_overflow, bus_off_count;
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
    /* 0x2001: state, TPDO2: bit 7 of the first is the emergency stop */
    uint8_t state;
    uint8_t fault;
    uint8_t zeroing;       /* enum zeroing_state */
    uint32_t input_digest; /* over every frame obeyed so far: a replay must come to the same */
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
    /* 0x2010: the parameters, in the order of CONTROL_PARAM_TABLE */
    struct control_params params;
    /* 0x2020: counters */
    struct controller_counters counters;
    /* 0x2030: identity */
    char version[32];
    uint32_t build_id;
    uint32_t params_crc;
    /* 0x2032: what the last crash left */
    uint8_t crash_count, crash_cause; /* enum crash_cause; 0 = none, or seen */
    struct co_domain crash_image;
    /* 0x2040: the black box */
    uint8_t black_box_count, black_box_state; /* enum black_box_state, 0 = there is none */
    uint32_t black_box_reason;
    struct co_domain black_box_image; /* while it is frozen */
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
};

/* Who keeps the settings. Both are asked at standstill without torque only, may take 100 ms,
 * and return CO_ABORT_NONE or an abort code. */
struct controller_settings_store_ops {
    uint32_t (*save_settings)(void *context);   /* those in force now */
    uint32_t (*forget_settings)(void *context); /* for good: as delivered from the next start on */
};

/* The parameters' own bytes, before the pointer and what aligns it. */
#define CONTROLLER_PARAMS_BYTES \
    (offsetof(struct control_params, table) + sizeof(struct speed_table))

struct controller_node {
    struct co_device device;
    struct controller_comm comm;
    struct controller_objects objects;
    bool powered;    /* drives may be under torque: body parameters are locked */
    bool standstill; /* both legs are still */
    const struct controller_settings_store_ops *settings_store; /* NULL: nobody keeps settings */
    void *settings_store_context;
    struct black_box *black_box;          /* NULL: there is none */
    struct crash_record *crash;           /* NULL: nobody leaves one */
    void (*show_counters)(void *context); /* NULL: they are as they are */
    void *show_context;
    uint8_t sent_state, sent_fault;
    /* The running check of the parameters' CRC. */
    uint32_t crc_so_far, crc_expected;
    uint16_t crc_at; /* bytes done */
    bool params_corrupt;
};

/* Object 0x1009: the revision of what the orthosis's node has at its ends (drives, sensors, stop). */
#define CONTROLLER_HARDWARE_VERSION "1"

extern const struct co_entry controller_object_table[];
extern const uint16_t controller_object_count;
extern const struct co_entry controller_comm_table[];
extern const uint16_t controller_comm_count;

/* Emergency codes of this node (CiA 301: 0xFF00.. are the device's own). The
 * vendor bytes are state, fault, and for a refused node: node, index, sub. */
enum controller_emcy {
    CONTROLLER_EMCY_FAULT = 0xFF10,        /* the supervisor latched a fault */
    CONTROLLER_EMCY_SETUP_REFUSED = 0x6320 /* a node's parameters are not as expected */
};

/* Prepares the node with these parameters (copied; from now on
 * node->objects.params are the ones in force) and sends its boot-up message.
 * Do not move the node afterwards. Returns 0, or -1 for an unusable dictionary. */
int controller_node_init(struct controller_node *node, const struct control_params *params,
                         float desired_speed_rad_s, bool walk_requested, struct can_bus bus);

/* Lets *settings_store be asked to keep the settings, and the black box and the crash record be read
 * over SDO; each may be NULL. All stay the caller's. Start-up only. */
void controller_node_attach(struct controller_node *node,
                            const struct controller_settings_store_ops *settings_store,
                            void *settings_store_context, struct black_box *black_box,
                            struct crash_record *crash);

/* CRC-32 over the parameters' values and tables, not over where they lie: the same on every
 * machine. */
uint32_t controller_node_crc_of(const struct control_params *params);

/* Takes a frame if it is for this node and says whether it did. */
bool controller_node_receive(struct controller_node *node, const struct can_msg *message,
                             uint64_t now_ns);

/* Once a tick: shows what the controller did, sends what is due (heartbeat, state
 * on change, step, emergencies). */
void controller_node_update(struct controller_node *node, const struct controller *controller,
                            const struct controller_output *output, bool emergency_stop,
                            uint64_t now_ns);

/* Once a tick: carries the CRC of the parameters in force CONTROLLER_CRC_BYTES further and
 * compares at their end. True when the last comparison failed: memory has changed by
 * itself. One round takes the parameters' and their tables' bytes / CONTROLLER_CRC_BYTES ticks; about
 * 11 instructions a byte. */
bool controller_node_params_corrupt(struct controller_node *node);
enum { CONTROLLER_CRC_BYTES = 16 };

/* A node was refused at start: raises the emergency and keeps the reason. */
void controller_node_report_setup(struct controller_node *node,
                                  const struct setup_failure *failure);

/* A node is set up: takes back what was said about it, if it had been refused. */
void controller_node_setup_done(struct controller_node *node, uint8_t which);

#endif
