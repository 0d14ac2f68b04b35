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

enum { SAMPLE_SURPLUS_LIMIT = 2 }; /* from here on it is a foreign node */

/* A frame with other content than the one before it in the same cycle. */
static inline void sample_surplus_more(uint8_t *surplus)
{
    *surplus = (uint8_t)(*surplus < UINT8_MAX ? *surplus + 1 : *surplus);
}

/* A cycle without a frame. */
static inline void sample_surplus_missed(uint8_t *surplus)
{
    *surplus = (uint8_t)(*surplus > 0 ? *surplus - 1 : 0);
}

#endif
