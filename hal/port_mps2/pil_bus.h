/* A can_bus over two named pipes of the host: SYNC-paced lock-step.
 *
 * Sending queues; receiving hands out what the last exchange brought. The next
 * exchange happens when everything is handed out and a SYNC is queued.
 */
#ifndef HAL_PORT_MPS2_PIL_BUS_H
#define HAL_PORT_MPS2_PIL_BUS_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/bus/can_bus.h"
#include "hal/emergency_stop.h"
#include "hal/pil_record.h"

struct pil_bus {
    int from_host, to_host; /* semihosting handles */
    struct pil_record out;
    struct pil_record in;
    uint32_t next_in; /* frame of `in` to hand out */
    bool sync_queued;
    uint32_t inputs;                /* of the last answer; emergency stop before the first */
    uint32_t ticks;                 /* reported to the host; set by the main */
    uint32_t (*stack_unused)(void); /* asked now and then, for the host; set by the main */
    struct can_bus_status status;
};

/* Opens pipes "pil-in" (to here) and "pil-out" in the host's working directory and
 * says hello. Returns false when there are no such pipes. Blocks like the host. */
bool pil_bus_open(struct pil_bus *bus, const struct pil_hello *hello);

/* The bus interface on *bus; receive may block in an exchange. */
struct can_bus pil_bus_interface(struct pil_bus *bus);

/* The emergency stop as the host's last answer says; pressed before the first. */
struct emergency_stop pil_bus_emergency_stop(struct pil_bus *bus);

#endif
