#include "sim_host/log/sdo_upload.h"

#include <string.h>

#include "hal/bus/bytes.h"
#include "hal/canopen/co_defs.h"

/* Byte 0 of requests and answers (CiA 301, figures 31 to 38). */
enum {
    REQUEST_WRITE = 0x23,
    REQUEST_READ = 0x40,
    REQUEST_SEGMENT = 0x60,
    COMMAND_MASK = 0xE0,
    ANSWER_SEGMENT = 0x00,
    ANSWER_READ = 0x40,
    ANSWER_WRITTEN = 0x60,
    ANSWER_ABORT = 0x80,
    EXPEDITED = 1 << 1,
    SIZE_INDICATED = 1 << 0,
    TOGGLE = 1 << 4,
    LAST = 1 << 0,
    SEGMENT_BYTES = 7
};

static enum sdo_upload_result ask(struct sdo_upload *upload, const uint8_t *request,
                                  uint8_t *answer)
{
    struct can_msg message = {.id = CO_COB_SDO_REQUEST + (uint32_t)upload->node, .length = 8};
    unsigned waits = 0;

    memcpy(message.data, request, 8);
    while (can_bus_send(upload->bus, &message) != CAN_OK) {
        if (!upload->wait(upload->context, waits++)) {
            return SDO_UPLOAD_SILENT;
        }
    }
    for (;;) {
        while (can_bus_receive(upload->bus, &message, NULL) == CAN_OK) {
            if (message.id != CO_COB_SDO_ANSWER + (uint32_t)upload->node || message.flags != 0 ||
                message.length != 8) {
                continue;
            }
            memcpy(answer, message.data, 8);
            upload->abort_code = bytes_get_u32(answer + 4);
            return (answer[0] & COMMAND_MASK) == ANSWER_ABORT ? SDO_UPLOAD_ABORTED
                                                              : SDO_UPLOAD_DONE;
        }
        if (!upload->wait(upload->context, waits++)) {
            return SDO_UPLOAD_SILENT;
        }
    }
}

static void address(uint8_t *request, uint8_t command, uint16_t index, uint8_t sub)
{
    memset(request, 0, 8);
    request[0] = command;
    bytes_put_u16(request + 1, index);
    request[3] = sub;
}

enum sdo_upload_result sdo_upload(struct sdo_upload *upload, uint16_t index, uint8_t sub,
                                  uint8_t *bytes, size_t capacity, size_t *length)
{
    uint8_t request[8], answer[8], toggle = 0;
    enum sdo_upload_result result;

    *length = 0;
    address(request, REQUEST_READ, index, sub);
    result = ask(upload, request, answer);
    if (result != SDO_UPLOAD_DONE || (answer[0] & COMMAND_MASK) != ANSWER_READ) {
        return result != SDO_UPLOAD_DONE ? result : SDO_UPLOAD_SILENT;
    }
    if ((answer[0] & EXPEDITED) != 0) {
        const size_t size = (answer[0] & SIZE_INDICATED) != 0 ? 4u - (answer[0] >> 2 & 3u) : 4u;
        *length = size < capacity ? size : capacity;
        memcpy(bytes, answer + 4, *length);
        return size <= capacity ? SDO_UPLOAD_DONE : SDO_UPLOAD_TOO_LARGE;
    }
    do {
        memset(request, 0, sizeof request);
        request[0] = (uint8_t)(REQUEST_SEGMENT | toggle);
        result = ask(upload, request, answer);
        if (result != SDO_UPLOAD_DONE) {
            return result;
        }
        const size_t size = SEGMENT_BYTES - (answer[0] >> 1 & 7u);
        if ((answer[0] & (COMMAND_MASK | TOGGLE)) != (ANSWER_SEGMENT | toggle)) {
            return SDO_UPLOAD_SILENT; /* an answer to somebody else's question */
        }
        if (*length + size > capacity) {
            return SDO_UPLOAD_TOO_LARGE;
        }
        memcpy(bytes + *length, answer + 1, size);
        *length += size;
        toggle ^= TOGGLE;
    } while ((answer[0] & LAST) == 0);
    return SDO_UPLOAD_DONE;
}

enum sdo_upload_result sdo_write(struct sdo_upload *upload, uint16_t index, uint8_t sub,
                                 uint32_t value, unsigned size)
{
    uint8_t request[8], answer[8];

    address(request, (uint8_t)(REQUEST_WRITE | (4u - size) << 2), index, sub);
    bytes_put_u32(request + 4, value);
    const enum sdo_upload_result result = ask(upload, request, answer);
    return result == SDO_UPLOAD_DONE && (answer[0] & COMMAND_MASK) != ANSWER_WRITTEN
               ? SDO_UPLOAD_SILENT
               : result;
}
