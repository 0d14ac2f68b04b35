/* The checksum that watches the parameters in force: memory that changes by itself is found
 * within one round of the scan.
 *
 * The checksum goes along with every change that is meant (params_guard_change); a scan, some
 * bytes in each tick, computes it anew and compares.
 */
#ifndef FIRMWARE_PARAMS_GUARD_H
#define FIRMWARE_PARAMS_GUARD_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "controller/control_params.h"

enum { PARAMS_GUARD_SCAN_BYTES = 16 }; /* in each tick */

/* The parameters' own bytes, before the pointer and what aligns it. */
#define PARAMS_GUARD_OWN_BYTES (offsetof(struct control_params, table) + sizeof(struct speed_table))

struct params_guard {
    uint32_t so_far, expected; /* of the round under way */
    uint16_t at;               /* bytes done in it */
    bool corrupt;              /* the last comparison failed */
};

/* CRC-32 over the parameters' values and tables, not over where they lie: the same on every
 * machine. Pure; about 11 instructions a byte. */
uint32_t params_guard_crc(const struct control_params *params);

/* Changes the parameter at this offset in struct control_params, and its part of *crc. The
 * others are not read: what a failing memory did to one of them is not taken for meant.
 * Loop only; O(1). */
void params_guard_change(struct control_params *params, uint32_t *crc, size_t offset, float value);

/* Once a tick: carries the scan PARAMS_GUARD_SCAN_BYTES further, and at the end of a round sets
 * guard->corrupt by the comparison with `crc`. A round during which `crc` changed decides
 * nothing. One round takes the parameters' and their tables' bytes / PARAMS_GUARD_SCAN_BYTES
 * ticks. Loop only; O(1). */
void params_guard_scan(struct params_guard *guard, const struct control_params *params,
                       uint32_t crc);

#endif
