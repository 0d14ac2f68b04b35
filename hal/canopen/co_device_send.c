/* Sending a device's frames: used by every file of the device. */
#include <string.h>

#include "hal/canopen/co_device_internal.h"

bool co_device_send(struct co_device *device, uint32_t id, const uint8_t *data, unsigned length)
{
    struct can_msg message = {.id = id, .length = (uint8_t)length};
    memcpy(message.data, data, length);
    if (can_bus_send(&device->bus, &message) == CAN_OK) {
        return true;
    }
    co_device_count(&device->counters.send_failures);
    return false;
}
