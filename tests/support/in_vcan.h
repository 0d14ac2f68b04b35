/* For tests that need a real SocketCAN interface: runs this program again where there
 * is one (scripts/vcan-guest), unless it is there already. */
#ifndef TESTS_SUPPORT_IN_VCAN_H
#define TESTS_SUPPORT_IN_VCAN_H

#include <stdbool.h>

/* False for a program with AddressSanitizer on a machine without vcan0 of its own: its
 * shadow memory and the guest's address space exclude each other. */
bool in_vcan_is_possible(void);

/* Call first in main(). Returns where vcan0 exists; elsewhere the process is replaced
 * by scripts/vcan-guest running it (from the top of the tree), or ends with a message. */
void in_vcan_or_restart(char *const *argv);

#endif
