/* The in-process bus against ISO 11898-1: order, duration, errors, bus-off. */
#include <check.h>
#include <stdlib.h>
#include <string.h>

#include "sim_host/bus/sim_bus.h"
#include "tests/support/assert_close.h"

enum { PORTS = 4, SEEN_MAX = 64, BIT_NS = 1000, INTERMISSION = 3 };

static struct sim_bus bus;
static struct can_bus port[PORTS];
static struct sim_bus_event seen[SEEN_MAX];
static unsigned seen_count;

static void remember(void *context, const struct sim_bus_event *event)
{
    (void)context;
    if (seen_count < SEEN_MAX) {
        seen[seen_count++] = *event;
    }
}

static void setup(void)
{
    sim_bus_init(&bus, 1000000);
    seen_count = 0;
    for (int i = 0; i < PORTS; i++) {
        const int index = sim_bus_attach(&bus, "node", NULL, NULL);
        ck_assert_int_eq(index, i);
        port[i] = sim_bus_port(&bus, index);
    }
    sim_bus_set_tap(&bus, remember, NULL);
}

static void send(int from, uint32_t id, uint8_t length)
{
    struct can_msg message = {.id = id, .length = length};
    for (unsigned i = 0; i < length; i++) {
        message.data[i] = (uint8_t)(id + i);
    }
    ck_assert_int_eq(can_bus_send(&port[from], &message), CAN_OK);
}

static unsigned frame_bits_of(const struct can_msg *message)
{
    return frame_bits_stuffed(&bus.bits, message) + FRAME_BITS_TAIL;
}

START_TEST(frames_leave_in_order_of_identifiers_whoever_sends)
{
    send(0, 0x301, 6);
    send(1, 0x182, 6);
    send(0, 0x080, 0);
    send(2, 0x283, 5);
    send(1, 0x702, 1);
    send(3, 0x181, 6);
    sim_bus_run_until(&bus, 1000000);
    static const uint32_t want[] = {0x080, 0x181, 0x182, 0x283, 0x301, 0x702};
    ck_assert_uint_eq(seen_count, 6);
    for (unsigned i = 0; i < 6; i++) {
        ck_assert_uint_eq(seen[i].message.id, want[i]);
    }
    ck_assert_uint_eq(bus.stats.frames, 6);
}
END_TEST

START_TEST(each_frame_takes_its_stuffed_bits_and_the_intermission)
{
    send(0, 0x080, 0);
    send(0, 0x201, 8);
    send(1, 0x181, 6);
    sim_bus_run_until(&bus, 1000000);
    uint64_t start_ns = 0;
    for (unsigned i = 0; i < 3; i++) {
        const uint64_t want = start_ns + (uint64_t)frame_bits_of(&seen[i].message) * BIT_NS;
        ck_assert_uint_eq(seen[i].time_ns, want);
        start_ns = want + (uint64_t)INTERMISSION * BIT_NS;
    }
    assert_close(sim_bus_load(&bus), (double)start_ns / 1e6, 1e-12, 0.0);
}
END_TEST

START_TEST(a_frame_on_the_wire_is_not_interrupted_and_time_stops_where_told)
{
    send(0, 0x701, 1);
    sim_bus_run_until(&bus, 10 * BIT_NS);
    ck_assert_uint_eq(sim_bus_now_ns(&bus), 10 * BIT_NS);
    ck_assert_uint_eq(seen_count, 0);
    send(1, 0x001, 1); /* more urgent, but too late */
    sim_bus_run_until(&bus, 1000000);
    ck_assert_uint_eq(seen[0].message.id, 0x701);
    ck_assert_uint_eq(seen[1].message.id, 0x001);
    ck_assert_uint_eq(sim_bus_now_ns(&bus), 1000000);
}
END_TEST

START_TEST(only_the_own_sync_comes_back_to_its_sender)
{
    struct can_msg message;
    uint64_t time_ns;
    send(0, 0x080, 0);
    send(0, 0x201, 8);
    sim_bus_run_until(&bus, 1000000);
    ck_assert_int_eq(can_bus_receive(&port[0], &message, &time_ns), CAN_OK);
    ck_assert_uint_eq(message.id, 0x080);
    ck_assert_uint_eq(message.flags, CAN_FRAME_OWN);
    ck_assert_uint_eq(time_ns, seen[0].time_ns);
    ck_assert_int_eq(can_bus_receive(&port[0], &message, NULL), CAN_EMPTY);
    ck_assert_int_eq(can_bus_receive(&port[1], &message, NULL), CAN_OK);
    ck_assert_uint_eq(message.flags, 0);
    ck_assert_int_eq(can_bus_receive(&port[1], &message, NULL), CAN_OK);
    ck_assert_uint_eq(message.id, 0x201);
}
END_TEST

START_TEST(extended_remote_and_data_frames_arbitrate_as_the_standard_says)
{
    struct can_msg extended = {.id = 0x181U << 18, .flags = CAN_FRAME_EXTENDED};
    struct can_msg remote = {.id = 0x181, .flags = CAN_FRAME_REMOTE, .length = 2};
    struct can_msg data = {.id = 0x181, .length = 2};
    ck_assert_int_eq(can_bus_send(&port[0], &extended), CAN_OK);
    ck_assert_int_eq(can_bus_send(&port[1], &remote), CAN_OK);
    ck_assert_int_eq(can_bus_send(&port[2], &data), CAN_OK);
    sim_bus_run_until(&bus, 1000000);
    ck_assert_uint_eq(seen[0].port, 2);
    ck_assert_uint_eq(seen[1].port, 1);
    ck_assert_uint_eq(seen[2].port, 0);
}
END_TEST

START_TEST(refusals_are_told_and_counted)
{
    struct can_msg message = {.id = 0x800};
    ck_assert_int_eq(can_bus_send(&port[0], &message), CAN_INVALID);
    message.id = 0x7FF;
    message.length = 9;
    ck_assert_int_eq(can_bus_send(&port[0], &message), CAN_INVALID);
    for (int i = 0; i < SIM_BUS_TX_QUEUE; i++) {
        send(0, 0x100, 0);
    }
    message.length = 0;
    ck_assert_int_eq(can_bus_send(&port[0], &message), CAN_FULL);
    struct can_bus_status status;
    can_bus_get_status(&port[0], &status);
    ck_assert_uint_eq(status.tx_refused, 1);
    for (int i = 0; i < SIM_BUS_RX_QUEUE + 5; i++) {
        sim_bus_run_until(&bus, sim_bus_now_ns(&bus) + 200000);
        send(1, 0x200, 0);
    }
    sim_bus_run_until(&bus, sim_bus_now_ns(&bus) + 200000);
    can_bus_get_status(&port[0], &status);
    ck_assert_uint_eq(status.rx_overflow, 5);
    ck_assert_uint_eq(status.tx_frames, SIM_BUS_TX_QUEUE);
}
END_TEST

/* A node that babbles keeps the bus: what stops everything must still find room in the queue. */
START_TEST(a_full_queue_gives_up_its_least_urgent_frame_for_a_more_urgent_one)
{
    struct can_bus_status status;
    const struct can_msg stop = {.id = 0x000, .length = 2, .data = {2, 0}};
    const struct can_msg extended = {.id = 0x201 << 18, .flags = CAN_FRAME_EXTENDED};
    send(0, 0x710, 0);
    for (int i = 1; i < SIM_BUS_TX_QUEUE; i++) {
        send(0, 0x201, 0);
    }
    ck_assert_int_eq(can_bus_send(&port[0], &stop), CAN_OK);
    can_bus_get_status(&port[0], &status);
    ck_assert_uint_eq(status.tx_refused, 1);
    ck_assert_int_eq(can_bus_send(&port[0], &extended), CAN_FULL); /* loses against 0x201 */
    sim_bus_run_until(&bus, 10000000);
    can_bus_get_status(&port[0], &status);
    ck_assert_uint_eq(status.tx_refused, 2);
    ck_assert_uint_eq(status.tx_frames, SIM_BUS_TX_QUEUE);
    ck_assert_uint_eq(seen[0].message.id, 0x000);
    for (int i = 1; i < SIM_BUS_TX_QUEUE; i++) {
        ck_assert_uint_eq(seen[i].message.id, 0x201);
    }
}
END_TEST

/* A hook with a script: which fault for which frame number. */
struct script {
    unsigned frame;
    unsigned from;
    unsigned to;
    uint32_t id; /* 0: all */
    struct sim_bus_fault fault;
};

static struct sim_bus_fault play(void *context, const struct can_msg *message, unsigned sender,
                                 uint64_t time_ns)
{
    struct script *script = context;
    (void)sender;
    (void)time_ns;
    const struct sim_bus_fault none = {.kind = SIM_BUS_FAULT_NONE};
    if (script->id != 0 && script->id != message->id) {
        return none;
    }
    const unsigned frame = script->frame++;
    return frame >= script->from && frame < script->to ? script->fault : none;
}

START_TEST(a_destroyed_frame_is_repeated_and_counted)
{
    struct script script = {.to = 1, .fault = {.kind = SIM_BUS_FAULT_DESTROY, .bit = 30}};
    sim_bus_set_fault_hook(&bus, play, &script);
    send(0, 0x181, 6);
    sim_bus_run_until(&bus, 1000000);
    ck_assert_uint_eq(seen_count, 2);
    ck_assert_int_eq(seen[0].kind, SIM_BUS_ERROR_FRAME);
    /* 31 bits, error flags of 12, delimiter of 8 */
    ck_assert_uint_eq(seen[0].time_ns, 51 * BIT_NS);
    ck_assert_int_eq(seen[1].kind, SIM_BUS_FRAME);
    struct can_bus_status status;
    can_bus_get_status(&port[0], &status);
    ck_assert_uint_eq(status.tx_error_count, 7); /* +8, then -1 for the good one */
    can_bus_get_status(&port[1], &status);
    ck_assert_uint_eq(status.rx_error_count, 0); /* +1, -1 */
    ck_assert_uint_eq(status.error_frames, 1);
    struct can_msg message;
    ck_assert_int_eq(can_bus_receive(&port[1], &message, NULL), CAN_OK);
    ck_assert_uint_eq(message.flags, CAN_FRAME_ERROR);
    ck_assert_int_eq(can_bus_receive(&port[1], &message, NULL), CAN_OK);
    ck_assert_uint_eq(message.id, 0x181);
}
END_TEST

START_TEST(a_sender_which_always_fails_goes_passive_then_bus_off_and_recovers)
{
    struct script script = {.to = 1000, .id = 0x181, .fault = {.kind = SIM_BUS_FAULT_DESTROY}};
    sim_bus_set_fault_hook(&bus, play, &script);
    send(0, 0x181, 6);
    sim_bus_run_until(&bus, 16 * 24 * BIT_NS); /* 16 errors of 1 + 20 + 3 bits */
    struct can_bus_status status;
    can_bus_get_status(&port[0], &status);
    ck_assert_int_eq(status.error_state, CAN_ERROR_PASSIVE);
    ck_assert_uint_eq(status.tx_error_count, 128);
    sim_bus_run_until(&bus, 2000000);
    can_bus_get_status(&port[0], &status);
    ck_assert_int_eq(status.error_state, CAN_BUS_OFF);
    ck_assert_uint_eq(status.bus_off_count, 1);
    ck_assert_uint_eq(bus.stats.error_frames, 32);
    ck_assert_uint_eq(bus.stats.faults[SIM_BUS_FAULT_DESTROY], 32);
    struct can_msg message = {.id = 0x181};
    ck_assert_int_eq(can_bus_send(&port[0], &message), CAN_DOWN);

    can_bus_recover(&port[0]);
    const uint64_t needed_ns = 128 * 11 * BIT_NS;
    sim_bus_run_until(&bus, 2000000 + needed_ns - 1);
    ck_assert_int_eq(can_bus_send(&port[0], &message), CAN_DOWN);
    sim_bus_run_until(&bus, 2000000 + needed_ns);
    ck_assert_int_eq(can_bus_send(&port[0], &message), CAN_OK);
    can_bus_get_status(&port[0], &status);
    ck_assert_int_eq(status.error_state, CAN_ERROR_ACTIVE);
}
END_TEST

START_TEST(recovery_counts_traffic_of_others_too)
{
    struct script script = {.to = 32, .id = 0x181, .fault = {.kind = SIM_BUS_FAULT_DESTROY}};
    sim_bus_set_fault_hook(&bus, play, &script);
    send(0, 0x181, 6);
    sim_bus_run_until(&bus, 2000000);
    can_bus_recover(&port[0]);
    /* A bus filled with back-to-back frames shows one gap of 11 bits per frame. */
    unsigned frames = 0;
    struct can_bus_status status;
    do {
        send(1, 0x100, 0);
        send(1, 0x100, 0);
        sim_bus_run_until(&bus, sim_bus_now_ns(&bus) + 2 * 52 * BIT_NS);
        frames += 2;
        can_bus_get_status(&port[0], &status);
    } while (status.error_state == CAN_BUS_OFF && frames < 1000);
    ck_assert_uint_ge(frames, 60);
    ck_assert_uint_le(frames, 130);
}
END_TEST

START_TEST(a_lone_node_never_goes_bus_off)
{
    for (int i = 1; i < PORTS; i++) {
        sim_bus_connect(&bus, i, false);
    }
    send(0, 0x181, 6);
    sim_bus_run_until(&bus, 50000000);
    struct can_bus_status status;
    can_bus_get_status(&port[0], &status);
    ck_assert_int_eq(status.error_state, CAN_ERROR_PASSIVE);
    ck_assert_uint_eq(status.tx_error_count, 128);
    sim_bus_connect(&bus, 1, true);
    sim_bus_run_until(&bus, 51000000);
    can_bus_get_status(&port[0], &status);
    ck_assert_uint_eq(status.tx_frames, 1);
}
END_TEST

START_TEST(two_senders_of_one_identifier_destroy_each_other)
{
    struct can_msg a = {.id = 0x181, .length = 2, .data = {1, 2}};
    struct can_msg b = {.id = 0x181, .length = 2, .data = {1, 3}};
    ck_assert_int_eq(can_bus_send(&port[0], &a), CAN_OK);
    ck_assert_int_eq(can_bus_send(&port[1], &b), CAN_OK);
    sim_bus_run_until(&bus, 10000000);
    struct can_bus_status status;
    can_bus_get_status(&port[0], &status);
    ck_assert_int_eq(status.error_state, CAN_BUS_OFF);
    can_bus_get_status(&port[1], &status);
    ck_assert_int_eq(status.error_state, CAN_BUS_OFF);
    ck_assert_uint_eq(bus.stats.frames, 0);
}
END_TEST

START_TEST(dropping_altering_delaying_and_duplicating_do_what_they_say)
{
    struct script script = {.to = 1};
    struct can_msg message;
    sim_bus_set_fault_hook(&bus, play, &script);
    script.fault = (struct sim_bus_fault){.kind = SIM_BUS_FAULT_DROP, .receivers = 1U << 1};
    send(0, 0x181, 2);
    sim_bus_run_until(&bus, 1000000);
    ck_assert_int_eq(can_bus_receive(&port[1], &message, NULL), CAN_EMPTY);
    ck_assert_int_eq(can_bus_receive(&port[2], &message, NULL), CAN_OK);

    script = (struct script){.to = 1, .fault = {.kind = SIM_BUS_FAULT_ALTER, .flip = {0, 0x80}}};
    send(0, 0x181, 2);
    sim_bus_run_until(&bus, 2000000);
    ck_assert_int_eq(can_bus_receive(&port[1], &message, NULL), CAN_OK);
    ck_assert_uint_eq(message.data[1], 0x82 ^ 0x80);

    script = (struct script){.to = 1, .fault = {.kind = SIM_BUS_FAULT_DELAY, .delay_ns = 300000}};
    send(0, 0x181, 2);
    send(0, 0x182, 2);
    sim_bus_run_until(&bus, 3000000);
    ck_assert_int_eq(can_bus_receive(&port[1], &message, NULL), CAN_OK);
    ck_assert_uint_eq(message.id, 0x182);
    uint64_t time_ns;
    ck_assert_int_eq(can_bus_receive(&port[1], &message, &time_ns), CAN_OK);
    ck_assert_uint_eq(message.id, 0x181);
    ck_assert_uint_ge(time_ns, 2300000);

    script = (struct script){.to = 1, .fault = {.kind = SIM_BUS_FAULT_DUPLICATE}};
    send(0, 0x181, 2);
    sim_bus_run_until(&bus, 4000000);
    ck_assert_int_eq(can_bus_receive(&port[1], &message, NULL), CAN_OK);
    ck_assert_int_eq(can_bus_receive(&port[1], &message, NULL), CAN_OK);
    ck_assert_int_eq(can_bus_receive(&port[1], &message, NULL), CAN_EMPTY);
    for (int kind = SIM_BUS_FAULT_DROP; kind <= SIM_BUS_FAULT_DUPLICATE; kind++) {
        const uint64_t want = kind == SIM_BUS_FAULT_DESTROY ? 0 : 1;
        ck_assert_uint_eq(bus.stats.faults[kind], want);
    }
}
END_TEST

START_TEST(a_babbling_node_starves_what_is_less_urgent)
{
    const struct can_msg noise = {.id = 0x001};
    sim_bus_babble(&bus, 3, &noise, 5000000);
    send(0, 0x080, 0);
    sim_bus_run_until(&bus, 5000000);
    ck_assert_uint_gt(bus.stats.babble_frames, 80);
    ck_assert_uint_eq(bus.stats.frames, bus.stats.babble_frames);
    sim_bus_run_until(&bus, 6000000);
    ck_assert_uint_eq(bus.stats.frames, bus.stats.babble_frames + 1);
}
END_TEST

/* A node that answers from its wake function. */
struct responder {
    struct can_bus bus;
    uint32_t id;
};

static void respond(void *context, uint64_t now_ns)
{
    struct responder *responder = context;
    struct can_msg message;
    (void)now_ns;
    while (can_bus_receive(&responder->bus, &message, NULL) == CAN_OK) {
        if (message.id == 0x080) {
            const struct can_msg answer = {.id = responder->id, .length = 5};
            ck_assert_int_eq(can_bus_send(&responder->bus, &answer), CAN_OK);
        }
    }
}

START_TEST(answers_to_the_sync_compete_right_behind_it)
{
    static struct responder nodes[2];
    static struct sim_bus_response response;
    for (int i = 0; i < 2; i++) {
        const int index = sim_bus_attach(&bus, "responder", respond, &nodes[i]);
        nodes[i] =
            (struct responder){.bus = sim_bus_port(&bus, index), .id = i == 0 ? 0x284U : 0x283U};
    }
    sim_bus_measure_response(&bus, &response);
    send(0, 0x080, 0);
    sim_bus_run_until(&bus, 1000000);
    ck_assert_uint_eq(seen_count, 3);
    ck_assert_uint_eq(seen[1].message.id, 0x283);
    ck_assert_uint_eq(seen[2].message.id, 0x284);
    ck_assert_uint_eq(seen[1].time_ns - seen[0].time_ns,
                      (uint64_t)(3 + frame_bits_of(&seen[1].message)) * BIT_NS);
    ck_assert_uint_eq(response.worst_ns[0x284], seen[2].time_ns - seen[0].time_ns);
}
END_TEST

START_TEST(a_withdrawn_frame_is_not_sent_and_others_are)
{
    send(0, 0x301, 6);
    send(0, 0x302, 6);
    send(0, 0x181, 6);
    sim_bus_run_until(&bus, 10000); /* 0x181 is on the wire */
    ck_assert_uint_eq(sim_bus_withdraw(&bus, 0, 0x301), 1);
    ck_assert_uint_eq(sim_bus_withdraw(&bus, 0, 0x181), 0);
    sim_bus_run_until(&bus, 1000000);
    ck_assert_uint_eq(seen_count, 2);
    ck_assert_uint_eq(seen[0].message.id, 0x181);
    ck_assert_uint_eq(seen[1].message.id, 0x302);
}
END_TEST

START_TEST(the_next_moment_is_when_something_happens)
{
    ck_assert_uint_eq(sim_bus_next_ns(&bus), UINT64_MAX);
    send(0, 0x301, 6);
    ck_assert_uint_eq(sim_bus_next_ns(&bus), 0);
    sim_bus_run_until(&bus, 0);
    const uint64_t end_ns = sim_bus_next_ns(&bus);
    ck_assert_uint_eq(seen_count, 0);
    sim_bus_run_until(&bus, end_ns - 1);
    ck_assert_uint_eq(seen_count, 0);
    sim_bus_run_until(&bus, end_ns);
    ck_assert_uint_eq(seen_count, 1);
    ck_assert_uint_eq(seen[0].time_ns, end_ns);
    sim_bus_run_until(&bus, 1000000);
    send(1, 0x301, 6);
    sim_bus_connect(&bus, 1, false); /* it waits, but nothing comes of it */
    ck_assert_uint_eq(sim_bus_next_ns(&bus), UINT64_MAX);
}
END_TEST

START_TEST(a_reset_port_is_as_new)
{
    send(0, 0x181, 6);
    send(0, 0x281, 6);
    sim_bus_run_until(&bus, 5 * BIT_NS); /* 0x181 is on the wire */
    sim_bus_reset_port(&bus, 0);
    sim_bus_run_until(&bus, 1000000);
    ck_assert_uint_eq(bus.stats.frames, 0);
    send(0, 0x181, 6);
    sim_bus_run_until(&bus, 2000000);
    ck_assert_uint_eq(bus.stats.frames, 1);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("sim_bus");
    TCase *tcase = tcase_create("all");
    tcase_add_checked_fixture(tcase, setup, NULL);
    tcase_add_test(tcase, frames_leave_in_order_of_identifiers_whoever_sends);
    tcase_add_test(tcase, each_frame_takes_its_stuffed_bits_and_the_intermission);
    tcase_add_test(tcase, a_frame_on_the_wire_is_not_interrupted_and_time_stops_where_told);
    tcase_add_test(tcase, only_the_own_sync_comes_back_to_its_sender);
    tcase_add_test(tcase, extended_remote_and_data_frames_arbitrate_as_the_standard_says);
    tcase_add_test(tcase, refusals_are_told_and_counted);
    tcase_add_test(tcase, a_full_queue_gives_up_its_least_urgent_frame_for_a_more_urgent_one);
    tcase_add_test(tcase, a_destroyed_frame_is_repeated_and_counted);
    tcase_add_test(tcase, a_sender_which_always_fails_goes_passive_then_bus_off_and_recovers);
    tcase_add_test(tcase, recovery_counts_traffic_of_others_too);
    tcase_add_test(tcase, a_lone_node_never_goes_bus_off);
    tcase_add_test(tcase, two_senders_of_one_identifier_destroy_each_other);
    tcase_add_test(tcase, dropping_altering_delaying_and_duplicating_do_what_they_say);
    tcase_add_test(tcase, a_babbling_node_starves_what_is_less_urgent);
    tcase_add_test(tcase, answers_to_the_sync_compete_right_behind_it);
    tcase_add_test(tcase, a_withdrawn_frame_is_not_sent_and_others_are);
    tcase_add_test(tcase, the_next_moment_is_when_something_happens);
    tcase_add_test(tcase, a_reset_port_is_as_new);
    suite_add_tcase(suite, tcase);
    return run_suite(suite);
}
