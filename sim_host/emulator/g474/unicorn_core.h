/* The instructions of a Cortex-M4F: the Unicorn engine, loaded at run time.
 *
 * Unicorn is under the GNU GPL version 2, this project under the MIT licence: nothing of it
 * is copied or linked. Its shared library (of the Python package that scripts/setup test
 * installs) is opened when a chip is started; the few functions and numbers used are
 * declared in unicorn_library.h and unicorn_core.c from its public documentation. Nothing else needs it.
 *
 * It executes instructions and no more: exceptions, interrupts, time and peripherals are
 * the caller's, who hears of each block of instructions before it runs.
 */
#ifndef SIM_HOST_EMULATOR_G474_UNICORN_CORE_H
#define SIM_HOST_EMULATOR_G474_UNICORN_CORE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "sim_host/emulator/g474/unicorn_library.h"

/* Registers, in the order of an exception frame as far as that goes. */
enum core_register {
    CORE_R0,
    CORE_R1,
    CORE_R2,
    CORE_R3,
    CORE_R12,
    CORE_LR,
    CORE_PC,
    CORE_XPSR,
    CORE_SP,
    CORE_MSP,
    CORE_PSP,
    CORE_CONTROL,
    CORE_PRIMASK,
    CORE_BASEPRI,
    CORE_FAULTMASK,
    CORE_FPSCR,
    CORE_REGISTERS
};

/* Why core_run came back. */
enum core_stop {
    CORE_ASKED,            /* core_stop */
    CORE_WAITS,            /* the processor waits for an interrupt */
    CORE_EXCEPTION_RETURN, /* a branch to an EXC_RETURN value */
    CORE_STORED,           /* a store was told; go on behind its instruction */
    CORE_LOADED,    /* the first load from a page that core_close_pages closed: bad_address */
    CORE_BROKE,     /* before the instruction at a breakpoint */
    CORE_STEPPED,   /* core_step has run its instruction */
    CORE_UNDEFINED, /* an instruction that does not exist, or SVC, BKPT */
    CORE_BAD_READ,
    CORE_BAD_WRITE,
    CORE_BAD_FETCH,
    CORE_FAILED /* the engine gave up: core->message */
};

struct core_callbacks {
    void *context;
    /* Before a block of `bytes` bytes of instructions at `address`. May call core_stop:
     * then the block is not run. */
    void (*block)(void *context, uint32_t address, uint32_t bytes);
    /* Accesses to what core_map_registers mapped. 1, 2 or 4 bytes. */
    uint32_t (*read)(void *context, uint32_t address, uint32_t bytes);
    void (*write)(void *context, uint32_t address, uint32_t bytes, uint32_t value);
    /* A store into what core_map_watched mapped, which the core itself does not make. */
    void (*store)(void *context, uint32_t address, uint32_t bytes, uint32_t value);
};

enum { CORE_MAP_MAX = 16, CORE_MESSAGE_MAX = 256, CORE_BREAKS_MAX = 32 };

struct core;

struct core_window {
    struct core *core;
    uint32_t base;
};

struct core {
    struct unicorn_library library;
    void *engine;
    struct core_callbacks callbacks;
    struct core_window window[CORE_MAP_MAX];
    unsigned windows;
    uint32_t watched_base, watched_bytes;
    size_t read_hook;
    void (*watched_read)(void *context); /* gets callbacks.context */
    size_t access_hook;
    void (*watched_access)(void *context, uint32_t address, bool is_store); /* likewise */
    struct {
        uint32_t address;
        size_t hook;
    } breaks[CORE_BREAKS_MAX];
    unsigned break_count;
    uint32_t passed; /* a breakpoint that is not heeded once; 1: none */
    bool broke, stepping;
    /* Of the last stop by a bad access. */
    uint32_t bad_address;
    uint32_t exception; /* the engine's number of what it did not execute */
    bool asked;         /* the last stop was core_stop's */
    char message[CORE_MESSAGE_MAX];
};

/* Opens the library at `path`; NULL: the environment's AFO_UNICORN, else the one in
 * build/venv. Returns 0, or -1 with the reason in core->message. core_close afterwards in
 * either case. */
int core_open(struct core *core, const char *path, const struct core_callbacks *callbacks);
void core_close(struct core *core);

/* `bytes` of memory at `base`, which stay the caller's. Both multiples of 4096. */
int core_map_memory(struct core *core, uint32_t base, uint32_t bytes, void *memory, bool writable);
/* Memory that is read and fetched; each store is told, and nothing else done. One such range. */
int core_map_watched(struct core *core, uint32_t base, uint32_t bytes, void *memory);
/* Closes that range to loads, fetches left aside: the first load from each page stops the core before
 * it. core_open_page opens the page, and the same instruction may be tried again. */
enum { CORE_PAGE_BYTES = 4096 };
void core_close_pages(struct core *core);
void core_open_page(struct core *core, uint32_t address);
/* Changes memory from outside; what was translated from it is translated anew. */
void core_write(struct core *core, uint32_t address, const void *bytes, uint32_t count);
/* Every access in the range calls read or write. */
int core_map_registers(struct core *core, uint32_t base, uint32_t bytes);

uint32_t core_get(struct core *core, enum core_register which);
void core_set(struct core *core, enum core_register which, uint32_t value);

/* The floating-point registers S0 to S15. */
void core_get_float(struct core *core, uint32_t s[16]);
void core_set_float(struct core *core, const uint32_t s[16]);

/* R0 to R12 by their number; D0 to D15. */
uint32_t core_get_general(struct core *core, unsigned number);
void core_set_general(struct core *core, unsigned number, uint32_t value);
uint64_t core_get_double(struct core *core, unsigned number);
void core_set_double(struct core *core, unsigned number, uint64_t value);

/* Sets bits of a register: R0 to R12 by their number, S0 to S31 by CORE_STICK_S0 and theirs. */
enum { CORE_STICK_S0 = 32 };
void core_stick(struct core *core, uint32_t number, uint32_t bits);

/* Calls `function` before each read of the word at `address`, of one at a time; NULL: no more. Not from
 * a callback. */
void core_watch_reads(struct core *core, uint32_t address, void (*function)(void *context));

/* Calls `function` before each load and store in a range, of one at a time; NULL: no more. Not from a
 * callback. */
void core_watch_accesses(struct core *core, uint32_t base, uint32_t bytes,
                         void (*function)(void *context, uint32_t address, bool is_store));

/* Executes from `pc` (bit 0 is ignored) on. */
enum core_stop core_run(struct core *core, uint32_t pc);

/* Executes one instruction. */
enum core_stop core_step(struct core *core, uint32_t pc);

/* From now on core_run stops before the instruction at `address`, or no more. Returns 0, or -1 when
 * there are too many. Not from a callback. */
int core_break(struct core *core, uint32_t address, bool on);
void core_break_none(struct core *core);
/* The breakpoint at `address`, if there is one, is passed once. */
void core_pass_break(struct core *core, uint32_t address);

/* From a callback: no further block. */
void core_stop(struct core *core);

#endif
