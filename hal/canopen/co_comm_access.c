/* Rules for writing communication objects. */
#include <string.h>

#include "hal/bus/bytes.h"
#include "hal/canopen/co_device_internal.h"

enum {
    RPDO_COMMUNICATION = 0x1400,
    RPDO_MAPPING = 0x1600,
    TPDO_COMMUNICATION = 0x1800,
    TPDO_MAPPING = 0x1A00,
    AREA_LAST = 0x1FFF,
    STORE_PARAMETERS = 0x1010,
    RESTORE_PARAMETERS = 0x1011,
    SUB_COB_ID = 1,
    SUB_TYPE = 2,
    SUB_INHIBIT = 3
};

/* What the profile answers for: its own objects, and storing parameters. */
static bool is_applications(uint16_t index)
{
    return index > AREA_LAST || index == STORE_PARAMETERS || index == RESTORE_PARAMETERS;
}

static const uint32_t ID_BITS = 0x1FFFFFFFU;
static const uint32_t EXTENDED_BIT = 0x20000000U;

/* Identifiers a PDO must not take: CiA 301 table 41, restricted COB-IDs. */
static bool is_restricted(uint32_t id)
{
    return id <= 0x07F || (id >= 0x101 && id <= 0x180) || (id >= 0x581 && id <= 0x5FF) ||
           (id >= 0x601 && id <= 0x67F) || (id >= 0x6E0 && id <= 0x6FF) || id >= 0x701 ||
           id == CO_COB_SYNC;
}

static uint32_t writing_cob_id(const struct co_pdo *pdo, uint32_t wanted)
{
    if ((wanted & EXTENDED_BIT) != 0) {
        return CO_ABORT_VALUE;
    }
    if ((wanted & CO_PDO_INVALID) != 0) {
        return CO_ABORT_NONE;
    }
    const uint32_t id = wanted & ID_BITS;
    if (id > CAN_ID_STANDARD_MAX || is_restricted(id)) {
        return CO_ABORT_VALUE;
    }
    /* A living PDO keeps its identifier: switch it off first. */
    if (co_pdo_is_valid(pdo) && (pdo->cob_id & ID_BITS) != id) {
        return CO_ABORT_VALUE;
    }
    return CO_ABORT_NONE;
}

static uint32_t writing_parameter(const struct co_pdo *pdo, uint8_t sub, const uint8_t *bytes)
{
    switch (sub) {
    case SUB_COB_ID:
        return writing_cob_id(pdo, bytes_get_u32(bytes));
    case SUB_TYPE: /* 241..253: reserved, or on remote request, which nobody here sends */
        return bytes[0] > CO_SYNC_MAX && bytes[0] < CO_EVENT_MANUFACTURER ? CO_ABORT_VALUE
                                                                          : CO_ABORT_NONE;
    case SUB_INHIBIT:
        return co_pdo_is_valid(pdo) ? CO_ABORT_ACCESS : CO_ABORT_NONE;
    default:
        return CO_ABORT_NONE;
    }
}

static uint32_t writing_mapping(struct co_device *device, struct co_pdo *pdo, uint8_t sub,
                                const uint8_t *bytes, enum co_access direction)
{
    if (co_pdo_is_valid(pdo)) {
        return CO_ABORT_ACCESS;
    }
    if (sub == 0) {
        return co_pdo_resolve(pdo, bytes[0], device->dictionaries, CO_DICTIONARIES, direction);
    }
    if (pdo->map_count != 0) {
        return CO_ABORT_ACCESS;
    }
    struct co_pdo_slot slot;
    const uint32_t map = bytes_get_u32(bytes);
    return map == 0
               ? CO_ABORT_NONE
               : co_pdo_check_entry(map, device->dictionaries, CO_DICTIONARIES, direction, &slot);
}

static uint32_t writing_consumer(const struct co_device *device, uint8_t sub, uint32_t wanted)
{
    const uint32_t node = wanted >> 16 & 0xFFU;
    if (wanted >> 24 != 0 || node > CO_NODE_MAX) {
        return CO_ABORT_VALUE;
    }
    for (unsigned i = 0; i < CO_HEARTBEATS_MAX; i++) {
        const uint32_t other = device->comm.consumer[i];
        if (i + 1 != sub && node != 0 && (wanted & 0xFFFFU) != 0 && (other >> 16 & 0xFFU) == node &&
            (other & 0xFFFFU) != 0) {
            return CO_ABORT_ACCESS; /* CiA 301: one entry per node, 0x06040043 or this */
        }
    }
    return CO_ABORT_NONE;
}

uint32_t co_comm_writing(void *context, const struct co_entry *entry, const uint8_t *bytes,
                         unsigned length)
{
    struct co_device *device = context;
    const uint16_t index = entry->index;
    const unsigned number = index & 0xFFU;
    if (is_applications(index)) {
        const struct co_device_ops *ops = device->config.ops;
        return ops->access.writing == NULL
                   ? CO_ABORT_NONE
                   : ops->access.writing(device->config.context, entry, bytes, length);
    }
    switch (index & 0xFF00) {
    case RPDO_COMMUNICATION:
        return writing_parameter(&device->comm.rpdo[number], entry->sub, bytes);
    case RPDO_MAPPING:
        return writing_mapping(device, &device->comm.rpdo[number], entry->sub, bytes, CO_MAP_RX);
    case TPDO_COMMUNICATION:
        return writing_parameter(&device->comm.tpdo[number], entry->sub, bytes);
    case TPDO_MAPPING:
        return writing_mapping(device, &device->comm.tpdo[number], entry->sub, bytes, CO_MAP_TX);
    default:
        break;
    }
    if (index == 0x1005) {
        /* Consumer only: generating SYNC (bit 30) is not this device's business. */
        return bytes_get_u32(bytes) > CAN_ID_STANDARD_MAX ? CO_ABORT_VALUE : CO_ABORT_NONE;
    }
    if (index == 0x1016) {
        return writing_consumer(device, entry->sub, bytes_get_u32(bytes));
    }
    return CO_ABORT_NONE;
}

void co_comm_written(void *context, const struct co_entry *entry)
{
    struct co_device *device = context;
    device->next_due_ns = 0; /* whatever was planned, plan again */
    if (is_applications(entry->index)) {
        const struct co_device_ops *ops = device->config.ops;
        if (ops->access.written != NULL) {
            ops->access.written(device->config.context, entry);
        }
        return;
    }
    if (entry->index == 0x1003) {
        memset(device->comm.history, 0, sizeof device->comm.history);
    } else if (entry->index == 0x1016) {
        device->consumers[entry->sub - 1] = (struct co_consumer_state){.state = 0xFF};
    } else if (entry->index == 0x1017) {
        device->heartbeat_due_ns = 0; /* the new period starts with a heartbeat */
    } else if ((entry->index & 0xFF00) == RPDO_COMMUNICATION) {
        struct co_pdo *pdo = &device->comm.rpdo[entry->index & 0xFFU];
        pdo->waiting = false;
        pdo->seen = false;
        pdo->timed_out = false;
    } else if ((entry->index & 0xFF00) == TPDO_COMMUNICATION) {
        struct co_pdo *pdo = &device->comm.tpdo[entry->index & 0xFFU];
        pdo->sync_count = 0;
        pdo->waiting = pdo->type >= CO_EVENT_MANUFACTURER;
    }
}

void co_comm_reading(void *context, const struct co_entry *entry)
{
    struct co_device *device = context;
    if (is_applications(entry->index) && device->config.ops->access.reading != NULL) {
        device->config.ops->access.reading(device->config.context, entry);
    }
}
