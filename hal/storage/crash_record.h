/* What a fault leaves behind: a record in memory that a reset does not clear.
 *
 * A fault handler fills it and resets; the next start finds it, reports it over
 * CAN, and keeps the orthosis in its safe state until an operator has seen it.
 */
#ifndef HAL_STORAGE_CRASH_RECORD_H
#define HAL_STORAGE_CRASH_RECORD_H

#include <stdbool.h>
#include <stdint.h>

enum { CRASH_RECORD_MAGIC = 0x43524153 };

/* Values appear on the bus and in logs: they never change meaning. */
enum crash_cause {
    CRASH_NONE = 0,
    CRASH_NMI = 1,
    CRASH_HARD_FAULT = 2,
    CRASH_MEMORY_FAULT = 3, /* MPU: also an overflow of the stack */
    CRASH_BUS_FAULT = 4,
    CRASH_USAGE_FAULT = 5,
    CRASH_UNEXPECTED_INTERRUPT = 6,
    CRASH_ASSERTION = 7,
    CRASH_CLOCK_FAILED = 8, /* the crystal stopped, or never started */
    CRASH_WATCHDOG = 9,     /* nobody wrote a record: the watchdog reset the processor */
    CRASH_SUPPLY = 10,      /* likewise: the supply dipped, so briefly that memory was kept */
    CRASH_LOST_WRITE = 11,  /* a register does not hold what the start wrote; detail: its address */
    CRASH_PROGRAM = 12,     /* the program in flash is another than the one that was written */
    CRASH_RAM = 13,         /* a word of RAM failed the march while running; detail: its address */
    CRASH_RAM_PARITY = 14,  /* a word of RAM was read with the wrong parity */
    CRASH_REGISTER = 15, /* a register of the core has a stuck bit; detail: 0 core, 1, 2 floats */
    CRASH_OSCILLATOR =
        16,          /* crystal and watchdog's oscillator disagree; detail: Hz of the latter */
    CRASH_STACK = 17 /* a stack came to within 32 bytes of its guard; detail: its bottom */
};

enum { CRASH_STACK_WORDS = 8 };

struct crash_record {
    uint32_t magic;
    uint32_t cause; /* enum crash_cause */
    uint32_t pc;    /* stacked return address, 0 when the stack was unreadable */
    uint32_t lr;
    uint32_t xpsr;
    uint32_t r0, r1, r2, r3, r12;
    uint32_t sp;   /* stack pointer before the exception */
    uint32_t cfsr; /* configurable fault status */
    uint32_t hfsr; /* hard fault status */
    uint32_t fault_address;
    uint32_t detail;   /* interrupt number, line of a failed assertion, or address of a register */
    uint32_t time_ms;  /* since start, 0 when unknown */
    uint32_t count;    /* crashes since power-up, this one included */
    uint32_t build_id; /* of the firmware that wrote the record */
    uint32_t stack[CRASH_STACK_WORDS]; /* what lay above the exception frame */
    uint32_t crc;                      /* CRC-32 of all before */
};

/* Crashes since the bus last worked, in memory that a reset does not clear. Apart from the
 * record, which nobody changes while it is read over the bus. */
struct crash_streak {
    uint32_t length;
    uint32_t inverted; /* its complement; anything else: memory after power-up, 0 */
};

/* From this length on the start must not rely on anything that it can do without. */
enum { CRASH_STREAK_LIMIT = 3 };

/* Number of crashes since crash_streak_end or power-up. O(1). */
static inline uint32_t crash_streak_length(const struct crash_streak *streak)
{
    return streak->inverted == ~streak->length ? streak->length : 0U;
}

/* True when this memory was never without power since it was first written: the present start is
 * no power-on. O(1). */
static inline bool crash_streak_is_kept(const struct crash_streak *streak)
{
    return streak->inverted == ~streak->length;
}

/* One more crash; saturates. Any context, faults included; O(1). */
static inline void crash_streak_add(struct crash_streak *streak)
{
    const uint32_t length = crash_streak_length(streak);

    streak->length = length < UINT32_MAX ? length + 1U : length;
    streak->inverted = ~streak->length;
}

/* The bus worked. Loop only; O(1). */
static inline void crash_streak_end(struct crash_streak *streak)
{
    streak->length = 0;
    streak->inverted = UINT32_MAX;
}

/* What a reset that left no record says about the run before it. by_watchdog, by_supply: the
 * processor's flags; power-on sets that of the supply, too. memory_kept: crash_streak_is_kept.
 * CRASH_NONE: it ended as it may. Pure; O(1). */
enum crash_cause crash_cause_of_reset(bool by_watchdog, bool by_supply, bool memory_kept);

/* Empties a record but for the number of crashes that it knows of. Any context, faults
 * included; about 2,000 instructions. */
void crash_record_begin(struct crash_record *record);

/* Seals a record that the caller filled, `count` being the crashes before this
 * one (crash_record_count): sets magic, counts this one, computes the CRC. Any
 * context, faults included; about 2,000 instructions. */
void crash_record_seal(struct crash_record *record);

/* True when *record was sealed and is intact. After power-up it is not. */
bool crash_record_is_valid(const struct crash_record *record);

/* Number of crashes since power-up that *record knows of; 0 when invalid. */
uint32_t crash_record_count(const struct crash_record *record);

/* Marks the record as seen; the count survives. Loop only. */
void crash_record_acknowledge(struct crash_record *record);

#endif
