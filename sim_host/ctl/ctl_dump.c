/* dump, diff. */
#include <stdlib.h>
#include <string.h>

#include "sim_host/cli/json_writer.h"
#include "sim_host/ctl/ctl.h"
#include "sim_host/ctl/ctl_internal.h"
#include "sim_host/text/ini.h"

/* The parameters are the section [controller] of other files, too. */
#define PARAMETERS "parameters"
#define PARAMETERS_IN_FILES "controller"

enum { COMMANDS = 0x2000, SETTINGS_LAST = 0x201F };

/* What stays as it was written: not requests, and not what is only acknowledged. */
static bool is_setting(const struct named_object *object)
{
    const unsigned both = (unsigned)CO_READ | CO_WRITE;
    const struct co_entry *entry = object->entry;
    return (entry->access & both) == both && entry->index >= COMMANDS &&
           entry->index <= SETTINGS_LAST && (entry->index > COMMANDS || entry->type == CO_REAL32);
}

static bool is_shown(const struct ctl *ctl, const struct named_object *object)
{
    return (object->entry->access & CO_READ) != 0 && (ctl->all || is_setting(object));
}

/* The part of a name before the point; empty without one. */
static void group_of(const struct named_object *object, char group[OBJECT_NAME_MAX])
{
    const int length = object->leaf > 0 ? (int)object->leaf - 1 : 0;
    (void)snprintf(group, OBJECT_NAME_MAX, "%.*s", length, object->name);
}

/* ---- dump ------------------------------------------------------------------------ */

static void print_line(struct ctl *ctl, const struct named_object *object,
                       const struct object_value *value, char last_group[OBJECT_NAME_MAX])
{
    char group[OBJECT_NAME_MAX], text[OBJECT_TEXT_MAX];
    group_of(object, group);
    if (strcmp(group, last_group) != 0) {
        (void)snprintf(last_group, OBJECT_NAME_MAX, "%s", group);
        fprintf(ctl->out, "\n[%s]\n",
                strcmp(group, PARAMETERS) == 0 ? PARAMETERS_IN_FILES
                : group[0] != '\0'             ? group
                                               : "node");
    }
    object_value_text(object, value, text);
    fprintf(ctl->out, "%s = %s", object->name + object->leaf, text);
    fprintf(ctl->out, "%s%s\n", object->unit[0] != '\0' ? " ; " : "", object->unit);
}

enum exit_status ctl_dump(struct ctl *ctl, int count, char **words)
{
    static struct object_value value;
    bool is_meant[OBJECT_LIST_MAX];
    char message[OBJECT_MESSAGE_MAX], last_group[OBJECT_NAME_MAX] = "-";
    struct json_writer json;
    bool good = true;
    if (ctl_mark_all(ctl, count, words, is_meant) != 0) {
        return EXIT_USAGE;
    }
    if (ctl->json) {
        json_begin(&json, ctl->out);
        json_open_object(&json, NULL);
    } else {
        fprintf(ctl->out, "; node %u, read by afo ctl dump\n", ctl->link.node);
    }
    for (size_t i = 0; i < ctl->objects.count && good; i++) {
        const struct named_object *object = &ctl->objects.object[i];
        if (!is_meant[i] || !is_shown(ctl, object)) {
            continue;
        }
        good = ctl_link_read(&ctl->link, object, &value, message) == 0;
        if (!good) { /* a file with holes is worse than none */
            ctl_complain(ctl, "%s", message);
        } else if (ctl->json) {
            ctl_value_json(&json, object, &value);
        } else {
            print_line(ctl, object, &value, last_group);
        }
    }
    if (ctl->json) {
        json_close_object(&json);
        json_end(&json);
    }
    return good ? EXIT_GOOD : EXIT_BAD;
}

/* ---- diff ------------------------------------------------------------------------ */

struct comparison {
    struct ctl *ctl;
    struct json_writer json;
    unsigned compared, different, unknown;
    bool failed;
};

static void tell_difference(struct comparison *comparison, const struct named_object *object,
                            const char *in_file, const struct object_value *value)
{
    struct ctl *ctl = comparison->ctl;
    char text[OBJECT_TEXT_MAX];
    object_value_text(object, value, text);
    comparison->different++;
    if (ctl->json) {
        json_open_object(&comparison->json, object->name);
        json_text(&comparison->json, "file", in_file);
        json_text(&comparison->json, "node", text);
        json_text(&comparison->json, "unit", object->unit[0] != '\0' ? object->unit : NULL);
        json_close_object(&comparison->json);
        return;
    }
    fprintf(ctl->out, "%s: file %s, node %s%s%s\n", object->name, in_file, text,
            object->unit[0] != '\0' ? " " : "", object->unit);
}

/* Alike as the node would hold the file's value: to the last bit of a float. */
static bool is_alike(const struct named_object *object, const char *in_file,
                     const struct object_value *value)
{
    char text[OBJECT_TEXT_MAX], *end = NULL;
    double number;
    object_value_text(object, value, text);
    if (strcmp(text, in_file) == 0) {
        return true;
    }
    const double wanted = strtod(in_file, &end);
    return object_number(object, value, &number) && end != in_file && *end == '\0' &&
           (object->entry->type == CO_REAL32 ? (float)wanted == (float)number : wanted == number);
}

static int compare_key(void *context, const char *section, const char *key, const char *value,
                       int line, char *message, size_t size)
{
    struct comparison *comparison = (struct comparison *)context;
    struct ctl *ctl = comparison->ctl;
    static struct object_value held;
    char name[2 * OBJECT_NAME_MAX], why[OBJECT_MESSAGE_MAX];
    const char *group = strcmp(section, PARAMETERS_IN_FILES) == 0 ? PARAMETERS : section;
    const bool is_plain = group[0] == '\0' || strcmp(group, "node") == 0;
    (void)snprintf(name, sizeof name, "%s%s%s", is_plain ? "" : group, is_plain ? "" : ".", key);
    const struct named_object *object = object_list_find(&ctl->objects, name, false, why);
    if (object == NULL) {
        comparison->unknown++;
        ctl_complain(ctl, "line %d: %s", line, why);
        return 0;
    }
    if (ctl_link_read(&ctl->link, object, &held, why) != 0) {
        (void)snprintf(message, size, "%s", why);
        comparison->failed = true;
        return -1;
    }
    comparison->compared++;
    if (!is_alike(object, value, &held)) {
        tell_difference(comparison, object, value, &held);
    }
    return 0;
}

enum exit_status ctl_diff(struct ctl *ctl, int count, char **words)
{
    struct comparison comparison = {.ctl = ctl};
    char message[OBJECT_MESSAGE_MAX] = "";
    (void)count;
    if (ctl->json) {
        json_begin(&comparison.json, ctl->out);
        json_open_object(&comparison.json, NULL);
    }
    const int result = ini_read(words[0], compare_key, &comparison, message, sizeof message);
    if (ctl->json) {
        json_close_object(&comparison.json);
        json_end(&comparison.json);
    }
    if (result != 0) {
        ctl_complain(ctl, "%s", message);
        return comparison.failed ? EXIT_BAD : EXIT_USAGE;
    }
    if (comparison.compared == 0) {
        ctl_complain(ctl, "%s names no object of node %u", words[0], ctl->link.node);
        return EXIT_USAGE;
    }
    if (!ctl->json) {
        fprintf(ctl->out, "%u compared, %u different, %u unknown\n", comparison.compared,
                comparison.different, comparison.unknown);
    }
    return comparison.different == 0 && comparison.unknown == 0 ? EXIT_GOOD : EXIT_BAD;
}
