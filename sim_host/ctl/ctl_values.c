/* names, get, set, watch. */
#include <string.h>

#include "firmware/settings_lock.h"
#include "hal/bus/bytes.h"
#include "hal/bus/frame_table.h"
#include "sim_host/cli/json_writer.h"
#include "sim_host/ctl/ctl.h"
#include "sim_host/ctl/ctl_internal.h"

/* ---- names -------------------------------------------------------------------------- */

static const char *access_of(const struct co_entry *entry)
{
    const unsigned access = entry->access & ((unsigned)CO_READ | CO_WRITE);
    return access == ((unsigned)CO_READ | CO_WRITE) ? "rw" : access == CO_READ ? "ro" : "wo";
}

static void name_json(struct json_writer *json, const struct named_object *object)
{
    char address[16];
    (void)snprintf(address, sizeof address, "0x%04X:%02X", object->entry->index,
                   object->entry->sub);
    json_open_object(json, object->name);
    json_text(json, "address", address);
    json_text(json, "access", access_of(object->entry));
    json_text(json, "unit", object->unit[0] != '\0' ? object->unit : NULL);
    if (object->has_range) {
        json_number(json, "low", object->low, 9);
        json_number(json, "high", object->high, 9);
    }
    json_text(json, "meaning", object->meaning);
    json_close_object(json);
}

enum exit_status ctl_names(struct ctl *ctl, int count, char **words)
{
    struct json_writer json;
    char range[OBJECT_TEXT_MAX];
    size_t found = 0;
    if (ctl->json) {
        json_begin(&json, ctl->out);
        json_open_object(&json, NULL);
    }
    for (size_t i = 0; i < ctl->objects.count; i++) {
        const struct named_object *object = &ctl->objects.object[i];
        bool is_meant = count == 0;
        for (int w = 0; w < count; w++) {
            is_meant = is_meant || object_is_meant(object, words[w]);
        }
        if (!is_meant) {
            continue;
        }
        found++;
        if (ctl->json) {
            name_json(&json, object);
            continue;
        }
        object_range_text(object, range);
        fprintf(ctl->out, "%-44s %s  0x%04X:%02X  %s%s%s\n", object->name, access_of(object->entry),
                object->entry->index, object->entry->sub, object->meaning,
                range[0] != '\0' ? "; " : "", range);
    }
    if (ctl->json) {
        json_close_object(&json);
        json_end(&json);
    }
    if (found == 0) {
        char message[OBJECT_MESSAGE_MAX];
        (void)object_list_find(&ctl->objects, words[0], true, message);
        ctl_complain(ctl, "%s", message);
    }
    return found > 0 ? EXIT_GOOD : EXIT_BAD;
}

/* ---- get ------------------------------------------------------------------------------- */

static void refusal_json(struct json_writer *json, const char *name, const char *message)
{
    json_open_object(json, name);
    json_text(json, "refused", message);
    json_close_object(json);
}

static void show(const struct ctl *ctl, const struct named_object *object,
                 const struct object_value *value, struct json_writer *json)
{
    if (ctl->json) {
        ctl_value_json(json, object, value);
    } else {
        ctl_print_value(ctl, object, value);
    }
}

/* Reads one object and shows it. Returns 0, or as ctl_link_read() after a complaint. */
static int get_one(struct ctl *ctl, const struct named_object *object, struct json_writer *json)
{
    static struct object_value value;
    char message[OBJECT_MESSAGE_MAX];
    const int result = ctl_link_read(&ctl->link, object, &value, message);
    if (result != 0) {
        ctl_complain(ctl, "%s", message);
        if (ctl->json) {
            refusal_json(json, object->name, message);
        }
        return result;
    }
    show(ctl, object, &value, json);
    return 0;
}

/* An object of another maker: of an index alone also what lies below it, which its first byte counts. */
static int get_foreign(struct ctl *ctl, const char *word, struct json_writer *json)
{
    static struct object_value value;
    struct ctl_address_object room;
    char message[OBJECT_MESSAGE_MAX];
    struct named_object *object = ctl_address(word, &room);
    const int first = get_one(ctl, object, json);
    if (first != 0) {
        return first;
    }
    const bool whole = strchr(word, ':') == NULL;
    if (!whole || ctl_link_read(&ctl->link, object, &value, message) != 0 || value.length != 1) {
        return 0;
    }
    const unsigned count = value.bytes[0];
    for (unsigned sub = 1; sub <= count; sub++) {
        ctl_link_any_object(room.entry.index, (uint8_t)sub, &room.object, &room.entry);
        const bool there = ctl_link_read(&ctl->link, object, &value, message) == 0;
        if (!there && sub == 1) {
            return 0; /* a variable of one byte */
        }
        if (there) {
            show(ctl, object, &value, json);
        }
    }
    return 0;
}

enum exit_status ctl_get(struct ctl *ctl, int count, char **words)
{
    bool is_meant[OBJECT_LIST_MAX] = {false};
    struct json_writer json;
    bool good = true, silent = false; /* who is silent is asked no more */
    for (int i = 0; i < count; i++) {
        if (!ctl_is_foreign(ctl, words[i]) && ctl_mark(ctl, words[i], is_meant) != 0) {
            return EXIT_USAGE;
        }
    }
    if (ctl->json) {
        json_begin(&json, ctl->out);
        json_open_object(&json, NULL);
    }
    for (size_t i = 0; i < ctl->objects.count && !silent; i++) {
        const int result = is_meant[i] ? get_one(ctl, &ctl->objects.object[i], &json) : 0;
        good = good && result == 0;
        silent = result == CTL_LINK_SILENT;
    }
    for (int i = 0; i < count && !silent; i++) {
        const int result = ctl_is_foreign(ctl, words[i]) ? get_foreign(ctl, words[i], &json) : 0;
        good = good && result == 0;
        silent = result == CTL_LINK_SILENT;
    }
    if (ctl->json) {
        json_close_object(&json);
        json_end(&json);
    }
    return good ? EXIT_GOOD : EXIT_BAD;
}

/* ---- set ------------------------------------------------------------------------------- */

struct assignment {
    const struct named_object *object;
    struct object_value value;
};

/* "NAME=VALUE", nothing sent yet. */
static int parse_assignment(const struct ctl *ctl, const char *word, struct assignment *assignment)
{
    char name[OBJECT_NAME_MAX], message[OBJECT_MESSAGE_MAX];
    const char *sign = strchr(word, '=');
    if (sign == NULL || sign == word) {
        ctl_complain(ctl, "\"%s\": write NAME=VALUE", word);
        return -1;
    }
    (void)snprintf(name, sizeof name, "%.*s", (int)(sign - word), word);
    assignment->object = object_list_find(&ctl->objects, name, false, message);
    if (assignment->object == NULL ||
        object_value_from_text(assignment->object, sign + 1, &assignment->value, message) != 0) {
        ctl_complain(ctl, "%s", message);
        return -1;
    }
    return 0;
}

/* A write to a drive or a sensor from anybody else while the controller works is a fault there. */
static int may_write_to_node(const struct ctl *ctl)
{
    struct ctl_link controller = ctl->link;
    char message[OBJECT_MESSAGE_MAX];
    static struct object_value state;
    struct ctl_address_object room;
    if (ctl->link.node == NODE_CONTROLLER) {
        return 0;
    }
    controller.node = NODE_CONTROLLER;
    ctl_link_any_object(CTL_STATE_INDEX, CTL_STATE_SUB, &room.object, &room.entry);
    if (ctl_link_read(&controller, &room.object, &state, message) == 0 &&
        supervisor_may_enable(ctl_state_of(&state))) {
        ctl_complain(ctl, "the controller has the drives under torque: `afo ctl stop' first");
        return -1;
    }
    return 0; /* or there is no controller on this bus */
}

/* The controller's parameters are locked until somebody gives a client number. */
static void unlock(struct ctl *ctl, const struct named_object *object)
{
    struct ctl_address_object room;
    static struct object_value key;
    char message[OBJECT_MESSAGE_MAX];
    if (ctl->link.node != NODE_CONTROLLER || object->entry->index != CTL_PARAMETERS_INDEX) {
        return;
    }
    ctl_link_any_object(CTL_UNLOCK_INDEX, CTL_UNLOCK_SUB, &room.object, &room.entry);
    bytes_put_u32(key.bytes, settings_lock_key_of(CTL_CLIENT));
    key.length = 4;
    (void)ctl_link_write(&ctl->link, &room.object, &key,
                         message); /* the next write says what is wrong */
}

/* A parameter that was accepted and is not there yet: during a walk it moves evenly. */
static bool is_on_its_way(const struct named_object *object, const struct object_value *wanted,
                          const struct object_value *now)
{
    return object->entry->index == CTL_PARAMETERS_INDEX && object->entry->type == CO_REAL32 &&
           now->length == sizeof(float) && memcmp(wanted->bytes, now->bytes, sizeof(float)) != 0;
}

static void tell_ramp(const struct ctl *ctl, const struct named_object *object,
                      const struct object_value *wanted, const struct object_value *now,
                      struct json_writer *json)
{
    char text[OBJECT_TEXT_MAX];
    double number;
    object_value_text(object, wanted, text);
    if (!ctl->json) {
        fprintf(ctl->out, "%s = %s %s accepted, there within %d s", object->name, text,
                object->unit, SETTINGS_RAMP_S);
        object_value_text(object, now, text);
        fprintf(ctl->out, " (now %s)\n", text);
        return;
    }
    json_open_object(json, object->name);
    if (object_number(object, now, &number)) {
        json_number(json, "value", number, 12);
    }
    if (object_number(object, wanted, &number)) {
        json_number(json, "accepted", number, 12);
    }
    json_text(json, "unit", object->unit[0] != '\0' ? object->unit : NULL);
    json_unsigned(json, "there_within_s", SETTINGS_RAMP_S);
    json_close_object(json);
}

static bool set_one(struct ctl *ctl, const struct assignment *assignment, struct json_writer *json)
{
    const struct named_object *object = assignment->object;
    static struct object_value before, after;
    char message[OBJECT_MESSAGE_MAX], text[OBJECT_TEXT_MAX];
    const bool readable = (object->entry->access & CO_READ) != 0;
    const int read = readable ? ctl_link_read(&ctl->link, object, &before, message) : -1;
    const bool known = read == 0;
    after = assignment->value;
    if (read != CTL_LINK_SILENT) {
        unlock(ctl, object);
    }
    if (read == CTL_LINK_SILENT ||
        ctl_link_write(&ctl->link, object, &assignment->value, message) != 0 ||
        (readable && ctl_link_read(&ctl->link, object, &after, message) != 0)) {
        ctl_complain(ctl, "%s", message);
        if (ctl->json) {
            refusal_json(json, object->name, message);
        }
        return false;
    }
    if (known && !ctl->json) {
        object_value_text(object, &before, text);
        fprintf(ctl->out, "was %s; ", text);
    }
    if (is_on_its_way(object, &assignment->value, &after)) {
        tell_ramp(ctl, object, &assignment->value, &after, json);
    } else {
        show(ctl, object, &after, json);
    }
    return true;
}

enum exit_status ctl_set(struct ctl *ctl, int count, char **words)
{
    static struct assignment assignment;
    struct json_writer json;
    bool good = true;
    for (int i = 0; i < count; i++) { /* nothing is sent unless all make sense */
        if (parse_assignment(ctl, words[i], &assignment) != 0) {
            return EXIT_USAGE;
        }
    }
    if (may_write_to_node(ctl) != 0) {
        return EXIT_BAD;
    }
    if (ctl->json) {
        json_begin(&json, ctl->out);
        json_open_object(&json, NULL);
    }
    for (int i = 0; i < count && good;
         i++) { /* a refusal ends it: later ones may rest on earlier ones */
        good =
            parse_assignment(ctl, words[i], &assignment) == 0 && set_one(ctl, &assignment, &json);
    }
    if (ctl->json) {
        json_close_object(&json);
        json_end(&json);
    }
    return good ? EXIT_GOOD : EXIT_BAD;
}

/* ---- watch ------------------------------------------------------------------------------ */

struct watched {
    const struct named_object *object;
    bool seen;
    size_t length;
    uint8_t bytes[CO_VALUE_MAX];
};

/* Shows what has changed since the last look. Returns false when the node refused or is silent. */
static bool look(struct ctl *ctl, struct watched *watched, size_t count)
{
    static struct object_value value;
    struct json_writer json;
    char message[OBJECT_MESSAGE_MAX];
    bool is_open = false;
    for (size_t i = 0; i < count; i++) {
        struct watched *w = &watched[i];
        if (ctl_link_read(&ctl->link, w->object, &value, message) != 0) {
            ctl_complain(ctl, "%s", message);
            return false;
        }
        const size_t kept = value.length < sizeof w->bytes ? value.length : sizeof w->bytes;
        if (w->seen && w->length == kept && memcmp(w->bytes, value.bytes, kept) == 0) {
            continue;
        }
        w->seen = true;
        w->length = kept;
        memcpy(w->bytes, value.bytes, kept);
        if (!ctl->json) {
            ctl_print_value(ctl, w->object, &value);
            continue;
        }
        if (!is_open) {
            json_begin(&json, ctl->out);
            json_open_object(&json, NULL);
            is_open = true;
        }
        ctl_value_json(&json, w->object, &value);
    }
    if (is_open) { /* one object a line */
        json_close_object(&json);
        json_end(&json);
    }
    fflush(ctl->out);
    return true;
}

enum exit_status ctl_watch(struct ctl *ctl, int count, char **words)
{
    static struct watched watched[OBJECT_LIST_MAX];
    bool is_meant[OBJECT_LIST_MAX] = {false};
    size_t used = 0;
    for (int i = 0; i < count; i++) {
        if (ctl_mark(ctl, words[i], is_meant) != 0) {
            return EXIT_USAGE;
        }
    }
    for (size_t i = 0; i < ctl->objects.count; i++) {
        if (is_meant[i]) {
            watched[used++] = (struct watched){.object = &ctl->objects.object[i]};
        }
    }
    for (unsigned n = 0; ctl->looks == 0 || n < ctl->looks; n++) {
        if (n > 0 && !ctl->link.pause(ctl->link.context, ctl->period_ms)) {
            return EXIT_GOOD;
        }
        if (!look(ctl, watched, used)) {
            return EXIT_BAD;
        }
        if (ferror(ctl->out) != 0) {
            return EXIT_USAGE;
        }
    }
    return EXIT_GOOD;
}
