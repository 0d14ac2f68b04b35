#include "hal/devices/latch_boards.h"

void latch_boards_init(struct latch_boards *boards, const bool present[SIDE_COUNT])
{
    *boards = (struct latch_boards){0};
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        boards->board[leg].present = present[leg];
        boards->board[leg].age_ticks = UINT16_MAX;
        sea_latch_sender_init(&boards->board[leg].sender);
    }
}

bool latch_boards_receive(struct latch_boards *boards, const struct can_msg *message)
{
    const bool right = message->id == FRAME_LATCH_STATE_RIGHT;
    struct latch_board *board = &boards->board[right ? SIDE_RIGHT : SIDE_LEFT];
    if ((message->id != FRAME_LATCH_STATE_LEFT && !right) || !board->present) {
        return false;
    }
    if (message->length != FRAME_BYTES_LATCH_STATE_LEFT || message->flags != 0) {
        if (boards->rx_malformed < UINT32_MAX) {
            boards->rx_malformed++;
        }
        return true;
    }
    board->holds = message->data[0] != 0;
    board->age_ticks = 0;
    return true;
}

enum latch_state latch_boards_state(const struct latch_boards *boards, enum side leg)
{
    const struct latch_board *board = &boards->board[leg];
    if (board->age_ticks > HEARTBEAT_TIMEOUT_TICKS) {
        return LATCH_UNKNOWN;
    }
    return board->holds ? LATCH_CLOSED : LATCH_OPEN;
}

void latch_boards_age(struct latch_boards *boards)
{
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        uint16_t *age = &boards->board[leg].age_ticks;
        if (*age < UINT16_MAX) {
            (*age)++;
        }
    }
}

enum can_result latch_boards_arm(struct latch_boards *boards, enum side leg, bool armed,
                                 const struct can_bus *bus)
{
    struct latch_board *board = &boards->board[leg];
    return board->present ? sea_latch_send_outputs(&board->sender, leg, armed, bus) : CAN_OK;
}
