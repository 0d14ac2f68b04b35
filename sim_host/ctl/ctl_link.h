/* A tool's line to one node: objects read and written over SDO, one after the other. It blocks; how
 * time passes meanwhile is the owner's: by a socket, or by running a simulated bus.
 */
#ifndef SIM_HOST_CTL_CTL_LINK_H
#define SIM_HOST_CTL_CTL_LINK_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/bus/can_bus.h"
#include "sim_host/ctl/object_list.h"
#include "sim_host/ctl/object_text.h"
#include "sim_host/log/sdo_upload.h"

struct ctl_link {
    struct can_bus bus; /* receives the nodes' SDO answers; hears nothing that it sends itself */
    /* Called while an answer is awaited, with the number of waits so far: lets some time pass, or a
     * frame come. False: it has been long enough. */
    bool (*wait)(void *context, unsigned waits);
    /* Lets so much time pass. False: the person wants to end (Ctrl-C). */
    bool (*pause)(void *context, unsigned milliseconds);
    void *context;
    uint8_t node; /* 1..127 */
};

/* ctl_link_read: the node did not answer at all. */
enum { CTL_LINK_SILENT = -2 };

/* Reads, or writes, an object of link->node. Returns 0, or -1 (or CTL_LINK_SILENT) with the reason in words in
 * message (OBJECT_MESSAGE_MAX bytes). object is of the node's list, or made by ctl_link_any_object. */
int ctl_link_read(const struct ctl_link *link, const struct named_object *object,
                  struct object_value *value, char *message);
int ctl_link_write(const struct ctl_link *link, const struct named_object *object,
                   const struct object_value *value, char *message);

/* An object of which nothing but the address is known: its value is bytes. The result points into
 * *object and *entry. */
void ctl_link_any_object(uint16_t index, uint8_t sub, struct named_object *object,
                         struct co_entry *entry);

#endif
