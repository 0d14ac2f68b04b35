/* Rules for writing communication objects. */
#include <string.h>

#include "hal/bus/bytes.h"
#include "hal/canopen/co_device_internal.h"

enum {
    RPDO_COMMUNICATION = 0x1400,
    RPDO_MAPPING = 0x1600,
    TPDO_COMMUNICATION = 0x1800,
    TPDO_MAPPING = 0x1A00,
    PROGRAM_DATA = 0x1F50, /* CiA 302-3 begins here, the profile's area at 0x2000 */
    HISTORY = 0x1003,
    STORE_PARAMETERS = 0x1010,
    RESTORE_PARAMETERS = 0x1011,
    SUB_COB_ID = 1,
    SUB_TYPE = 2,
    SUB_INHIBIT = 3,
    SUB_EVENT = 5
};

/* What the profile answers for: its own objects, programs, and storing parameters. */
static bool is_applications(uint16_t index)
{
    return index >= PROGRAM_DATA || index == STORE_PARAMETERS || index == RESTORE_PARAMETERS;
}

/* Identifiers that SYNC, EMCY, PDOs and SDOs must not be given: CiA 301 table 41, restricted
 * CAN-IDs (as in CANopenNode's 301/CO_driver.h, CO_IS_RESTRICTED_CAN_ID). Of these objects only the
 * PDOs' and the SYNC's can be written here. */
static bool is_restricted(uint32_t id)
{
    return id <= 0x07F || (id >= 0x101 && id <= 0x180) || (id >= 0x581 && id <= 0x5FF) ||
           (id >= 0x601 && id <= 0x67F) || (id >= 0x6E0 && id <= 0x6FF) || id >= 0x701;
}

/* Bit 30 may be set in both directions: it is not part of the identifier. An RPDO keeps it as it
 * was written (as in CANopenNode's 301/CO_PDO.c); tools set it, and some devices demand it. */
static uint32_t writing_cob_id(const struct co_device *device, const struct co_pdo *pdo,
                               uint32_t wanted)
{
    const uint32_t id = wanted & ~(CO_PDO_INVALID | CO_PDO_NO_RTR);
    if (id > CAN_ID_STANDARD_MAX) { /* 29 bits of identifier, or bits that have no meaning */
        return CO_ABORT_VALUE;
    }
    if ((wanted & CO_PDO_INVALID) != 0) {
        return CO_ABORT_NONE;
    }
    if (is_restricted(id) || id == CO_COB_SYNC ||
        id == (device->comm.sync_cob_id & CAN_ID_STANDARD_MAX)) {
        return CO_ABORT_VALUE;
    }
    /* A living PDO keeps its identifier: switch it off first. */
    return co_pdo_is_valid(pdo) && co_pdo_id(pdo) != id ? CO_ABORT_VALUE : CO_ABORT_NONE;
}

static bool is_of_a_pdo(const struct co_pdo *pdos, unsigned count, uint32_t id)
{
    bool is = false;
    for (unsigned i = 0; i < count; i++) {
        is = is || (co_pdo_is_valid(&pdos[i]) && co_pdo_id(&pdos[i]) == id);
    }
    return is;
}

/* 0x1005. Whether SYNC is sent (bit 30) is the device's own matter; while it is, the identifier
 * stays (CiA 301 clause 7.5.2.5). */
static uint32_t writing_sync(const struct co_comm *comm, uint32_t wanted)
{
    const uint32_t id = wanted & ~CO_SYNC_PRODUCER;
    if (((wanted ^ comm->sync_cob_id) & CO_SYNC_PRODUCER) != 0 || id > CAN_ID_STANDARD_MAX ||
        is_restricted(id) || is_of_a_pdo(comm->rpdo, comm->rpdo_count, id) ||
        is_of_a_pdo(comm->tpdo, comm->tpdo_count, id)) {
        return CO_ABORT_VALUE;
    }
    return (wanted & CO_SYNC_PRODUCER) != 0 && wanted != comm->sync_cob_id ? CO_ABORT_VALUE
                                                                           : CO_ABORT_NONE;
}

/* 0x1006: who sends SYNC has a period that nobody can write here; who does not, waits for none. */
static uint32_t writing_sync_period(const struct co_comm *comm, uint32_t wanted_us)
{
    const bool sends = (comm->sync_cob_id & CO_SYNC_PRODUCER) != 0;
    return sends && wanted_us != comm->sync_period_us ? CO_ABORT_VALUE : CO_ABORT_NONE;
}

static uint32_t writing_parameter(const struct co_device *device, const struct co_pdo *pdo,
                                  uint8_t sub, const uint8_t *bytes)
{
    switch (sub) {
    case SUB_COB_ID:
        return writing_cob_id(device, pdo, bytes_get_u32(bytes));
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
            return CO_ABORT_INCOMPATIBLE; /* CiA 301 clause 7.5.2.19: one entry per node */
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
        return writing_parameter(device, &device->comm.rpdo[number], entry->sub, bytes);
    case RPDO_MAPPING:
        return writing_mapping(device, &device->comm.rpdo[number], entry->sub, bytes, CO_MAP_RX);
    case TPDO_COMMUNICATION:
        return writing_parameter(device, &device->comm.tpdo[number], entry->sub, bytes);
    case TPDO_MAPPING:
        return writing_mapping(device, &device->comm.tpdo[number], entry->sub, bytes, CO_MAP_TX);
    default:
        break;
    }
    if (index == HISTORY) { /* 0 empties it, and nothing else may be written */
        return bytes[0] == 0 ? CO_ABORT_NONE : CO_ABORT_VALUE;
    }
    if (index == 0x1005) {
        return writing_sync(&device->comm, bytes_get_u32(bytes));
    }
    if (index == 0x1006) {
        return writing_sync_period(&device->comm, bytes_get_u32(bytes));
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
    if (entry->index == HISTORY) {
        memset(device->comm.history, 0, sizeof device->comm.history);
    } else if (entry->index == 0x1016) {
        device->consumers[entry->sub - 1] = (struct co_consumer_state){.state = 0xFF};
        co_device_clear_for(device, CO_EMCY_HEARTBEAT, entry->sub);
    } else if (entry->index == 0x1017) {
        device->heartbeat_due_ns = 0; /* the new period starts with a heartbeat */
    } else if ((entry->index & 0xFF00) == RPDO_COMMUNICATION) {
        if (entry->sub == SUB_EVENT) {
            co_device_forget_rpdo_timeout(device, entry->index & 0xFFU);
        } else {
            co_device_forget_rpdo(device, entry->index & 0xFFU);
        }
    } else if ((entry->index & 0xFF00) == TPDO_COMMUNICATION) {
        struct co_pdo *pdo = &device->comm.tpdo[entry->index & 0xFFU];
        pdo->cob_id |= CO_PDO_NO_RTR; /* whatever was written: remote requests are not answered */
        pdo->sync_count = 0;
        pdo->waiting = pdo->type >= CO_EVENT_MANUFACTURER;
    }
}

uint32_t co_comm_reading(void *context, const struct co_entry *entry)
{
    struct co_device *device = context;
    if (is_applications(entry->index) && device->config.ops->access.reading != NULL) {
        return device->config.ops->access.reading(device->config.context, entry);
    }
    /* CiA 301 clause 7.5.2.4: where no error is, there is nothing to read. */
    return entry->index == HISTORY && entry->sub > device->comm.history_count ? CO_ABORT_NO_DATA
                                                                              : CO_ABORT_NONE;
}

/* Domains are the application's; its tables say which can be written. */
uint32_t co_comm_begin(void *context, const struct co_entry *entry, uint32_t total)
{
    const struct co_device *device = context;
    const struct co_device_ops *ops = device->config.ops;
    return ops->access.begin == NULL || ops->access.take == NULL
               ? CO_ABORT_ACCESS
               : ops->access.begin(device->config.context, entry, total);
}

uint32_t co_comm_take(void *context, const struct co_entry *entry, const uint8_t *bytes,
                      unsigned length, bool last)
{
    const struct co_device *device = context;
    const struct co_device_ops *ops = device->config.ops;
    return ops->access.take(device->config.context, entry, bytes, length, last);
}
