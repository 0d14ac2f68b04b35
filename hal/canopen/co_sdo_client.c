#include "hal/canopen/co_sdo_client.h"

#include <string.h>

#include "hal/bus/bytes.h"
#include "hal/canopen/co_defs.h"
#include "hal/contract.h"

enum client_state {
    IDLE = 0,
    READ_START = 1,
    READ_SEGMENT = 2,
    WRITE_START = 3,
    WRITE_SEGMENT = 4,
    FAILED = 5
};

enum {
    SEGMENT_BYTES = 7,
    TOGGLE = 1 << 4,
    LAST_SEGMENT = 1 << 0,
    EXPEDITED = 1 << 1,
    SIZE_INDICATED = 1 << 0,
    REQUEST_DOWNLOAD_SEGMENT = 0 << 5,
    REQUEST_DOWNLOAD = 1 << 5,
    REQUEST_UPLOAD = 2 << 5,
    REQUEST_UPLOAD_SEGMENT = 3 << 5,
    ABORT = 4 << 5,
    ANSWER_UPLOAD_SEGMENT = 0,
    ANSWER_DOWNLOAD_SEGMENT = 1,
    ANSWER_UPLOAD = 2,
    ANSWER_DOWNLOAD = 3,
    ANSWER_ABORT = 4
};

void co_sdo_client_init(struct co_sdo_client *client, uint8_t node, uint64_t timeout_ns)
{
    HAL_ASSERT(node >= 1 && node <= CO_NODE_MAX);
    memset(client, 0, sizeof *client);
    client->node = node;
    client->timeout_ns = timeout_ns;
}

static void start(struct co_sdo_client *client, uint16_t index, uint8_t sub, uint64_t now_ns)
{
    client->index = index;
    client->sub = sub;
    client->toggle = 0;
    client->position = 0;
    client->abort_code = CO_ABORT_NONE;
    client->unsent = true;
    client->sent_ns = now_ns;
    memset(client->request, 0, sizeof client->request);
    bytes_put_u16(client->request + 1, index);
    client->request[3] = sub;
}

void co_sdo_client_read(struct co_sdo_client *client, uint16_t index, uint8_t sub, uint64_t now_ns)
{
    start(client, index, sub, now_ns);
    client->length = 0;
    client->state = READ_START;
    client->request[0] = REQUEST_UPLOAD;
}

void co_sdo_client_write(struct co_sdo_client *client, uint16_t index, uint8_t sub,
                         const uint8_t *bytes, unsigned length, uint64_t now_ns)
{
    HAL_ASSERT(length >= 1 && length <= CO_VALUE_MAX);
    start(client, index, sub, now_ns);
    memcpy(client->buffer, bytes, length);
    client->length = (uint8_t)length;
    client->state = WRITE_START;
    if (length <= 4) {
        client->request[0] =
            (uint8_t)(REQUEST_DOWNLOAD | (4 - length) << 2 | EXPEDITED | SIZE_INDICATED);
        memcpy(client->request + 4, bytes, length);
    } else {
        client->request[0] = REQUEST_DOWNLOAD | SIZE_INDICATED;
        bytes_put_u32(client->request + 4, length);
    }
}

static void fail(struct co_sdo_client *client, uint32_t code, bool tell)
{
    client->state = FAILED;
    client->abort_code = code;
    client->unsent = tell;
    if (tell) {
        client->request[0] = ABORT;
        bytes_put_u16(client->request + 1, client->index);
        client->request[3] = client->sub;
        bytes_put_u32(client->request + 4, code);
    }
}

static void request_next_upload(struct co_sdo_client *client)
{
    memset(client->request, 0, sizeof client->request);
    client->request[0] = (uint8_t)(REQUEST_UPLOAD_SEGMENT | client->toggle);
    client->unsent = true;
}

static void request_next_download(struct co_sdo_client *client)
{
    unsigned left = 0;
    /*@ split client->position; */
    if (client->position < client->length) {
        left = (unsigned)(client->length - client->position);
    }
    const unsigned count = left < SEGMENT_BYTES ? left : SEGMENT_BYTES;
    memset(client->request, 0, sizeof client->request);
    client->request[0] =
        (uint8_t)(REQUEST_DOWNLOAD_SEGMENT | client->toggle | (SEGMENT_BYTES - count) << 1 |
                  (count == left ? LAST_SEGMENT : 0));
    if (count > 0) {
        memcpy(client->request + 1, client->buffer + client->position, count);
        client->position = (uint8_t)(client->position + count);
    }
    client->unsent = true;
}

static void take_upload_start(struct co_sdo_client *client, const uint8_t *answer)
{
    if ((answer[0] & EXPEDITED) != 0) {
        const unsigned unused =
            (answer[0] & SIZE_INDICATED) != 0 ? (unsigned)(answer[0] >> 2 & 3) : 0;
        client->length = (uint8_t)(4 - unused);
        memcpy(client->buffer, answer + 4, client->length);
        client->state = IDLE;
        return;
    }
    if ((answer[0] & SIZE_INDICATED) != 0 && bytes_get_u32(answer + 4) > CO_VALUE_MAX) {
        fail(client, CO_ABORT_MEMORY, true);
        return;
    }
    client->state = READ_SEGMENT;
    request_next_upload(client);
}

static void take_upload_segment(struct co_sdo_client *client, const uint8_t *answer)
{
    const unsigned count = SEGMENT_BYTES - (unsigned)(answer[0] >> 1 & 7);
    if ((answer[0] & TOGGLE) != client->toggle) {
        fail(client, CO_ABORT_TOGGLE, true);
        return;
    }
    /*@ split client->position; */
    if (client->position > CO_VALUE_MAX || count > CO_VALUE_MAX - (unsigned)client->position) {
        fail(client, CO_ABORT_MEMORY, true);
        return;
    }
    if (count > 0) {
        memcpy(client->buffer + client->position, answer + 1, count);
        client->position = (uint8_t)(client->position + count);
    }
    client->toggle ^= TOGGLE;
    if ((answer[0] & LAST_SEGMENT) != 0) {
        client->length = client->position;
        client->state = IDLE;
        return;
    }
    request_next_upload(client);
}

static void take_download_segment(struct co_sdo_client *client, const uint8_t *answer)
{
    if ((answer[0] & TOGGLE) != client->toggle) {
        fail(client, CO_ABORT_TOGGLE, true);
        return;
    }
    client->toggle ^= TOGGLE;
    if (client->position == client->length) {
        client->state = IDLE;
        return;
    }
    request_next_download(client);
}

static bool same_object(const struct co_sdo_client *client, const uint8_t *answer)
{
    return bytes_get_u16(answer + 1) == client->index && answer[3] == client->sub;
}

/* Those that start a transfer or abort it (CiA 301 clause 7.2.4.3: multiplexor m); segments do not. */
static bool names_object(unsigned command)
{
    return command == ANSWER_UPLOAD || command == ANSWER_DOWNLOAD || command == ANSWER_ABORT;
}

bool co_sdo_client_is_busy(const struct co_sdo_client *client)
{
    return client->state != IDLE && client->state != FAILED;
}

bool co_sdo_client_receive(struct co_sdo_client *client, const struct can_msg *message,
                           uint64_t now_ns)
{
    if (message->id != (uint32_t)CO_COB_SDO_ANSWER + client->node || message->flags != 0) {
        return false;
    }
    if (message->length != 8 || !co_sdo_client_is_busy(client) || client->unsent) {
        return true; /* not an answer to anything asked */
    }
    const uint8_t *answer = message->data;
    const unsigned command = answer[0] >> 5;
    if (names_object(command) && !same_object(client, answer)) {
        return true; /* to a transfer that was forgotten, or to another client */
    }
    client->sent_ns = now_ns;
    if (command == ANSWER_ABORT) {
        fail(client, bytes_get_u32(answer + 4), false);
    } else if (client->state == READ_START && command == ANSWER_UPLOAD) {
        take_upload_start(client, answer);
    } else if (client->state == WRITE_START && command == ANSWER_DOWNLOAD) {
        if (client->length <= 4) {
            client->state = IDLE;
        } else {
            client->state = WRITE_SEGMENT;
            request_next_download(client);
        }
    } else if (client->state == READ_SEGMENT && command == ANSWER_UPLOAD_SEGMENT) {
        take_upload_segment(client, answer);
    } else if (client->state == WRITE_SEGMENT && command == ANSWER_DOWNLOAD_SEGMENT) {
        take_download_segment(client, answer);
    } else if ((client->state != READ_START || command != ANSWER_DOWNLOAD) &&
               (client->state != WRITE_START || command != ANSWER_UPLOAD)) {
        fail(client, CO_ABORT_COMMAND, true);
    } /* else a late answer to a transfer that was begun anew, or given up */
    return true;
}

enum co_sdo_result co_sdo_client_poll(struct co_sdo_client *client, const struct can_bus *bus,
                                      uint64_t now_ns)
{
    if (co_sdo_client_is_busy(client) && now_ns - client->sent_ns > client->timeout_ns) {
        fail(client, CO_ABORT_TIMEOUT, true);
    }
    if (client->unsent) {
        struct can_msg message = {.id = (uint32_t)CO_COB_SDO_REQUEST + client->node, .length = 8};
        memcpy(message.data, client->request, sizeof client->request);
        if (can_bus_send(bus, &message) == CAN_OK) {
            client->unsent = false;
        }
    }
    if (client->state == IDLE) {
        return CO_SDO_DONE;
    }
    return client->state == FAILED ? CO_SDO_ABORTED : CO_SDO_BUSY;
}
