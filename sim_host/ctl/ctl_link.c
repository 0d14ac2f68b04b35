#include "sim_host/ctl/ctl_link.h"

#include <stdio.h>
#include <string.h>

#include "hal/bus/bytes.h"

static void explain(const struct ctl_link *link, const struct named_object *object,
                    enum sdo_upload_result result, uint32_t abort_code, bool wrote, char *message)
{
    switch (result) {
    case SDO_UPLOAD_ABORTED:
        object_refusal_text(object, abort_code, wrote, message);
        break;
    case SDO_UPLOAD_SILENT:
        (void)snprintf(message, OBJECT_MESSAGE_MAX,
                       "node %u does not answer; is it on, is the bit rate right, and does anybody "
                       "else acknowledge on this bus?",
                       link->node);
        break;
    case SDO_UPLOAD_TOO_LARGE:
        (void)snprintf(message, OBJECT_MESSAGE_MAX,
                       "%s is longer than %d bytes; use `afo blackbox'", object->name,
                       (int)OBJECT_BYTES_MAX);
        break;
    case SDO_UPLOAD_DISTURBED:
        (void)snprintf(message, OBJECT_MESSAGE_MAX,
                       "another tool spoke with node %u in the middle of %s; try again", link->node,
                       object->name);
        break;
    case SDO_UPLOAD_DONE:
        break;
    }
}

static struct sdo_upload client_of(const struct ctl_link *link)
{
    return (struct sdo_upload){
        .bus = &link->bus, .node = link->node, .wait = link->wait, .context = link->context};
}

int ctl_link_read(const struct ctl_link *link, const struct named_object *object,
                  struct object_value *value, char *message)
{
    struct sdo_upload client = client_of(link);
    memset(value->bytes, 0, 8); /* a shorter answer than the type leaves no rest of an older one */
    const enum sdo_upload_result result =
        sdo_upload(&client, object->entry->index, object->entry->sub, value->bytes,
                   sizeof value->bytes, &value->length);
    explain(link, object, result, client.abort_code, false, message);
    return result == SDO_UPLOAD_DONE ? 0 : result == SDO_UPLOAD_SILENT ? CTL_LINK_SILENT : -1;
}

int ctl_link_write(const struct ctl_link *link, const struct named_object *object,
                   const struct object_value *value, char *message)
{
    struct sdo_upload client = client_of(link);
    const enum sdo_upload_result result =
        sdo_write(&client, object->entry->index, object->entry->sub, bytes_get_u32(value->bytes),
                  (unsigned)value->length);
    explain(link, object, result, client.abort_code, true, message);
    return result == SDO_UPLOAD_DONE ? 0 : -1;
}

void ctl_link_any_object(uint16_t index, uint8_t sub, struct named_object *object,
                         struct co_entry *entry)
{
    memset(object, 0, sizeof *object);
    *entry = (struct co_entry){.index = index,
                               .sub = sub,
                               .type = CO_DOMAIN,
                               .access = CO_READ | CO_WRITE,
                               .low = 1,
                               .name = ""};
    (void)snprintf(object->name, sizeof object->name, "0x%04X:%02X", index, sub);
    object->entry = entry;
    object->unit = "";
    object->scale = 1.0;
    object->meaning = "unknown object";
}
