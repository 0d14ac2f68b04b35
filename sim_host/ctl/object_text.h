/* Values of objects as a person reads and writes them, and SDO refusals in words. */
#ifndef SIM_HOST_CTL_OBJECT_TEXT_H
#define SIM_HOST_CTL_OBJECT_TEXT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "sim_host/ctl/object_list.h"

enum { OBJECT_TEXT_MAX = 256, OBJECT_BYTES_MAX = 4096 };

/* What was read of an object. */
struct object_value {
    uint8_t bytes[OBJECT_BYTES_MAX];
    size_t length;
};

/* Whether the bytes are a number of the object's type; *number: in the unit that is shown. */
bool object_number(const struct named_object *object, const struct object_value *value,
                   double *number);

/* The value without its unit: a number with no more digits than it needs, a string, or the bytes. */
void object_value_text(const struct named_object *object, const struct object_value *value,
                       char text[OBJECT_TEXT_MAX]);

/* What this value is called ("walking, emergency stop pressed"); empty where values have no names. */
void object_value_name(const struct named_object *object, const struct object_value *value,
                       char text[OBJECT_TEXT_MAX]);

/* "0 .. 1 m/(rad/s)", "1 m", or empty. */
void object_range_text(const struct named_object *object, char text[OBJECT_TEXT_MAX]);

/* Bytes to write for what a person typed: a number in the unit shown, or the name of a value. Returns
 * 0, or -1 with the reason in message (OBJECT_MESSAGE_MAX bytes): no number, more than the type holds,
 * nothing of this kind can be written. The range is the node's to judge. */
int object_value_from_text(const struct named_object *object, const char *text,
                           struct object_value *value, char *message);

/* Why a node refused, and what to do, for an SDO abort code (CiA 301 table 22). object: NULL when its
 * dictionary is not known. wrote: it was to be written, else read. */
void object_refusal_text(const struct named_object *object, uint32_t abort_code, bool wrote,
                         char *message);

#endif
