/* What the files of co_device share; not for its users. */
#ifndef HAL_CANOPEN_CO_DEVICE_INTERNAL_H
#define HAL_CANOPEN_CO_DEVICE_INTERNAL_H

#include "hal/canopen/co_device.h"

#define CO_NS_PER_MS UINT64_C(1000000)
#define CO_NS_PER_100US UINT64_C(100000)

/* Causes of errors: RPDOs and heartbeat consumers count from 1. */
enum { CO_CAUSE_PROFILE = 0, CO_CAUSE_FIRST = 1, CO_CAUSE_BUS = 1 };

static inline void co_device_count(uint32_t *counter)
{
    if (*counter < UINT32_MAX) {
        (*counter)++;
    }
}

static inline uint64_t co_device_sooner(uint64_t a, uint64_t b)
{
    return a < b ? a : b;
}

/* Sends a frame of up to 8 bytes; a refusal is counted. */
bool co_device_send(struct co_device *device, uint32_t id, const uint8_t *data, unsigned length);

/* Hooks of the device's SDO server: communication objects are handled here, the rest
 * is passed to the profile. context is the struct co_device. */
uint32_t co_comm_writing(void *context, const struct co_entry *entry, const uint8_t *bytes,
                         unsigned length);
void co_comm_written(void *context, const struct co_entry *entry);
uint32_t co_comm_reading(void *context, const struct co_entry *entry);
uint32_t co_comm_begin(void *context, const struct co_entry *entry, uint32_t total);
uint32_t co_comm_take(void *context, const struct co_entry *entry, const uint8_t *bytes,
                      unsigned length, bool last);

void co_device_take_rpdo(struct co_device *device, unsigned number, const struct can_msg *message,
                         uint64_t now_ns);
/* What was received of this RPDO, and what was wrong with it, is of the past: it was written, or
 * PDOs came to life or ended. The errors are over. */
void co_device_forget_rpdo(struct co_device *device, unsigned number);
/* Its time-out is over, as the time was written anew; what waits for the SYNC is still to be used. */
void co_device_forget_rpdo_timeout(struct co_device *device, unsigned number);
void co_device_take_sync(struct co_device *device, uint64_t now_ns);

/* Each does what is due and returns when it wants to be called next. */
uint64_t co_device_process_rpdos(struct co_device *device, uint64_t now_ns);
uint64_t co_device_process_tpdos(struct co_device *device, uint64_t now_ns);
uint64_t co_device_process_emcy(struct co_device *device, uint64_t now_ns);

#endif
