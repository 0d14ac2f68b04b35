/* A can_bus over UART 0 to an adapter that speaks slcan (LAWICEL): for boards
 * without a CAN controller.
 *
 * The adapter acknowledges each frame when it was on the bus; the acknowledgement
 * of the own SYNC is its echo. Polled: receive() empties the UART.
 */
#ifndef HAL_PORT_MPS2_UART_SLCAN_BUS_H
#define HAL_PORT_MPS2_UART_SLCAN_BUS_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/bus/can_bus.h"
#include "hal/bus/slcan_channel.h"

struct uart_slcan_bus {
    struct slcan_channel channel;
    struct can_bus_status status;
};

/* Sets the UART up and opens the adapter's channel at the bit rate of the bus (slcan_open_commands). */
void uart_slcan_bus_open(struct uart_slcan_bus *bus);

struct can_bus uart_slcan_bus_interface(struct uart_slcan_bus *bus);

#endif
