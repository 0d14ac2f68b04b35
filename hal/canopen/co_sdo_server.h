/* SDO server, CiA 301 clause 7.2.4: expedited and segmented transfers in both
 * directions; domains are read segment by segment from where they lie, and given to the
 * owner segment by segment as they are written. Block transfer is
 * refused as the standard demands (0x05040001).
 * One request in, at most one answer out; it knows no bus and no clock.
 */
#ifndef HAL_CANOPEN_CO_SDO_SERVER_H
#define HAL_CANOPEN_CO_SDO_SERVER_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/canopen/co_od.h"

/* The owner's say in an access: called before a value is stored (bytes in bus
 * order; returning an abort code refuses it), after it was stored, and before a
 * value is read (returning an abort code refuses it, too). Any may be NULL. */
struct co_access_hooks {
    uint32_t (*writing)(void *context, const struct co_entry *entry, const uint8_t *bytes,
                        unsigned length);
    void (*written)(void *context, const struct co_entry *entry);
    uint32_t (*reading)(void *context, const struct co_entry *entry);
    /* A domain that may be written: a transfer of `total` bytes (0: not told) begins, and the
     * next `length` bytes of it, `last` with the end. Each returns CO_ABORT_NONE, or the abort
     * code that ends the transfer. NULL: no domain can be written. */
    uint32_t (*begin)(void *context, const struct co_entry *entry, uint32_t total);
    uint32_t (*take)(void *context, const struct co_entry *entry, const uint8_t *bytes,
                     unsigned length, bool last);
};

enum co_sdo_phase { CO_SDO_IDLE = 0, CO_SDO_DOWNLOAD = 1, CO_SDO_UPLOAD = 2 };

struct co_sdo_server {
    const struct co_dictionary *dictionaries;
    unsigned dictionary_count;
    const struct co_access_hooks *hooks;
    void *context;
    uint64_t last_ns;
    uint32_t aborts; /* sent, saturating */
    uint16_t index;
    uint8_t sub;
    uint8_t phase; /* enum co_sdo_phase */
    uint8_t toggle;
    uint32_t length;               /* of an upload; announced length of a download, 0 unknown */
    uint32_t position;             /* bytes done */
    const uint8_t *source;         /* of an upload: buffer, or where a domain lies */
    const struct co_entry *domain; /* that is being written; NULL: another object */
    uint8_t buffer[CO_VALUE_MAX];
};

enum { CO_SDO_SERVER_TIMEOUT_MS = 1000 };

/* Everything is kept by pointer and stays the caller's. */
void co_sdo_server_init(struct co_sdo_server *server, const struct co_dictionary *dictionaries,
                        unsigned dictionary_count, const struct co_access_hooks *hooks,
                        void *context);

/* Handles one request of 8 bytes. Returns true when answer[8] is to be sent (an
 * abort included). A transfer that stood still for CO_SDO_SERVER_TIMEOUT_MS is
 * forgotten. Cost: O(log entries). */
bool co_sdo_server_handle(struct co_sdo_server *server, const uint8_t *request, uint64_t now_ns,
                          uint8_t *answer);

/* Forgets a transfer under way (NMT stopped or reset). */
void co_sdo_server_reset(struct co_sdo_server *server);

/* What both PDO and SDO use to change a value: hooks, checks, store. */
uint32_t co_access_write(const struct co_access_hooks *hooks, void *context,
                         const struct co_entry *entry, void *base, const uint8_t *bytes,
                         unsigned length);

#endif
