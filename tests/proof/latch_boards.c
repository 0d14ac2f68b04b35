/* Latches on boards of their own: frames of any content, in any order, for legs with and without a board. */
#include "hal/devices/latch_boards.h"
#include "tests/proof/arbitrary.h"

static struct latch_boards boards;

void proof_latch_boards(void)
{
    bool present[SIDE_COUNT];
    present[SIDE_LEFT] = any_bool();
    present[SIDE_RIGHT] = any_bool();
    latch_boards_init(&boards, present);
    for (;;) {
        struct can_msg message;
        const enum side leg = any_bool() ? SIDE_RIGHT : SIDE_LEFT;
        any_message(&message);
        (void)latch_boards_receive(&boards, &message);
        if (any_bool()) {
            latch_boards_age(&boards);
        }
        const enum latch_state state = latch_boards_state(&boards, leg);
        //@ assert state: LATCH_UNKNOWN <= state <= LATCH_OPEN;
        (void)state;
        (void)latch_boards_arm(&boards, leg, any_bool(), &any_bus);
    }
}
