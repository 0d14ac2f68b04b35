#include "hal/port_mps2/semihosting.h"

enum {
    SYS_OPEN = 0x01,
    SYS_WRITE = 0x05,
    SYS_READ = 0x06,
    SYS_EXIT_EXTENDED = 0x20,
    REASON_APPLICATION_EXIT = 0x20026
};

static uint32_t call(uint32_t operation, const uint32_t *parameters)
{
    register uint32_t r0 __asm("r0") = operation;
    register const uint32_t *r1 __asm("r1") = parameters;
    __asm volatile("bkpt 0xAB" : "+r"(r0) : "r"(r1) : "memory");
    return r0;
}

int semihosting_open(const char *path, uint32_t path_length, enum semihosting_mode mode)
{
    const uint32_t parameters[3] = {(uint32_t)(uintptr_t)path, (uint32_t)mode, path_length};
    return (int)call(SYS_OPEN, parameters);
}

/* Both operations return the number of bytes NOT transferred. */
static int transfer(uint32_t operation, int handle, uintptr_t data, uint32_t length)
{
    uint32_t left = length;

    while (left > 0) { /* a pipe may give less at a time; each call makes progress or fails */
        const uint32_t parameters[3] = {(uint32_t)handle, (uint32_t)data + (length - left), left};
        uint32_t not_done = call(operation, parameters);
        if (not_done >= left) {
            return -1;
        }
        left = not_done;
    }
    return 0;
}

int semihosting_read(int handle, void *data, uint32_t length)
{
    return transfer(SYS_READ, handle, (uintptr_t)data, length);
}

int semihosting_write(int handle, const void *data, uint32_t length)
{
    return transfer(SYS_WRITE, handle, (uintptr_t)data, length);
}

_Noreturn void semihosting_exit(uint32_t status)
{
    const uint32_t parameters[2] = {REASON_APPLICATION_EXIT, status};

    for (;;) {
        call(SYS_EXIT_EXTENDED, parameters);
    }
}
