/* Reads a large object (a domain) from a node over SDO, segment by segment (CiA 301 clause
 * 7.2.4.3.6), into the caller's memory, or writes one. For tools; hal's own client takes small values.
 */
#ifndef SIM_HOST_LOG_SDO_UPLOAD_H
#define SIM_HOST_LOG_SDO_UPLOAD_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "hal/bus/can_bus.h"

enum sdo_upload_result {
    SDO_UPLOAD_DONE = 0,
    SDO_UPLOAD_ABORTED = -1,   /* abort_code is the node's */
    SDO_UPLOAD_SILENT = -2,    /* no answer within the waits allowed */
    SDO_UPLOAD_TOO_LARGE = -3, /* more than the memory holds */
    SDO_UPLOAD_DISTURBED = -4  /* another client spoke with the node in the middle of it */
};

struct sdo_upload {
    const struct can_bus *bus;
    uint8_t node;
    /* Called while nothing has come: lets time pass, in a simulation by running it. Returns
     * false when it has been long enough. */
    bool (*wait)(void *context, unsigned waits);
    void *context;
    uint32_t abort_code;
};

/* Reads index:sub into bytes[capacity] and its length into *length. Blocks as wait does. Answers
 * that name another object are another client's and are left alone. What waits to be received when
 * it is called is dropped. */
enum sdo_upload_result sdo_upload(struct sdo_upload *upload, uint16_t index, uint8_t sub,
                                  uint8_t *bytes, size_t capacity, size_t *length);

/* Writes `length` bytes, segment by segment. told, which may be NULL, hears how many are through.
 * Results as above. */
enum sdo_upload_result sdo_download(struct sdo_upload *upload, uint16_t index, uint8_t sub,
                                    const uint8_t *bytes, size_t length,
                                    void (*told)(void *context, size_t done), void *told_context);

/* Writes up to 4 bytes, expedited. Results as above. */
enum sdo_upload_result sdo_write(struct sdo_upload *upload, uint16_t index, uint8_t sub,
                                 uint32_t value, unsigned size);

#endif
