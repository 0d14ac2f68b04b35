#include "sim_host/subjects/actuators.h"

#include <stdio.h>
#include <string.h>

static const char *section_of(int leg)
{
    static const char *const names[SIDE_COUNT] = {
        [SIDE_LEFT] = "left.plant", [SIDE_RIGHT] = "right.plant"};
    return leg < 0 ? "plant" : names[leg];
}

/* The keys of one section, in the order of the file. */
static int take_section(const struct device_file *file, int section, const char *path,
                        struct actuators *actuators, char *message)
{
    char why[ACTUATORS_MESSAGE_MAX / 2];
    for (int i = 0; i < file->plant_keys; i++) {
        const struct device_plant_key *entry = &file->plant[i];
        for (int leg = 0; leg < SIDE_COUNT && entry->leg == section; leg++) {
            if ((section < 0 || section == leg) &&
                sea_config_set(&actuators->config[leg], entry->key, entry->value, why,
                               sizeof why) != SEA_SET) {
                (void)snprintf(message, ACTUATORS_MESSAGE_MAX, "%.250s:%d: [%s]: %s", path,
                               entry->line, section_of(section), why);
                return -1;
            }
        }
    }
    return 0;
}

static int refuse_twice(const struct device_file *file, const char *path, char *message)
{
    for (int i = 0; i < file->plant_keys; i++) {
        for (int k = 0; k < i; k++) {
            const struct device_plant_key *a = &file->plant[i], *b = &file->plant[k];
            if (a->leg == b->leg && strcmp(a->key, b->key) == 0) {
                (void)snprintf(message, ACTUATORS_MESSAGE_MAX,
                               "%.250s:%d: [%s]: key \"%s\" is given twice", path, a->line,
                               section_of(a->leg), a->key);
                return -1;
            }
        }
    }
    return 0;
}

/* One battery is told alike at both legs. */
static int check_battery(const struct actuators *actuators, const char *path, char *message)
{
    const struct sea_config *left = &actuators->config[SIDE_LEFT];
    const struct sea_config *right = &actuators->config[SIDE_RIGHT];
    const bool alike = left->supply_V == right->supply_V && left->supply_ohm == right->supply_ohm &&
                       left->supply_current_max_A == right->supply_current_max_A;
    if (left->supply_shared == right->supply_shared && (left->supply_shared < 0.5 || alike)) {
        return 0;
    }
    (void)snprintf(
        message, ACTUATORS_MESSAGE_MAX,
        "%.250s: [plant]: supply_shared is %g at the left leg and %g at the right: one battery has "
        "one supply_V, supply_ohm and supply_current_max_A; tell them in [plant]",
        path, left->supply_shared, right->supply_shared);
    return -1;
}

int actuators_of(const struct device_file *file, const char *path, struct actuators *actuators,
                 char *message)
{
    char why[ACTUATORS_MESSAGE_MAX / 2];
    actuators->as_built = file->plant_keys > 0;
    if (!actuators->as_built) {
        return 0;
    }
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        sea_config_default(&actuators->config[leg]);
    }
    if (refuse_twice(file, path, message) != 0 ||
        take_section(file, -1, path, actuators, message) != 0 ||
        take_section(file, SIDE_LEFT, path, actuators, message) != 0 ||
        take_section(file, SIDE_RIGHT, path, actuators, message) != 0) {
        return -1;
    }
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        if (sea_config_check(&actuators->config[leg], why, sizeof why) != 0) {
            (void)snprintf(message, ACTUATORS_MESSAGE_MAX, "%.250s: [%s]: %s", path,
                           section_of(leg), why);
            return -1;
        }
    }
    return check_battery(actuators, path, message);
}
