/* A maker's data sheet of a CANopen node, as CiA 306 has it: which objects there are, what may be read,
 * written and mapped, and within which limits. EDS and DCF files are read alike.
 */
#ifndef SIM_HOST_DEVICES_EDS_FILE_H
#define SIM_HOST_DEVICES_EDS_FILE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { EDS_NAME_MAX = 96, EDS_DUMMY_TYPES = 32, EDS_MESSAGE_MAX = 512 };

struct eds_object {
    uint16_t index;
    uint8_t sub;
    uint8_t type; /* CiA 301, 7.4.7: 2, 3, 4 are INTEGER8, 16, 32; 5, 6, 7 UNSIGNED; 0 = not told */
    bool readable, writable; /* over SDO */
    bool mappable;
    bool is_whole; /* it has parts of its own (ObjectType 8 or 9), and is none itself */
    bool has_default, has_low, has_high;
    int64_t default_value, low, high;
    char name[EDS_NAME_MAX];
};

struct eds_file {
    char product[EDS_NAME_MAX], vendor[EDS_NAME_MAX];
    bool dummy[EDS_DUMMY_TYPES]; /* may be mapped as a place holder */
    struct eds_object *objects;  /* sorted by index, then sub */
    size_t count, capacity;
};

/* Reads a file; the objects are on the heap until eds_file_free. Returns 0, or -1 with the reason in message
 * (EDS_MESSAGE_MAX bytes); then nothing is held. */
int eds_file_read(struct eds_file *eds, const char *path, char *message);
void eds_file_free(struct eds_file *eds);

/* The object, or NULL. */
const struct eds_object *eds_find(const struct eds_file *eds, uint16_t index, uint8_t sub);

/* Whether any object of that index exists. */
bool eds_has_index(const struct eds_file *eds, uint16_t index);

/* Whether value may be written to it: access and limits. */
bool eds_takes(const struct eds_object *object, int64_t value);

#endif
