/* The latch's command frame, the same for every drive protocol.
 *
 * A CiA 402 drive takes it in the RPDO of its controlword; beside a drive that has
 * no outputs a latch board of its own listens to the same frame (node 1 or 2,
 * controlword ignored). Sent on change and every SLOW_PDO_TICKS.
 */
#ifndef HAL_DEVICES_SEA_LATCH_H
#define HAL_DEVICES_SEA_LATCH_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/bus/bytes.h"
#include "hal/bus/can_bus.h"
#include "hal/bus/frame_table.h"
#include "model/side.h"

struct sea_latch_sender {
    uint16_t sent_controlword;
    uint32_t sent_outputs;
    uint16_t ticks_since_sent;
};

static inline void sea_latch_sender_init(struct sea_latch_sender *sender)
{
    *sender = (struct sea_latch_sender){0, 0, SLOW_PDO_TICKS};
}

/* Once a tick. Returns what the bus said, CAN_OK when nothing was due; a refused
 * frame is due again at the next tick. */
static inline enum can_result sea_latch_send(struct sea_latch_sender *sender, enum side leg,
                                             uint16_t controlword, bool armed,
                                             const struct can_bus *bus)
{
    const uint32_t outputs = armed ? DRIVE_OUTPUT_LATCH_ARMED : 0;
    if (controlword == sender->sent_controlword && outputs == sender->sent_outputs &&
        sender->ticks_since_sent < SLOW_PDO_TICKS) {
        sender->ticks_since_sent++;
        return CAN_OK;
    }
    struct can_msg message = {.id = leg == SIDE_LEFT ? FRAME_DRIVE_COMMAND_LEFT
                                                     : FRAME_DRIVE_COMMAND_RIGHT,
                              .length = FRAME_BYTES_DRIVE_COMMAND_LEFT};
    bytes_put_u16(message.data, controlword);
    bytes_put_u32(message.data + 2, outputs);
    const enum can_result result = can_bus_send(bus, &message);
    if (result == CAN_OK) {
        *sender = (struct sea_latch_sender){controlword, outputs, 1};
    }
    return result;
}

#endif
