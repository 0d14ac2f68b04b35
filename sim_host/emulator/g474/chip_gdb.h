/* The emulated chip for a debugger: gdb attaches as to a board (`target remote`), reads and writes
 * registers and memory, sets breakpoints, steps, goes on and leaves.
 *
 * While the chip is halted, time stands still for it, the bus and the walker. A stop inside a block of
 * instructions counts what it has run of that block twice, so a debugged run has its own timing. A
 * debugger that leaves or dies lets the chip run on without breakpoints. Reads of peripherals' registers
 * act on them as the core's own would, but are no findings. Flash is not written.
 */
#ifndef SIM_HOST_EMULATOR_G474_CHIP_GDB_H
#define SIM_HOST_EMULATOR_G474_CHIP_GDB_H

#include "sim_host/emulator/g474/chip.h"
#include "sim_host/emulator/g474/gdb_link.h"

struct chip_gdb {
    struct chip *chip;
    struct gdb_link link;
    bool attached;
    char answer[GDB_PACKET_MAX];
};

/* Listens at 127.0.0.1 (port 0: one that is free), tells on standard error where, waits for a debugger
 * and halts the chip, which must have been started. Returns 0, or -1 with the reason in
 * gdb->link.message. */
int chip_gdb_open(struct chip_gdb *gdb, struct chip *chip, unsigned port);

/* The run is over: tells the debugger. */
void chip_gdb_close(struct chip_gdb *gdb);

#endif
