/* What a node can be asked, by name: made of its object dictionary, the same tables that answer over
 * SDO and write the EDS. There is no second list of names, units or ranges.
 *
 * A name is the group's and the entry's, in small letters: "commands.walk_requested". The group is what
 * the EDS calls the object, the part behind the point what it calls the sub-index. Units at the end of
 * an EDS name ("Precompression 10 um") give the scale; values are shown in SI units.
 */
#ifndef SIM_HOST_CTL_OBJECT_LIST_H
#define SIM_HOST_CTL_OBJECT_LIST_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "hal/canopen/co_od.h"

enum { OBJECT_NAME_MAX = 96, OBJECT_LIST_MAX = 640, OBJECT_MESSAGE_MAX = 512 };

struct named_object {
    char name[OBJECT_NAME_MAX];
    size_t leaf; /* where the part behind the point begins; 0 = there is no point */
    const struct co_entry *entry;
    const char *unit; /* of the value shown; "" without one */
    double scale;     /* the value shown is the number on the bus times this */
    bool has_range;   /* low and high limit what may be written, in `unit` */
    double low, high;
    const char
        *meaning; /* for people: the EDS name, or what the parameter's table says; never NULL */
};

struct object_list {
    struct named_object object[OBJECT_LIST_MAX]; /* by index and sub-index */
    size_t count;
};

/* Which dictionary a node has. */
enum object_list_kind {
    OBJECTS_OF_CONTROLLER,
    OBJECTS_OF_DRIVE,     /* the virtual drive's; a maker's own objects with it */
    OBJECTS_OF_ANY_DRIVE, /* of the profile CiA 402 alone */
    OBJECTS_OF_LEG_SENSOR,
    OBJECTS_OF_ANY_NODE /* of the communication profile CiA 301 alone */
};

/* Fills the list. Cost: once over the tables and over the pairs of names. */
void object_list_make(struct object_list *list, enum object_list_kind kind);

/* The object that text names, or NULL with what is wrong, and the nearest names, in message
 * (OBJECT_MESSAGE_MAX bytes). Text is a whole name, the part behind the point where only one object has
 * it, or index:sub ("0x2010:07"). With may_complete also the beginning of one name only. */
const struct named_object *object_list_find(const struct object_list *list, const char *text,
                                            bool may_complete, char *message);

/* "0x2010:07" and "0x6041": true with both numbers. */
bool object_address_from_text(const char *text, uint16_t *index, uint8_t *sub);

/* Whether the object belongs to what a word names: its whole group ("commands"), the beginning of its
 * name, or the name. */
bool object_is_meant(const struct named_object *object, const char *word);

#endif
