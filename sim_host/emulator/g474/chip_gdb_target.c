#include "sim_host/emulator/g474/chip_gdb_target.h"

#include <stdio.h>
#include <string.h>

enum { SP = 13, LR = 14, PC = 15, XPSR = 16, SYSTEM = 17, D0 = 23, FPSCR = D0 + 16 };
#define FLASH_BASE 0x08000000u
#define RAM_BASE 0x20000000u
#define REGISTERS_BASE 0x40000000u

#define REG(name) "<reg name=\"" name "\" bitsize=\"32\"/>"
#define DOUBLE(name) "<reg name=\"" name "\" bitsize=\"64\" type=\"ieee_double\"/>"
static const char description[] =
    "<?xml version=\"1.0\"?><!DOCTYPE target SYSTEM \"gdb-target.dtd\"><target>"
    "<architecture>arm</architecture><feature name=\"org.gnu.gdb.arm.m-profile\">" REG("r0") REG("r1") REG(
        "r2") REG("r3") REG("r4") REG("r5") REG("r6") REG("r7") REG("r8") REG("r9") REG("r10") REG("r11")
        REG("r12") "<reg name=\"sp\" bitsize=\"32\" type=\"data_ptr\"/>" REG("lr") "<reg name=\"pc\" bitsize=\"32\" type=\"code_ptr\"/>" REG(
            "xpsr") "</feature>"
                    "<feature name=\"org.gnu.gdb.arm.m-system\">" REG("msp") REG("psp")
                        REG("primask") REG("basepri") REG("faultmask") REG(
                            "control") "</feature>"
                                       "<feature name=\"org.gnu.gdb.arm.vfp\">" DOUBLE("d0") DOUBLE(
                                           "d1") DOUBLE("d2") DOUBLE("d3") DOUBLE("d4") DOUBLE("d5")
                                           DOUBLE("d6") DOUBLE("d7") DOUBLE("d8") DOUBLE(
                                               "d9") DOUBLE("d10") DOUBLE("d11") DOUBLE("d12")
                                               DOUBLE("d13") DOUBLE("d14") DOUBLE(
                                                   "d15") "<reg name=\"fpscr\" bitsize=\"32\" type=\"int\"/></feature></target>";

static const enum core_register named[] = {[SP - SP] = CORE_SP,
                                           [LR - SP] = CORE_LR,
                                           [PC - SP] = CORE_PC,
                                           [XPSR - SP] = CORE_XPSR,
                                           [SYSTEM - SP] = CORE_MSP,
                                           CORE_PSP,
                                           CORE_PRIMASK,
                                           CORE_BASEPRI,
                                           CORE_FAULTMASK,
                                           CORE_CONTROL};

const char *chip_gdb_description(void)
{
    return description;
}

static unsigned bytes_of(unsigned number)
{
    return number >= D0 && number < FPSCR ? 8 : 4;
}

static uint64_t get(struct chip *chip, unsigned number)
{
    if (number < SP) {
        return core_get_general(&chip->core, number);
    }
    if (number == PC) {
        return chip->pc;
    }
    if (number >= D0 && number < FPSCR) {
        return core_get_double(&chip->core, number - D0);
    }
    return core_get(&chip->core, number == FPSCR ? CORE_FPSCR : named[number - SP]);
}

static void set(struct chip *chip, unsigned number, uint64_t value)
{
    if (number < SP) {
        core_set_general(&chip->core, number, (uint32_t)value);
    } else if (number == PC) {
        chip->pc = (uint32_t)value & ~1u;
    } else if (number >= D0 && number < FPSCR) {
        core_set_double(&chip->core, number - D0, value);
    } else {
        core_set(&chip->core, number == FPSCR ? CORE_FPSCR : named[number - SP], (uint32_t)value);
    }
}

unsigned chip_gdb_register_text(struct chip *chip, unsigned number, char *text)
{
    const uint64_t value = get(chip, number);

    for (unsigned i = 0; i < bytes_of(number); i++) {
        snprintf(text + 2 * i, 3, "%02x", (unsigned)(value >> (8 * i) & 0xFF));
    }
    return 2 * bytes_of(number);
}

static bool parse_byte(const char *hex, uint8_t *byte)
{
    unsigned value;
    char pair[3] = {hex[0], hex[0] != '\0' ? hex[1] : '\0', '\0'};
    const bool good =
        strspn(pair, "0123456789abcdefABCDEF") == 2 && sscanf(pair, "%2x", &value) == 1;

    *byte = good ? (uint8_t)value : 0;
    return good;
}

const char *chip_gdb_set_register(struct chip *chip, unsigned number, const char *text)
{
    uint64_t value = 0;

    for (unsigned i = 0; i < bytes_of(number); i++) {
        uint8_t byte;
        if (!parse_byte(text + 2 * i, &byte)) {
            return NULL;
        }
        value |= (uint64_t)byte << (8 * i);
    }
    set(chip, number, value);
    return text + 2 * (size_t)bytes_of(number);
}

/* What a debugger does is no misuse by the program. */
static uint32_t peek(struct chip *chip, uint32_t address)
{
    static char findings[CHIP_FINDINGS_MAX][CHIP_FINDING_BYTES];
    const uint64_t count = chip->finding_count;

    memcpy(findings, chip->findings, sizeof findings);
    const uint32_t value = chip_read(chip, address, 4);
    memcpy(chip->findings, findings, sizeof findings);
    chip->finding_count = count;
    return value;
}

bool chip_gdb_read_byte(struct chip *chip, uint32_t address, uint8_t *byte)
{
    static uint32_t word, word_address = UINT32_MAX;
    static uint64_t cycle;

    if (address - RAM_BASE < (uint32_t)CHIP_RAM_BYTES) {
        *byte = chip->ram[address - RAM_BASE];
    } else if (address - FLASH_BASE < (uint32_t)CHIP_FLASH_BYTES) {
        *byte = ((const uint8_t *)chip->flash_registers.word)[address - FLASH_BASE];
    } else if (address >= REGISTERS_BASE) {
        if (address % 4 == 0 || word_address != (address & ~3u) || cycle != chip->cycles) {
            word_address = address & ~3u;
            cycle = chip->cycles;
            word = peek(chip, word_address);
        }
        *byte = (uint8_t)(word >> (8 * (address % 4)));
    } else {
        return false;
    }
    return true;
}

static bool write_register(struct chip *chip, uint32_t address, const uint8_t *bytes)
{
    static char findings[CHIP_FINDINGS_MAX][CHIP_FINDING_BYTES];
    const uint64_t count = chip->finding_count;
    uint32_t value;

    memcpy(&value, bytes, 4);
    memcpy(findings, chip->findings, sizeof findings);
    chip_write(chip, address, 4, value);
    memcpy(chip->findings, findings, sizeof findings);
    chip->finding_count = count;
    return true;
}

bool chip_gdb_write(struct chip *chip, uint32_t address, uint32_t count, const char *hex)
{
    const uint32_t offset = address - RAM_BASE;
    const bool is_ram =
        offset < (uint32_t)CHIP_RAM_BYTES && count <= (uint32_t)CHIP_RAM_BYTES - offset;
    uint8_t word[4];

    if (!is_ram && (address < REGISTERS_BASE || address % 4 != 0 || count % 4 != 0)) {
        return false;
    }
    for (uint32_t i = 0; i < count; i++) {
        uint8_t byte;
        if (!parse_byte(hex + 2 * (size_t)i, &byte)) {
            return false;
        }
        if (is_ram) {
            chip->ram[offset + i] = byte;
        } else {
            word[i % 4] = byte;
            if (i % 4 == 3) {
                (void)write_register(chip, address + i - 3, word);
            }
        }
    }
    return true;
}
