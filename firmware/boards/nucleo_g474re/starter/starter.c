/* What the chip runs first: tests the program's RAM, carries out an ordered update, and starts the
 * program if it is whole.
 *
 * A program that is not whole does not run. Then LD2 blinks (three short, three long), and the
 * virtual COM port says why, again and again. Nothing is sent on the bus: the drives hear nothing
 * and stay or go unloaded by themselves. It needs no crystal and no interrupt.
 */
#include "hal/port_cortex_m/cortex_m4.h"
#include "hal/port_cortex_m/mmio.h"
#include "hal/port_stm32g474/flash_registers.h"
#include "hal/port_stm32g474/flash_store.h"
#include "hal/port_stm32g474/option_bytes.h"
#include "hal/port_stm32g474/signs.h"
#include "hal/port_stm32g474/system_registers.h"
#include "hal/ram_march.h"
#include "hal/storage/black_box.h"

extern uint32_t starter_stack_top[], starter_bss_start[], starter_bss_end[];

enum { UNIT_MS = 150, SHORTS_AND_LONGS = 6 };

#define PROGRAM_RAM 0x20000000u /* link.ld of the program */
#define PROGRAM_RAM_WORDS (0x8000u / 4u)
#define BLACK_BOX 0x20010000u
#define CCM_RAM 0x20018000u
#define CCM_RAM_BYTES 0x8000u

static struct flash_store flash;

static uint32_t read_ram(uint32_t address)
{
    return *(volatile const uint32_t *)address;
}

static void write_ram(uint32_t address, uint32_t value)
{
    *(volatile uint32_t *)address = value;
}

static const struct ram_march_access ram_access = {read_ram, write_ram};

void starter_reset(void);
void starter_begin(void);
void starter_nmi(void);
void starter_stop(void);

__attribute__((section(".vectors"), used)) static const union vector vectors[16] = {
    {.stack = starter_stack_top}, {.handler = starter_reset}, {.handler = starter_nmi},
    {.handler = starter_stop},    {.handler = starter_stop},  {.handler = starter_stop},
    {.handler = starter_stop},    {.handler = starter_stop},  {.handler = starter_stop},
    {.handler = starter_stop},    {.handler = starter_stop},  {.handler = starter_stop},
    {.handler = starter_stop},    {.handler = starter_stop},  {.handler = starter_stop},
    {.handler = starter_stop},
};

static const char *reason_of(enum program_verdict verdict)
{
    switch (verdict) {
    case PROGRAM_NO_HEADER:
        return "afo: there is no program; flash one (make flash)\r\n";
    case PROGRAM_BAD_LENGTH:
        return "afo: the program's length is impossible; flash it again (make flash)\r\n";
    case PROGRAM_OTHER_HARDWARE:
        return "afo: the program is for another board; flash one for this board (make flash)\r\n";
    default:
        return "afo: the program is not whole (CRC); flash it again (make flash)\r\n";
    }
}

/* For good: a reset tries again. */
static _Noreturn void say(const char *text)
{
    signs_init(FALLBACK_HZ);
    for (uint32_t blink = 0;; blink = (blink + 1u) % (2u * SHORTS_AND_LONGS)) {
        const bool lit = blink % 2u == 0u, is_long = blink / 2u >= 3u;
        if (blink == 0u) {
            signs_write(text);
        }
        signs_light(lit);
        signs_wait(FALLBACK_HZ, (uint32_t)UNIT_MS * (lit && is_long ? 3u : 1u));
    }
}

static _Noreturn void run(uint32_t slot)
{
    SCB_VTOR = slot;
    cortex_m4_barrier();
    __asm volatile("msr msp, %0\n"
                   "bx %1\n" ::"r"(*(const volatile uint32_t *)slot),
                   "r"(*(const volatile uint32_t *)(slot + 4u)));
    __builtin_unreachable();
}

/* With parity on, memory that was never written must not be read (RM0440, "SRAM parity check"). The
 * march writes SRAM1's part. CCM SRAM is the end of the black box; its beginning, in memory without
 * parity, says whether it holds anything. */
static void clear_parity_memory(void)
{
    const struct black_box *box = (const struct black_box *)BLACK_BOX;

    if (box->header.magic == (uint32_t)BLACK_BOX_MAGIC) {
        (void)read_ram(CCM_RAM); /* as in starter_reset */
        return;
    }
    write_ram(CCM_RAM, 0);
    cortex_m4_barrier();
    for (uint32_t address = CCM_RAM; address < CCM_RAM + CCM_RAM_BYTES; address += 4u) {
        write_ram(address, 0);
    }
}

int main(void)
{
    const struct program_slots slots = flash_store_programs(&flash);
    struct program_header header;

    flash_store_init(&flash);
    if (!option_bytes_are_set() && option_bytes_set((mmio_read(RCC_CSR) & RCC_CSR_OBLRSTF) != 0u)) {
        for (;;) { /* the chip is being reset */
        }
    }
    clear_parity_memory();
    if (ram_march(&ram_access, PROGRAM_RAM, PROGRAM_RAM_WORDS) != 0u) {
        say("afo: the RAM has failed; this board must not be used\r\n");
    }
    if (program_slots_is_ordered(&slots)) {
        (void)program_slots_install(&slots);
    }
    const enum program_verdict verdict = program_slots_check(&slots, &header);
    if (verdict != PROGRAM_GOOD) {
        say(reason_of(verdict));
    }
    run(slots.slot);
}

/* The error correction gave up on a word: the read that met it says so. */
void starter_nmi(void)
{
    if (!flash_store_survives_nmi(&flash)) {
        starter_stop();
    }
}

void starter_stop(void)
{
    say("afo: the starter failed; flash the program again (make flash)\r\n");
}

/* Behind a reset the first store to each RAM may be lost (scripts/errata.txt, system 2.2.7): no stack before
 * this. SRAM1 is of 32, 32 and 16 KiB, SRAM2 follows. The first has parity, so that what nobody wrote must not
 * be loaded: two stores, and the march writes it anew. The others are the black box and the starter's own. */
__attribute__((naked, noreturn)) void starter_reset(void)
{
    __asm volatile("mov.w r1, #0x20000000\n"
                   "movs r0, #0\n"
                   "str r0, [r1]\n"
                   "dsb\n"
                   "str r0, [r1]\n"
                   "orr.w r2, r1, #0x8000\n"
                   "ldr r0, [r2]\n"
                   "orr.w r2, r1, #0x10000\n"
                   "ldr r0, [r2]\n"
                   "orr.w r2, r1, #0x14000\n"
                   "ldr r0, [r2]\n"
                   "dsb\n"
                   "b starter_begin\n");
}

__attribute__((used, noreturn)) void starter_begin(void)
{
    for (volatile uint32_t *to = starter_bss_start; to < starter_bss_end; to++) {
        *to = 0;
    }
    (void)main();
    __builtin_unreachable(); /* it hands over, or says why not */
}
