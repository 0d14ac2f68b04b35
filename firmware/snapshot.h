/* The control task's whole state as bytes, to go on from in a replay.
 *
 * Fields are copied one by one, without pointers and padding between them, so a
 * snapshot of the target can be restored on the host: both are little-endian,
 * have 32-bit enumerations and IEEE 754 floats.
 */
#ifndef FIRMWARE_SNAPSHOT_H
#define FIRMWARE_SNAPSHOT_H

#include <stddef.h>
#include <stdint.h>

#include "firmware/control_task.h"
#include "hal/devices/device_drives.h"

/* What a snapshot covers. Both stay the caller's. */
struct snapshot_source {
    struct control_task *task;
    struct device_drives *drives;
};

/* Size of every snapshot of this build with these drives. */
size_t snapshot_size(const struct snapshot_source *source);

/* Copies the state of *context (a struct snapshot_source) to `out`. Returns the
 * size, 0 when it exceeds `capacity`. Between ticks only. Cost: one copy. */
size_t snapshot_save(const void *context, uint8_t *out, size_t capacity);

/* Restores a snapshot, the parameters included, into a task whose gait branch is
 * that of the one it was taken from. Returns 0, or -1 when the size is another (then
 * nothing was changed). Between ticks only. */
int snapshot_restore(const struct snapshot_source *source, const uint8_t *bytes, size_t size);

#endif
