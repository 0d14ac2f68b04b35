/* What the commands on a real bus have in common: the options that every one of them
 * takes, how they are asked to end, and what they say about an interface that cannot be had.
 */
#ifndef SIM_HOST_CLI_BUS_PROGRAM_H
#define SIM_HOST_CLI_BUS_PROGRAM_H

#include <argp.h>
#include <signal.h>
#include <stdbool.h>
#include <stdint.h>

/* More steps than anybody walks: two weeks in real time. */
enum { BUS_PROGRAM_STEPS_MAX = 1000000 };

struct bus_options {
    const char *interface; /* never NULL after parsing */
    uint32_t steps;        /* 0 = until asked to end */
    bool json;
    bool quiet;
};

/* Child parser: its input is a struct bus_options, zero at the start. --can must be given. */
extern const struct argp bus_options_parser;

/* SIGINT, SIGTERM and SIGHUP (unless it was ignored at the start, as nohup(1) does) end a
 * wait in the kernel and are remembered. SIGPIPE is ignored: who writes sees the error. */
void bus_program_catch_signals(void);

/* Whether one of them has come. */
bool bus_program_is_to_end(void);

/* Says on standard error why `interface` cannot be had; error: what socketcan_bus_open()
 * returned. */
void bus_program_no_interface(const char *interface, int error);

#endif
