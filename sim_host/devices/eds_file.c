#include "sim_host/devices/eds_file.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "sim_host/text/ini.h"

struct reading {
    struct eds_file *eds;
    bool out_of_memory;
};

static int compare(const void *a, const void *b)
{
    const struct eds_object *left = a, *right = b;
    const int one = left->index << 8 | left->sub, other = right->index << 8 | right->sub;
    return one < other ? -1 : one > other;
}

/* "6040" or "60FEsub1", in whatever case; false for other sections. */
static bool place_of(const char *section, uint16_t *index, uint8_t *sub)
{
    char *end = NULL;
    if (strlen(section) < 4 || !isxdigit((unsigned char)section[0])) {
        return false;
    }
    const unsigned long first = strtoul(section, &end, 16);
    if (end != section + 4 || first > 0xFFFF) {
        return false;
    }
    *index = (uint16_t)first;
    *sub = 0;
    if (*end == '\0') {
        return true;
    }
    if (strncasecmp(end, "sub", 3) != 0) {
        return false;
    }
    const char *from = end + 3;
    const unsigned long second = strtoul(from, &end, 16);
    *sub = (uint8_t)second;
    return end != from && *end == '\0' && second <= 0xFF;
}

/* The newest object is the one whose keys come now; an index's own section and its part 0 are one. */
static struct eds_object *object_at(struct reading *reading, uint16_t index, uint8_t sub)
{
    struct eds_file *eds = reading->eds;
    for (size_t i = eds->count; i > 0; i--) {
        struct eds_object *object = &eds->objects[i - 1];
        if (object->index == index && object->sub == sub) {
            return object;
        }
    }
    if (eds->count == eds->capacity) {
        const size_t capacity = eds->capacity == 0 ? 256 : 2 * eds->capacity;
        struct eds_object *larger = realloc(eds->objects, capacity * sizeof *larger);
        if (larger == NULL) {
            reading->out_of_memory = true;
            return NULL;
        }
        eds->objects = larger;
        eds->capacity = capacity;
    }
    struct eds_object *object = &eds->objects[eds->count++];
    *object = (struct eds_object){.index = index, .sub = sub};
    return object;
}

/* "$NODEID+0x200" counts without the node's number. */
static bool number_of(const char *text, int64_t *number)
{
    const char *plus = strchr(text, '+');
    char *end = NULL;
    if (text[0] == '$') {
        text = plus != NULL ? plus + 1 : "0";
    }
    *number = strtoll(text, &end, 0);
    return end != text;
}

static void take_access(struct eds_object *object, const char *value)
{
    object->readable = strcasecmp(value, "wo") != 0;
    object->writable = strncasecmp(value, "rw", 2) == 0 || strcasecmp(value, "wo") == 0;
}

static void take_object_key(struct eds_object *object, const char *key, const char *value)
{
    int64_t number = 0;
    const bool is_number = number_of(value, &number);
    if (strcasecmp(key, "ParameterName") == 0) {
        if (object->name[0] == '\0') {
            snprintf(object->name, sizeof object->name, "%.*s", EDS_NAME_MAX - 1, value);
        }
    } else if (strcasecmp(key, "AccessType") == 0) {
        take_access(object, value);
    } else if (!is_number) {
        return;
    } else if (strcasecmp(key, "ObjectType") == 0) {
        object->is_whole = number == 8 || number == 9;
    } else if (strcasecmp(key, "DataType") == 0) {
        object->type = (uint8_t)number;
    } else if (strcasecmp(key, "PDOMapping") == 0) {
        object->mappable = number != 0;
    } else if (strcasecmp(key, "DefaultValue") == 0 || strcasecmp(key, "ParameterValue") == 0) {
        object->has_default = true;
        object->default_value = number; /* a DCF's own value stands behind */
    } else if (strcasecmp(key, "LowLimit") == 0) {
        object->has_low = true;
        object->low = number;
    } else if (strcasecmp(key, "HighLimit") == 0) {
        object->has_high = true;
        object->high = number;
    }
}

static int take_key(void *context, const char *section, const char *key, const char *value,
                    int line, char *message, size_t size)
{
    struct reading *reading = context;
    struct eds_file *eds = reading->eds;
    uint16_t index;
    uint8_t sub;
    (void)line;
    if (strcasecmp(section, "DeviceInfo") == 0) {
        if (strcasecmp(key, "ProductName") == 0) {
            snprintf(eds->product, sizeof eds->product, "%.*s", EDS_NAME_MAX - 1, value);
        } else if (strcasecmp(key, "VendorName") == 0) {
            snprintf(eds->vendor, sizeof eds->vendor, "%.*s", EDS_NAME_MAX - 1, value);
        }
    } else if (strcasecmp(section, "DummyUsage") == 0) {
        const unsigned long type = strlen(key) == 9 ? strtoul(key + 5, NULL, 16) : 0;
        if (type > 0 && type < EDS_DUMMY_TYPES) {
            eds->dummy[type] = strtol(value, NULL, 0) != 0;
        }
    } else if (place_of(section, &index, &sub)) {
        struct eds_object *object = object_at(reading, index, sub);
        if (object == NULL) {
            snprintf(message, size, "out of memory");
            return -1;
        }
        take_object_key(object, key, value);
    }
    return 0;
}

int eds_file_read(struct eds_file *eds, const char *path, char *message)
{
    struct reading reading = {.eds = eds};
    *eds = (struct eds_file){.count = 0};
    if (ini_read(path, take_key, &reading, message, EDS_MESSAGE_MAX) != 0) {
        eds_file_free(eds);
        return -1;
    }
    if (eds->count == 0) {
        snprintf(message, EDS_MESSAGE_MAX, "%.300s: no object in it: is it an EDS?", path);
        eds_file_free(eds);
        return -1;
    }
    qsort(eds->objects, eds->count, sizeof eds->objects[0], compare);
    return 0;
}

void eds_file_free(struct eds_file *eds)
{
    free(eds->objects);
    *eds = (struct eds_file){.count = 0};
}

const struct eds_object *eds_find(const struct eds_file *eds, uint16_t index, uint8_t sub)
{
    const struct eds_object wanted = {.index = index, .sub = sub};
    return bsearch(&wanted, eds->objects, eds->count, sizeof wanted, compare);
}

bool eds_has_index(const struct eds_file *eds, uint16_t index)
{
    for (size_t i = 0; i < eds->count; i++) {
        if (eds->objects[i].index == index) {
            return true;
        }
    }
    return false;
}

bool eds_takes(const struct eds_object *object, int64_t value)
{
    return object != NULL && object->writable && !(object->has_low && value < object->low) &&
           !(object->has_high && value > object->high);
}
