/* The two cyclic redundancy checks of this project. */
#ifndef HAL_STORAGE_CRC_H
#define HAL_STORAGE_CRC_H

#include <stddef.h>
#include <stdint.h>

enum { CRC32_INIT = 0, CRC16_INIT = 0 };

/* Continues CRC-32 (ISO 3309, as in Ethernet and zlib: polynomial 0x04C11DB7
 * reflected, check value 0xCBF43926 over "123456789") over `length` bytes.
 * Start with CRC32_INIT; the result of one call is the start of the next.
 * Any context; about 11 instructions a byte. */
uint32_t crc32_update(uint32_t crc, const void *data, size_t length);

/* What the CRC-32 of some data changes by (exclusive or) when the four bytes that
 * `following` bytes come after change by `difference` (exclusive or, little-endian): the
 * rest need not be read, and what it hides stays found. following < 4096. Any context;
 * at most 2,500 instructions. Method: the check is linear over GF(2), and a zero byte
 * multiplies by x^8 (zlib's crc32_combine). */
uint32_t crc32_change(uint32_t difference, size_t following);

/* Continues the CRC-16 of CiA 301's SDO block transfer (polynomial 0x1021, not
 * reflected, start 0, check value 0x31C3 over "123456789") over `length` bytes.
 * Any context; about 20 instructions a byte. */
uint16_t crc16_update(uint16_t crc, const void *data, size_t length);

#endif
