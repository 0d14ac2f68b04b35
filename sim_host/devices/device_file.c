#include "sim_host/devices/device_file.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sim_host/devices/device_text.h"
#include "sim_host/text/ini.h"
#include "sim_host/text/nearest.h"
#include "sim_host/text/number_text.h"

/* Where a key was given: bits. */
enum { IN_BOTH = 1, IN_LEG = 2 };

struct reading {
    struct device_file *file;
    uint8_t given[SIDE_COUNT][DEVICE_LEG_COUNT];
    bool common_given[DEVICE_COMMON_COUNT], name_given;
};

/* ---- numbers ------------------------------------------------------------------ */

static void put(void *owner, const struct device_key *row, double number)
{
    uint8_t *field = (uint8_t *)owner + row->offset;
    if (row->type == DEVICE_FLOAT) {
        const float value = (float)number;
        memcpy(field, &value, sizeof value);
    } else {
        const int32_t value = (int32_t)lround(number);
        memcpy(field, &value, sizeof value);
    }
}

double device_file_number(const struct device_file *file, enum side leg, enum device_leg_key key)
{
    return file->number[leg][key];
}

void device_file_set(struct device_file *file, enum side leg, enum device_leg_key key,
                     double number)
{
    file->number[leg][key] = number;
    put(&file->description.leg[leg], &device_leg_keys[key], number);
}

/* The shortest decimal number that is this float: 0.0001, not the double of the float nearest to it. */
static double decimal_of(float value)
{
    char text[NUMBER_TEXT_MAX];
    for (int digits = 6; digits <= 9; digits++) {
        snprintf(text, sizeof text, "%.*g", digits, (double)value);
        if (strtof(text, NULL) == value) {
            break;
        }
    }
    return strtod(text, NULL);
}

void device_file_default(struct device_file *file)
{
    *file = (struct device_file){.name = "virtual drives, the paper's spring"};
    device_description_default(&file->description);
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        for (unsigned key = 0; key < DEVICE_LEG_COUNT; key++) {
            const float value = device_value(&file->description, leg, key);
            device_file_set(file, (enum side)leg, (enum device_leg_key)key,
                            device_leg_keys[key].type == DEVICE_FLOAT ? decimal_of(value)
                                                                      : (double)value);
        }
    }
}

/* ---- reading ------------------------------------------------------------------ */

static int find_key(const struct device_key *rows, unsigned count, const char *key)
{
    for (unsigned i = 0; i < count; i++) {
        if (strcmp(rows[i].name, key) == 0) {
            return (int)i;
        }
    }
    return -1;
}

static int refuse_unknown(const struct device_key *rows, unsigned count, const char *section,
                          const char *key, char *message, size_t size)
{
    const char *names[DEVICE_LEG_COUNT];
    for (unsigned i = 0; i < count; i++) {
        names[i] = rows[i].name;
    }
    const char *near = nearest_name(key, names, count, sizeof names[0]);
    snprintf(message, size, "unknown key \"%.40s\" in section [%.40s]%s%s", key, section,
             near != NULL ? "; nearest: " : "", near != NULL ? near : "");
    return -1;
}

static int read_value(const struct device_key *row, const char *value, double *number,
                      char *message, size_t size)
{
    char reason[DEVICE_MESSAGE_MAX / 2];
    if (device_value_read(row, value, number, reason, sizeof reason) != 0) {
        snprintf(message, size, "key \"%s\" (%s): %s", row->name, row->meaning, reason);
        return -1;
    }
    return 0;
}

static int refuse_twice(const struct device_key *row, char *message, size_t size)
{
    snprintf(message, size, "key \"%s\" (%s) is given twice", row->name, row->meaning);
    return -1;
}

static int take_common(struct reading *reading, const char *key, const char *value, char *message,
                       size_t size)
{
    double number;
    if (strcmp(key, "name") == 0) {
        if (reading->name_given) {
            snprintf(message, size, "key \"name\" is given twice");
            return -1;
        }
        reading->name_given = true;
        snprintf(reading->file->name, DEVICE_NAME_MAX, "%.*s", DEVICE_NAME_MAX - 1, value);
        return 0;
    }
    const int found = find_key(device_common_keys, DEVICE_COMMON_COUNT, key);
    if (found < 0) {
        return refuse_unknown(device_common_keys, DEVICE_COMMON_COUNT, "device", key, message,
                              size);
    }
    const struct device_key *row = &device_common_keys[found];
    if (reading->common_given[found]) {
        return refuse_twice(row, message, size);
    }
    reading->common_given[found] = true;
    if (read_value(row, value, &number, message, size) != 0) {
        return -1;
    }
    put(&reading->file->description.common, row, number);
    return 0;
}

static int take_leg(struct reading *reading, int only, const char *section, const char *key,
                    const char *value, char *message, size_t size)
{
    double number;
    const int found = find_key(device_leg_keys, DEVICE_LEG_COUNT, key);
    if (found < 0) {
        return refuse_unknown(device_leg_keys, DEVICE_LEG_COUNT, section, key, message, size);
    }
    const struct device_key *row = &device_leg_keys[found];
    const uint8_t where = only < 0 ? IN_BOTH : IN_LEG;
    if (read_value(row, value, &number, message, size) != 0) {
        return -1;
    }
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        uint8_t *given = &reading->given[leg][found];
        if (only >= 0 && leg != only) {
            continue;
        }
        if ((*given & where) != 0) {
            return refuse_twice(row, message, size);
        }
        if (only >= 0 || (*given & IN_LEG) == 0) {
            device_file_set(reading->file, (enum side)leg, (enum device_leg_key)found, number);
        }
        *given |= where;
    }
    return 0;
}

static int take_plant(struct device_file *file, int leg, const char *key, const char *value,
                      int line, char *message, size_t size)
{
    if (file->plant_keys == DEVICE_PLANT_KEYS_MAX || strlen(key) >= DEVICE_PLANT_TEXT_MAX ||
        strlen(value) >= DEVICE_PLANT_VALUE_MAX) {
        snprintf(
            message, size,
            "more than %d keys for the plant, or one of more than %d letters, or a value of more than "
            "%d",
            DEVICE_PLANT_KEYS_MAX, DEVICE_PLANT_TEXT_MAX - 1, DEVICE_PLANT_VALUE_MAX - 1);
        return -1;
    }
    struct device_plant_key *entry = &file->plant[file->plant_keys++];
    *entry = (struct device_plant_key){.leg = leg, .line = line};
    memcpy(entry->key, key, strlen(key) + 1);
    memcpy(entry->value, value, strlen(value) + 1);
    return 0;
}

static int take_key(void *context, const char *section, const char *key, const char *value,
                    int line, char *message, size_t size)
{
    static const struct {
        const char *name;
        int leg;
        bool plant;
    } sections[] = {
        {"both", -1, false}, {"left", SIDE_LEFT, false},      {"right", SIDE_RIGHT, false},
        {"plant", -1, true}, {"left.plant", SIDE_LEFT, true}, {"right.plant", SIDE_RIGHT, true}};
    struct reading *reading = (struct reading *)context;
    if (strcmp(section, "device") == 0) {
        return take_common(reading, key, value, message, size);
    }
    for (size_t i = 0; i < sizeof sections / sizeof sections[0]; i++) {
        if (strcmp(section, sections[i].name) == 0) {
            return sections[i].plant
                       ? take_plant(reading->file, sections[i].leg, key, value, line, message, size)
                       : take_leg(reading, sections[i].leg, section, key, value, message, size);
        }
    }
    if (section[0] == '\0') {
        snprintf(message, size, "key \"%.40s\" stands before the first [section]", key);
    } else {
        snprintf(message, size,
                 "section [%.40s] is none of a device file: those are [device], [both], [left], "
                 "[right], [plant], [left.plant] and [right.plant]",
                 section);
    }
    return -1;
}

static int refuse_leg_key(const char *path, int leg, unsigned key, const char *reason,
                          char *message)
{
    const struct device_key *row = &device_leg_keys[key];
    snprintf(message, DEVICE_MESSAGE_MAX, "%.300s: %s, key \"%s\" (%s) %s", path,
             device_leg_name(leg), row->name, row->meaning, reason);
    return -1;
}

/* What is missing is not filled in from somebody else's device, and a key that would do nothing
 * would be believed. */
static int check_given(const struct reading *reading, const char *path, char *message)
{
    const struct device_leg *leg = reading->file->description.leg;
    for (int side = 0; side < SIDE_COUNT; side++) {
        for (unsigned key = 0; key < DEVICE_LEG_COUNT; key++) {
            const uint8_t given = reading->given[side][key];
            const bool applies = device_key_applies(&leg[side], key);
            if (given == 0 && applies && device_leg_keys[key].fallback == DEVICE_ASKED) {
                char allowed[256];
                const struct device_key *row = &device_leg_keys[key];
                if (row->type == DEVICE_FLOAT || row->type == DEVICE_INT) {
                    snprintf(allowed, sizeof allowed, "is missing, allowed is %g to %g %s",
                             (double)row->minimum, (double)row->maximum, row->unit);
                } else {
                    snprintf(allowed, sizeof allowed, "is missing, allowed is %s", row->unit);
                }
                return refuse_leg_key(path, side, key, allowed, message);
            }
            if (!applies && ((given & IN_LEG) != 0 ||
                             ((given & IN_BOTH) != 0 &&
                              !device_key_applies(&leg[SIDE_COUNT - 1 - side], key)))) {
                return refuse_leg_key(path, side, key,
                                      "does nothing with this leg's protocol, latch or ankle",
                                      message);
            }
        }
    }
    return 0;
}

static void start(struct device_file *file, const char *path)
{
    device_file_default(file);
    snprintf(file->name, sizeof file->name, "%.*s", DEVICE_NAME_MAX - 1, path);
    for (unsigned key = 0; key < DEVICE_LEG_COUNT; key++) {
        const float fallback = device_leg_keys[key].fallback;
        for (int leg = 0; leg < SIDE_COUNT && fallback != DEVICE_ASKED; leg++) {
            device_file_set(file, (enum side)leg, (enum device_leg_key)key,
                            device_leg_keys[key].type == DEVICE_FLOAT ? decimal_of(fallback)
                                                                      : (double)fallback);
        }
    }
}

int device_file_read(struct device_file *file, const char *path, char *message)
{
    struct reading reading = {.file = file};
    struct device_refusal refusal;
    start(file, path);
    if (ini_read(path, take_key, &reading, message, DEVICE_MESSAGE_MAX) != 0 ||
        check_given(&reading, path, message) != 0) {
        return -1;
    }
    if (device_check(&file->description, &refusal) != DEVICE_OK) {
        char reason[DEVICE_MESSAGE_MAX];
        device_refusal_text(&refusal, reason, sizeof reason);
        snprintf(message, DEVICE_MESSAGE_MAX, "%.300s: %.460s", path, reason);
        return -1;
    }
    return 0;
}

/* ---- writing ------------------------------------------------------------------ */

static void write_key(FILE *stream, const struct device_key *row, double number)
{
    char text[DEVICE_VALUE_TEXT_MAX], line[DEVICE_VALUE_TEXT_MAX + 64];
    device_value_text(row, number, text, sizeof text);
    snprintf(line, sizeof line, "%s = %s", row->name, text);
    const bool has_unit = row->type <= DEVICE_INT && row->unit[0] != '\0';
    fprintf(stream, "%-34s ; %s%s%s\n", line, has_unit ? row->unit : "", has_unit ? ": " : "",
            row->meaning);
}

static bool is_shared(const struct device_file *file, unsigned key)
{
    const struct device_leg *leg = file->description.leg;
    return device_key_applies(&leg[SIDE_LEFT], key) && device_key_applies(&leg[SIDE_RIGHT], key) &&
           file->number[SIDE_LEFT][key] == file->number[SIDE_RIGHT][key];
}

static void write_plant(FILE *stream, const struct device_file *file, int leg)
{
    static const char *const names[] = {"plant", "left.plant", "right.plant"};
    bool begun = false;
    for (int i = 0; i < file->plant_keys; i++) {
        const struct device_plant_key *entry = &file->plant[i];
        if (entry->leg == leg) {
            if (!begun) {
                fprintf(stream, "\n[%s]\n", names[leg + 1]);
            }
            begun = true;
            fprintf(stream, "%s = %s\n", entry->key, entry->value);
        }
    }
}

void device_file_write(FILE *stream, const struct device_file *file)
{
    static const char *const names[] = {"both", "left", "right"};
    fprintf(stream, "[device]\nname = %s\n", file->name);
    for (unsigned key = 0; key < DEVICE_COMMON_COUNT; key++) {
        write_key(stream, &device_common_keys[key],
                  (double)device_value(&file->description, -1, key));
    }
    for (int section = -1; section < SIDE_COUNT; section++) {
        fprintf(stream, "\n[%s]\n", names[section + 1]);
        for (unsigned key = 0; key < DEVICE_LEG_COUNT; key++) {
            const int leg = section < 0 ? SIDE_LEFT : section;
            const bool here =
                section < 0
                    ? is_shared(file, key)
                    : !is_shared(file, key) && device_key_applies(&file->description.leg[leg], key);
            if (here) {
                write_key(stream, &device_leg_keys[key], file->number[leg][key]);
            }
        }
    }
    for (int leg = -1; leg < SIDE_COUNT; leg++) {
        write_plant(stream, file, leg);
    }
}
