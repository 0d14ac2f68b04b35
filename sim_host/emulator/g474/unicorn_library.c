#include "sim_host/emulator/g474/unicorn_library.h"

#include <dlfcn.h>
#include <glob.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char default_place[] =
    "build/venv/lib/python3*/site-packages/unicorn/lib/libunicorn.so.2";

static void *open_handle(const char *path, char *message, size_t size)
{
    void *library = NULL;
    glob_t found;

    if (path == NULL) {
        path = getenv("AFO_UNICORN");
    }
    if (path != NULL) {
        library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    } else if (glob(default_place, 0, NULL, &found) == 0) {
        library = dlopen(found.gl_pathv[0], RTLD_NOW | RTLD_LOCAL);
        globfree(&found);
    } else {
        snprintf(message, size, "the Unicorn engine is not at %s: scripts/setup test installs it",
                 default_place);
        return NULL;
    }
    if (library == NULL) {
        snprintf(message, size, "%s", dlerror());
    }
    return library;
}

/* Where each function goes; POSIX lets dlsym's result be stored through a void pointer. */
static int find_functions(struct unicorn_library *library, char *message, size_t size)
{
    const struct {
        const char *name;
        void *place;
    } wanted[] = {
        {"uc_open", &library->open},
        {"uc_close", &library->close},
        {"uc_ctl", &library->control},
        {"uc_mem_map_ptr", &library->map_memory},
        {"uc_mmio_map", &library->map_registers},
        {"uc_mem_protect", &library->protect_memory},
        {"uc_mem_write", &library->write_memory},
        {"uc_reg_read", &library->read_register},
        {"uc_reg_write", &library->write_register},
        {"uc_hook_add", &library->add_hook},
        {"uc_hook_del", &library->remove_hook},
        {"uc_emu_start", &library->start},
        {"uc_emu_stop", &library->stop},
        {"uc_strerror", &library->error_text},
    };

    for (size_t i = 0; i < sizeof wanted / sizeof wanted[0]; i++) {
        void *symbol = dlsym(library->handle, wanted[i].name);
        if (symbol == NULL) {
            snprintf(message, size, "the Unicorn library has no %s", wanted[i].name);
            return -1;
        }
        memcpy(wanted[i].place, &symbol, sizeof symbol);
    }
    return 0;
}

int unicorn_library_open(struct unicorn_library *library, const char *path, char *message,
                         size_t size)
{
    library->handle = open_handle(path, message, size);
    return library->handle != NULL ? find_functions(library, message, size) : -1;
}

void unicorn_library_close(struct unicorn_library *library)
{
    if (library->handle != NULL) {
        (void)dlclose(library->handle);
        library->handle = NULL;
    }
}
