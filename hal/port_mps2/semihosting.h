/* Files of the host, from inside the emulator (Arm semihosting, document
 * "Semihosting for AArch32 and AArch64", operations SYS_OPEN .. SYS_EXIT). */
#ifndef HAL_PORT_MPS2_SEMIHOSTING_H
#define HAL_PORT_MPS2_SEMIHOSTING_H

#include <stdint.h>

enum semihosting_mode {
    SEMIHOSTING_READ = 1, /* "rb" */
    SEMIHOSTING_WRITE = 5 /* "wb" */
};

/* Opens a file of the host. Returns its handle, or -1. Blocks like the host. */
int semihosting_open(const char *path, uint32_t path_length, enum semihosting_mode mode);

/* Reads or writes exactly `length` bytes. Returns 0, or -1 at the end of the file
 * and on errors. Blocks like the host; virtual time stands still meanwhile. */
int semihosting_read(int handle, void *data, uint32_t length);
int semihosting_write(int handle, const void *data, uint32_t length);

/* Ends the emulator with an exit status. */
_Noreturn void semihosting_exit(uint32_t status);

#endif
