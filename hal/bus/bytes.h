/* Little-endian integers in frames (CiA 301, 7.1.4), and float-to-integer
 * conversions that saturate instead of being undefined. */
#ifndef HAL_BUS_BYTES_H
#define HAL_BUS_BYTES_H

#include <stdint.h>

static inline uint16_t bytes_get_u16(const uint8_t *from)
{
    return (uint16_t)(from[0] | (uint16_t)(from[1] << 8));
}

static inline int16_t bytes_get_i16(const uint8_t *from)
{
    return (int16_t)bytes_get_u16(from);
}

static inline uint32_t bytes_get_u32(const uint8_t *from)
{
    return (uint32_t)from[0] | (uint32_t)from[1] << 8 | (uint32_t)from[2] << 16 |
           (uint32_t)from[3] << 24;
}

static inline int32_t bytes_get_i32(const uint8_t *from)
{
    return (int32_t)bytes_get_u32(from);
}

/* Signed 24 bit, sign extended. */
static inline int32_t bytes_get_i24(const uint8_t *from)
{
    const uint32_t bits = (uint32_t)from[0] | (uint32_t)from[1] << 8 | (uint32_t)from[2] << 16;
    return (int32_t)(bits ^ 0x800000u) - 0x800000;
}

static inline void bytes_put_u16(uint8_t *to, uint16_t value)
{
    to[0] = (uint8_t)(value & 0xFFu);
    to[1] = (uint8_t)(value >> 8);
}

static inline void bytes_put_u32(uint8_t *to, uint32_t value)
{
    bytes_put_u16(to, (uint16_t)(value & 0xFFFFu));
    bytes_put_u16(to + 2, (uint16_t)(value >> 16));
}

/* IEEE 754 single precision, as it lies in a frame. */
static inline uint32_t bytes_of_f32(float value)
{
    const union {
        float value;
        uint32_t bits;
    } number = {value};
    return number.bits;
}

static inline float bytes_get_f32(const uint8_t *from)
{
    const union {
        uint32_t bits;
        float value;
    } number = {bytes_get_u32(from)};
    return number.value;
}

/* Round to nearest, halves away from zero; outside low..high: the nearer limit;
 * NaN: low. low and high within +-2^24, where float holds every integer, or at
 * the ends of int32_t. */
static inline int32_t bytes_saturate_i32(float value, int32_t low, int32_t high)
{
    if (value != value || value <= (float)low) {
        return low;
    }
    if (value >= (float)high) {
        return high;
    }
    return (int32_t)(value < 0.0f ? value - 0.5f : value + 0.5f);
}

#endif
