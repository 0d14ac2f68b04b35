/* Rounding of measured values to the integers of a frame: to nearest, halves away
 * from zero, saturating; NaN becomes 0. */
#ifndef SIM_HOST_NODES_NODE_NUMBERS_H
#define SIM_HOST_NODES_NODE_NUMBERS_H

#include <stdint.h>

static inline int32_t node_round_i32(double value)
{
    if (value >= 2147483647.0) {
        return INT32_MAX;
    }
    if (value <= -2147483648.0) {
        return INT32_MIN;
    }
    return value == value ? (int32_t)(value < 0.0 ? value - 0.5 : value + 0.5) : 0;
}

static inline int16_t node_round_i16(double value)
{
    const int32_t wide = node_round_i32(value);
    return (int16_t)(wide > INT16_MAX ? INT16_MAX : (wide < INT16_MIN ? INT16_MIN : wide));
}

#endif
