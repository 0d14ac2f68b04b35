/* A CANopen device (CiA 301): NMT slave, heartbeat producer and consumer, SDO
 * server, SYNC consumer, up to four RPDOs and TPDOs, emergencies with error register and
 * history. Profiles (drive, encoder, the orthosis controller) bring their own
 * object dictionary and reactions.
 *
 * It knows a `struct can_bus` to send on and the time it is told; frames are fed by
 * the owner, who may share one bus between a device and other things.
 * Everything is in the caller's struct: no heap, no globals.
 */
#ifndef HAL_CANOPEN_CO_DEVICE_H
#define HAL_CANOPEN_CO_DEVICE_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/bus/can_bus.h"
#include "hal/canopen/co_defs.h"
#include "hal/canopen/co_od.h"
#include "hal/canopen/co_pdo.h"
#include "hal/canopen/co_sdo_server.h"

enum {
    CO_HEARTBEATS_MAX = 4,
    CO_HISTORY_MAX = 8,
    CO_ACTIVE_ERRORS_MAX = 16,
    CO_EMCY_QUEUE = 8,
    CO_NAME_MAX = 32,
    CO_DICTIONARIES = 3
};

/* Values of the objects 0x1000 to 0x1FFF (table: co_comm_objects.c) but for the PDOs, which
 * lie where the owner has put them. */
struct co_comm {
    uint32_t device_type;
    uint8_t error_register;
    uint8_t history_count;
    uint32_t history[CO_HISTORY_MAX];
    uint32_t sync_cob_id;
    uint32_t sync_period_us;
    char name[CO_NAME_MAX];
    char hardware_version[8];
    char software_version[32];
    uint32_t emcy_cob_id;
    uint16_t emcy_inhibit_100us;
    uint8_t heartbeat_consumers;          /* highest sub-index: CO_HEARTBEATS_MAX */
    uint32_t consumer[CO_HEARTBEATS_MAX]; /* node << 16 | ms */
    uint16_t heartbeat_ms;
    uint8_t identity_count;
    uint32_t vendor, product, revision, serial;
    uint8_t behaviour_count;
    uint8_t communication_error_behaviour; /* 0x1029:01 */
    uint8_t sdo_count;
    uint32_t sdo_request_id, sdo_answer_id;
    struct co_pdo *rpdo, *tpdo;
    uint8_t rpdo_count, tpdo_count;
};

struct co_device;

/* Reactions of the profile; any may be NULL. context is the owner's. */
struct co_device_ops {
    struct co_access_hooks access; /* application objects, 0x1010 and 0x1011 only */
    /* SYNC seen, synchronous RPDOs applied, TPDOs not yet packed: sample now. */
    void (*sync)(void *context, uint64_t now_ns);
    void (*state_changed)(void *context, enum co_nmt_state state, uint64_t now_ns);
    /* A consumed heartbeat failed or came back; an RPDO's event timer ran out or the
     * RPDO came again. */
    void (*heartbeat)(void *context, uint8_t node, bool alive, uint64_t now_ns);
    void (*rpdo_timeout)(void *context, unsigned number, bool timed_out, uint64_t now_ns);
    /* NMT reset: put the application's objects to their power-on values. */
    void (*reset)(void *context, bool whole_node, uint64_t now_ns);
    /* The own CAN controller went bus-off or came back. */
    void (*bus_off)(void *context, bool is_off, uint64_t now_ns);
};

struct co_device_config {
    uint8_t node_id;                         /* 1..127 */
    const struct co_dictionary *application; /* the profile's objects, 0x2000 and above */
    const struct co_device_ops *ops;
    void *context;
    struct co_pdos pdos;
    /* Fills the power-on values of comm which are not the predefined ones (device
     * type, names, identity, PDOs). Also called at reset communication. */
    void (*defaults)(void *context, struct co_comm *comm);
};

struct co_consumer_state {
    bool monitoring; /* since the first heartbeat, CiA 301 7.2.8.2.2 */
    bool lost;
    uint8_t state;
    uint64_t last_ns;
};

/* One code may be active for several causes at once: two heartbeats are lost, and one returns. */
struct co_active_error {
    uint16_t code;
    uint8_t register_bits;
    uint8_t cause; /* 0: the profile's; else which RPDO or consumer, from 1 */
};

struct co_device_counters { /* saturate */
    uint32_t send_failures;
    uint32_t sdo_requests;
    uint32_t rpdo_length_errors;
    uint32_t emcy_lost;        /* the oldest of a full queue, given up for a newer one */
    uint32_t errors_untracked; /* told, but in no register: too many at once */
    uint32_t malformed;        /* NMT, heartbeat or SDO frames of a wrong length */
};

struct co_device {
    struct co_comm comm;
    struct co_device_config config;
    struct can_bus bus;
    struct co_dictionary dictionaries[CO_DICTIONARIES]; /* communication, PDOs, application */
    struct co_access_hooks hooks;
    struct co_sdo_server sdo;
    struct co_consumer_state consumers[CO_HEARTBEATS_MAX];
    struct co_active_error errors[CO_ACTIVE_ERRORS_MAX];
    struct co_device_counters counters;
    enum co_nmt_state state;
    bool boot_unsent;
    bool was_bus_off, was_passive;
    uint8_t emcy_count;
    uint8_t emcy_queue[CO_EMCY_QUEUE][8];
    uint64_t emcy_sent_ns;
    uint64_t heartbeat_due_ns;
    uint64_t next_due_ns; /* nothing by time before this */
};

/* Power-on: objects to defaults, boot-up queued, state pre-operational. config and
 * bus are copied, what they point to must outlive the device. Returns 0, or -1 when
 * the node id or a default PDO mapping is invalid. */
int co_device_init(struct co_device *device, const struct co_device_config *config,
                   struct can_bus bus, uint64_t now_ns);

/* Handles one received frame; true when it was for this device. O(1), plus the
 * work of an SDO request or a PDO. */
bool co_device_receive(struct co_device *device, const struct can_msg *message, uint64_t now_ns);

/* Sends what is due by time: boot-up, heartbeat, emergencies, event PDOs; watches
 * time-outs. Call at every tick and after
 * co_device_receive(), _trigger_tpdo(), _raise() and _clear(), which only queue; cheap when nothing is due. */
void co_device_process(struct co_device *device, uint64_t now_ns);

/* Sends TPDO number 0..3 with event transmission as soon as its inhibit time lets
 * it; without effect on synchronous ones (but acyclic type 0: at the next SYNC). */
void co_device_trigger_tpdo(struct co_device *device, unsigned number);

/* Reports an error of the profile: EMCY (once while it lasts), error register, history. vendor: 5
 * bytes or NULL. When the bus takes no EMCY the newest CO_EMCY_QUEUE wait. */
void co_device_raise(struct co_device *device, uint16_t code, uint8_t register_bits,
                     const uint8_t *vendor);

/* The profile's error is over: EMCY 0x0000 with the register of what is left. */
void co_device_clear(struct co_device *device, uint16_t code);

/* The same for one of several causes that share a code; cause 0 is the profile's own. */
void co_device_raise_for(struct co_device *device, uint16_t code, uint8_t cause,
                         uint8_t register_bits, const uint8_t *vendor);
void co_device_clear_for(struct co_device *device, uint16_t code, uint8_t cause);

/* Whether an error with this code is active, whatever its cause. */
bool co_device_has_error(const struct co_device *device, uint16_t code);

static inline bool co_device_is_operational(const struct co_device *device)
{
    return device->state == CO_STATE_OPERATIONAL;
}

/* The communication objects every device has; base is struct co_comm. */
extern const struct co_entry co_comm_objects[];
extern const uint16_t co_comm_object_count;

#endif
