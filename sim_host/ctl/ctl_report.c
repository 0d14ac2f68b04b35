/* What the verbs have in common: which objects are meant, and how values and complaints are told. */
#include <stdarg.h>
#include <string.h>

#include "sim_host/ctl/ctl.h"
#include "sim_host/ctl/ctl_internal.h"

enum { COMPLAINT_MAX = 2 * OBJECT_MESSAGE_MAX };

void ctl_complain(const struct ctl *ctl, const char *format, ...)
{
    char line[COMPLAINT_MAX];
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(line, sizeof line, format, arguments);
    va_end(arguments);
    (void)fflush(ctl->out); /* where both go to one file, lines stay whole and in their order */
    fprintf(ctl->complaints, "afo ctl: %s\n", line);
}

/* ---- which objects are meant ------------------------------------------------------- */

struct named_object *ctl_address(const char *word, struct ctl_address_object *room)
{
    uint16_t index;
    uint8_t sub;
    if (!object_address_from_text(word, &index, &sub)) {
        return NULL;
    }
    ctl_link_any_object(index, sub, &room->object, &room->entry);
    return &room->object;
}

bool ctl_is_foreign(const struct ctl *ctl, const char *word)
{
    uint16_t index;
    uint8_t sub;
    if (!object_address_from_text(word, &index, &sub)) {
        return false;
    }
    const bool any_sub = strchr(word, ':') == NULL;
    for (size_t i = 0; i < ctl->objects.count; i++) {
        const struct co_entry *entry = ctl->objects.object[i].entry;
        if (entry->index == index && (any_sub || entry->sub == sub)) {
            return false;
        }
    }
    return true;
}

int ctl_mark(const struct ctl *ctl, const char *word, bool *is_meant)
{
    const struct object_list *list = &ctl->objects;
    const size_t length = strlen(word);
    char message[OBJECT_MESSAGE_MAX];
    bool any = false;
    uint16_t index = 0;
    uint8_t sub;
    const bool is_index = strchr(word, ':') == NULL && object_address_from_text(word, &index, &sub);
    for (size_t i = 0; i < list->count; i++) {
        const struct named_object *object = &list->object[i];
        const bool in_group = (is_index && object->entry->index == index) ||
                              (object->leaf > 0 && strncmp(object->name, word, length) == 0 &&
                               (length == object->leaf - 1 || length == object->leaf));
        is_meant[i] = is_meant[i] || in_group;
        any = any || in_group;
    }
    if (any) {
        return 0;
    }
    const struct named_object *object = object_list_find(list, word, true, message);
    if (object == NULL) {
        ctl_complain(ctl, "%s", message);
        return -1;
    }
    is_meant[object - list->object] = true;
    return 0;
}

int ctl_mark_all(const struct ctl *ctl, int count, char **words, bool *is_meant)
{
    memset(is_meant, count == 0 ? 1 : 0, OBJECT_LIST_MAX * sizeof *is_meant);
    for (int i = 0; i < count; i++) {
        if (ctl_mark(ctl, words[i], is_meant) != 0) {
            return -1;
        }
    }
    return 0;
}

/* ---- one value ------------------------------------------------------------------------ */

void ctl_print_value(const struct ctl *ctl, const struct named_object *object,
                     const struct object_value *value)
{
    char text[OBJECT_TEXT_MAX], name[OBJECT_TEXT_MAX];
    object_value_text(object, value, text);
    object_value_name(object, value, name);
    fprintf(ctl->out, "%s = %s%s%s%s%s%s\n", object->name, text, object->unit[0] != '\0' ? " " : "",
            object->unit, name[0] != '\0' ? " (" : "", name, name[0] != '\0' ? ")" : "");
}

void ctl_value_json(struct json_writer *json, const struct named_object *object,
                    const struct object_value *value)
{
    char text[OBJECT_TEXT_MAX];
    double number;
    json_open_object(json, object->name);
    if (object_number(object, value, &number)) {
        json_number(json, "value", number, 12);
    } else {
        object_value_text(object, value, text);
        json_text(json, "value", text);
    }
    json_text(json, "unit", object->unit[0] != '\0' ? object->unit : NULL);
    object_value_name(object, value, text);
    if (text[0] != '\0') {
        json_text(json, "name", text);
    }
    json_close_object(json);
}
