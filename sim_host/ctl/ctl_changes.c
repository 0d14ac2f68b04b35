/* changes: who changed what, when, from what to what. */
#include <string.h>

#include "firmware/change_log.h"
#include "hal/bus/bytes.h"
#include "sim_host/ctl/ctl.h"
#include "sim_host/ctl/ctl_internal.h"

enum { LOG_INDEX = 0x2005, NUMBER_SUB = 1, RECORDS_SUB = 2, TRIES = 3 };

/* Names as the device file has them, with the leg: the dictionary's own are the same words. */
static const struct named_object *object_of(const struct ctl *ctl, uint16_t index, uint8_t sub)
{
    for (size_t i = 0; i < ctl->objects.count; i++) {
        const struct co_entry *entry = ctl->objects.object[i].entry;
        if (entry->index == index && entry->sub == sub) {
            return &ctl->objects.object[i];
        }
    }
    return NULL;
}

static int read_at(const struct ctl *ctl, uint8_t sub, struct object_value *value)
{
    char message[OBJECT_MESSAGE_MAX];
    const struct named_object *object = object_of(ctl, LOG_INDEX, sub);
    if (object == NULL) {
        ctl_complain(ctl, "this node keeps no log of changes");
        return -1;
    }
    if (ctl_link_read(&ctl->link, object, value, message) != 0) {
        ctl_complain(ctl, "%s", message);
        return -1;
    }
    return 0;
}

static struct change_record record_at(const uint8_t *bytes)
{
    return (struct change_record){.number = bytes_get_u32(bytes),
                                  .time_s = bytes_get_u32(bytes + 4),
                                  .index = bytes_get_u16(bytes + 8),
                                  .sub = bytes[10],
                                  .client = bytes[11],
                                  .before = bytes_get_f32(bytes + 12),
                                  .after = bytes_get_f32(bytes + 16)};
}

/* Sorted by number, oldest first; returns how many. A change that comes meanwhile makes it begin anew. */
static int read_log(const struct ctl *ctl, struct change_record *record, uint32_t *newest)
{
    static struct object_value value;
    for (int i = 0; i < TRIES; i++) {
        int count = 0;
        if (read_at(ctl, NUMBER_SUB, &value) != 0) {
            return -1;
        }
        *newest = bytes_get_u32(value.bytes);
        if (read_at(ctl, RECORDS_SUB, &value) != 0) {
            return -1;
        }
        if (value.length != CHANGE_LOG_RECORDS * CHANGE_LOG_RECORD_BYTES) {
            ctl_complain(ctl, "the log has %u bytes, expected %u: another version of the firmware",
                         (unsigned)value.length,
                         (unsigned)(CHANGE_LOG_RECORDS * CHANGE_LOG_RECORD_BYTES));
            return -1;
        }
        for (uint32_t n = 0; n < CHANGE_LOG_RECORDS; n++) {
            const uint32_t place = (*newest + n) % CHANGE_LOG_RECORDS;
            record[count] = record_at(value.bytes + place * CHANGE_LOG_RECORD_BYTES);
            count += record[count].number > 0 && record[count].number <= *newest ? 1 : 0;
        }
        if (count == 0 || record[count - 1].number == *newest) {
            return count;
        }
    }
    ctl_complain(ctl, "the log changes while it is read: ask again");
    return -1;
}

static void name_of(const struct ctl *ctl, const struct change_record *record,
                    char name[OBJECT_NAME_MAX])
{
    const struct named_object *object = object_of(ctl, record->index, record->sub);
    if (object != NULL) {
        (void)snprintf(name, OBJECT_NAME_MAX, "%s", object->name);
    } else {
        (void)snprintf(name, OBJECT_NAME_MAX, "0x%04X:%02X", record->index, record->sub);
    }
}

static void print(struct ctl *ctl, const struct change_record *record)
{
    char name[OBJECT_NAME_MAX], who[24] = "no client";
    name_of(ctl, record, name);
    if (record->client != 0) {
        (void)snprintf(who, sizeof who, "client %u", record->client);
    }
    fprintf(ctl->out, "%4u  %6u s  %-10s %s: %.7g to %.7g\n", (unsigned)record->number,
            (unsigned)record->time_s, who, name, (double)record->before, (double)record->after);
}

static void change_json(struct json_writer *json, const struct ctl *ctl,
                        const struct change_record *record)
{
    char name[OBJECT_NAME_MAX], address[16];
    name_of(ctl, record, name);
    (void)snprintf(address, sizeof address, "0x%04X:%02X", record->index, record->sub);
    json_open_object(json, NULL);
    json_unsigned(json, "number", record->number);
    json_unsigned(json, "time_s", record->time_s);
    json_unsigned(json, "client", record->client);
    json_text(json, "name", name);
    json_text(json, "address", address);
    json_number(json, "before", (double)record->before, 9);
    json_number(json, "after", (double)record->after, 9);
    json_close_object(json);
}

enum exit_status ctl_changes(struct ctl *ctl, int count, char **words)
{
    struct change_record record[CHANGE_LOG_RECORDS];
    struct json_writer json;
    uint32_t newest = 0;
    (void)count;
    (void)words;
    const int kept = read_log(ctl, record, &newest);
    if (kept < 0) {
        return EXIT_BAD;
    }
    if (ctl->json) {
        json_begin(&json, ctl->out);
        json_open_object(&json, NULL);
        json_unsigned(&json, "since_start", newest);
        json_open_list(&json, "changes");
    } else {
        fprintf(ctl->out, "%u changes since the start, the last %d of them:\n", (unsigned)newest,
                kept);
    }
    for (int i = 0; i < kept; i++) {
        if (ctl->json) {
            change_json(&json, ctl, &record[i]);
        } else {
            print(ctl, &record[i]);
        }
    }
    if (ctl->json) {
        json_close_list(&json);
        json_close_object(&json);
        json_end(&json);
    }
    return EXIT_GOOD;
}
