#include "hal/storage/crc.h"

/* One table entry per value of four bits: 64 bytes of flash instead of 1 KiB. */
static const uint32_t crc32_of_nibble[16] = {0x00000000U, 0x1DB71064U, 0x3B6E20C8U, 0x26D930ACU,
                                             0x76DC4190U, 0x6B6B51F4U, 0x4DB26158U, 0x5005713CU,
                                             0xEDB88320U, 0xF00F9344U, 0xD6D6A3E8U, 0xCB61B38CU,
                                             0x9B64C2B0U, 0x86D3D2D4U, 0xA00AE278U, 0xBDBDF21CU};

static const uint16_t crc16_of_nibble[16] = {0x0000, 0x1021, 0x2042, 0x3063, 0x4084, 0x50A5,
                                             0x60C6, 0x70E7, 0x8108, 0x9129, 0xA14A, 0xB16B,
                                             0xC18C, 0xD1AD, 0xE1CE, 0xF1EF};

uint32_t crc32_update(uint32_t crc, const void *data, size_t length)
{
    const uint8_t *bytes = data;
    uint32_t state = ~crc;

    for (size_t i = 0; i < length; i++) {
        state ^= bytes[i];
        state = (state >> 4) ^ crc32_of_nibble[state & 0x0FU];
        state = (state >> 4) ^ crc32_of_nibble[state & 0x0FU];
    }
    return ~state;
}

/* x^(8 * 2^k) modulo the polynomial: 2^k zero bytes. */
static const uint32_t zero_bytes[12] = {0x00800000U, 0x00008000U, 0xEDB88320U, 0xB1E6B092U,
                                        0xA06A2517U, 0xED627DAEU, 0x88D14467U, 0xD7BBFE6AU,
                                        0xEC447F11U, 0x8E7EA170U, 0x6427800EU, 0x4D47BAE0U};

/* The product of two polynomials modulo the CRC's, reflected: x^0 is the topmost bit. */
static uint32_t multiply(uint32_t a, uint32_t b)
{
    uint32_t product = 0;

    for (; a != 0U; a <<= 1) {
        if ((a & 0x80000000U) != 0U) {
            product ^= b;
        }
        b = (b >> 1) ^ ((b & 1U) != 0U ? 0xEDB88320U : 0U);
    }
    return product;
}

uint32_t crc32_change(uint32_t difference, size_t following)
{
    const uint8_t bytes[4] = {(uint8_t)difference, (uint8_t)(difference >> 8),
                              (uint8_t)(difference >> 16), (uint8_t)(difference >> 24)};
    uint32_t change = ~crc32_update(UINT32_MAX, bytes, sizeof bytes); /* from an empty register */

    for (unsigned k = 0; k < sizeof zero_bytes / sizeof zero_bytes[0]; k++) {
        if ((following >> k & 1U) != 0U) {
            change = multiply(change, zero_bytes[k]);
        }
    }
    return change;
}

uint16_t crc16_update(uint16_t crc, const void *data, size_t length)
{
    const uint8_t *bytes = data;
    uint32_t state = crc;

    for (size_t i = 0; i < length; i++) {
        state = (state << 4) ^ crc16_of_nibble[((state >> 12) ^ (uint32_t)(bytes[i] >> 4)) & 0x0FU];
        state &= 0xFFFFU;
        state =
            (state << 4) ^ crc16_of_nibble[((state >> 12) ^ (uint32_t)(bytes[i] & 0x0FU)) & 0x0FU];
        state &= 0xFFFFU;
    }
    return (uint16_t)state;
}
