#include "hal/port_mps2/uart_slcan_bus.h"

#include <string.h>

#include "hal/bus/frame_table.h"
#include "hal/bus/slcan_rate.h"
#include "hal/port_mps2/mps2_registers.h"

enum { UART_DIVISOR = 16 }; /* 25 MHz / 16 = 1.5625 Mbaud, the fastest */

static void put_byte(char byte)
{
    while ((UART0_STATE & UART_STATE_TX_FULL) != 0u) {
        /* one byte's time; the watchdog guards against a UART that never sends */
    }
    UART0_DATA = (uint32_t)(uint8_t)byte;
}

static void put_text(const char *text, size_t length)
{
    for (size_t i = 0; i < length; i++) {
        put_byte(text[i]);
    }
}

void uart_slcan_bus_open(struct uart_slcan_bus *bus)
{
    memset(bus, 0, sizeof *bus);
    slcan_channel_init(&bus->channel);
    UART0_BAUDDIV = UART_DIVISOR;
    UART0_CTRL = UART_CTRL_TX_RX;
    put_text(slcan_open_commands, SLCAN_OPEN_COMMANDS_LENGTH);
}

static enum can_result bus_send(void *context, const struct can_msg *message)
{
    struct uart_slcan_bus *bus = context;
    char line[SLCAN_LINE_MAX];
    size_t length = slcan_encode(message, line);

    if (length == 0) {
        return CAN_INVALID;
    }
    if (!slcan_channel_sent(&bus->channel, message->id)) {
        bus->status.tx_refused++;
        return CAN_FULL;
    }
    put_text(line, length);
    return CAN_OK;
}

static enum can_result bus_receive(void *context, struct can_msg *message, uint64_t *time_ns)
{
    struct uart_slcan_bus *bus = context;

    if (time_ns != NULL) {
        *time_ns = 0; /* the line tells none */
    }
    while ((UART0_STATE & UART_STATE_RX_FULL) != 0u) {
        switch (slcan_channel_receive(&bus->channel, (char)UART0_DATA)) {
        case SLCAN_FRAME:
            *message = bus->channel.decoder.message;
            bus->status.rx_frames++;
            return CAN_OK;
        case SLCAN_ACKNOWLEDGED:
            bus->status.tx_frames++;
            if (bus->channel.answered_id == FRAME_SYNC) {
                *message = (struct can_msg){.id = FRAME_SYNC, .flags = CAN_FRAME_OWN};
                return CAN_OK;
            }
            break;
        case SLCAN_REFUSED:
        case SLCAN_MALFORMED:
            bus->status.error_frames++;
            break;
        case SLCAN_NOTHING:
        case SLCAN_DONE:
        case SLCAN_OTHER:
            break;
        }
    }
    return CAN_EMPTY;
}

static void bus_get_status(void *context, struct can_bus_status *status)
{
    const struct uart_slcan_bus *bus = context;
    *status = bus->status;
}

static void bus_recover(void *context)
{
    (void)context; /* the adapter's own doing */
}

static const struct can_bus_ops bus_ops = {bus_send, bus_receive, bus_get_status, bus_recover};

struct can_bus uart_slcan_bus_interface(struct uart_slcan_bus *bus)
{
    struct can_bus interface = {&bus_ops, bus};
    return interface;
}
