/* Loads and stores of the core on the models' registers, and how long the flash takes. */
#include "sim_host/emulator/g474/chip.h"
#include "sim_host/emulator/g474/mmio_model.h"
#include "sim_host/emulator/g474/model_check.h"

enum { SR_BSY = 1 << 16, ISR_TXE = 1 << 7 };
#define FLASH_SR 0x40022010u
#define LPUART_ISR 0x4000801Cu

static bool in_store(uint32_t address)
{
    return address - (0x08000000u + CHIP_BANK_BYTES) < (uint32_t)CHIP_BANK_BYTES;
}

static bool is_reachable(struct chip *chip, uint32_t address)
{
    const char *name = "";

    if (chip_has_clock(chip, address, &name)) {
        return true;
    }
    chip_find(chip, "%s was accessed without its clock", name);
    return false;
}

/* The second bank cannot be read while it is being erased or written: the core waits. */
static void wait_for_flash(struct chip *chip)
{
    if (chip->flash_done_ns != CHIP_NEVER) {
        chip->cycles = chip_cycle_of(chip, chip->flash_done_ns);
        chip_fire(chip);
    }
}

/* A program that asks whether flash or port are done would hear the same until something happens:
 * that is when it asks next. */
static void skip_polls(struct chip *chip, uint32_t address, uint32_t value)
{
    uint64_t until = chip_next_due_cycle(chip);

    if (address == LPUART_ISR && (value & ISR_TXE) == 0) {
        const uint64_t ready = chip_cycle_of(chip, chip->uart_ready_ns);
        until = ready < until ? ready : until;
    } else if (address != FLASH_SR || (value & SR_BSY) == 0) {
        return;
    }
    chip->cycles = until > chip->cycles ? until : chip->cycles;
}

static uint32_t read_word(struct chip *chip, uint32_t address)
{
    uint32_t value;

    if (in_store(address)) {
        wait_for_flash(chip);
        chip_flash_use_note(chip, address - 0x08000000u, 4);
    } else if (!is_reachable(chip, address)) {
        return 0;
    }
    chip->can.time_bits = (uint32_t)(chip_now_ns(chip) / 1000u);
    value = mmio_model_load(address);
    skip_polls(chip, address, value);
    return value;
}

uint32_t chip_read(void *context, uint32_t address, uint32_t bytes)
{
    struct chip *chip = context;
    const uint32_t shift = 8 * (address & 3);
    uint64_t value = read_word(chip, address & ~3u);

    if ((address & 3) + bytes > 4) {
        MODEL_CHECK(in_store(address), "register %#x was read unaligned", address);
        value |= (uint64_t)read_word(chip, (address & ~3u) + 4) << 32;
    }
    value >>= shift;
    return bytes == 4 ? (uint32_t)value : (uint32_t)value & ((1u << (8 * bytes)) - 1);
}

/* What the models count in polls takes time here. */
static void time_flash(struct chip *chip, bool is_program)
{
    if (chip->flash_registers.busy == UINT32_MAX && chip->flash_done_ns == CHIP_NEVER) {
        chip->flash_done_ns = chip_now_ns(chip) + (is_program ? MODEL_PROGRAM_NS : MODEL_ERASE_NS);
        if (chip->flash_registers.worked_on == 0) {
            wait_for_flash(chip); /* the core cannot fetch meanwhile */
        }
    }
    if (chip->flash_registers.power_off) {
        chip_stop(chip);
    }
}

void chip_write_flash(void *context, uint32_t address, uint32_t bytes, uint32_t value)
{
    struct chip *chip = context;

    if (chip_mpu_forbids(chip, address, CORE_BAD_WRITE)) {
        chip->forbidden_store = address;
        return;
    }
    MODEL_CHECK(bytes == 4 && address % 4 == 0, "flash %#x was written by %u bytes", address,
                bytes);
    flash_model_store(&chip->flash_registers, (address & ~3u) - 0x08000000u, value);
    time_flash(chip, true);
    chip_update(chip);
}

void chip_write(void *context, uint32_t address, uint32_t bytes, uint32_t value)
{
    struct chip *chip = context;
    const uint32_t shift = 8 * (address & 3), word = address & ~3u;

    if (!in_store(address) && !is_reachable(chip, address)) {
        return;
    }
    if (bytes < 4) {
        const uint32_t mask = ((1u << (8 * bytes)) - 1) << shift;
        MODEL_CHECK(word >= 0xE000E000u, "register %#x was written by %u bytes", address, bytes);
        value = (mmio_model_load(word) & ~mask) | (value << shift & mask);
    }
    mmio_model_store(word, value);
    if (chip->flash_registers.options_wanted && !chip->reset_asked) {
        chip->reset_asked = true;
        chip->reset_cause = (uint32_t)CHIP_RESET_OPTIONS | (uint32_t)CHIP_RESET_PIN;
    }
    if (in_store(word) || word - 0x40022000u < 0x400u) {
        time_flash(chip, in_store(word));
        chip_clocks_apply(chip);
    }
    if (word - 0x40006400u < 0x400u || word - 0x48000000u < 0x400u) {
        chip_can_changed(chip); /* what hangs on the bus must look */
        return;
    }
    chip_update(chip);
}
