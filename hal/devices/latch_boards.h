/* Latches on boards of their own: armed by a frame of outputs, heard in one of their state.
 *
 * A board is a CANopen node with output 0x60FE:01 (or what it maps there) in RPDO1, and, if it tells,
 * one byte in TPDO1 that is not 0 while the latch holds: on change, repeated slowly.
 */
#ifndef HAL_DEVICES_LATCH_BOARDS_H
#define HAL_DEVICES_LATCH_BOARDS_H

#include "hal/devices/sea_latch.h"
#include "model/sea_state.h"

struct latch_board {
    struct sea_latch_sender sender;
    uint16_t age_ticks; /* of what it told; UINT16_MAX = never */
    bool present;       /* this leg has a board */
    bool holds;
};

struct latch_boards {
    struct latch_board board[SIDE_COUNT];
    uint32_t rx_malformed; /* saturates */
};

/* present[leg]: that leg's latch is on a board. */
void latch_boards_init(struct latch_boards *boards, const bool present[SIDE_COUNT]);

/* Takes a frame if a board sent it, and says whether it did. O(1). */
bool latch_boards_receive(struct latch_boards *boards, const struct can_msg *message);

/* What a board told last; LATCH_UNKNOWN when it does not tell, or has been silent for
 * HEARTBEAT_TIMEOUT_MS. */
enum latch_state latch_boards_state(const struct latch_boards *boards, enum side leg);

/* A cycle has ended. */
void latch_boards_age(struct latch_boards *boards);

/* Once a tick: arms or disarms. Returns what the bus said, CAN_OK when nothing was due. */
enum can_result latch_boards_arm(struct latch_boards *boards, enum side leg, bool armed,
                                 const struct can_bus *bus);

#endif
