/* What crosses the pipes between the emulated processor and the host: records of
 * one size, so that neither side ever waits for a length. Both are little-endian.
 *
 * One exchange per SYNC: the processor writes what it queued since the last one,
 * the SYNC included; the host answers with everything that was on the bus up to
 * and with that SYNC. The host's part is sim_host's.
 */
#ifndef HAL_PIL_RECORD_H
#define HAL_PIL_RECORD_H

#include <assert.h>
#include <stdint.h>

#include "hal/bus/can_frame.h"
#include "hal/storage/crash_record.h"

enum { PIL_MAGIC = 0x4C495031, PIL_FRAMES = 14, PIL_RECORD_BYTES = 256 };

enum pil_kind {
    PIL_HELLO = 1, /* processor, once after its start: identity, crash record */
    PIL_CYCLE = 2, /* either side: frames */
    PIL_MORE = 3   /* host: frames, and another record follows at once */
};

/* Bits of pil_record.inputs, host to processor. */
enum pil_input {
    PIL_EMERGENCY_STOP = 1 << 0,
    PIL_RESET_REQUEST = 1 << 1,
    PIL_END = 1 << 2, /* stop the emulator */
    /* Faults to provoke, for tests. */
    PIL_DO_HARD_FAULT = 1 << 8,
    PIL_DO_HANG = 1 << 9,
    PIL_DO_OVERFLOW_STACK = 1 << 10,
    PIL_DO_ASSERT = 1 << 11,
    PIL_DO_EXECUTE_RAM = 1 << 13,
    PIL_DO_WRITE_PROGRAM = 1 << 14,
    PIL_DO_STALL_SUPERVISOR = 1 << 12 /* all goes on but the supervisor */
};

struct pil_hello {
    uint32_t build_id;
    uint32_t black_box_state; /* of what the last run left; 0 = nothing */
    uint32_t black_box_reason;
    struct crash_record crash; /* magic 0 when there is none */
};

struct pil_record {
    uint32_t magic;
    uint16_t kind;
    uint16_t count;        /* frames */
    uint32_t sequence;     /* of exchanges since the processor's start */
    uint32_t inputs;       /* host to processor */
    uint32_t instructions; /* processor to host: at most this many since the last answer */
    uint32_t stack_unused; /* processor to host: bytes of the thread stack never used */
    uint32_t ticks;        /* processor to host: of the control task */
    uint32_t reserved;
    union {
        struct can_msg frame[PIL_FRAMES];
        struct pil_hello hello;
    } body;
};

static_assert(sizeof(struct can_msg) == 16, "a frame has the same layout on both sides");
static_assert(sizeof(struct pil_record) == PIL_RECORD_BYTES, "a record has one size");

#endif
