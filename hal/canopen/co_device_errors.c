/* Emergencies of a device: error register, history, EMCY frames (CiA 301 clauses
 * 7.2.7, 7.5.2.2, 7.5.2.4). */
#include <string.h>

#include "hal/bus/bytes.h"
#include "hal/canopen/co_device_internal.h"
#include "hal/contract.h"

static void queue_emcy(struct co_device *device, uint16_t code, const uint8_t *vendor)
{
    if (device->emcy_count == CO_EMCY_QUEUE) { /* the newest says how things are now */
        co_device_count(&device->counters.emcy_lost);
        device->emcy_count--;
        memmove(device->emcy_queue[0], device->emcy_queue[1],
                (size_t)device->emcy_count * sizeof device->emcy_queue[0]);
    }
    uint8_t *frame = device->emcy_queue[device->emcy_count++];
    memset(frame, 0, 8);
    bytes_put_u16(frame, code);
    frame[2] = device->comm.error_register;
    if (vendor != NULL) {
        memcpy(frame + 3, vendor, 5);
    }
    device->next_due_ns = 0;
}

static void update_register(struct co_device *device)
{
    uint8_t bits = 0;
    for (unsigned i = 0; i < CO_ACTIVE_ERRORS_MAX; i++) {
        if (device->errors[i].code != CO_EMCY_NONE) {
            bits |= device->errors[i].register_bits | CO_ERROR_GENERIC;
        }
    }
    device->comm.error_register = bits;
}

bool co_device_has_error(const struct co_device *device, uint16_t code)
{
    for (unsigned i = 0; i < CO_ACTIVE_ERRORS_MAX; i++) {
        if (device->errors[i].code == code) {
            return true;
        }
    }
    return false;
}

static struct co_active_error *find(struct co_device *device, uint16_t code, uint8_t cause)
{
    for (unsigned i = 0; i < CO_ACTIVE_ERRORS_MAX; i++) {
        if (device->errors[i].code == code && device->errors[i].cause == cause) {
            return &device->errors[i];
        }
    }
    return NULL;
}

static void remember(struct co_device *device, uint16_t code, const uint8_t *vendor)
{
    struct co_comm *comm = &device->comm;
    memmove(comm->history + 1, comm->history, sizeof comm->history - sizeof comm->history[0]);
    comm->history[0] =
        (uint32_t)code | (vendor == NULL ? 0 : (uint32_t)bytes_get_u16(vendor) << 16);
    if (comm->history_count < CO_HISTORY_MAX) {
        comm->history_count++;
    }
}

void co_device_raise_for(struct co_device *device, uint16_t code, uint8_t cause,
                         uint8_t register_bits, const uint8_t *vendor)
{
    HAL_ASSERT(code != CO_EMCY_NONE);
    if (find(device, code, cause) != NULL) {
        return;
    }
    struct co_active_error *error = find(device, CO_EMCY_NONE, 0);
    if (error != NULL) {
        *error = (struct co_active_error){code, register_bits, cause};
    } else {
        co_device_count(&device->counters.errors_untracked);
    }
    update_register(device);
    remember(device, code, vendor);
    queue_emcy(device, code, vendor);
}

void co_device_clear_for(struct co_device *device, uint16_t code, uint8_t cause)
{
    struct co_active_error *error = code != CO_EMCY_NONE ? find(device, code, cause) : NULL;
    if (error == NULL) {
        return;
    }
    *error = (struct co_active_error){CO_EMCY_NONE, 0, 0};
    update_register(device);
    uint8_t what[5] = {0};
    bytes_put_u16(what, code); /* says which of them went away */
    queue_emcy(device, CO_EMCY_NONE, what);
}

void co_device_raise(struct co_device *device, uint16_t code, uint8_t register_bits,
                     const uint8_t *vendor)
{
    co_device_raise_for(device, code, CO_CAUSE_PROFILE, register_bits, vendor);
}

void co_device_clear(struct co_device *device, uint16_t code)
{
    co_device_clear_for(device, code, CO_CAUSE_PROFILE);
}

uint64_t co_device_process_emcy(struct co_device *device, uint64_t now_ns)
{
    if (device->emcy_count == 0) {
        return UINT64_MAX;
    }
    if (device->state == CO_STATE_STOPPED) {
        device->emcy_count = 0; /* a stopped node is silent but for its heartbeat */
        return UINT64_MAX;
    }
    const uint64_t inhibit_end_ns =
        device->emcy_sent_ns == 0
            ? 0
            : device->emcy_sent_ns + device->comm.emcy_inhibit_100us * CO_NS_PER_100US;
    if (now_ns < inhibit_end_ns) {
        return inhibit_end_ns;
    }
    if (!co_device_send(device, device->comm.emcy_cob_id & CAN_ID_STANDARD_MAX,
                        device->emcy_queue[0], 8)) {
        return now_ns;
    }
    device->emcy_sent_ns = now_ns;
    device->emcy_count--;
    memmove(device->emcy_queue[0], device->emcy_queue[1],
            (size_t)device->emcy_count * sizeof device->emcy_queue[0]);
    return device->emcy_count == 0 ? UINT64_MAX : now_ns;
}
