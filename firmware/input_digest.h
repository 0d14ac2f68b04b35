/* A digest of every frame that the controller obeyed: a replay must come to the same.
 *
 * Within a tick it is a sum, so that the order of the frames does not count (a CAN
 * controller may sort them into several queues), of a hash that any changed bit changes:
 * FNV-1a's step (isthe.com/chongo/tech/comp/fnv) over words. Inline: it runs for each frame.
 */
#ifndef FIRMWARE_INPUT_DIGEST_H
#define FIRMWARE_INPUT_DIGEST_H

#include <stdint.h>

#include "hal/bus/bytes.h"
#include "hal/bus/can_frame.h"

#define INPUT_DIGEST_PRIME UINT32_C(16777619)

/* A frame that was obeyed in this tick. O(1). */
static inline void input_digest_add(uint32_t *digest, const struct can_msg *message)
{
    uint32_t hash =
        (UINT32_C(2166136261) ^ (message->id << 4 | message->length)) * INPUT_DIGEST_PRIME;
    hash = (hash ^ bytes_get_u32(message->data)) * INPUT_DIGEST_PRIME;
    *digest += (hash ^ bytes_get_u32(message->data + 4)) * INPUT_DIGEST_PRIME;
}

/* The tick is over: what comes from now on counts as later. O(1). */
static inline void input_digest_end_tick(uint32_t *digest)
{
    *digest = *digest * INPUT_DIGEST_PRIME + 1u;
}

#endif
