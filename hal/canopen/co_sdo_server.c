#include "hal/canopen/co_sdo_server.h"

#include <string.h>

#include "hal/bus/bytes.h"
#include "hal/canopen/co_defs.h"

/* Command specifiers, upper three bits of byte 0 (CiA 301, figures 31 to 38). */
enum {
    CLIENT_DOWNLOAD_SEGMENT = 0,
    CLIENT_INITIATE_DOWNLOAD = 1,
    CLIENT_INITIATE_UPLOAD = 2,
    CLIENT_UPLOAD_SEGMENT = 3,
    CLIENT_ABORT = 4,
    SERVER_UPLOAD_SEGMENT = 0 << 5,
    SERVER_DOWNLOAD_SEGMENT = 1 << 5,
    SERVER_INITIATE_UPLOAD = 2 << 5,
    SERVER_INITIATE_DOWNLOAD = 3 << 5,
    ABORT = 4 << 5,
    EXPEDITED = 1 << 1,
    SIZE_INDICATED = 1 << 0,
    TOGGLE = 1 << 4,
    LAST_SEGMENT = 1 << 0,
    SEGMENT_BYTES = 7
};

static const uint64_t TIMEOUT_NS = UINT64_C(1000000) * CO_SDO_SERVER_TIMEOUT_MS;

void co_sdo_server_init(struct co_sdo_server *server, const struct co_dictionary *dictionaries,
                        unsigned dictionary_count, const struct co_access_hooks *hooks,
                        void *context)
{
    memset(server, 0, sizeof *server);
    server->dictionaries = dictionaries;
    server->dictionary_count = dictionary_count;
    server->hooks = hooks;
    server->context = context;
    server->source = server->buffer;
}

void co_sdo_server_reset(struct co_sdo_server *server)
{
    server->phase = CO_SDO_IDLE;
}

uint32_t co_access_write(const struct co_access_hooks *hooks, void *context,
                         const struct co_entry *entry, void *base, const uint8_t *bytes,
                         unsigned length)
{
    uint32_t refused = co_od_check(entry, bytes, length);
    if (refused == CO_ABORT_NONE && hooks != NULL && hooks->writing != NULL) {
        refused = hooks->writing(context, entry, bytes, length);
    }
    if (refused == CO_ABORT_NONE) {
        refused = co_od_store(entry, base, bytes, length);
        if (refused == CO_ABORT_NONE && hooks != NULL && hooks->written != NULL) {
            hooks->written(context, entry);
        }
    }
    return refused;
}

static void put_multiplexor(const struct co_sdo_server *server, uint8_t *answer)
{
    bytes_put_u16(answer + 1, server->index);
    answer[3] = server->sub;
}

static bool send_abort(struct co_sdo_server *server, uint32_t code, uint8_t *answer)
{
    server->phase = CO_SDO_IDLE;
    if (server->aborts < UINT32_MAX) {
        server->aborts++;
    }
    answer[0] = ABORT;
    put_multiplexor(server, answer);
    bytes_put_u32(answer + 4, code);
    return true;
}

static uint32_t find(const struct co_sdo_server *server, unsigned wanted,
                     const struct co_entry **entry, void **base)
{
    uint32_t refused;
    *entry = co_od_find(server->dictionaries, server->dictionary_count, server->index, server->sub,
                        base, &refused);
    if (*entry == NULL) {
        return refused;
    }
    if (((*entry)->access & wanted) != 0) {
        return CO_ABORT_NONE;
    }
    return wanted == CO_WRITE ? CO_ABORT_READ_ONLY : CO_ABORT_WRITE_ONLY;
}

static uint32_t write_object(struct co_sdo_server *server, const uint8_t *bytes, unsigned length)
{
    const struct co_entry *entry;
    void *base;
    const uint32_t refused = find(server, CO_WRITE, &entry, &base);
    if (refused != CO_ABORT_NONE) {
        return refused;
    }
    return co_access_write(server->hooks, server->context, entry, base, bytes, length);
}

/* A domain goes to its owner as it comes; nothing of it is kept here. */
static uint32_t begin_domain(struct co_sdo_server *server, const struct co_entry *entry,
                             uint32_t length)
{
    const struct co_access_hooks *hooks = server->hooks;

    if (hooks == NULL || hooks->begin == NULL || hooks->take == NULL) {
        return CO_ABORT_ACCESS;
    }
    const uint32_t refused = hooks->begin(server->context, entry, length);
    server->domain = refused == CO_ABORT_NONE ? entry : NULL;
    return refused;
}

static uint32_t begin_segments(struct co_sdo_server *server, const struct co_entry *entry,
                               uint32_t length)
{
    server->domain = NULL;
    if (entry->type == CO_DOMAIN) {
        return begin_domain(server, entry, length);
    }
    return length > entry->size ? CO_ABORT_TOO_LONG : CO_ABORT_NONE;
}

static bool initiate_download(struct co_sdo_server *server, const uint8_t *request, uint8_t *answer)
{
    const struct co_entry *entry;
    void *base;
    uint32_t refused = find(server, CO_WRITE, &entry, &base);
    if (refused != CO_ABORT_NONE) {
        return send_abort(server, refused, answer);
    }
    if ((request[0] & EXPEDITED) != 0) {
        /* Without a size, as many bytes as the object has (CiA 301: "d contains
         * unspecified number of bytes"). */
        const unsigned unused = (unsigned)(request[0] >> 2 & 3);
        const unsigned size = entry->size < 4 ? entry->size : 4;
        const unsigned length = (request[0] & SIZE_INDICATED) != 0 ? 4 - unused : size;
        refused = co_access_write(server->hooks, server->context, entry, base, request + 4, length);
        if (refused != CO_ABORT_NONE) {
            return send_abort(server, refused, answer);
        }
    } else {
        const uint32_t length = (request[0] & SIZE_INDICATED) != 0 ? bytes_get_u32(request + 4) : 0;
        refused = begin_segments(server, entry, length);
        if (refused != CO_ABORT_NONE) {
            return send_abort(server, refused, answer);
        }
        server->phase = CO_SDO_DOWNLOAD;
        server->toggle = 0;
        server->position = 0;
        server->length = length;
    }
    answer[0] = SERVER_INITIATE_DOWNLOAD;
    put_multiplexor(server, answer);
    return true;
}

static uint32_t take_segment(struct co_sdo_server *server, const uint8_t *bytes, unsigned count,
                             bool last)
{
    if (server->domain == NULL) {
        /*@ split count; */
        if (server->position > CO_VALUE_MAX - count) {
            return CO_ABORT_TOO_LONG; /* no object is longer */
        }
        for (unsigned i = 0; i < count && server->position + i < CO_VALUE_MAX; i++) {
            server->buffer[server->position + i] = bytes[i];
        }
    }
    server->position += count;
    if (server->length != 0 && server->position > server->length) {
        return CO_ABORT_TOO_LONG;
    }
    if (last && server->length != 0 && server->position != server->length) {
        return CO_ABORT_TOO_SHORT;
    }
    if (server->domain != NULL) {
        return server->hooks->take(server->context, server->domain, bytes, count, last);
    }
    return last ? write_object(server, server->buffer, (unsigned)server->position) : CO_ABORT_NONE;
}

static bool download_segment(struct co_sdo_server *server, const uint8_t *request, uint8_t *answer)
{
    const unsigned toggle = request[0] & TOGGLE;
    if (server->phase != CO_SDO_DOWNLOAD) {
        return send_abort(server, CO_ABORT_COMMAND, answer);
    }
    if (toggle != server->toggle) {
        return send_abort(server, CO_ABORT_TOGGLE, answer);
    }
    const unsigned count = SEGMENT_BYTES - (unsigned)(request[0] >> 1 & 7);
    const bool last = (request[0] & LAST_SEGMENT) != 0;
    const uint32_t refused = take_segment(server, request + 1, count, last);
    if (refused != CO_ABORT_NONE) {
        return send_abort(server, refused, answer);
    }
    if (last) {
        server->phase = CO_SDO_IDLE;
    }
    server->toggle = (uint8_t)(toggle ^ TOGGLE);
    answer[0] = (uint8_t)(SERVER_DOWNLOAD_SEGMENT | toggle);
    return true;
}

static const struct co_domain *domain_of(const struct co_entry *entry, const void *base)
{
    return (const struct co_domain *)(const void *)((const char *)base + entry->offset);
}

static bool initiate_upload(struct co_sdo_server *server, uint8_t *answer)
{
    const struct co_entry *entry;
    void *base;
    uint32_t refused = find(server, CO_READ | CO_CONST, &entry, &base);
    if (refused == CO_ABORT_NONE && server->hooks != NULL && server->hooks->reading != NULL) {
        refused = server->hooks->reading(server->context, entry);
    }
    if (refused != CO_ABORT_NONE) {
        return send_abort(server, refused, answer);
    }
    server->source = server->buffer;
    if (entry->type == CO_DOMAIN) {
        const struct co_domain *domain = domain_of(entry, base);
        server->source = domain->bytes;
        server->length = domain->length;
        if (domain->length == 0) {
            return send_abort(server, CO_ABORT_DEVICE_STATE, answer);
        }
    } else {
        server->length = co_od_load(entry, base, server->buffer);
    }
    put_multiplexor(server, answer);
    if (server->length > 0 && server->length <= 4) {
        answer[0] = (uint8_t)(SERVER_INITIATE_UPLOAD | (4 - server->length) << 2 | EXPEDITED |
                              SIZE_INDICATED);
        memcpy(answer + 4, server->source, server->length);
        return true;
    }
    server->phase = CO_SDO_UPLOAD;
    server->toggle = 0;
    server->position = 0;
    answer[0] = SERVER_INITIATE_UPLOAD | SIZE_INDICATED;
    bytes_put_u32(answer + 4, server->length);
    return true;
}

static bool upload_segment(struct co_sdo_server *server, const uint8_t *request, uint8_t *answer)
{
    const unsigned toggle = request[0] & TOGGLE;
    if (server->phase != CO_SDO_UPLOAD) {
        return send_abort(server, CO_ABORT_COMMAND, answer);
    }
    if (toggle != server->toggle) {
        return send_abort(server, CO_ABORT_TOGGLE, answer);
    }
    uint32_t left = 0;
    /*@ split server->position; */
    if (server->position < server->length) {
        left = server->length - server->position;
    }
    const unsigned count = left < SEGMENT_BYTES ? left : SEGMENT_BYTES;
    if (count > 0) {
        memcpy(answer + 1, server->source + server->position, count);
        server->position += count;
    }
    server->toggle = (uint8_t)(toggle ^ TOGGLE);
    answer[0] = (uint8_t)(SERVER_UPLOAD_SEGMENT | toggle | (SEGMENT_BYTES - count) << 1);
    if (server->position == server->length) {
        answer[0] |= LAST_SEGMENT;
        server->phase = CO_SDO_IDLE;
    }
    return true;
}

bool co_sdo_server_handle(struct co_sdo_server *server, const uint8_t *request, uint64_t now_ns,
                          uint8_t *answer)
{
    const unsigned command = request[0] >> 5;
    memset(answer, 0, 8);
    if (server->phase != CO_SDO_IDLE && now_ns - server->last_ns > TIMEOUT_NS) {
        server->phase = CO_SDO_IDLE;
    }
    server->last_ns = now_ns;
    if (command == CLIENT_DOWNLOAD_SEGMENT) {
        return download_segment(server, request, answer);
    }
    if (command == CLIENT_UPLOAD_SEGMENT) {
        return upload_segment(server, request, answer);
    }
    if (command == CLIENT_ABORT) {
        server->phase = CO_SDO_IDLE;
        return false;
    }
    /* A new request ends whatever was under way. */
    server->phase = CO_SDO_IDLE;
    server->index = bytes_get_u16(request + 1);
    server->sub = request[3];
    if (command == CLIENT_INITIATE_DOWNLOAD) {
        return initiate_download(server, request, answer);
    }
    if (command == CLIENT_INITIATE_UPLOAD) {
        return initiate_upload(server, answer);
    }
    return send_abort(server, CO_ABORT_COMMAND, answer);
}
