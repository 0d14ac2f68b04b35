/* The last changes of parameters and of the device's description: a ring that is read as one domain
 * (0x2005:02), 32 records, oldest first by their number. It is kept in RAM: a restart forgets it.
 *
 * Of a description every key that a tool writes is a change, some fifty in a commissioning; 32 keep at
 * least a whole step of it, and all that is done by hand in a visit.
 */
#ifndef FIRMWARE_CHANGE_LOG_H
#define FIRMWARE_CHANGE_LOG_H

#include <stdint.h>

enum { CHANGE_LOG_RECORDS = 32, CHANGE_LOG_RECORD_BYTES = 20 };

/* One change, as it lies on the bus: little-endian, without padding. */
struct change_record {
    uint32_t number; /* 1 = the first since the start; 0 = none yet in this place */
    uint32_t time_s; /* since the start */
    uint16_t index;  /* of the object */
    uint8_t sub;
    uint8_t
        client; /* who had unlocked the parameters; 0 = nobody, as for the description, or the device itself */
    float before, after;
};

struct change_log {
    struct change_record record[CHANGE_LOG_RECORDS]; /* number n lies at (n - 1) modulo the count */
    uint32_t number;                                 /* of the newest; saturates */
};

/* Keeps a change; number is set here. O(1). */
void change_log_note(struct change_log *log, const struct change_record *record);

#endif
