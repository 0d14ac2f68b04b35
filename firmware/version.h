/* Which build this is: read over CAN, printed by --version, named in every log.
 *
 * Both are constants of the build and reproducible: the version is git's word on
 * the commit, the build id a checksum over the sources alone, the same for every
 * compiler and machine.
 */
#ifndef FIRMWARE_VERSION_H
#define FIRMWARE_VERSION_H

#include <stdint.h>

/* "0.3.0+g<commit>", with ".dirty" behind it when the work tree had changes;
 * "0.3.0" outside git. A constant, valid for ever. Callable from anywhere. */
const char *version_text(void);

/* The first 32 bits of the SHA-256 over all sources. Callable from anywhere. */
uint32_t version_build_id(void);

#endif
