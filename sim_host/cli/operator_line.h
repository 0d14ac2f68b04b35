/* The operator's line: what a person asks of the controller goes over the bus.
 *
 * The control task obeys node 16's object dictionary. A program that runs the task could
 * write into it, but then a log of the bus would not hold what moved the controller, and
 * could not be replayed. So its wishes travel like those of any other tool: by SDO, through
 * an opening of the bus of their own, which the task's one hears.
 */
#ifndef SIM_HOST_CLI_OPERATOR_LINE_H
#define SIM_HOST_CLI_OPERATOR_LINE_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/bus/can_bus.h"
#include "hal/canopen/co_sdo_client.h"

/* Subindices of object 0x2000 (firmware/controller_objects.c). */
enum operator_command { OPERATOR_WALK = 2, OPERATOR_RESET = 3 };

struct operator_line {
    struct can_bus bus;
    struct co_sdo_client client;
    bool under_way;
    uint8_t identity_asked; /* sub-indices of 0x2030 so far */
};

/* bus: not the task's own, for that does not hear what it sends; it need receive the
 * controller's SDO answers only, and stays the caller's. */
void operator_line_init(struct operator_line *line, struct can_bus bus);

/* Sends 0x2000:wish = value, unless the last wish is still under way; whether it was taken
 * shows in the object. now_ns: CLOCK_MONOTONIC. */
void operator_line_ask(struct operator_line *line, enum operator_command wish, uint8_t value,
                       uint64_t now_ns);

/* Reads 0x2030:02 and :03, the controller's build and parameters, one after the other: what they
 * are does not matter here, but a log of the bus then names them. Call it until it returns
 * false: then both were asked for. */
bool operator_line_ask_identity(struct operator_line *line, uint64_t now_ns);

/* Once a cycle: takes the answer. One system call while a wish is under way, else none. */
void operator_line_poll(struct operator_line *line, uint64_t now_ns);

#endif
