/* What the board's FDCAN lets through: every frame the control task looks at, nothing else.
 *
 * FIFO 0 for the answers of every cycle, FIFO 1 for all else: neither can fill up with the
 * other's frames. Those that only the controller sends are among them: from anybody else they
 * are a fault (frame_is_masters).
 */
#ifndef FIRMWARE_BOARDS_NUCLEO_G474RE_CAN_FILTERS_H
#define FIRMWARE_BOARDS_NUCLEO_G474RE_CAN_FILTERS_H

#include "hal/frame_table.h"
#include "hal/port_stm32g474/fdcan.h"

static const struct fdcan_filter can_filters[] = {
    {FRAME_DRIVE_STATE_LEFT, FRAME_DRIVE_STATE_RIGHT, 0},
    {FRAME_LEG_STATE_LEFT, FRAME_LEG_STATE_RIGHT, 0},
    {FRAME_NMT, FRAME_NMT, 1},
    {FRAME_SYNC, FRAME_EMCY_SENSOR_RIGHT, 1},
    {FRAME_DRIVE_TARGETS, FRAME_DRIVE_TARGETS, 1},
    {FRAME_DRIVE_COMMAND_LEFT, FRAME_DRIVE_COMMAND_RIGHT, 1},
    {FRAME_DRIVE_SLOW_LEFT, FRAME_DRIVE_SLOW_RIGHT, 1},
    {FRAME_SDO_ANSWER_DRIVE_LEFT, FRAME_SDO_ANSWER_SENSOR_RIGHT, 1},
    {FRAME_SDO_REQUEST_CONTROLLER, FRAME_SDO_REQUEST_CONTROLLER, 1},
    {FRAME_HEARTBEAT_DRIVE_LEFT, FRAME_HEARTBEAT_CONTROLLER, 1},
};

#endif
