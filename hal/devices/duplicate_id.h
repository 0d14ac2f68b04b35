/* Two nodes with one identifier: more frames come than cycles go by.
 *
 * A frame that comes twice with the same content is CAN's own doing (a repetition that one
 * receiver did not need); one that comes a cycle late makes two in the next, but was missed
 * in its own. What is left over is somebody else's.
 */
#ifndef HAL_DEVICES_DUPLICATE_ID_H
#define HAL_DEVICES_DUPLICATE_ID_H

#include <stdbool.h>
#include <stdint.h>

enum { DUPLICATE_ID_LIMIT = 2 }; /* from here on it is a foreign node */

/* A frame with other content than the one before it in the same cycle. */
static inline void duplicate_id_seen(uint8_t *duplicate_id_count)
{
    *duplicate_id_count =
        (uint8_t)(*duplicate_id_count < UINT8_MAX ? *duplicate_id_count + 1 : *duplicate_id_count);
}

/* A cycle without a frame. */
static inline void duplicate_id_missed(uint8_t *duplicate_id_count)
{
    *duplicate_id_count = (uint8_t)(*duplicate_id_count > 0 ? *duplicate_id_count - 1 : 0);
}

#endif
