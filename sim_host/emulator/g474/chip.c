#include "sim_host/emulator/g474/chip.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "sim_host/emulator/g474/mmio_model.h"
#include "sim_host/emulator/g474/model_check.h"

enum {
    PAGE = 4096,
    MEMORY_KEPT_MV = 1000,
    EXCEPTION_NMI = 2,
    STALL_LOOP = 0xE7FE,    /* b . */
    STORE_R0_AT_R1 = 0x6008 /* A7.7.161 */
};
#define FLASH_BASE 0x08000000u
#define SECOND_BANK (FLASH_BASE + CHIP_BANK_BYTES)
#define RAM_BASE 0x20000000u

/* ---- Findings ------------------------------------------------------------------------------ */

static void take_misuse(void *context, const char *description)
{
    chip_find(context, "%s", description);
}

static void on_nmi(void *context)
{
    chip_pend(context, EXCEPTION_NMI);
}

/* ---- Instructions ------------------------------------------------------------------------------------ */

/* Armv7-M, A5.3.18: coprocessor instructions, of coprocessors 10 and 11. */
static bool is_float(const uint16_t *code)
{
    return (code[0] & 0xEC00) == 0xEC00 && (code[1] & 0x0E00) == 0x0A00;
}

static struct chip_block read_block(const struct chip *chip, uint32_t offset, uint32_t bytes)
{
    struct chip_block block = {.bytes = (uint16_t)bytes};

    for (uint32_t at = offset; at < offset + bytes; block.instructions++) {
        const uint16_t *code = (const uint16_t *)(const void *)(chip->flash + at);
        const bool is_long = (code[0] >> 11) >= 0x1D;
        block.has_float = block.has_float || (is_long && is_float(code));
        at += is_long ? 4 : 2;
    }
    return block;
}

static uint32_t instructions_of_block(struct chip *chip, uint32_t address, uint32_t bytes)
{
    const uint32_t offset = address - FLASH_BASE;

    if (offset >= CHIP_FLASH_BYTES || bytes > CHIP_FLASH_BYTES - offset) {
        return bytes / 2;
    }
    struct chip_block *block = &chip->block[offset / 2];
    if (block->bytes != bytes) {
        *block = read_block(chip, offset, bytes);
    }
    if (block->has_float && chip_float_is_owed(chip)) {
        chip_store_float(chip);
    }
    return block->instructions;
}

static bool may_leave_way(struct chip *chip)
{
    return chip->hang && chip->scs.depth == 0 && (core_get(&chip->core, CORE_PRIMASK) & 1) == 0;
}

/* Something is due before the next block; true when the core must stop. */
static bool look_around(struct chip *chip)
{
    chip_refresh(chip);
    if (chip->cycles >= chip_next_due_cycle(chip)) {
        chip_fire(chip);
    }
    return chip->stop_asked || chip->reset_asked || chip->dead ||
           (chip->attention && chip_next_exception(chip) != 0) || may_leave_way(chip);
}

static void on_block(void *context, uint32_t address, uint32_t bytes)
{
    struct chip *chip = context;

    if (chip->stuck_bit != 0) {
        *(uint32_t *)(void *)(chip->ram + chip->stuck_at) |= chip->stuck_bit;
    }
    if (chip->stuck_register_bits != 0) {
        core_stick(&chip->core, chip->stuck_register, chip->stuck_register_bits);
    }
    if (chip->first_stores.watched && chip_first_stores_are_over(chip)) {
        core_stop(&chip->core);
        return;
    }
    if (chip->cycles >= chip->due && look_around(chip)) {
        core_stop(&chip->core);
        return;
    }
    if (chip->flash_use != NULL) {
        chip_flash_use_note(chip, address - FLASH_BASE, bytes);
    }
    const uint32_t count = instructions_of_block(chip, address, bytes);
    chip->cycles += count;
    chip->instructions += count;
    if (chip->profile != NULL) {
        chip_profile_note(chip->profile, address, count);
    }
}

/* Until an exception is pending, whether masked or not. */
static void sleep_on(struct chip *chip)
{
    while (!chip->attention && !chip->stop_asked && !chip->reset_asked) {
        const uint64_t due = chip_next_due_cycle(chip);
        chip->cycles = due > chip->cycles ? due : chip->cycles;
        chip_fire(chip);
    }
}

static uint32_t find_instruction(const struct chip *chip, uint16_t code)
{
    for (uint32_t offset = 0x100; offset < CHIP_BANK_BYTES; offset += 2) {
        if (*(const uint16_t *)(const void *)(chip->flash + offset) == code) {
            return FLASH_BASE + offset;
        }
    }
    return 0;
}

/* Returns where it goes on. */
static uint32_t leave_way(struct chip *chip)
{
    switch (chip->wild) {
    case CHIP_WILD_IN_RAM:
        return RAM_BASE + (uint32_t)CHIP_UNUSED_RAM; /* not in a stack's guard */
    case CHIP_WILD_IN_FLASH:
        core_set(&chip->core, CORE_R1, FLASH_BASE + CHIP_STARTER_BYTES);
        return find_instruction(chip, STORE_R0_AT_R1);
    case CHIP_WILD_LOOP:
        break;
    }
    return find_instruction(chip, STALL_LOOP);
}

/* Armv7-M, A7.7.161 and A7.7.163: plain stores of a word, which change nothing but memory. */
static uint32_t behind_store(struct chip *chip, uint32_t pc)
{
    const uint16_t *code = (const uint16_t *)(const void *)(chip->flash + (pc - FLASH_BASE));
    const bool is_short = (code[0] & 0xF800) == 0x6000 || (code[0] & 0xFE00) == 0x5000;
    const bool is_long =
        (code[0] & 0xFFF0) == 0xF8C0 || ((code[0] & 0xFFF0) == 0xF840 && (code[1] & 0x0FC0) == 0);

    if (pc - FLASH_BASE >= (uint32_t)CHIP_BANK_BYTES || (!is_short && !is_long)) {
        chip_find(chip, "a store into flash by an instruction that is not modelled");
    }
    return pc + (is_short ? 2 : 4);
}

static uint32_t forbid_store(struct chip *chip, uint32_t pc)
{
    const uint32_t address = chip->forbidden_store;

    chip->forbidden_store = 0;
    return chip_enter(chip, chip_fault(chip, CORE_BAD_WRITE, address), pc);
}

static uint32_t run_core(struct chip *chip, uint32_t pc)
{
    struct core *core = &chip->core;
    const enum core_stop stop = chip->debug_step ? core_step(core, pc) : core_run(core, pc);

    pc = core_get(core, CORE_PC);
    switch (stop) {
    case CORE_ASKED:
        return pc;
    case CORE_BROKE:
    case CORE_STEPPED:
        chip->debug_halted = true;
        return pc;
    case CORE_WAITS:
        chip->sleeping = true;
        return pc;
    case CORE_STORED:
        return chip->forbidden_store == 0 ? behind_store(chip, pc) : forbid_store(chip, pc);
    case CORE_LOADED:
        chip_flash_use_load(chip, core->bad_address);
        return pc;
    case CORE_EXCEPTION_RETURN:
        return chip_leave(chip, pc | 1u);
    case CORE_FAILED:
        chip_find(chip, "%s", core->message);
        chip->dead = true;
        return pc;
    case CORE_UNDEFINED:
    case CORE_BAD_READ:
    case CORE_BAD_WRITE:
    case CORE_BAD_FETCH:
        break;
    }
    return chip_enter(chip, chip_fault(chip, stop, core->bad_address), pc);
}

/* ---- Reset ---------------------------------------------------------------------------------------------- */

static void reset(struct chip *chip, bool power_on)
{
    struct core *core = &chip->core;
    const uint64_t now_ns = chip_now_ns(chip);

    chip_flash_forget(chip);
    chip->base_ns = now_ns;
    chip->base_cycles = chip->cycles;
    chip_clocks_reset(chip, power_on);
    chip_scs_reset(chip);
    chip_io_reset(chip);
    chip_supply_reset(chip);
    if (power_on || chip->flash_registers.options_wanted) {
        flash_model_load_options(&chip->flash_registers);
    }
    fdcan_model_reset(&chip->can);
    flash_model_power_up(&chip->flash_registers);
    chip->flash_done_ns = CHIP_NEVER;
    chip->reset_asked = chip->dead = chip->hang = chip->sleeping = false;
    chip->resets++;
    core_set(core, CORE_CONTROL, 0);
    core_set(core, CORE_XPSR, 1u << 24);
    core_set(core, CORE_CONTROL, 0); /* once more: in a handler it keeps the stack it is on */
    core_set(core, CORE_PRIMASK, 0);
    core_set(core, CORE_BASEPRI, 0);
    core_set(core, CORE_FAULTMASK, 0);
    core_set(core, CORE_LR, 0xFFFFFFFFu);
    chip_flash_use_note(chip, 0, 8);
    core_set(core, CORE_MSP, ((const uint32_t *)(const void *)chip->flash)[0]);
    chip->pc = ((const uint32_t *)(const void *)chip->flash)[1] & ~1u;
    chip_stop(chip);
}

/* What RAM holds when power comes on: anything. */
static void scramble(struct chip *chip)
{
    chip_fill_ram(chip, CHIP_RAM_BYTES);
    memset(chip->can.ram, 0xA7, sizeof chip->can.ram);
}

void chip_power_cycle(struct chip *chip)
{
    if (chip->on_power_loss != NULL) {
        chip->on_power_loss(chip->power_context);
    }
    scramble(chip);
    chip->reset_cause = (uint32_t)CHIP_RESET_POWER | (uint32_t)CHIP_RESET_PIN;
    reset(chip, true);
}

void chip_set_supply(struct chip *chip, uint32_t millivolts)
{
    const bool was_low = chip_supply_is_low(chip), was_held = chip_supply_resets(chip);

    chip->supply.vdd_mV = millivolts;
    const bool held = chip_supply_resets(chip);
    if (millivolts < (uint32_t)MEMORY_KEPT_MV) {
        chip_power_cycle(chip);
    } else if (held || was_held) {
        chip->reset_cause = (uint32_t)CHIP_RESET_POWER | (uint32_t)CHIP_RESET_PIN;
        reset(chip, true);
    }
    chip->dead = chip->dead || held;
    chip_supply_follow(chip, was_low);
}

void chip_run(struct chip *chip, uint64_t until_ns)
{
    chip->outside_due_ns = until_ns;
    chip->stop_asked = false;
    chip_refresh(chip);
    while (!chip->stop_asked) {
        if (chip->reset_asked) {
            reset(chip, false);
            return;
        }
        if (chip->debug != NULL) {
            chip->debug(chip->debug_context);
        }
        if (chip->first_stores.watched && chip_first_stores_are_over(chip)) {
            chip_first_stores_end(chip);
        }
        chip_check_guards(chip);
        chip_refresh(chip);
        if (chip->sleeping || chip->dead) {
            sleep_on(chip);
            chip->sleeping = chip->sleeping && !chip->attention;
            if (chip->sleeping || chip->dead) {
                continue;
            }
        }
        const unsigned exception = chip->attention ? chip_next_exception(chip) : 0;
        if (exception != 0) {
            chip->pc = chip_enter(chip, exception, chip->pc);
        } else if (may_leave_way(chip)) {
            chip->hang = false;
            chip->pc = leave_way(chip);
        }
        chip->pc = run_core(chip, chip->pc);
    }
}

/* ---- Building ---------------------------------------------------------------------------------------------- */

static int load_image(struct chip *chip, const char *path)
{
    FILE *file = fopen(path, "rb");

    if (file == NULL) {
        snprintf(chip->message, sizeof chip->message, "cannot read the image %s", path);
        return -1;
    }
    const size_t length = fread(chip->flash, 1, CHIP_BANK_BYTES, file);
    fclose(file);
    if (length < 1024 || chip->flash[3] != RAM_BASE >> 24 || chip->flash[7] != FLASH_BASE >> 24) {
        snprintf(chip->message, sizeof chip->message,
                 "%s is no image for an STM32G474: it does not begin with a stack in RAM and a "
                 "start in flash",
                 path);
        return -1;
    }
    return 0;
}

static void put_word(struct flash_model *model, uint32_t offset, const uint8_t *bytes)
{
    uint64_t word;

    memcpy(&word, bytes, 8);
    if (word != UINT64_MAX && offset < CHIP_FLASH_BYTES) {
        model->word[offset / 2048][offset % 2048 / 8] = word;
        model->state[offset / 2048][offset % 2048 / 8] = WORD_WRITTEN;
    }
}

static void load_store(struct chip *chip, const uint8_t *store, uint32_t bytes)
{
    for (uint32_t i = 0; i + 8 <= bytes; i += 8) {
        put_word(&chip->flash_registers, MODEL_STORE_PAGE * 2048 + i, store + i);
    }
    for (uint32_t i = 0; i < CHIP_BANK_BYTES; i += 8) {
        put_word(&chip->flash_registers, i, chip->flash + i);
    }
}

static int map_all(struct chip *chip)
{
    static const uint32_t windows[][2] = {{SECOND_BANK, CHIP_BANK_BYTES},
                                          {0x40000000u, PAGE},
                                          {0x40003000u, PAGE},
                                          {0x40006000u, 3 * PAGE},
                                          {0x4000A000u, PAGE},
                                          {0x40010000u, PAGE},
                                          {0x40021000u, 2 * PAGE},
                                          {0x48000000u, 2 * PAGE},
                                          {0xE0000000u, PAGE},
                                          {0xE0001000u, PAGE},
                                          {0xE000E000u, PAGE},
                                          {0xE0042000u, PAGE}};
    struct core *core = &chip->core;

    if (core_map_memory(core, FLASH_BASE, CHIP_STARTER_BYTES, chip->flash, false) != 0 ||
        core_map_watched(core, FLASH_BASE + CHIP_STARTER_BYTES,
                         CHIP_BANK_BYTES - CHIP_STARTER_BYTES,
                         chip->flash + CHIP_STARTER_BYTES) != 0 ||
        core_map_memory(core, RAM_BASE, CHIP_RAM_BYTES, chip->ram, true) != 0) {
        return -1;
    }
    for (size_t i = 0; i < sizeof windows / sizeof windows[0]; i++) {
        if (core_map_registers(core, windows[i][0], windows[i][1]) != 0) {
            return -1;
        }
    }
    return 0;
}

int chip_start(struct chip *chip, const char *core_path, const char *image_path,
               const uint8_t *store, uint32_t store_bytes)
{
    const struct core_callbacks callbacks = {chip, on_block, chip_read, chip_write,
                                             chip_write_flash};

    memset(chip, 0, sizeof *chip);
    chip->flash = aligned_alloc(PAGE, CHIP_FLASH_BYTES);
    chip->ram = aligned_alloc(PAGE, CHIP_RAM_BYTES);
    chip->block = calloc(CHIP_FLASH_BYTES / 2, sizeof *chip->block);
    if (chip->flash == NULL || chip->ram == NULL || chip->block == NULL) {
        snprintf(chip->message, sizeof chip->message, "out of memory");
        return -1;
    }
    memset(chip->flash, 0xFF, CHIP_FLASH_BYTES);
    if (load_image(chip, image_path) != 0) {
        return -1;
    }
    if (core_open(&chip->core, core_path, &callbacks) != 0 || map_all(chip) != 0) {
        snprintf(chip->message, sizeof chip->message, "%s", chip->core.message);
        return -1;
    }
    model_on_misuse(take_misuse, chip);
    mmio_model_reset();
    fdcan_model_init(&chip->can);
    flash_model_init(&chip->flash_registers);
    chip->flash_registers.busy_time = UINT32_MAX; /* until flash_done_ns */
    chip->flash_registers.first_page = CHIP_STARTER_BYTES / 2048;
    chip->flash_registers.changed = chip_flash_changed;
    chip->flash_registers.changed_context = chip;
    chip->flash_registers.nmi = on_nmi;
    chip->flash_registers.nmi_context = chip;
    load_store(chip, store, store_bytes);
    chip_scs_map(chip);
    chip_clocks_map(chip);
    chip_io_map(chip);
    chip_supply_map(chip);
    chip->supply.vdd_mV = 3300;
    chip->supply.lsi_hz = 32000;
    chip->flash_registers.optr_stored = MODEL_OPTIONS_SET;
    chip->clocks.crystal_works = true;
    chip->clocks.core_khz = chip->clocks.timer_khz = 1;
    chip_power_cycle(chip);
    return 0;
}

void chip_free(struct chip *chip)
{
    core_close(&chip->core);
    model_on_misuse(NULL, NULL);
    free(chip->flash);
    free(chip->ram);
    free(chip->block);
    chip->flash = chip->ram = NULL;
    chip->block = NULL;
}

uint32_t chip_ram_word(const struct chip *chip, uint32_t address)
{
    const uint32_t offset = address - RAM_BASE;
    return offset <= CHIP_RAM_BYTES - 4
               ? *(const uint32_t *)(const void *)(chip->ram + (offset & ~3u))
               : 0;
}
