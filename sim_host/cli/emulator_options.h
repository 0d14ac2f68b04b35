/* The options of every command that walks with the flashed object code on an emulated processor. */
#ifndef SIM_HOST_CLI_EMULATOR_OPTIONS_H
#define SIM_HOST_CLI_EMULATOR_OPTIONS_H

#include <argp.h>
#include <stdbool.h>
#include <stdint.h>

struct emulator_options {
    const char *image;
    uint32_t steps, steps_max;
    uint64_t corrupt_frame; /* 0 = none */
    bool json, quiet;
};

/* Child parser: its input is a struct emulator_options, set up by emulator_options_init. */
extern const struct argp emulator_options_parser;

/* steps: the default. */
void emulator_options_init(struct emulator_options *options, uint32_t steps, uint32_t steps_max);

#endif
