/* What the control task must hear, against what the board's filters let through. That the
 * FDCAN filters by these ranges is shown by tests/hal/port_fdcan/test_fdcan.c. */
#include "firmware/boards/nucleo_g474re/can_filters.h"
#include "hal/bus/can_frame.h"
#include "tests/support/assert_close.h"

#include <stdint.h>

static const struct {
    uint32_t first, last;
    int fifo;
} can_filters[] = {
#define FILTER(first, last, fifo) {first, last, fifo},
    CAN_FILTERS(FILTER)
#undef FILTER
};

static const struct {
    uint32_t id;
    unsigned sender;
    char kind;
} table[] = {
#define ENTRY(name, id, bytes, period_us, deadline_us, node, kind) {id, node, #kind[0]},
    FRAME_TABLE(ENTRY)
#undef ENTRY
};
enum {
    FRAMES = sizeof table / sizeof table[0],
    FILTERS = sizeof can_filters / sizeof can_filters[0]
};

/* The queue an identifier goes to; -1: rejected. The first filter that matches decides (RM0440,
 * FDCAN acceptance filter). */
static int queue_of(uint32_t id)
{
    for (size_t i = 0; i < FILTERS; i++) {
        if (id >= can_filters[i].first && id <= can_filters[i].last) {
            return can_filters[i].fifo;
        }
    }
    return -1;
}

START_TEST(what_others_send_is_heard)
{
    for (size_t i = 0; i < FRAMES; i++) {
        if (table[i].sender != NODE_CONTROLLER) {
            const bool cyclic = table[i].kind == 'S';
            ck_assert_msg(queue_of(table[i].id) == (cyclic ? 0 : 1), "%#x goes to queue %d",
                          table[i].id, queue_of(table[i].id));
        }
    }
}
END_TEST

START_TEST(a_second_master_is_heard)
{
    unsigned masters = 0;
    for (uint32_t id = 0; id <= CAN_ID_STANDARD_MAX; id++) {
        if (frame_is_masters(id)) {
            masters++;
            ck_assert_msg(queue_of(id) == 1, "%#x goes to queue %d", id, queue_of(id));
        }
    }
    ck_assert_uint_eq(masters, 8);
    ck_assert_int_eq(queue_of(FRAME_NMT), 1);
}
END_TEST

/* Whatever number a node has: and only the answers of every cycle share a queue. */
START_TEST(everything_is_heard_and_the_answers_apart)
{
    unsigned first_queue = 0;
    for (uint32_t id = 0; id <= CAN_ID_STANDARD_MAX; id++) {
        ck_assert_int_ge(queue_of(id), 0);
        first_queue += queue_of(id) == 0 ? 1 : 0;
    }
    ck_assert_uint_eq(first_queue, 6); /* drives, leg sensors, and ankle sensors of their own */
}
END_TEST

START_TEST(a_tool_that_asks_the_nodes_is_heard)
{
    unsigned requests = 0;
    for (uint32_t id = 0; id <= CAN_ID_STANDARD_MAX; id++) {
        if (frame_is_node_request(id)) {
            requests++;
            ck_assert_int_eq(queue_of(id), 1);
        }
    }
    ck_assert_uint_eq(requests, 126); /* CiA 301: 127 numbers, one of them its own */
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("board_filters");
    TCase *tests = tcase_create("all");
    tcase_add_test(tests, what_others_send_is_heard);
    tcase_add_test(tests, a_second_master_is_heard);
    tcase_add_test(tests, everything_is_heard_and_the_answers_apart);
    tcase_add_test(tests, a_tool_that_asks_the_nodes_is_heard);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
