/* Heartbeats both ways and NMT start, against the frames of CiA 301. */
#include "hal/bus/frame_table.h"
#include "hal/canopen/network.h"
#include "tests/support/assert_close.h"
#include "tests/support/fake_bus.h"

static void hear(struct network *network, uint32_t id, uint8_t state)
{
    const struct can_msg frame = {.id = id, .length = 1, .data = {state}};
    ck_assert(network_receive(network, &frame));
}

static void hear_all(struct network *network, uint8_t state)
{
    for (uint32_t node = 1; node <= 4; node++) {
        hear(network, 0x700 + node, state);
    }
}

START_TEST(nodes_are_started_one_by_one_and_become_operational)
{
    struct fake_bus fake;
    struct network network;
    fake_bus_init(&fake);
    const struct can_bus bus = fake_bus_interface(&fake);
    network_init(&network);
    network_update(&network, &bus, 0xF);
    ck_assert_uint_eq(fake_bus_count(&fake, 0x000), 0);
    hear_all(&network, 0); /* boot-up */
    network_update(&network, &bus, 0xF);
    ck_assert_uint_eq(fake_bus_count(&fake, 0x000), 4);
    for (uint8_t i = 0; i < 4; i++) {
        const struct can_msg *start = &fake.sent[fake.sent_count - 4 + i];
        ck_assert_int_eq(start->length, 2);
        ck_assert_int_eq(start->data[0], 1);
        ck_assert_int_eq(start->data[1], i + 1);
    }
    ck_assert(!network_all_operational(&network));
    hear_all(&network, 5);
    ck_assert(network_all_operational(&network));
    hear(&network, 0x703, 4); /* stopped */
    ck_assert(!network_all_operational(&network));
}
END_TEST

START_TEST(start_waits_for_permission_and_is_repeated)
{
    struct fake_bus fake;
    struct network network;
    fake_bus_init(&fake);
    const struct can_bus bus = fake_bus_interface(&fake);
    network_init(&network);
    for (int tick = 0; tick < 200; tick++) {
        hear_all(&network, 127);
        network_update(&network, &bus, 0x2); /* only node 2 may start */
    }
    const unsigned starts = fake_bus_count(&fake, 0x000);
    ck_assert_uint_ge(starts, 3);
    ck_assert_uint_le(starts, 5);
    for (unsigned i = 0; i < fake.sent_count; i++) {
        ck_assert(fake.sent[i].id != 0x000 || fake.sent[i].data[1] == 2);
    }
}
END_TEST

/* An emergency has eight bytes; what has fewer, or is a question, tells of no error and clears none. */
START_TEST(an_emergency_that_is_none_changes_nothing)
{
    struct network network;
    struct can_msg frame = {.id = 0x082, .length = 8, .data = {0x10, 0x23, 0x03}};
    network_init(&network);
    frame.length = 7;
    ck_assert(network_receive(&network, &frame)); /* its identifier all the same */
    frame.length = 8;
    frame.flags = CAN_FRAME_REMOTE;
    ck_assert(network_receive(&network, &frame));
    ck_assert(!network_has_error(&network));
    frame.flags = 0;
    ck_assert(network_receive(&network, &frame));
    ck_assert(network_has_error(&network));
    frame.data[0] = frame.data[1] = frame.data[2] =
        0; /* the error has gone, and no other is left */
    frame.length = 2;
    ck_assert(network_receive(&network, &frame));
    ck_assert(network_has_error(&network));
    frame.length = 8;
    ck_assert(network_receive(&network, &frame));
    ck_assert(!network_has_error(&network));
}
END_TEST

START_TEST(silence_is_noticed_within_the_time_out)
{
    struct fake_bus fake;
    struct network network;
    fake_bus_init(&fake);
    const struct can_bus bus = fake_bus_interface(&fake);
    network_init(&network);
    hear_all(&network, 5);
    for (int tick = 0; tick < HEARTBEAT_TIMEOUT_TICKS; tick++) {
        ck_assert(network_all_operational(&network));
        hear(&network, 0x701, 5);
        hear(&network, 0x702, 5);
        hear(&network, 0x704, 5);
        network_update(&network, &bus, 0xF);
    }
    network_update(&network, &bus, 0xF);
    ck_assert(!network_all_operational(&network));
    hear(&network, 0x703, 5);
    ck_assert(network_all_operational(&network));
}
END_TEST

/* CiA 301, 7.2.7: an emergency about the device itself, until code 0 or a boot-up. */
START_TEST(an_error_of_a_node_is_a_node_lost)
{
    struct network network;
    struct can_msg emergency = {.id = 0x083, .length = 8, .data = {0x00, 0x50}};
    network_init(&network);
    hear_all(&network, 5);
    ck_assert(network_receive(&network, &emergency));
    ck_assert(!network_all_operational(&network));
    ck_assert(network_has_error(&network));
    emergency.data[1] = 0x00; /* over */
    ck_assert(network_receive(&network, &emergency));
    ck_assert(!network_has_error(&network));
    ck_assert(network_all_operational(&network));
    emergency.data[1] = 0x81; /* communication: left to its time-outs */
    ck_assert(network_receive(&network, &emergency));
    emergency.data[1] = 0x82;
    ck_assert(network_receive(&network, &emergency));
    ck_assert(network_all_operational(&network));
    emergency.data[1] = 0x50;
    emergency.length = 7; /* malformed */
    ck_assert(network_receive(&network, &emergency));
    ck_assert(network_all_operational(&network));
    emergency.length = 8;
    emergency.id = 0x081;
    ck_assert(network_receive(&network, &emergency));
    ck_assert(!network_all_operational(&network));
    hear(&network, 0x701, 0); /* it has booted */
    hear(&network, 0x701, 5);
    ck_assert(network_all_operational(&network));
    emergency.id = 0x085;
    ck_assert(!network_receive(&network, &emergency));
}
END_TEST

/* CiA 301, 7.2.7.1: code 0 ends one error; as long as the error register, byte 2, is not 0 the node has others.
 * Communication (bit 4, with the generic bit 0) is left to its time-outs here too. */
START_TEST(code_0_with_errors_left_in_the_register_is_no_end)
{
    static const struct {
        uint8_t error_register;
        bool error;
    } cases[] = {{0x00, false}, {0x01, true},  {0x05, true}, {0x08, true},
                 {0x11, false}, {0x10, false}, {0x19, true}, {0x80, true}};
    struct network network;
    struct can_msg emergency = {.id = 0x081, .length = 8, .data = {0x10, 0x42, 0x09}};
    network_init(&network);
    hear_all(&network, 5);
    ck_assert(network_receive(&network, &emergency));
    emergency.data[0] = emergency.data[1] = 0;
    emergency.data[2] = cases[_i].error_register;
    ck_assert(network_receive(&network, &emergency));
    ck_assert(network_has_error(&network) == cases[_i].error);
    /* Nobody heard what it was: the register alone is enough. */
    network_init(&network);
    hear_all(&network, 5);
    ck_assert(network_receive(&network, &emergency));
    ck_assert(network_has_error(&network) == cases[_i].error);
}
END_TEST

/* Its boot-up got lost: it was operational, and now waits without anybody having asked it to. */
START_TEST(a_node_that_falls_back_has_booted)
{
    struct fake_bus fake;
    struct network network;
    fake_bus_init(&fake);
    const struct can_bus bus = fake_bus_interface(&fake);
    network_init(&network);
    hear_all(&network, 0);
    network_clear_booted(&network);
    network_update(&network, &bus, 0xF);
    hear_all(&network, 5);
    hear(&network, 0x702, 127);
    ck_assert(network.node[1].booted);
    ck_assert(!network.node[0].booted && !network.node[2].booted);
    /* One that was asked to has not. */
    network_clear_booted(&network);
    (void)network_enter_pre_operational(&network, &bus, 1);
    ck_assert_uint_eq(fake.sent[fake.sent_count - 1].data[0], 128);
    ck_assert_uint_eq(fake.sent[fake.sent_count - 1].data[1], 1);
    hear(&network, 0x701, 5); /* sent before */
    hear(&network, 0x701, 127);
    hear(&network, 0x701, 127);
    ck_assert(!network.node[0].booted);
    hear(&network, 0x701, 5);
    hear(&network, 0x701, 127);
    ck_assert(network.node[0].booted);
    /* Stopped and then waiting is the same. */
    network_clear_booted(&network);
    hear(&network, 0x703, 4);
    hear(&network, 0x703, 127);
    ck_assert(network.node[2].booted);
}
END_TEST

/* It was started, the answer is still "pre-operational" long after: the start was before its reset. */
START_TEST(a_node_that_was_started_and_still_waits_has_booted)
{
    struct fake_bus fake;
    struct network network;
    fake_bus_init(&fake);
    const struct can_bus bus = fake_bus_interface(&fake);
    network_init(&network);
    hear(&network, 0x702, 0);
    network_clear_booted(&network);
    network_update(&network, &bus, 0x2);
    hear(&network, 0x702, 127); /* on its way while the start was */
    ck_assert(!network.node[1].booted);
    for (int tick = 0; tick < 60; tick++) {
        network_update(&network, &bus, 0);
    }
    hear(&network, 0x702, 127);
    ck_assert(network.node[1].booted);
}
END_TEST

/* All at once, and not started again before it is over. */
START_TEST(stopped_nodes_wait_and_are_started_again)
{
    struct fake_bus fake;
    struct network network;
    fake_bus_init(&fake);
    const struct can_bus bus = fake_bus_interface(&fake);
    network_init(&network);
    hear_all(&network, 5);
    ck_assert_int_eq(network_stop_all(&network, &bus), CAN_OK);
    ck_assert_uint_eq(fake.sent_count, 1);
    ck_assert_uint_eq(fake.sent[0].id, 0x000);
    ck_assert_uint_eq(fake.sent[0].data[0], 2);
    ck_assert_uint_eq(fake.sent[0].data[1], 0);
    for (int tick = 1; tick < NETWORK_STOP_TICKS; tick++) {
        hear_all(&network, tick % 2 == 0 ? 4 : 127);
        ck_assert(network.node[3].stop_pending);
        network_update(&network, &bus, 0xF);
        ck_assert_uint_eq(fake.sent_count, 1);
    }
    hear_all(&network, 4); /* stopped */
    network_update(&network, &bus, 0xF);
    ck_assert(!network.node[3].stop_pending);
    ck_assert_uint_eq(fake.sent_count, 5);
    ck_assert_uint_eq(fake.sent[4].data[0], 1);
    ck_assert_uint_eq(fake.sent[4].data[1], 4);
    /* One that boots knows of no stop. */
    ck_assert_int_eq(network_stop_all(&network, &bus), CAN_OK);
    hear(&network, 0x702, 0);
    ck_assert(!network.node[1].stop_pending && network.node[0].stop_pending);
}
END_TEST

/* A start that the bus did not take is tried again at once, not after the wait for an answer. */
START_TEST(a_start_that_was_not_sent_is_sent_again)
{
    struct fake_bus fake;
    struct network network;
    fake_bus_init(&fake);
    const struct can_bus bus = fake_bus_interface(&fake);
    network_init(&network);
    hear(&network, 0x702, 127);
    fake.verdict = CAN_FULL;
    network_update(&network, &bus, 0x2);
    ck_assert_uint_eq(fake_bus_count(&fake, 0x000), 0);
    fake.verdict = CAN_OK;
    network_update(&network, &bus, 0x2);
    ck_assert_uint_eq(fake_bus_count(&fake, 0x000), 1);
    network_update(&network, &bus, 0x2);
    ck_assert_uint_eq(fake_bus_count(&fake, 0x000), 1); /* now it waits */
}
END_TEST

START_TEST(nodes_have_their_index)
{
    struct network network;
    network_init(&network);
    for (uint8_t node = 1; node <= NODE_SENSOR_RIGHT; node++) {
        ck_assert_uint_eq(network_index(&network, node), node - 1u);
    }
    ck_assert_uint_eq(network_index(&network, 16), NETWORK_NODES);
    ck_assert_uint_eq(network_index(&network, 0),
                      NETWORK_NODES); /* the number of who is not there */
}
END_TEST

/* Other numbers, and one drive alone: who is not there is not waited for. */
START_TEST(the_nodes_of_another_device)
{
    static const uint8_t numbers[NETWORK_NODES] = {[NETWORK_DRIVE_RIGHT] = 77,
                                                   [NETWORK_SENSOR_LEFT] = 9,
                                                   [NETWORK_SENSOR_RIGHT] = 10,
                                                   [NETWORK_LATCH_RIGHT] = 78};
    struct network network;
    network_init(&network);
    network_set_nodes(&network, numbers);
    ck_assert_uint_eq(network_index(&network, 77), NETWORK_DRIVE_RIGHT);
    ck_assert_uint_eq(network_index(&network, 1), NETWORK_NODES);
    ck_assert(!network_is_overdue(&network, NETWORK_DRIVE_LEFT));
    for (unsigned i = 0; i < NETWORK_NODES; i++) {
        const struct can_msg alive = {.id = 0x700u + numbers[i], .length = 1, .data = {5}};
        ck_assert(!network_all_operational(&network));
        ck_assert(numbers[i] == 0 || network_receive(&network, &alive));
        if (i == NETWORK_LATCH_RIGHT) {
            break;
        }
    }
    ck_assert(network_all_operational(&network));
    const struct can_msg gone = {.id = 0x700, .length = 1, .data = {5}};
    ck_assert(!network_receive(&network, &gone));
    struct fake_bus fake;
    fake_bus_init(&fake);
    const struct can_bus bus = fake_bus_interface(&fake);
    for (unsigned i = 0; i <= HEARTBEAT_TIMEOUT_TICKS; i++) {
        network_update(&network, &bus, 0);
    }
    for (unsigned i = 0; i < NETWORK_NODES; i++) {
        ck_assert_int_eq(network_is_overdue(&network, i), numbers[i] != 0);
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("network");
    TCase *tests = tcase_create("all");
    tcase_add_test(tests, nodes_are_started_one_by_one_and_become_operational);
    tcase_add_test(tests, start_waits_for_permission_and_is_repeated);
    tcase_add_test(tests, an_emergency_that_is_none_changes_nothing);
    tcase_add_test(tests, silence_is_noticed_within_the_time_out);
    tcase_add_test(tests, an_error_of_a_node_is_a_node_lost);
    tcase_add_test(tests, a_start_that_was_not_sent_is_sent_again);
    tcase_add_loop_test(tests, code_0_with_errors_left_in_the_register_is_no_end, 0, 8);
    tcase_add_test(tests, a_node_that_falls_back_has_booted);
    tcase_add_test(tests, a_node_that_was_started_and_still_waits_has_booted);
    tcase_add_test(tests, nodes_have_their_index);
    tcase_add_test(tests, the_nodes_of_another_device);
    tcase_add_test(tests, stopped_nodes_wait_and_are_started_again);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
