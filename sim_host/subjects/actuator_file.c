#include "sim_host/subjects/actuator_file.h"

#include <stdio.h>
#include <string.h>

#include "sim_host/subjects/ini.h"

enum { BOTH = SIDE_COUNT, SECTIONS = SIDE_COUNT + 1, TABLES = 2, KEYS = SEA_KEYS + TABLES };

static const char *const sections[SECTIONS] = {
    [SIDE_LEFT] = "left.plant", [SIDE_RIGHT] = "right.plant", [BOTH] = "plant"};

/* Which keys each section has said, the tables behind the numbers. */
struct reading {
    struct actuators *actuators;
    bool given[SECTIONS][KEYS];
    bool found;
};

static int number_of(const char *key)
{
    static const char *const tables[TABLES] = {"spring_table", "lever_table"};
    for (int i = 0; i < SEA_KEYS; i++) {
        if (strcmp(key, sea_keys[i].name) == 0) {
            return i;
        }
    }
    for (int i = 0; i < TABLES; i++) {
        if (strcmp(key, tables[i]) == 0) {
            return SEA_KEYS + i;
        }
    }
    return -1;
}

static int set(struct reading *reading, int section, const char *key, const char *value,
               char *message, size_t size)
{
    const int number = number_of(key);
    if (number >= 0 && reading->given[section][number]) {
        (void)snprintf(message, size, "key \"%s\" is given twice in section [%s]", key,
                       sections[section]);
        return -1;
    }
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        const bool own_said = section == BOTH && number >= 0 && reading->given[leg][number];
        if ((section == leg || section == BOTH) && !own_said &&
            sea_config_set(&reading->actuators->leg[leg], key, value, message, size) != SEA_SET) {
            return -1;
        }
    }
    reading->given[section][number] = true;
    return 0;
}

static int set_key(void *context, const char *section, const char *key, const char *value, int line,
                   char *message, size_t size)
{
    struct reading *reading = (struct reading *)context;
    (void)line;
    for (int i = 0; i < SECTIONS; i++) {
        if (strcmp(section, sections[i]) == 0) {
            reading->found = true;
            return set(reading, i, key, value, message, size);
        }
    }
    return 0;
}

int actuators_read(struct actuators *actuators, const char *path, char *message)
{
    struct reading reading = {.actuators = actuators};
    char why[ACTUATOR_MESSAGE_MAX / 2];
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        sea_config_default(&actuators->leg[leg]);
    }
    if (ini_read(path, set_key, &reading, message, ACTUATOR_MESSAGE_MAX) != 0) {
        return -1;
    }
    if (!reading.found) {
        (void)snprintf(message, ACTUATOR_MESSAGE_MAX,
                       "%.300s: there is no section [plant], [left.plant] or [right.plant]", path);
        return -1;
    }
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        if (sea_config_check(&actuators->leg[leg], why, sizeof why) != 0) {
            (void)snprintf(message, ACTUATOR_MESSAGE_MAX, "%.300s: [%s]: %s", path, sections[leg],
                           why);
            return -1;
        }
    }
    return 0;
}
