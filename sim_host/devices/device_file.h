/* A device as a file describes it: what hangs on the bus, leg by leg.
 *
 *     [device]        name, tick_us, bitrate_bit_s
 *     [both]          keys of both legs
 *     [left] [right]  keys of one leg; they take the place of those in [both]
 *     [plant] [left.plant] [right.plant]   for the simulated actuator only
 *
 * The keys are those of hal/devices/device_keys.h; `afo device keys` lists them. The description is
 * the one that the controller gets, in its own numbers. The simulated world needs the same numbers in
 * double and as they stand in the file: device_file_number().
 */
#ifndef SIM_HOST_DEVICES_DEVICE_FILE_H
#define SIM_HOST_DEVICES_DEVICE_FILE_H

#include <stdbool.h>
#include <stdio.h>

#include "hal/devices/device_description.h"

enum {
    DEVICE_NAME_MAX = 64,
    DEVICE_MESSAGE_MAX = 768,
    DEVICE_PLANT_KEYS_MAX = 160,
    DEVICE_PLANT_TEXT_MAX = 48,
    DEVICE_PLANT_VALUE_MAX = 200 /* a table of points */
};

/* A key of a [plant] section, unread. */
struct device_plant_key {
    int leg; /* enum side, or -1: [plant], both legs */
    int line;
    char key[DEVICE_PLANT_TEXT_MAX], value[DEVICE_PLANT_VALUE_MAX];
};

struct device_file {
    char name[DEVICE_NAME_MAX];
    struct device_description description;
    double number[SIDE_COUNT][DEVICE_LEG_COUNT]; /* the same as the file says it */
    struct device_plant_key plant[DEVICE_PLANT_KEYS_MAX];
    int plant_keys;
};

/* The virtual device: the same as sim_host/devices/virtual.ini. */
void device_file_default(struct device_file *file);

/* Reads a file. Every key that says something of a leg and has no fallback must be given; a key that
 * would do nothing is refused. The plant's keys are kept as they are: who reads them refuses those it
 * does not know. Returns 0, or -1 with file, leg, key and what is allowed in message
 * (DEVICE_MESSAGE_MAX bytes); *file is then not to be used. */
int device_file_read(struct device_file *file, const char *path, char *message);

/* A key's number as the file says it, in double. */
double device_file_number(const struct device_file *file, enum side leg, enum device_leg_key key);

/* Sets a key of a leg, in the description and in double. Not checked. */
void device_file_set(struct device_file *file, enum side leg, enum device_leg_key key,
                     double number);

/* Writes the file: keys that both legs have alike under [both], what each key means behind it.
 * Reading it gives the same numbers again. The stream keeps its error. */
void device_file_write(FILE *stream, const struct device_file *file);

#endif
