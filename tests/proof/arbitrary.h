/* Values that a proof leaves open: what an analysis assumes nothing of.
 *
 * The analyser takes a volatile object as any value of its type, read anew each time: a float is
 * any number, an infinity or NaN.
 */
#ifndef TESTS_PROOF_ARBITRARY_H
#define TESTS_PROOF_ARBITRARY_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "hal/bus/can_bus.h"

/* The analyser's own: a value from low to high, both included. */
/*@ assigns \result \from low, high;
    ensures low <= \result <= high; */
extern int Frama_C_interval(int low, int high);
/*@ assigns \result \from low, high;
    ensures \is_finite(\result) && low <= \result <= high; */
extern float Frama_C_float_interval(float low, float high);

static volatile float any_float;
static volatile uint8_t any_u8;
static volatile uint16_t any_u16;
static volatile uint32_t any_u32;
static volatile uint64_t any_u64;
static volatile int any_int;

static inline enum can_result any_send(void *context, const struct can_msg *message)
{
    (void)context;
    (void)message;
    return (enum can_result)any_int;
}

/* A bus that may refuse any frame. */
static const struct can_bus_ops any_bus_ops = {.send = any_send};
static const struct can_bus any_bus = {&any_bus_ops, NULL};

static inline bool any_bool(void)
{
    return Frama_C_interval(0, 1) != 0;
}

static inline void any_bytes(uint8_t *bytes, size_t length)
{
    for (size_t i = 0; i < length; i++) {
        bytes[i] = any_u8;
    }
}

/* A frame of any identifier, flags, bytes, and of a length that a port may deliver. */
static inline void any_message(struct can_msg *message)
{
    message->id = any_u32;
    message->length = (uint8_t)Frama_C_interval(0, CAN_FRAME_DATA_MAX);
    message->flags = any_u8;
    any_bytes(message->data, CAN_FRAME_DATA_MAX);
}

#endif
