/* Unicorn's functions, found in its shared library when it runs: the project is not linked with it (unicorn_core.h).
 * Signatures as its documentation of the C interface has them (2.1).
 */
#ifndef SIM_HOST_EMULATOR_G474_UNICORN_LIBRARY_H
#define SIM_HOST_EMULATOR_G474_UNICORN_LIBRARY_H

#include <stddef.h>
#include <stdint.h>

struct unicorn_library {
    void *handle; /* NULL: not open */
    int (*open)(int arch, int mode, void **engine);
    int (*close)(void *engine);
    int (*control)(void *engine, int what, ...);
    int (*map_memory)(void *engine, uint64_t address, uint64_t size, uint32_t permits,
                      void *memory);
    int (*map_registers)(void *engine, uint64_t address, uint64_t size,
                         uint64_t (*read)(void *, uint64_t, unsigned, void *), void *read_context,
                         void (*write)(void *, uint64_t, unsigned, uint64_t, void *),
                         void *write_context);
    int (*protect_memory)(void *engine, uint64_t address, uint64_t size, uint32_t permits);
    int (*write_memory)(void *engine, uint64_t address, const void *bytes, uint64_t size);
    int (*read_register)(void *engine, int which, void *value);
    int (*write_register)(void *engine, int which, const void *value);
    int (*add_hook)(void *engine, size_t *handle, int kind, void *function, void *context,
                    uint64_t begin, uint64_t end, ...);
    int (*remove_hook)(void *engine, size_t handle);
    int (*start)(void *engine, uint64_t from, uint64_t until, uint64_t timeout, size_t count);
    int (*stop)(void *engine);
    const char *(*error_text)(int error);
};

/* Opens the library at path; NULL: the environment's AFO_UNICORN, else the one in build/venv. Returns 0, or -1 with the
 * reason in message; to be closed in either case. */
int unicorn_library_open(struct unicorn_library *library, const char *path, char *message,
                         size_t size);
void unicorn_library_close(struct unicorn_library *library);

#endif
