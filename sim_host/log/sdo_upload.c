#include "sim_host/log/sdo_upload.h"

#include <string.h>

#include "hal/bus/bytes.h"
#include "hal/canopen/co_defs.h"

/* Byte 0 of requests and answers (CiA 301, figures 31 to 38). */
enum {
    REQUEST_WRITE = 0x23,
    REQUEST_WRITE_SEGMENTS = 0x21,
    REQUEST_READ = 0x40,
    REQUEST_SEGMENT = 0x60,
    COMMAND_MASK = 0xE0,
    ANSWER_SEGMENT = 0x00,
    ANSWER_SEGMENT_WRITTEN = 0x20,
    ANSWER_READ = 0x40,
    ANSWER_WRITTEN = 0x60,
    ANSWER_ABORT = 0x80,
    EXPEDITED = 1 << 1,
    SIZE_INDICATED = 1 << 0,
    TOGGLE = 1 << 4,
    LAST = 1 << 0,
    SEGMENT_BYTES = 7
};

static bool is_answer(const struct sdo_upload *upload, const struct can_msg *message)
{
    return message->id == CO_COB_SDO_ANSWER + (uint32_t)upload->node && message->flags == 0 &&
           message->length == 8;
}

/* What waits was said before the question that comes now. */
static void forget_old_answers(const struct sdo_upload *upload)
{
    struct can_msg message;
    while (can_bus_receive(upload->bus, &message, NULL) == CAN_OK) {
    }
}

static bool send(const struct sdo_upload *upload, const uint8_t *request, unsigned *waits)
{
    struct can_msg message = {.id = CO_COB_SDO_REQUEST + (uint32_t)upload->node, .length = 8};
    memcpy(message.data, request, 8);
    while (can_bus_send(upload->bus, &message) != CAN_OK) {
        if (!upload->wait(upload->context, (*waits)++)) {
            return false;
        }
    }
    return true;
}

/* The node's next answer, whoever it is for. */
static bool next_answer(const struct sdo_upload *upload, uint8_t *answer, unsigned *waits)
{
    struct can_msg message;
    for (;;) {
        while (can_bus_receive(upload->bus, &message, NULL) == CAN_OK) {
            if (is_answer(upload, &message)) {
                memcpy(answer, message.data, 8);
                return true;
            }
        }
        if (!upload->wait(upload->context, (*waits)++)) {
            return false;
        }
    }
}

static bool same_object(const uint8_t *request, const uint8_t *answer)
{
    return memcmp(request + 1, answer + 1, 3) == 0;
}

/* Sends the start of a transfer and takes the answer that names its object; the others are another
 * client's. */
static enum sdo_upload_result start(struct sdo_upload *upload, const uint8_t *request,
                                    uint8_t expected, uint8_t *answer)
{
    unsigned waits = 0;

    forget_old_answers(upload);
    if (!send(upload, request, &waits)) {
        return SDO_UPLOAD_SILENT;
    }
    while (next_answer(upload, answer, &waits)) {
        const uint8_t command = answer[0] & COMMAND_MASK;
        if (same_object(request, answer) && command == ANSWER_ABORT) {
            upload->abort_code = bytes_get_u32(answer + 4);
            return SDO_UPLOAD_ABORTED;
        }
        if (same_object(request, answer) && command == expected) {
            return SDO_UPLOAD_DONE;
        }
    }
    return SDO_UPLOAD_SILENT;
}

/* Ends a transfer, and tells the node that it need not wait (CiA 301 clause 7.2.4.3.17). */
static enum sdo_upload_result give_up(const struct sdo_upload *upload, const uint8_t *first,
                                      uint32_t code, enum sdo_upload_result result)
{
    uint8_t request[8] = {ANSWER_ABORT, first[1], first[2], first[3]};
    unsigned waits = 0;

    bytes_put_u32(request + 4, code);
    (void)send(upload, request, &waits);
    return result;
}

static void address(uint8_t *request, uint8_t command, uint16_t index, uint8_t sub)
{
    memset(request, 0, 8);
    request[0] = command;
    bytes_put_u16(request + 1, index);
    request[3] = sub;
}

/* One segment. Segments name no object, so an answer that cannot be this one's is proof of another
 * client, whose start has ended this transfer in the node. */
static enum sdo_upload_result next_segment(struct sdo_upload *upload, const uint8_t *first,
                                           uint8_t toggle, uint8_t *answer)
{
    uint8_t request[8] = {(uint8_t)(REQUEST_SEGMENT | toggle)};
    unsigned waits = 0;

    if (!send(upload, request, &waits) || !next_answer(upload, answer, &waits)) {
        return give_up(upload, first, CO_ABORT_TIMEOUT, SDO_UPLOAD_SILENT);
    }
    const uint8_t command = answer[0] & COMMAND_MASK;
    if (command == ANSWER_ABORT && same_object(first, answer)) {
        upload->abort_code = bytes_get_u32(answer + 4);
        return SDO_UPLOAD_ABORTED;
    }
    if (command != ANSWER_SEGMENT || (answer[0] & TOGGLE) != toggle) {
        return give_up(upload, first,
                       command == ANSWER_SEGMENT ? CO_ABORT_TOGGLE : CO_ABORT_COMMAND,
                       SDO_UPLOAD_DISTURBED);
    }
    return SDO_UPLOAD_DONE;
}

/* The segments after an answer that announced them. */
static enum sdo_upload_result read_segments(struct sdo_upload *upload, const uint8_t *first,
                                            const uint8_t *announced, uint8_t *bytes,
                                            size_t capacity, size_t *length)
{
    const bool has_size = (announced[0] & SIZE_INDICATED) != 0;
    const size_t size = bytes_get_u32(announced + 4);
    uint8_t answer[8], toggle = 0;

    if (has_size && size > capacity) {
        return give_up(upload, first, CO_ABORT_MEMORY, SDO_UPLOAD_TOO_LARGE);
    }
    do {
        const enum sdo_upload_result result = next_segment(upload, first, toggle, answer);
        if (result != SDO_UPLOAD_DONE) {
            return result;
        }
        const size_t part = SEGMENT_BYTES - (answer[0] >> 1 & 7u);
        if (*length + part > capacity) {
            return give_up(upload, first, CO_ABORT_MEMORY, SDO_UPLOAD_TOO_LARGE);
        }
        memcpy(bytes + *length, answer + 1, part);
        *length += part;
        toggle ^= TOGGLE;
    } while ((answer[0] & LAST) == 0);
    return has_size && *length != size ? SDO_UPLOAD_DISTURBED : SDO_UPLOAD_DONE;
}

enum sdo_upload_result sdo_upload(struct sdo_upload *upload, uint16_t index, uint8_t sub,
                                  uint8_t *bytes, size_t capacity, size_t *length)
{
    uint8_t request[8], answer[8];

    *length = 0;
    address(request, REQUEST_READ, index, sub);
    const enum sdo_upload_result result = start(upload, request, ANSWER_READ, answer);
    if (result != SDO_UPLOAD_DONE) {
        return result;
    }
    if ((answer[0] & EXPEDITED) == 0) {
        return read_segments(upload, request, answer, bytes, capacity, length);
    }
    const size_t size = (answer[0] & SIZE_INDICATED) != 0 ? 4u - (answer[0] >> 2 & 3u) : 4u;
    *length = size < capacity ? size : capacity;
    memcpy(bytes, answer + 4, *length);
    return size <= capacity ? SDO_UPLOAD_DONE : SDO_UPLOAD_TOO_LARGE;
}

enum sdo_upload_result sdo_write(struct sdo_upload *upload, uint16_t index, uint8_t sub,
                                 uint32_t value, unsigned size)
{
    uint8_t request[8], answer[8];

    address(request, (uint8_t)(REQUEST_WRITE | (4u - size) << 2), index, sub);
    bytes_put_u32(request + 4, value);
    return start(upload, request, ANSWER_WRITTEN, answer);
}

static enum sdo_upload_result send_segment(struct sdo_upload *upload, const uint8_t *first,
                                           uint8_t *request)
{
    uint8_t answer[8];
    unsigned waits = 0;

    if (!send(upload, request, &waits) || !next_answer(upload, answer, &waits)) {
        return give_up(upload, first, CO_ABORT_TIMEOUT, SDO_UPLOAD_SILENT);
    }
    if ((answer[0] & COMMAND_MASK) == ANSWER_ABORT && same_object(first, answer)) {
        upload->abort_code = bytes_get_u32(answer + 4);
        return SDO_UPLOAD_ABORTED;
    }
    return (answer[0] & COMMAND_MASK) == ANSWER_SEGMENT_WRITTEN &&
                   (answer[0] & TOGGLE) == (request[0] & TOGGLE)
               ? SDO_UPLOAD_DONE
               : give_up(upload, first, CO_ABORT_COMMAND, SDO_UPLOAD_DISTURBED);
}

enum sdo_upload_result sdo_download(struct sdo_upload *upload, uint16_t index, uint8_t sub,
                                    const uint8_t *bytes, size_t length,
                                    void (*told)(void *context, size_t done), void *told_context)
{
    uint8_t first[8], answer[8], toggle = 0;
    size_t done = 0;

    address(first, REQUEST_WRITE_SEGMENTS, index, sub);
    bytes_put_u32(first + 4, (uint32_t)length);
    enum sdo_upload_result result = start(upload, first, ANSWER_WRITTEN, answer);
    while (result == SDO_UPLOAD_DONE && done < length) {
        const size_t part = length - done < SEGMENT_BYTES ? length - done : SEGMENT_BYTES;
        uint8_t request[8] = {(uint8_t)(toggle | (SEGMENT_BYTES - part) << 1)};
        memcpy(request + 1, bytes + done, part);
        done += part;
        request[0] |= done == length ? LAST : 0;
        result = send_segment(upload, first, request);
        toggle ^= TOGGLE;
        if (told != NULL) {
            told(told_context, done);
        }
    }
    return result;
}
