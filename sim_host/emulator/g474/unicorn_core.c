#include "sim_host/emulator/g474/unicorn_core.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- Unicorn 2.1, as its documentation of the C interface has it -------------------- */
enum {
    ARCH_ARM = 1,
    MODE_THUMB = 1 << 4,
    MODE_M_CLASS = 1 << 5,
    MODEL_CORTEX_M4 = 9,
    /* uc_ctl: what, number of arguments at bit 26, write at bit 30. */
    CONTROL_CPU_MODEL = 7 | 1 << 26 | 1 << 30,
    PERMIT_READ = 1,
    PERMIT_WRITE = 2,
    PERMIT_EXECUTE = 4,
    HOOK_INTERRUPT = 1 << 0,
    HOOK_CODE = 1 << 2,
    HOOK_BLOCK = 1 << 3,
    HOOK_BAD_MEMORY = 0x3F << 4, /* read, write, fetch: unmapped and forbidden */
    HOOK_BAD_INSTRUCTION = 1 << 14,
    HOOK_READ = 1 << 10,
    HOOK_WRITE = 1 << 11,
    /* uc_ctl: forget all translations, write at bit 30. */
    CONTROL_FORGET = 10 | 1 << 30,
    ERROR_NONE = 0,
    ERROR_NO_INSTRUCTION = 10,
    MEMORY_WRITE = 17,
    MEMORY_READ_UNMAPPED = 19,
    MEMORY_WRITE_UNMAPPED = 20,
    MEMORY_WRITE_FORBIDDEN = 22,
    MEMORY_READ_FORBIDDEN = 23,
    /* Numbers of exceptions that the hook is told, QEMU's own. */
    EXCEPTION_RETURN = 8,
    STORE_TOLD = 1000, /* none of its */
    LOAD_TOLD = 1001,
    REGISTER_D0 = 14,
    REGISTER_R0 = 66,
};

static const int register_numbers[CORE_REGISTERS] = {
    [CORE_R0] = 66,       [CORE_R1] = 67,       [CORE_R2] = 68,         [CORE_R3] = 69,
    [CORE_R12] = 78,      [CORE_LR] = 10,       [CORE_PC] = 11,         [CORE_XPSR] = 120,
    [CORE_SP] = 12,       [CORE_MSP] = 115,     [CORE_PSP] = 116,       [CORE_CONTROL] = 117,
    [CORE_PRIMASK] = 123, [CORE_BASEPRI] = 124, [CORE_FAULTMASK] = 126, [CORE_FPSCR] = 6,
};

/* ---- Callbacks ----------------------------------------------------------------------- */

static void on_block(void *engine, uint64_t address, uint32_t bytes, void *context)
{
    struct core *core = context;
    (void)engine;
    core->callbacks.block(core->callbacks.context, (uint32_t)address, bytes);
}

static void on_interrupt(void *engine, uint32_t number, void *context)
{
    struct core *core = context;
    (void)engine;
    core->exception = number;
    (void)core->library.stop(core->engine);
}

static bool on_bad_memory(void *engine, int kind, uint64_t address, int bytes, int64_t value,
                          void *context)
{
    struct core *core = context;
    (void)engine;
    if (kind == MEMORY_WRITE_FORBIDDEN && address - core->watched_base < core->watched_bytes) {
        core->callbacks.store(core->callbacks.context, (uint32_t)address, (uint32_t)bytes,
                              (uint32_t)value);
        core->exception = STORE_TOLD;
        return false;
    }
    const bool is_closed =
        kind == MEMORY_READ_FORBIDDEN && address - core->watched_base < core->watched_bytes;
    core->bad_address = (uint32_t)address;
    core->exception = is_closed ? (uint32_t)LOAD_TOLD : (uint32_t)kind;
    return false;
}

static bool on_bad_instruction(void *engine, void *context)
{
    (void)engine;
    (void)context;
    return false;
}

static uint64_t on_read(void *engine, uint64_t offset, unsigned bytes, void *context)
{
    const struct core_window *window = context;
    const struct core_callbacks *callbacks = &window->core->callbacks;
    (void)engine;
    return callbacks->read(callbacks->context, window->base + (uint32_t)offset, bytes);
}

static void on_write(void *engine, uint64_t offset, unsigned bytes, uint64_t value, void *context)
{
    const struct core_window *window = context;
    const struct core_callbacks *callbacks = &window->core->callbacks;
    (void)engine;
    callbacks->write(callbacks->context, window->base + (uint32_t)offset, bytes, (uint32_t)value);
}

static int check(struct core *core, int error)
{
    if (error != ERROR_NONE) {
        snprintf(core->message, sizeof core->message, "Unicorn: %s",
                 core->library.error_text(error));
        return -1;
    }
    return 0;
}

/* A hook's function as the void pointer that the library takes. */
static int hook(struct core *core, int kind, const void *place_of_function)
{
    size_t handle;
    void *function;

    memcpy(&function, place_of_function, sizeof function);
    return check(core, core->library.add_hook(core->engine, &handle, kind, function, core, 1, 0));
}

int core_open(struct core *core, const char *path, const struct core_callbacks *callbacks)
{
    void (*const block)(void *, uint64_t, uint32_t, void *) = on_block;
    void (*const interrupt)(void *, uint32_t, void *) = on_interrupt;
    bool (*const bad_memory)(void *, int, uint64_t, int, int64_t, void *) = on_bad_memory;
    bool (*const bad_instruction)(void *, void *) = on_bad_instruction;

    memset(core, 0, sizeof *core);
    core->callbacks = *callbacks;
    core->passed = 1;
    if (unicorn_library_open(&core->library, path, core->message, sizeof core->message) != 0 ||
        check(core, core->library.open(ARCH_ARM, MODE_THUMB | MODE_M_CLASS, &core->engine)) != 0 ||
        check(core, core->library.control(core->engine, CONTROL_CPU_MODEL, MODEL_CORTEX_M4)) != 0) {
        return -1;
    }
    return hook(core, HOOK_BLOCK, &block) == 0 && hook(core, HOOK_INTERRUPT, &interrupt) == 0 &&
                   hook(core, HOOK_BAD_MEMORY, &bad_memory) == 0 &&
                   hook(core, HOOK_BAD_INSTRUCTION, &bad_instruction) == 0
               ? 0
               : -1;
}

void core_close(struct core *core)
{
    if (core->engine != NULL) {
        (void)core->library.close(core->engine);
        core->engine = NULL;
    }
    unicorn_library_close(&core->library);
}

int core_map_memory(struct core *core, uint32_t base, uint32_t bytes, void *memory, bool writable)
{
    const uint32_t permits =
        (uint32_t)PERMIT_READ | (uint32_t)(writable ? PERMIT_WRITE : PERMIT_EXECUTE);
    return check(core, core->library.map_memory(core->engine, base, bytes, permits, memory));
}

/* A hook on every store would make the engine slow: the memory is closed, and a store into it stops. */
int core_map_watched(struct core *core, uint32_t base, uint32_t bytes, void *memory)
{
    core->watched_base = base;
    core->watched_bytes = bytes;
    return core_map_memory(core, base, bytes, memory, false);
}

void core_close_pages(struct core *core)
{
    (void)check(core, core->library.protect_memory(core->engine, core->watched_base,
                                                   core->watched_bytes, PERMIT_EXECUTE));
}

void core_open_page(struct core *core, uint32_t address)
{
    (void)check(core, core->library.protect_memory(
                          core->engine, address & ~(uint32_t)(CORE_PAGE_BYTES - 1), CORE_PAGE_BYTES,
                          (uint32_t)PERMIT_READ | (uint32_t)PERMIT_EXECUTE));
}

void core_write(struct core *core, uint32_t address, const void *bytes, uint32_t count)
{
    (void)check(core, core->library.write_memory(core->engine, address, bytes, count));
}

int core_map_registers(struct core *core, uint32_t base, uint32_t bytes)
{
    struct core_window *window = &core->window[core->windows];

    if (core->windows == CORE_MAP_MAX) {
        snprintf(core->message, sizeof core->message, "too many windows of registers");
        return -1;
    }
    core->windows++;
    *window = (struct core_window){core, base};
    return check(core, core->library.map_registers(core->engine, base, bytes, on_read, window,
                                                   on_write, window));
}

/* ---- Registers and running ------------------------------------------------------------- */

uint32_t core_get(struct core *core, enum core_register which)
{
    uint32_t value = 0;
    (void)core->library.read_register(core->engine, register_numbers[which], &value);
    return value;
}

void core_set(struct core *core, enum core_register which, uint32_t value)
{
    (void)core->library.write_register(core->engine, register_numbers[which], &value);
}

void core_get_float(struct core *core, uint32_t s[16])
{
    for (int i = 0; i < 8; i++) {
        uint64_t d = 0;
        (void)core->library.read_register(core->engine, REGISTER_D0 + i, &d);
        s[2 * i] = (uint32_t)d;
        s[2 * i + 1] = (uint32_t)(d >> 32);
    }
}

void core_set_float(struct core *core, const uint32_t s[16])
{
    for (int i = 0; i < 8; i++) {
        const uint64_t d = (uint64_t)s[2 * i + 1] << 32 | s[2 * i];
        (void)core->library.write_register(core->engine, REGISTER_D0 + i, &d);
    }
}

void core_stick(struct core *core, uint32_t number, uint32_t bits)
{
    uint64_t value = 0;
    const bool is_float = number >= (uint32_t)CORE_STICK_S0;
    const uint32_t s = number - (uint32_t)CORE_STICK_S0;
    const int which = is_float ? REGISTER_D0 + (int)(s / 2) : REGISTER_R0 + (int)number;

    (void)core->library.read_register(core->engine, which, &value);
    value |= is_float && s % 2 == 1 ? (uint64_t)bits << 32 : bits;
    (void)core->library.write_register(core->engine, which, &value);
}

static void on_watched_read(void *engine, int kind, uint64_t address, int bytes, int64_t value,
                            void *context)
{
    const struct core *core = context;
    (void)engine;
    (void)kind;
    (void)address;
    (void)bytes;
    (void)value;
    core->watched_read(core->callbacks.context);
}

/* Only while somebody watches: such a hook makes every access slow. */
void core_watch_reads(struct core *core, uint32_t address, void (*function)(void *context))
{
    void (*const read)(void *, int, uint64_t, int, int64_t, void *) = on_watched_read;
    void *hooked;

    core->watched_read = function;
    if (function == NULL) {
        (void)core->library.remove_hook(core->engine, core->read_hook);
    } else {
        memcpy(&hooked, &read, sizeof hooked);
        (void)core->library.add_hook(core->engine, &core->read_hook, HOOK_READ, hooked, core,
                                     address, (uint64_t)address + 3);
    }
    (void)core->library.control(core->engine, CONTROL_FORGET);
}

static void on_watched_access(void *engine, int kind, uint64_t address, int bytes, int64_t value,
                              void *context)
{
    const struct core *core = context;
    (void)engine;
    (void)bytes;
    (void)value;
    core->watched_access(core->callbacks.context, (uint32_t)address, kind == MEMORY_WRITE);
}

void core_watch_accesses(struct core *core, uint32_t base, uint32_t bytes,
                         void (*function)(void *context, uint32_t address, bool is_store))
{
    void (*const access)(void *, int, uint64_t, int, int64_t, void *) = on_watched_access;
    void *hooked;

    core->watched_access = function;
    if (function == NULL) {
        (void)core->library.remove_hook(core->engine, core->access_hook);
    } else {
        memcpy(&hooked, &access, sizeof hooked);
        (void)core->library.add_hook(core->engine, &core->access_hook, HOOK_READ | HOOK_WRITE,
                                     hooked, core, base, (uint64_t)base + bytes - 1);
    }
    (void)core->library.control(core->engine, CONTROL_FORGET);
}

/* ---- For a debugger ---------------------------------------------------------------------- */

uint32_t core_get_general(struct core *core, unsigned number)
{
    uint32_t value = 0;
    (void)core->library.read_register(core->engine, REGISTER_R0 + (int)number, &value);
    return value;
}

void core_set_general(struct core *core, unsigned number, uint32_t value)
{
    (void)core->library.write_register(core->engine, REGISTER_R0 + (int)number, &value);
}

uint64_t core_get_double(struct core *core, unsigned number)
{
    uint64_t value = 0;
    (void)core->library.read_register(core->engine, REGISTER_D0 + (int)number, &value);
    return value;
}

void core_set_double(struct core *core, unsigned number, uint64_t value)
{
    (void)core->library.write_register(core->engine, REGISTER_D0 + (int)number, &value);
}

static void on_breakpoint(void *engine, uint64_t address, uint32_t bytes, void *context)
{
    struct core *core = context;
    (void)bytes;
    if (core->passed == (uint32_t)address) {
        core->passed = 1;
        return;
    }
    core->broke = true;
    (void)core->library.stop(engine);
}

static void forget_break(struct core *core, unsigned place)
{
    (void)core->library.remove_hook(core->engine, core->breaks[place].hook);
    core->breaks[place] = core->breaks[--core->break_count];
    (void)core->library.control(core->engine, CONTROL_FORGET);
}

int core_break(struct core *core, uint32_t address, bool on)
{
    void (*const code)(void *, uint64_t, uint32_t, void *) = on_breakpoint;
    void *hooked;

    address &= ~1u;
    for (unsigned i = 0; i < core->break_count; i++) {
        if (core->breaks[i].address == address) {
            if (!on) {
                forget_break(core, i);
            }
            return 0;
        }
    }
    if (!on) {
        return 0;
    }
    if (core->break_count == CORE_BREAKS_MAX) {
        return -1;
    }
    memcpy(&hooked, &code, sizeof hooked);
    core->breaks[core->break_count].address = address;
    if (core->library.add_hook(core->engine, &core->breaks[core->break_count].hook, HOOK_CODE,
                               hooked, core, address, address) != ERROR_NONE) {
        return -1;
    }
    core->break_count++;
    (void)core->library.control(core->engine, CONTROL_FORGET);
    return 0;
}

void core_break_none(struct core *core)
{
    while (core->break_count > 0) {
        forget_break(core, core->break_count - 1);
    }
    core->passed = 1;
}

void core_pass_break(struct core *core, uint32_t address)
{
    core->passed = address & ~1u;
}

static enum core_stop stop_of(struct core *core, int error)
{
    switch (core->exception) {
    case 0:
        break;
    case MEMORY_READ_UNMAPPED:
    case MEMORY_READ_FORBIDDEN:
        return CORE_BAD_READ;
    case MEMORY_WRITE_UNMAPPED:
    case MEMORY_WRITE_FORBIDDEN:
        return CORE_BAD_WRITE;
    case EXCEPTION_RETURN:
        return CORE_EXCEPTION_RETURN;
    case STORE_TOLD:
        return CORE_STORED;
    case LOAD_TOLD:
        return CORE_LOADED;
    default:
        return error >= 6 && error <= 18 && error != ERROR_NO_INSTRUCTION ? CORE_BAD_FETCH
                                                                          : CORE_UNDEFINED;
    }
    if (error == ERROR_NO_INSTRUCTION) {
        return CORE_UNDEFINED;
    }
    if (check(core, error) != 0) {
        return CORE_FAILED;
    }
    if (core->broke) {
        return CORE_BROKE;
    }
    return core->asked ? CORE_ASKED : CORE_WAITS;
}

/* The engine counts instructions by a hook, which is in what it translates from then on. */
static void change_pace(struct core *core, bool stepping)
{
    if (core->stepping != stepping) {
        core->stepping = stepping;
        (void)core->library.control(core->engine, CONTROL_FORGET);
    }
}

enum core_stop core_run(struct core *core, uint32_t pc)
{
    change_pace(core, false);
    core->exception = 0;
    core->asked = core->broke = false;
    return stop_of(core, core->library.start(core->engine, pc | 1u, UINT32_MAX - 1u, 0, 0));
}

enum core_stop core_step(struct core *core, uint32_t pc)
{
    change_pace(core, true);
    core->exception = 0;
    core->asked = core->broke = false;
    const enum core_stop stop =
        stop_of(core, core->library.start(core->engine, pc | 1u, UINT32_MAX - 1u, 0, 1));
    return stop == CORE_WAITS ? CORE_STEPPED : stop;
}

void core_stop(struct core *core)
{
    core->asked = true;
    (void)core->library.stop(core->engine);
}
