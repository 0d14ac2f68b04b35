/* An STM32G474 that runs the image that is flashed: instructions by the engine, registers
 * by the models of its peripherals, exceptions as Armv7-M has them.
 *
 * Time is virtual and counted in cycles of the core: an instruction takes one cycle, an
 * exception's entry and return twelve each, a tail-chained entry six, and WFI lasts until
 * something happens. Interrupts come in between blocks of instructions (up to a branch).
 * The same image, memory and bus give the same run on every machine.
 *
 * What the program does that the chip's reference manual leaves undefined or forbids is a
 * finding: written down, and the run goes on.
 *
 * Simplified: a write into a part of RAM that the MPU closes faults when the next exception
 * comes or the core sleeps, not at the instruction (the engine protects pages, and the
 * regions are smaller); reads there are not noticed. An exception's floating-point state is stored
 * before the block with the handler's first floating-point instruction, not at that instruction.
 * No cycle is added for wait states and caches.
 */
#ifndef SIM_HOST_EMULATOR_G474_CHIP_H
#define SIM_HOST_EMULATOR_G474_CHIP_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "sim_host/emulator/g474/chip_profile.h"
#include "sim_host/emulator/g474/fdcan_model.h"
#include "sim_host/emulator/g474/flash_model.h"
#include "sim_host/emulator/g474/unicorn_core.h"

enum {
    CHIP_FLASH_BYTES = 512 * 1024,
    CHIP_BANK_BYTES = CHIP_FLASH_BYTES / 2,
    CHIP_STARTER_BYTES = 8 * 1024, /* which nothing writes */
    CHIP_UART_MAX = 512,
    CHIP_RAM_BYTES = 128 * 1024,
    CHIP_UNUSED_RAM = 0x5A40, /* of the 32 KiB that the program tests, what it has no use for */
    CHIP_INTERRUPTS = 102,
    CHIP_EXCEPTIONS = 16 + CHIP_INTERRUPTS,
    CHIP_NEST_MAX = 32,
    CHIP_MPU_REGIONS = 8,
    CHIP_GUARD_MAX = 256, /* bytes of a closed region in RAM that are watched */
    CHIP_PORTS = 7,       /* GPIOA to GPIOG */
    CHIP_FINDINGS_MAX = 16,
    CHIP_FINDING_BYTES = 160,
    CHIP_IRQ_PVD = 1,
    CHIP_IRQ_FDCAN1 = 21,
    CHIP_IRQ_TIM2 = 28
};
#define CHIP_NEVER UINT64_MAX

/* Why the chip was reset last; bits of RCC_CSR. */
enum chip_reset {
    CHIP_RESET_OPTIONS = 1 << 25,
    CHIP_RESET_PIN = 1 << 26,
    CHIP_RESET_POWER = 1 << 27,
    CHIP_RESET_SOFTWARE = 1 << 28,
    CHIP_RESET_WATCHDOG = 1 << 29
};

/* What a program does that has left its way. */
enum chip_wild {
    CHIP_WILD_LOOP,    /* it loops for ever */
    CHIP_WILD_IN_RAM,  /* it executes RAM */
    CHIP_WILD_IN_FLASH /* it writes to itself */
};

struct chip_flash_use;

struct chip_scs {
    bool pending[CHIP_EXCEPTIONS], active[CHIP_EXCEPTIONS], enabled[CHIP_EXCEPTIONS];
    uint8_t priority[CHIP_EXCEPTIONS];
    uint8_t nest[CHIP_NEST_MAX]; /* exceptions being handled, the innermost last */
    unsigned depth;
    uint32_t vtor, aircr, scr, ccr, shcsr, cfsr, hfsr, mmfar, bfar, cpacr, fpccr, fpcar, demcr;
    uint32_t mpu_ctrl, mpu_rnr, mpu_rbar[CHIP_MPU_REGIONS], mpu_rasr[CHIP_MPU_REGIONS];
    uint8_t guarded[CHIP_MPU_REGIONS][CHIP_GUARD_MAX]; /* what a closed region in RAM holds */
    uint32_t systick_ctrl, systick_load;
    uint64_t systick_since; /* cycle of the last reload */
    uint64_t entries, tail_chained;
};

struct chip_clocks {
    uint32_t rcc[0x100 / 4], pwr[0x100 / 4];
    uint64_t hse_ready_ns, pll_ready_ns;
    bool crystal_works; /* the outside world's */
    uint32_t core_khz, timer_khz;
};

struct chip_timer {
    uint32_t cr1, dier, sr, psc, psc_active, arr, ccr1;
    uint32_t count_base;
    uint64_t base_ns; /* when count_base was right */
    uint64_t match_ns, overflow_ns;
    /* The second channel's output. */
    uint32_t ccmr1, ccer, ccr2;
    bool high;
    uint64_t low_ns;                   /* when it goes low; never while it is */
    uint64_t pulses, rose_ns, fell_ns; /* at PA1, with the last edges */
};

struct chip_watchdog {
    uint32_t pr, rlr, winr;
    bool running, unlocked;
    uint64_t due_ns, busy_until_ns;
};

/* The chip's supply, what looks after it, and the watchdog's oscillator. */
struct chip_supply {
    uint32_t vdd_mV;
    uint32_t exti[6], cfgr2; /* EXTI's first registers; SYSCFG_CFGR2 */
    uint32_t lptim[9];
    uint64_t lptim_since_ns;
    uint32_t lsi_hz;
};

struct chip_port {
    uint32_t reg[0x2C / 4];
    uint32_t driven, level; /* pins held from outside, and at what */
};

/* Instructions up to a branch. */
struct chip_block {
    uint16_t bytes, instructions;
    bool has_float; /* an instruction of the floating-point unit is among them */
};

/* Of each RAM, whether it was touched since, and what its first store would have changed. */
enum { CHIP_RAMS = 5 };
struct chip_first_stores {
    bool watched, touched[CHIP_RAMS], lost[CHIP_RAMS];
    uint32_t offset[CHIP_RAMS], word[CHIP_RAMS];
};

struct chip {
    struct core core;
    uint8_t *flash, *ram;              /* of flash, what the core fetches: the first bank */
    uint32_t changed_from, changed_to; /* of it, that may be translated as it was before */
    struct chip_block *block;          /* by half-word of flash: that which begins there */
    /* Time. */
    uint64_t cycles, instructions;
    uint64_t base_cycles, base_ns; /* the last change of the clock */
    uint64_t due;                  /* cycle of the next thing to happen by itself */
    uint64_t outside_due_ns;       /* until when chip_run was asked to run */
    bool attention;                /* an exception may be taken */
    bool stop_asked, reset_asked;
    bool sleeping; /* in WFI */
    bool dead;     /* no clock, or locked up: only the watchdog helps */
    uint32_t pc;   /* where chip_run goes on */
    uint32_t reset_cause;
    uint32_t resets;
    /* Peripherals. */
    struct chip_scs scs;
    struct chip_clocks clocks;
    struct chip_timer timer;
    struct chip_watchdog watchdog;
    struct chip_supply supply;
    struct chip_port port[CHIP_PORTS];
    struct fdcan_model can;
    struct flash_model flash_registers;
    uint64_t flash_done_ns;
    uint64_t permit_edge_ns; /* when PC1 changed last */
    uint64_t permit_edges;
    /* What the virtual COM port said last, and how often LD2 went on. */
    char uart[CHIP_UART_MAX];
    uint32_t uart_count;
    uint32_t uart_reg[3]; /* CR1, BRR; when the next character may be put */
    uint64_t uart_ready_ns;
    uint32_t led_edges;
    uint32_t stuck_at, stuck_bit; /* offset into RAM and bits that stay 1; no bits: none */
    uint32_t weak_at;             /* address of a word that is read wrong; 0: none */
    uint32_t weak_reads;
    bool weak_is_ram;                             /* its parity fails; else flash, which mends it */
    uint32_t stuck_register, stuck_register_bits; /* core_stick's number, and bits that stay 1 */
    bool hang;           /* for tests: the program leaves its way from now on, interrupts go on */
    enum chip_wild wild; /* where to */
    uint32_t forbidden_store; /* the address of a store into flash that the MPU forbids; 0: none */
    /* Findings. */
    char findings[CHIP_FINDINGS_MAX][CHIP_FINDING_BYTES];
    uint64_t finding_count;
    struct chip_flash_use *flash_use;     /* notes what is read of flash; NULL = nobody asks */
    void (*on_power_loss)(void *context); /* before power comes back; NULL = nobody looks */
    void *power_context;
    void (*debug)(void *context); /* between two runs of the core; NULL = no debugger */
    void *debug_context;
    bool debug_halted, debug_step; /* it stops before the next instruction, or after it */
    struct chip_first_stores first_stores;
    bool dirty_ram;               /* a program that begins finds anything in RAM */
    struct chip_profile *profile; /* NULL = not asked for; the caller's */
    FILE *trace; /* what a debugger records of the trace port; NULL = none listens */
    char message[CORE_MESSAGE_MAX];
};

/* ---- Use ------------------------------------------------------------------------------ */

/* A chip with `image` at the beginning of its flash and `store`, which may be NULL, in the
 * parameter memory; power comes on. `core_path` as in core_open. One chip at a time: the
 * models' addresses are the program's. Returns 0, or -1 with the reason in chip->message. */
int chip_start(struct chip *chip, const char *core_path, const char *image_path,
               const uint8_t *store, uint32_t store_bytes);
void chip_free(struct chip *chip);

/* Runs to `until_ns` or until something asked to stop (chip_stop, a reset). */
void chip_run(struct chip *chip, uint64_t until_ns);

/* Lets chip_run return before the next block. */
void chip_stop(struct chip *chip);

uint64_t chip_now_ns(const struct chip *chip);

/* Power goes and comes back: memory is lost, flash is not. */
void chip_power_cycle(struct chip *chip);

/* The crystal works from now on, or stops. */
void chip_set_crystal(struct chip *chip, bool works);

/* The supply is so high from now on. Below the brown-out level the chip is held in reset; memory is
 * kept down to 1 V. */
void chip_set_supply(struct chip *chip, uint32_t millivolts);

/* The watchdog's oscillator has another frequency from now on. */
void chip_set_lsi(struct chip *chip, uint32_t hz);

/* Somebody feeds the watchdog now. */
void chip_feed_watchdog(struct chip *chip);

/* From now on reads of the word at `address` meet a wrong bit: RAM fails its parity, the first bank of
 * flash mends it. 0: no more. */
void chip_weaken(struct chip *chip, uint32_t address);

/* From now on the first access to each RAM is lost if it is a store (ES0430, 2.2.7). */
void chip_lose_first_stores(struct chip *chip);

/* Holds a pin at a level from outside. */
void chip_drive_pin(struct chip *chip, unsigned port, unsigned pin, bool high);

/* Whether the program holds a pin high: an output, and its bit set. */
bool chip_gives(const struct chip *chip, unsigned port, unsigned pin);

/* Flash from `offset` on is as erased. */
void chip_erase(struct chip *chip, uint32_t offset, uint32_t bytes);
/* A bit of a word of flash has changed, and the error correction does not see it. */
void chip_damage(struct chip *chip, uint32_t offset);

/* True while FDCAN1 is a node of a bus at 1 Mbit/s: pins, clock and bit timing. */
bool chip_can_is_on_bus(const struct chip *chip);
/* Something about FDCAN1 changed outside of the program: its interrupt may be due. */
void chip_can_changed(struct chip *chip);

/* A word of RAM, 0 outside of it. */
uint32_t chip_ram_word(const struct chip *chip, uint32_t address);

void chip_find(struct chip *chip, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* ---- Between the parts of the chip ------------------------------------------------------- */

/* What is due by now happens. */
void chip_fire(struct chip *chip);
/* For the core: accesses to registers and to the parameter memory; context is the chip. */
uint32_t chip_read(void *context, uint32_t address, uint32_t bytes);
/* The flash model changed. context is the chip. */
void chip_flash_changed(void *context, uint32_t offset, uint32_t bytes);
/* Another program begins: what was translated of changed flash is forgotten. */
void chip_flash_forget(struct chip *chip);
/* Before each block: what was lost is lost. Returns true once nothing is left to look for. */
bool chip_first_stores_are_over(struct chip *chip);
void chip_first_stores_end(struct chip *chip);
/* The beginning of RAM gets anything, the same after as many resets. */
void chip_fill_ram(struct chip *chip, uint32_t bytes);
/* The starter hands over to the program. */
void chip_begin_program(struct chip *chip);
/* A store into the first bank of flash. */
void chip_write_flash(void *context, uint32_t address, uint32_t bytes, uint32_t value);
void chip_write(void *context, uint32_t address, uint32_t bytes, uint32_t value);
/* A register changed: interrupts and due times are looked at again before the next block. */
void chip_update(struct chip *chip);
/* Looks at them now. */
void chip_refresh(struct chip *chip);
/* Cycle of the next thing that happens by itself. */
uint64_t chip_next_due_cycle(const struct chip *chip);
/* Core cycle at which `time_ns` is reached. */
uint64_t chip_cycle_of(const struct chip *chip, uint64_t time_ns);

/* The core takes `bytes` bytes at `offset` into flash. Noted where chip_flash_use_begin asked
 * for it. */
void chip_flash_use_note(struct chip *chip, uint32_t offset, uint32_t bytes);
/* The core is about to load from a page of 4 KiB for the first time. */
void chip_flash_use_load(struct chip *chip, uint32_t address);
/* Flash was erased, or one word of it (8 bytes) programmed. */
void chip_flash_use_change(struct chip *chip, uint32_t offset, uint32_t bytes);

void chip_scs_reset(struct chip *chip);
void chip_scs_map(struct chip *chip);
uint64_t chip_systick_due(const struct chip *chip);
void chip_systick_fire(struct chip *chip);

void chip_pend(struct chip *chip, unsigned exception);
/* Whether the most urgent pending exception beats what runs, masks left aside. */
bool chip_wants_exception(const struct chip *chip);
/* The same, masks considered. 0 = none. */
unsigned chip_next_exception(struct chip *chip);
/* Enters it; `pc` is where the program goes on afterwards. Returns the handler's address. */
uint32_t chip_enter(struct chip *chip, unsigned exception, uint32_t pc);
/* After a branch to EXC_RETURN. Returns where to go on. */
uint32_t chip_leave(struct chip *chip, uint32_t exc_return);
/* The floating-point state of what was interrupted has a place on the stack and is not stored there. */
bool chip_float_is_owed(const struct chip *chip);
/* Stores it: the first floating-point instruction since is about to run. */
void chip_store_float(struct chip *chip);
/* Remembers what the closed regions in RAM hold, and pends the fault when one was written. */
void chip_guard(struct chip *chip);
void chip_check_guards(struct chip *chip);
/* Whether the MPU forbids an access of that kind: CORE_BAD_READ, CORE_BAD_WRITE or CORE_BAD_FETCH. */
bool chip_mpu_forbids(const struct chip *chip, uint32_t address, enum core_stop access);
/* An access or instruction failed at `pc`. Returns the exception to enter. */
unsigned chip_fault(struct chip *chip, enum core_stop stop, uint32_t address);

void chip_clocks_reset(struct chip *chip, bool power_on);
void chip_clocks_map(struct chip *chip);
uint64_t chip_clocks_due(const struct chip *chip);
void chip_clocks_fire(struct chip *chip);
/* The core clock by the registers; also checks the flash's wait states. */
void chip_clocks_apply(struct chip *chip);
/* Whether what lies at `address` has its clock. */
bool chip_has_clock(const struct chip *chip, uint32_t address, const char **name);

void chip_supply_reset(struct chip *chip);
void chip_supply_map(struct chip *chip);
/* Below the detector's threshold; below the brown-out level. */
bool chip_supply_is_low(const struct chip *chip);
bool chip_supply_resets(const struct chip *chip);
/* The supply has changed: its detector's edge. */
void chip_supply_follow(struct chip *chip, bool was_low);

void chip_io_reset(struct chip *chip);
void chip_io_map(struct chip *chip);
void chip_timer_reset(struct chip *chip);
void chip_timer_map(struct chip *chip);
void chip_timer_rebase(struct chip *chip);
uint64_t chip_timer_due(const struct chip *chip);
void chip_timer_fire(struct chip *chip);
uint64_t chip_io_due(const struct chip *chip);
void chip_io_fire(struct chip *chip);

#endif
