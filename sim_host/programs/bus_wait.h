/* How time passes for a command that asks nodes over a real bus: the waits of sdo_upload.h and ctl.h. */
#ifndef SIM_HOST_PROGRAMS_BUS_WAIT_H
#define SIM_HOST_PROGRAMS_BUS_WAIT_H

#include <stdbool.h>

/* One wait for frames, of 20 ms at most; waits: how many there were for this answer. context: a struct
 * socketcan_bus. Asks for recovery in the first and then each fifth wait (it is none unless the bus is off),
 * and passes on the bus' advice. Returns whether to go on: false after two seconds, and when the command is
 * to end. */
bool bus_wait(void *context, unsigned waits);

/* Takes frames, unread, for so many milliseconds. Returns false when the command is to end. */
bool bus_wait_pause(void *context, unsigned milliseconds);

#endif
