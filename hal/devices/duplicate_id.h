/* Two nodes with one identifier: more frames come than cycles go by.
 *
 * A frame that comes twice with the same content is CAN's own doing (a repetition that one
 * receiver did not need). Frames that a full bus held up come together in a later cycle, but were
 * missed in their own: so many are owed, DUPLICATE_ID_OWED_MAX at most. A stream that was silent
 * for longer, or has not begun, owes nothing. What is left over is somebody else's.
 *
 * Found after 2 cycles if nothing is owed, after 5 at most. Cost: O(1).
 */
#ifndef HAL_DEVICES_DUPLICATE_ID_H
#define HAL_DEVICES_DUPLICATE_ID_H

#include <stdbool.h>
#include <stdint.h>

enum {
    DUPLICATE_ID_LIMIT = 2, /* from here on it is a foreign node */
    DUPLICATE_ID_OWED_MAX = 3
};

/* A frame with other content than the one before it in the same cycle. */
static inline void duplicate_id_seen(int8_t *duplicate_id_count)
{
    *duplicate_id_count =
        (int8_t)(*duplicate_id_count < INT8_MAX ? *duplicate_id_count + 1 : *duplicate_id_count);
}

/* A cycle without a frame, the silent_cycles-th in a row (from 1 on). */
static inline void duplicate_id_missed(int8_t *duplicate_id_count, uint16_t silent_cycles)
{
    if (*duplicate_id_count > 0) {
        (*duplicate_id_count)--;
    } else if (silent_cycles > DUPLICATE_ID_OWED_MAX) {
        *duplicate_id_count = 0;
    } else if (*duplicate_id_count > -DUPLICATE_ID_OWED_MAX) {
        (*duplicate_id_count)--;
    }
}

#endif
