/* What the board's FDCAN lets through: everything, as nodes may have any number and drives of other
 * protocols any identifier (hal/devices/device_nodes.h).
 *
 * FIFO 0 for the answers of every cycle, FIFO 1 for all else: neither can fill up with the
 * other's frames. Those that only the controller sends are among them: from anybody else they
 * are a fault (frame_is_masters), or SDO requests (frame_is_node_request).
 */
#ifndef FIRMWARE_BOARDS_NUCLEO_G474RE_CAN_FILTERS_H
#define FIRMWARE_BOARDS_NUCLEO_G474RE_CAN_FILTERS_H

#include "hal/bus/frame_table.h"

/* X(first identifier, last identifier, FIFO) */
#define CAN_FILTERS(X)                                               \
    X(FRAME_DRIVE_STATE_LEFT, FRAME_DRIVE_STATE_RIGHT, 0)            \
    X(FRAME_LEG_STATE_LEFT, FRAME_LEG_STATE_RIGHT, 0)                \
    X(FRAME_ANKLE_STATE_LEFT, FRAME_ANKLE_STATE_RIGHT, 0)            \
    X(FRAME_NMT, FRAME_NMT, 1)                                       \
    X(FRAME_SYNC, FRAME_EMCY_SENSOR_RIGHT, 1)                        \
    X(FRAME_DRIVE_TARGETS, FRAME_DRIVE_TARGETS, 1)                   \
    X(FRAME_DRIVE_COMMAND_LEFT, FRAME_DRIVE_COMMAND_RIGHT, 1)        \
    X(FRAME_DRIVE_SLOW_LEFT, FRAME_FOOT_RIGHT, 1)                    \
    X(FRAME_SDO_ANSWER_DRIVE_LEFT, FRAME_SDO_ANSWER_SENSOR_RIGHT, 1) \
    X(FRAME_SDO_REQUEST_CONTROLLER, FRAME_SDO_REQUEST_CONTROLLER, 1) \
    X(FRAME_HEARTBEAT_DRIVE_LEFT, FRAME_HEARTBEAT_CONTROLLER, 1)     \
    X(0x000, 0x7FF, 1)

#endif
