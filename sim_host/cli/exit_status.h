/* What every command of afo ends with. */
#ifndef SIM_HOST_CLI_EXIT_STATUS_H
#define SIM_HOST_CLI_EXIT_STATUS_H

/* Scripts and tests rely on the values: they never change meaning. A command's --help says what its
 * "no" is. */
enum exit_status {
    EXIT_GOOD = 0, /* yes: walked, equal, found, written, safe, or help was printed */
    EXIT_BAD = 1,  /* no: fell, stopped by a fault, differs, not found, unsafe */
    EXIT_USAGE =
        2 /* no answer: wrong usage, input or interface, or the output could not be written */
};

#endif
