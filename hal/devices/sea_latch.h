/* The frames of controlword and latch: sent on change and every SLOW_PDO_TICKS.
 *
 * A CiA 402 drive takes its controlword and, where its latch hangs at its outputs, these in one RPDO. A
 * latch board listens to a frame of its own with the outputs (hal/devices/latch_boards.h).
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

/* One of these frames: the words, and how many bytes of them go out from the first on. */
static inline enum can_result sea_latch_send_frame(struct sea_latch_sender *sender, uint32_t id,
                                                   uint16_t controlword, uint32_t outputs,
                                                   uint8_t first, uint8_t bytes,
                                                   const struct can_bus *bus)
{
    if (controlword == sender->sent_controlword && outputs == sender->sent_outputs &&
        sender->ticks_since_sent < SLOW_PDO_TICKS) {
        sender->ticks_since_sent++;
        return CAN_OK;
    }
    uint8_t words[6];
    struct can_msg message = {.id = id, .length = bytes};
    bytes_put_u16(words, controlword);
    bytes_put_u32(words + 2, outputs);
    for (uint8_t i = 0; i < bytes; i++) {
        message.data[i] = words[first + i];
    }
    const enum can_result result = can_bus_send(bus, &message);
    if (result == CAN_OK) {
        *sender = (struct sea_latch_sender){controlword, outputs, 1};
    }
    return result;
}

/* Once a tick. Returns what the bus said, CAN_OK when nothing was due; a refused
 * frame is due again at the next tick. */
static inline enum can_result sea_latch_send(struct sea_latch_sender *sender, enum side leg,
                                             uint16_t controlword, bool armed,
                                             const struct can_bus *bus)
{
    return sea_latch_send_frame(
        sender, leg == SIDE_LEFT ? FRAME_DRIVE_COMMAND_LEFT : FRAME_DRIVE_COMMAND_RIGHT,
        controlword, armed ? DRIVE_OUTPUT_LATCH_ARMED : 0, 0, FRAME_BYTES_DRIVE_COMMAND_LEFT, bus);
}

/* The same to a drive without outputs. */
static inline enum can_result sea_latch_send_controlword(struct sea_latch_sender *sender,
                                                         enum side leg, uint16_t controlword,
                                                         const struct can_bus *bus)
{
    return sea_latch_send_frame(
        sender, leg == SIDE_LEFT ? FRAME_DRIVE_COMMAND_LEFT : FRAME_DRIVE_COMMAND_RIGHT,
        controlword, 0, 0, sizeof controlword, bus);
}

/* The same to a latch board. */
static inline enum can_result sea_latch_send_outputs(struct sea_latch_sender *sender, enum side leg,
                                                     bool armed, const struct can_bus *bus)
{
    return sea_latch_send_frame(
        sender, leg == SIDE_LEFT ? FRAME_LATCH_COMMAND_LEFT : FRAME_LATCH_COMMAND_RIGHT, 0,
        armed ? DRIVE_OUTPUT_LATCH_ARMED : 0, sizeof(uint16_t), FRAME_BYTES_LATCH_COMMAND_LEFT,
        bus);
}

#endif
