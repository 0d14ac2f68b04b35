/* What a debugger sees of the chip: its registers by gdb's numbers, and its memory. */
#ifndef SIM_HOST_EMULATOR_G474_CHIP_GDB_TARGET_H
#define SIM_HOST_EMULATOR_G474_CHIP_GDB_TARGET_H

#include "sim_host/emulator/g474/chip.h"

/* R0 to R12, SP, LR, PC, xPSR; MSP, PSP, PRIMASK, BASEPRI, FAULTMASK, CONTROL; D0 to D15, FPSCR. */
enum { CHIP_GDB_REGISTERS = 17 + 6 + 17 };

/* The same for gdb (GDB manual, appendix G, "ARM Features"). */
const char *chip_gdb_description(void);

/* Writes a register in hexadecimal, its lowest byte first; returns the number of characters. */
unsigned chip_gdb_register_text(struct chip *chip, unsigned number, char *text);
/* Sets one from such a text; returns what stands behind it, or NULL. */
const char *chip_gdb_set_register(struct chip *chip, unsigned number, const char *text);

/* False where nothing is. Registers of peripherals are read by words. */
bool chip_gdb_read_byte(struct chip *chip, uint32_t address, uint8_t *byte);
/* `hex` has two digits a byte. RAM, and words of registers; false elsewhere. */
bool chip_gdb_write(struct chip *chip, uint32_t address, uint32_t count, const char *hex);

#endif
