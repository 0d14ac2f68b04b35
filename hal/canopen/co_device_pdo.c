/* PDO traffic of a device: receiving, SYNC, event transmission and time-outs. */
#include <string.h>

#include "hal/canopen/co_device_internal.h"
#include "hal/contract.h"

static void apply_rpdo(struct co_device *device, unsigned number, const uint8_t *data)
{
    const struct co_pdo *pdo = &device->comm.rpdo[number];
    unsigned at = 0;
    for (unsigned i = 0; i < pdo->map_count; i++) {
        const struct co_pdo_slot *slot = &pdo->slot[i];
        if (slot->entry != NULL) {
            /* A value out of limits leaves the old one: no SDO here to say so. */
            (void)co_access_write(&device->hooks, device, slot->entry, slot->base, data + at,
                                  slot->size);
        }
        at += slot->size;
    }
}

static uint8_t cause_of(unsigned number)
{
    return (uint8_t)(CO_CAUSE_FIRST + number);
}

/* CiA 301 clause 7.2.7.1, table 26: 0x8210 when it is too short, 0x8220 when it is too long. */
static void judge_length(struct co_device *device, unsigned number, unsigned length)
{
    const unsigned wanted = device->comm.rpdo[number].length;
    const uint8_t cause = cause_of(number);
    if (length == wanted) {
        if (device->comm.error_register != 0) {
            co_device_clear_for(device, CO_EMCY_PDO_TOO_SHORT, cause);
            co_device_clear_for(device, CO_EMCY_PDO_TOO_LONG, cause);
        }
        return;
    }
    co_device_count(&device->counters.rpdo_length_errors);
    co_device_raise_for(device, length < wanted ? CO_EMCY_PDO_TOO_SHORT : CO_EMCY_PDO_TOO_LONG,
                        cause, CO_ERROR_COMMUNICATION, NULL);
}

void co_device_forget_rpdo_timeout(struct co_device *device, unsigned number)
{
    device->comm.rpdo[number].timed_out = false;
    co_device_clear_for(device, CO_EMCY_RPDO_TIMEOUT, cause_of(number));
}

void co_device_forget_rpdo(struct co_device *device, unsigned number)
{
    struct co_pdo *pdo = &device->comm.rpdo[number];
    pdo->waiting = false;
    pdo->seen = false;
    co_device_forget_rpdo_timeout(device, number);
    co_device_clear_for(device, CO_EMCY_PDO_TOO_SHORT, cause_of(number));
    co_device_clear_for(device, CO_EMCY_PDO_TOO_LONG, cause_of(number));
}

void co_device_take_rpdo(struct co_device *device, unsigned number, const struct can_msg *message,
                         uint64_t now_ns)
{
    struct co_pdo *pdo = &device->comm.rpdo[number];
    if (device->state != CO_STATE_OPERATIONAL) {
        return;
    }
    judge_length(device, number, message->length);
    if (message->length < pdo->length) {
        return;
    }
    pdo->last_ns = now_ns;
    pdo->seen = true;
    if (pdo->event_ms != 0) {
        const uint64_t due_ns = now_ns + pdo->event_ms * CO_NS_PER_MS;
        device->next_due_ns = due_ns < device->next_due_ns ? due_ns : device->next_due_ns;
    }
    if (pdo->timed_out) {
        pdo->timed_out = false;
        co_device_clear_for(device, CO_EMCY_RPDO_TIMEOUT, cause_of(number));
        if (device->config.ops->rpdo_timeout != NULL) {
            device->config.ops->rpdo_timeout(device->config.context, number, false, now_ns);
        }
    }
    if (co_pdo_is_synchronous(pdo)) {
        memcpy(pdo->data, message->data, sizeof pdo->data);
        pdo->waiting = true;
    } else {
        apply_rpdo(device, number, message->data);
    }
}

static bool send_tpdo(struct co_device *device, struct co_pdo *pdo, uint64_t now_ns)
{
    uint8_t data[CAN_FRAME_DATA_MAX];
    const unsigned length = co_pdo_pack(pdo, data);
    if (!co_device_send(device, co_pdo_id(pdo), data, length)) {
        return false;
    }
    pdo->last_ns = now_ns;
    return true;
}

void co_device_take_sync(struct co_device *device, uint64_t now_ns)
{
    if (device->state != CO_STATE_OPERATIONAL) {
        return;
    }
    for (unsigned i = 0; i < device->comm.rpdo_count; i++) {
        struct co_pdo *pdo = &device->comm.rpdo[i];
        if (pdo->waiting) { /* switched off, it waits no more: co_comm_written() */
            pdo->waiting = false;
            apply_rpdo(device, i, pdo->data);
        }
    }
    if (device->config.ops->sync != NULL) {
        device->config.ops->sync(device->config.context, now_ns);
    }
    for (unsigned i = 0; i < device->comm.tpdo_count; i++) {
        struct co_pdo *pdo = &device->comm.tpdo[i];
        if (!co_pdo_is_valid(pdo) || !co_pdo_is_synchronous(pdo)) {
            continue;
        }
        if (pdo->type == CO_SYNC_ACYCLIC) {
            if (pdo->waiting) {
                pdo->waiting = !send_tpdo(device, pdo, now_ns);
            }
        } else if (++pdo->sync_count >= pdo->type) {
            pdo->sync_count = 0;
            (void)send_tpdo(device, pdo, now_ns);
        }
    }
}

void co_device_trigger_tpdo(struct co_device *device, unsigned number)
{
    HAL_ASSERT(number < device->comm.tpdo_count);
    struct co_pdo *pdo = &device->comm.tpdo[number];
    if (pdo->type == CO_SYNC_ACYCLIC || pdo->type >= CO_EVENT_MANUFACTURER) {
        pdo->waiting = true;
        device->next_due_ns = 0;
    }
}

uint64_t co_device_process_rpdos(struct co_device *device, uint64_t now_ns)
{
    uint64_t due_ns = UINT64_MAX;
    if (device->state != CO_STATE_OPERATIONAL) {
        return due_ns;
    }
    for (unsigned i = 0; i < device->comm.rpdo_count; i++) {
        struct co_pdo *pdo = &device->comm.rpdo[i];
        const uint64_t limit_ns = pdo->event_ms * CO_NS_PER_MS;
        if (limit_ns == 0 || !pdo->seen || pdo->timed_out) {
            continue;
        }
        if (now_ns - pdo->last_ns < limit_ns) {
            due_ns = co_device_sooner(due_ns, pdo->last_ns + limit_ns);
            continue;
        }
        const uint8_t vendor[5] = {(uint8_t)(i + 1)};
        pdo->timed_out = true;
        co_device_raise_for(device, CO_EMCY_RPDO_TIMEOUT, cause_of(i), CO_ERROR_COMMUNICATION,
                            vendor);
        if (device->config.ops->rpdo_timeout != NULL) {
            device->config.ops->rpdo_timeout(device->config.context, i, true, now_ns);
        }
    }
    return due_ns;
}

uint64_t co_device_process_tpdos(struct co_device *device, uint64_t now_ns)
{
    uint64_t due_ns = UINT64_MAX;
    if (device->state != CO_STATE_OPERATIONAL) {
        return due_ns;
    }
    for (unsigned i = 0; i < device->comm.tpdo_count; i++) {
        struct co_pdo *pdo = &device->comm.tpdo[i];
        if (!co_pdo_is_valid(pdo) || pdo->type < CO_EVENT_MANUFACTURER) {
            continue;
        }
        const uint64_t event_ns = pdo->event_ms * CO_NS_PER_MS;
        const uint64_t inhibit_end_ns =
            pdo->last_ns == 0 ? 0 : pdo->last_ns + pdo->inhibit_100us * CO_NS_PER_100US;
        if (event_ns != 0 && now_ns - pdo->last_ns >= event_ns) {
            pdo->waiting = true;
        }
        if (pdo->waiting && now_ns >= inhibit_end_ns) {
            pdo->waiting = !send_tpdo(device, pdo, now_ns);
        }
        if (pdo->waiting) {
            due_ns = co_device_sooner(due_ns, inhibit_end_ns > now_ns ? inhibit_end_ns : now_ns);
        }
        if (event_ns != 0) {
            due_ns = co_device_sooner(due_ns, pdo->last_ns + event_ns);
        }
    }
    return due_ns;
}
