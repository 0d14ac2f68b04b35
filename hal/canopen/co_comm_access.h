/* Rules for writing communication objects; used by co_device.c only. */
#ifndef HAL_CANOPEN_CO_COMM_ACCESS_H
#define HAL_CANOPEN_CO_COMM_ACCESS_H

#include "hal/canopen/co_device.h"

/* Hooks of the device's SDO server: communication objects are handled here, the
 * rest is passed to the profile. context is the struct co_device. */
uint32_t co_comm_writing(void *context, const struct co_entry *entry, const uint8_t *bytes,
                         unsigned length);
void co_comm_written(void *context, const struct co_entry *entry);
void co_comm_reading(void *context, const struct co_entry *entry);

#endif
