/* A black box as a log that candump -L could have written and afo replay goes through from
 * the middle of a walk.
 *
 * What is no frame of the bus stands before the frames in 29-bit identifiers, of which this
 * bus has none: the identity of what recorded, and the snapshot to begin with, 8 bytes a
 * line. canplayer would play them; nobody listens to them. After a gap in the recording
 * comes the next snapshot, and the replay goes on from there.
 */
#ifndef SIM_HOST_LOG_BLACK_BOX_LOG_H
#define SIM_HOST_LOG_BLACK_BOX_LOG_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "hal/bus/can_bus.h"
#include "hal/storage/black_box.h"
#include "hal/storage/crash_record.h"

enum {
    BLACK_BOX_ID_IDENTITY = 0x1AB00000, /* build id u32, parameter CRC-32 u32 */
    BLACK_BOX_ID_VERSION = 0x1AB00100,  /* + i: eight characters of the version */
    BLACK_BOX_ID_BEGIN = 0x1AB00001,    /* tick of the snapshot u32, its bytes u32 */
    BLACK_BOX_ID_FOREIGN = 0x1AB00002,  /* the next frame has an identifier of the controller, but
                                           another node sent it */
    BLACK_BOX_ID_DATA = 0x1AB10000,     /* + i: bytes 8 i .. 8 i + 7 */
    BLACK_BOX_VERSION_MAX = 32
};

/* Writes, before the frames of a log, who recorded it: build, parameters, version (may be "").
 * Returns false when writing failed (ferror). */
bool black_box_log_identify(FILE *log, const char *interface, uint32_t build_id,
                            uint32_t parameter_crc, const char *version);

struct black_box_summary {
    uint32_t state, reason, trigger_tick, build_id, parameter_crc;
    uint32_t first_tick, last_tick;
    uint32_t blocks, frames, snapshots, damaged, lost_frames;
};

/* Writes what *box holds. version may be "". Returns 0; -1 when it holds nothing that can be
 * read, or writing failed (ferror). The summary says what was found in any case. */
int black_box_log_write(const struct black_box *box, const char *version, const char *interface,
                        FILE *log, struct black_box_summary *summary);

/* Fetches the black box of the orthosis controller over SDO (object 0x2040), and its version
 * (0x2030). When `freeze`, a box that still records is frozen first. bus and wait as in
 * sdo_upload.h. Returns 0, or -1 with the reason in message. */
int black_box_fetch(const struct can_bus *bus, bool (*wait)(void *context, unsigned waits),
                    void *context, bool freeze, struct black_box *box,
                    char version[BLACK_BOX_VERSION_MAX + 1], char *message, size_t size);

/* Reads what the controller's last crash left (0x2032) into *record: magic 0 when nothing, or
 * it was seen. Results as above. */
int black_box_fetch_crash(const struct can_bus *bus, bool (*wait)(void *context, unsigned waits),
                          void *context, struct crash_record *record, char *message, size_t size);

/* Lets the box of the controller record anew, and calls its crash record seen. Results as
 * above. */
int black_box_release(const struct can_bus *bus, bool (*wait)(void *context, unsigned waits),
                      void *context, char *message, size_t size);

#endif
