/* Every frame of the orthosis bus: identifier, length, period, deadline.
 *
 * The one source that the code, the EDS files, the DBC and the bus budget share.
 * Columns of FRAME_TABLE(X):
 *   X(NAME, identifier, data bytes, period_us, deadline_us, sender node, kind)
 * period_us is the shortest time between two such frames while walking (SDO: one
 * transfer with each node in 50 ms; tools that ask faster slow down each other and, at
 * the lowest priority, the heartbeats); deadline_us counts
 * from the SYNC (or from queueing, for frames without SYNC) to the end of the
 * frame on the bus. kind: S = sent at every SYNC, N = every Nth SYNC, E = event
 * with inhibit time, A = asynchronous, O = as E, by optional hardware only.
 */
#ifndef HAL_BUS_FRAME_TABLE_H
#define HAL_BUS_FRAME_TABLE_H

#include <assert.h>
#include <stdbool.h>
#include <stdint.h>

#include "model/tick.h"

/* The nodes that the controller sets up, starts and watches, in this order: X(NAME, number,
 * CiA profile). At most 8; their frames are rows of the table below. */
#define NODE_TABLE(X)      \
    X(DRIVE_LEFT, 1, 402)  \
    X(DRIVE_RIGHT, 2, 402) \
    X(SENSOR_LEFT, 3, 406) \
    X(SENSOR_RIGHT, 4, 406)

#define NODE_ID_ENTRY(name, number, profile) NODE_##name = number,
enum node_id { NODE_TABLE(NODE_ID_ENTRY) NODE_CONTROLLER = 16 };
#undef NODE_ID_ENTRY

enum {
    SLOW_PDO_TICKS = TICKS_OF_MS(100),
    HEARTBEAT_PERIOD_MS = 100,
    HEARTBEAT_TIMEOUT_MS = 250,
    HEARTBEAT_TIMEOUT_TICKS = TICKS_OF_MS(HEARTBEAT_TIMEOUT_MS),
    FOOT_INHIBIT_TICKS = 5, /* FOOT is sent on change, at most once in so many ticks, */
    FOOT_REPEAT_MS = 50,    /* and at least once in this time */
    FOOT_AGE_MAX_TICKS = TICKS_OF_MS(120)
};

/* bit/s. A build may choose another, with a tick that fits it (scripts/bus-budget). */
#ifndef BUS_BITRATE
#define BUS_BITRATE 1000000
#endif
static_assert(BUS_BITRATE >= 10000 && BUS_BITRATE <= 1000000, "classic CAN: 10 kbit/s to 1 Mbit/s");
static_assert(SLOW_PDO_TICKS >= 1 && SLOW_PDO_TICKS <= 240, "a PDO comes at most every 240th SYNC");

/* A time in the table that goes with the tick. */
#define FRAME_TICKS(n) ((n)*TICK_PERIOD_US)

#define FRAME_TABLE(X)                                                      \
    X(NMT, 0x000, 2, 100000, 100000, 16, A)                                 \
    X(SYNC, 0x080, 0, FRAME_TICKS(1), FRAME_TICKS(1), 16, S)                \
    X(EMCY_DRIVE_LEFT, 0x081, 8, 10000, 10000, 1, E)                        \
    X(EMCY_DRIVE_RIGHT, 0x082, 8, 10000, 10000, 2, E)                       \
    X(EMCY_SENSOR_LEFT, 0x083, 8, 10000, 10000, 3, E)                       \
    X(EMCY_SENSOR_RIGHT, 0x084, 8, 10000, 10000, 4, E)                      \
    X(EMCY_CONTROLLER, 0x090, 8, 10000, 10000, 16, E)                       \
    X(DRIVE_STATE_LEFT, 0x181, 6, FRAME_TICKS(1), FRAME_TICKS(1), 1, S)     \
    X(DRIVE_STATE_RIGHT, 0x182, 6, FRAME_TICKS(1), FRAME_TICKS(1), 2, S)    \
    X(TELEMETRY, 0x390, 8, 100000, 50000, 16, E)                            \
    X(DRIVE_TARGETS, 0x201, 8, FRAME_TICKS(1), FRAME_TICKS(1), 16, S)       \
    X(LEG_STATE_LEFT, 0x283, 5, FRAME_TICKS(1), FRAME_TICKS(1), 3, S)       \
    X(LEG_STATE_RIGHT, 0x284, 5, FRAME_TICKS(1), FRAME_TICKS(1), 4, S)      \
    X(CONTROLLER_STATE, 0x290, 6, 10000, 10000, 16, E)                      \
    X(DRIVE_COMMAND_LEFT, 0x301, 6, FRAME_TICKS(2), FRAME_TICKS(5), 16, E)  \
    X(DRIVE_COMMAND_RIGHT, 0x302, 6, FRAME_TICKS(2), FRAME_TICKS(5), 16, E) \
    X(DRIVE_SLOW_LEFT, 0x381, 8, 100000, 50000, 1, N)                       \
    X(DRIVE_SLOW_RIGHT, 0x382, 8, 100000, 50000, 2, N)                      \
    X(FOOT_LEFT, 0x383, 1, FRAME_TICKS(5), FRAME_TICKS(5), 3, O)            \
    X(FOOT_RIGHT, 0x384, 1, FRAME_TICKS(5), FRAME_TICKS(5), 4, O)           \
    X(SDO_ANSWER_DRIVE_LEFT, 0x581, 8, 50000, 100000, 1, A)                 \
    X(SDO_ANSWER_DRIVE_RIGHT, 0x582, 8, 50000, 100000, 2, A)                \
    X(SDO_ANSWER_SENSOR_LEFT, 0x583, 8, 50000, 100000, 3, A)                \
    X(SDO_ANSWER_SENSOR_RIGHT, 0x584, 8, 50000, 100000, 4, A)               \
    X(SDO_ANSWER_CONTROLLER, 0x590, 8, 50000, 100000, 16, A)                \
    X(SDO_REQUEST_DRIVE_LEFT, 0x601, 8, 50000, 100000, 16, A)               \
    X(SDO_REQUEST_DRIVE_RIGHT, 0x602, 8, 50000, 100000, 16, A)              \
    X(SDO_REQUEST_SENSOR_LEFT, 0x603, 8, 50000, 100000, 16, A)              \
    X(SDO_REQUEST_SENSOR_RIGHT, 0x604, 8, 50000, 100000, 16, A)             \
    X(SDO_REQUEST_CONTROLLER, 0x610, 8, 50000, 100000, 0, A)                \
    X(HEARTBEAT_DRIVE_LEFT, 0x701, 1, 100000, 100000, 1, A)                 \
    X(HEARTBEAT_DRIVE_RIGHT, 0x702, 1, 100000, 100000, 2, A)                \
    X(HEARTBEAT_SENSOR_LEFT, 0x703, 1, 100000, 100000, 3, A)                \
    X(HEARTBEAT_SENSOR_RIGHT, 0x704, 1, 100000, 100000, 4, A)               \
    X(HEARTBEAT_CONTROLLER, 0x710, 1, 100000, 100000, 16, A)

/* Frames that only some devices have: a target of its own for a drive that has no dummy entries
 * (then that of the left one has 4 bytes, too), latch boards, and ankle sensors on nodes of their own
 * (then LEG_STATE has the leg angle alone). Columns as above. */
#define FRAME_OPTIONAL_TABLE(X)                                             \
    X(DRIVE_TARGET_RIGHT, 0x202, 4, FRAME_TICKS(1), FRAME_TICKS(1), 16, S)  \
    X(LATCH_COMMAND_LEFT, 0x303, 4, FRAME_TICKS(2), FRAME_TICKS(5), 16, E)  \
    X(LATCH_COMMAND_RIGHT, 0x304, 4, FRAME_TICKS(2), FRAME_TICKS(5), 16, E) \
    X(LATCH_STATE_LEFT, 0x385, 1, 20000, 10000, 5, E)                       \
    X(LATCH_STATE_RIGHT, 0x386, 1, 20000, 10000, 6, E)                      \
    X(ANKLE_STATE_LEFT, 0x287, 2, FRAME_TICKS(1), FRAME_TICKS(1), 7, S)     \
    X(ANKLE_STATE_RIGHT, 0x288, 2, FRAME_TICKS(1), FRAME_TICKS(1), 8, S)

#define FRAME_ID_ENTRY(name, id, bytes, period_us, deadline_us, node, kind) FRAME_##name = id,
enum frame_id { FRAME_TABLE(FRAME_ID_ENTRY) FRAME_OPTIONAL_TABLE(FRAME_ID_ENTRY) };
#undef FRAME_ID_ENTRY

#define FRAME_BYTES_ENTRY(name, id, bytes, period_us, deadline_us, node, kind) \
    FRAME_BYTES_##name = bytes,
enum frame_bytes { FRAME_TABLE(FRAME_BYTES_ENTRY) FRAME_OPTIONAL_TABLE(FRAME_BYTES_ENTRY) };
#undef FRAME_BYTES_ENTRY

/* Frames by which the nodes are led: on this bus they come from the controller only. From
 * anybody else they are a reason to stop, so a controller must hear them. */
static inline bool frame_is_masters(uint32_t id)
{
    return id == FRAME_SYNC || id == FRAME_DRIVE_TARGETS || id == FRAME_DRIVE_COMMAND_LEFT ||
           id == FRAME_DRIVE_COMMAND_RIGHT || id == FRAME_HEARTBEAT_CONTROLLER ||
           id == FRAME_DRIVE_TARGET_RIGHT || id == FRAME_LATCH_COMMAND_LEFT ||
           id == FRAME_LATCH_COMMAND_RIGHT;
}

/* SDO requests go to this identifier and the number of the node (CiA 301, 7.3.5). */
enum { FRAME_SDO_ANSWER_BASE = 0x580, FRAME_SDO_REQUEST_BASE = 0x600, NODE_NUMBER_LAST = 127 };

/* SDO requests to nodes of any number but the controller's: while they run only the controller
 * configures its nodes, so it must hear who else asks. */
static inline bool frame_is_node_request(uint32_t id)
{
    return id > FRAME_SDO_REQUEST_BASE && id <= FRAME_SDO_REQUEST_BASE + NODE_NUMBER_LAST &&
           id != FRAME_SDO_REQUEST_CONTROLLER;
}

/* What the numbers in the frames mean. */
enum {
    LEG_ANGLE_COUNTS_PER_TURN = 1 << 24, /* LEG_STATE bytes 0..2, signed */
    ANKLE_COUNTS_PER_METRE = 100000,     /* LEG_STATE bytes 3..4, signed, linear ankle */
    ANKLE_COUNTS_PER_TURN = 1 << 16,     /* the same bytes, lever ankle */
    FOOT_IS_DOWN = 1 << 0,               /* FOOT byte 0: the switch is closed, */
    FOOT_HAS_FAULT = 1 << 1,             /* or does not know */
    DRIVE_OUTPUT_LATCH_ARMED = 1 << 16   /* object 0x60FE:01 */
};

#endif
