/* The SocketCAN port on a real vcan0. A second raw socket, spoken to with the plain
 * kernel interface, plays the others on the bus. */
#include <check.h>
#include <errno.h>
#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <poll.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "hal/port_socketcan/socketcan_bus.h"
#include "tests/support/assert_close.h"
#include "tests/support/in_vcan.h"

static struct socketcan_bus bus;
static struct can_bus can;
static int other = -1;

static const struct socketcan_filter filters[] = {{0x181, 0x7FF}, {0x280, 0x7F8}};

static int open_other(void)
{
    const int fd = socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK, CAN_RAW);
    struct sockaddr_can address = {.can_family = AF_CAN};
    address.can_ifindex = (int)if_nametoindex("vcan0");
    ck_assert_int_ge(fd, 0);
    ck_assert_int_eq(bind(fd, (struct sockaddr *)&address, sizeof address), 0);
    return fd;
}

static void run(const char *command)
{
    ck_assert_msg(system(command) == 0, "failed: %s", command);
}

static void setup(void)
{
    run("ip link set vcan0 up");
    ck_assert_int_eq(socketcan_bus_open(&bus, "vcan0", filters, 2, true), 0);
    can = socketcan_bus_interface(&bus);
    other = open_other();
}

static void teardown(void)
{
    socketcan_bus_close(&bus);
    close(other);
}

static void other_sends(uint32_t id, unsigned length)
{
    struct can_frame frame = {.can_id = id, .can_dlc = (uint8_t)length};
    for (unsigned i = 0; i < length; i++) {
        frame.data[i] = (uint8_t)(0x10 + i);
    }
    ck_assert_int_eq(send(other, &frame, sizeof frame, 0), sizeof frame);
}

static void other_reads(struct can_frame *frame)
{
    struct pollfd waiting = {.fd = other, .events = POLLIN};
    ck_assert_int_eq(poll(&waiting, 1, 500), 1);
    ck_assert_int_eq(read(other, frame, sizeof *frame), sizeof *frame);
}

static bool wait_for_frame(unsigned ms)
{
    return socketcan_bus_wait(&bus, socketcan_now_ns() + ms * UINT64_C(1000000)) == 1;
}

START_TEST(frames_pass_the_filters_or_are_not_seen_at_all)
{
    struct can_msg message;
    uint64_t time_ns;
    const uint64_t before_ns = socketcan_now_ns();
    other_sends(0x182, 8);
    other_sends(0x181, 6);
    other_sends(0x288, 5);
    other_sends(0x283, 5);
    other_sends(0x181 | CAN_EFF_FLAG, 2);
    other_sends(0x181 | CAN_RTR_FLAG, 2);
    ck_assert(wait_for_frame(200));
    ck_assert_int_eq(can_bus_receive(&can, &message, &time_ns), CAN_OK);
    ck_assert_uint_eq(message.id, 0x181);
    ck_assert_uint_eq(message.length, 6);
    ck_assert_uint_eq(message.flags, 0);
    ck_assert_uint_eq(message.data[5], 0x15);
    ck_assert_uint_eq(message.data[6], 0);
    ck_assert_uint_ge(time_ns + 1000000, before_ns);
    ck_assert_uint_le(time_ns, socketcan_now_ns() + 1000000);
    ck_assert_int_eq(can_bus_receive(&can, &message, NULL), CAN_OK);
    ck_assert_uint_eq(message.id, 0x283);
    ck_assert_int_eq(can_bus_receive(&can, &message, NULL), CAN_EMPTY);
}
END_TEST

START_TEST(only_the_own_sync_is_heard_and_in_its_place)
{
    struct can_msg message = {.id = 0x201, .length = 8};
    ck_assert_int_eq(can_bus_send(&can, &message), CAN_OK);
    socketcan_bus_flush(&bus);
    other_sends(0x181, 6);
    message = (struct can_msg){.id = 0x080};
    ck_assert_int_eq(can_bus_send(&can, &message), CAN_OK);
    message = (struct can_msg){.id = 0x181};
    ck_assert_int_eq(can_bus_send(&can, &message), CAN_OK); /* own: not heard */
    socketcan_bus_flush(&bus);
    other_sends(0x283, 5);
    usleep(20000);
    ck_assert_int_eq(can_bus_receive(&can, &message, NULL), CAN_OK);
    ck_assert_uint_eq(message.id, 0x181);
    ck_assert_int_eq(can_bus_receive(&can, &message, NULL), CAN_OK);
    ck_assert_uint_eq(message.id, 0x080);
    ck_assert_uint_eq(message.flags, CAN_FRAME_OWN);
    ck_assert_int_eq(can_bus_receive(&can, &message, NULL), CAN_OK);
    ck_assert_uint_eq(message.id, 0x283);
    ck_assert_int_eq(can_bus_receive(&can, &message, NULL), CAN_EMPTY);
    struct can_frame frame;
    other_reads(&frame);
    ck_assert_uint_eq(frame.can_id, 0x201);
    ck_assert_uint_eq(frame.can_dlc, 8);
}
END_TEST

START_TEST(what_is_sent_at_once_leaves_in_order_of_identifiers)
{
    static const uint32_t sent[] = {0x301, 0x710, 0x201, 0x081, 0x601, 0x302};
    static const uint32_t want[] = {0x081, 0x201, 0x301, 0x302, 0x601, 0x710, 0x080};
    struct can_frame frame;
    for (unsigned i = 0; i < 6; i++) {
        const struct can_msg message = {.id = sent[i]};
        ck_assert_int_eq(can_bus_send(&can, &message), CAN_OK);
    }
    const struct can_msg sync = {.id = 0x080}; /* the next cycle: not before them */
    ck_assert_int_eq(can_bus_send(&can, &sync), CAN_OK);
    socketcan_bus_flush(&bus);
    for (unsigned i = 0; i < 7; i++) {
        other_reads(&frame);
        ck_assert_uint_eq(frame.can_id, want[i]);
    }
}
END_TEST

/* What came together is known together: a device sees that its SYNC is not the newest. */
START_TEST(a_frame_that_was_fetched_and_waits_is_seen)
{
    struct can_msg message;
    other_sends(0x181, 6);
    other_sends(0x283, 5);
    other_sends(0x181, 6);
    usleep(20000);
    ck_assert(wait_for_frame(200));
    ck_assert(socketcan_bus_has_fetched(&bus, 0x181));
    ck_assert(!socketcan_bus_has_fetched(&bus, 0x284));
    ck_assert_int_eq(can_bus_receive(&can, &message, NULL), CAN_OK);
    ck_assert(socketcan_bus_has_fetched(&bus, 0x181));
    ck_assert(socketcan_bus_has_fetched(&bus, 0x283));
    ck_assert_int_eq(can_bus_receive(&can, &message, NULL), CAN_OK);
    ck_assert_int_eq(can_bus_receive(&can, &message, NULL), CAN_OK);
    ck_assert_uint_eq(message.id, 0x181);
    ck_assert(!socketcan_bus_has_fetched(&bus, 0x181));
}
END_TEST

START_TEST(all_kinds_of_frames_go_out_as_they_are)
{
    struct can_frame frame;
    struct can_msg message = {
        .id = 0x1ABCDEF0, .flags = CAN_FRAME_EXTENDED, .length = 3, .data = {1, 2, 3}};
    ck_assert_int_eq(can_bus_send(&can, &message), CAN_OK);
    socketcan_bus_flush(&bus);
    other_reads(&frame);
    ck_assert_uint_eq(frame.can_id, 0x1ABCDEF0 | CAN_EFF_FLAG);
    message = (struct can_msg){.id = 0x123, .flags = CAN_FRAME_REMOTE, .length = 4};
    ck_assert_int_eq(can_bus_send(&can, &message), CAN_OK);
    socketcan_bus_flush(&bus);
    other_reads(&frame);
    ck_assert_uint_eq(frame.can_id, 0x123 | CAN_RTR_FLAG);
    message = (struct can_msg){.id = 0x800};
    ck_assert_int_eq(can_bus_send(&can, &message), CAN_INVALID);
    message = (struct can_msg){.id = 0x100, .length = 9};
    ck_assert_int_eq(can_bus_send(&can, &message), CAN_INVALID);
}
END_TEST

static void other_reports(uint32_t classes, unsigned controller, unsigned tec, unsigned rec)
{
    struct can_frame frame = {.can_id = CAN_ERR_FLAG | classes, .can_dlc = 8};
    frame.data[1] = (uint8_t)controller;
    frame.data[6] = (uint8_t)tec;
    frame.data[7] = (uint8_t)rec;
    ck_assert_int_eq(send(other, &frame, sizeof frame, 0), sizeof frame);
}

START_TEST(error_frames_change_the_status)
{
    struct can_msg message;
    struct can_bus_status status;
    other_reports(CAN_ERR_CRTL, CAN_ERR_CRTL_TX_PASSIVE, 130, 5);
    ck_assert(wait_for_frame(200));
    ck_assert_int_eq(can_bus_receive(&can, &message, NULL), CAN_OK);
    ck_assert_uint_eq(message.flags, CAN_FRAME_ERROR);
    can_bus_get_status(&can, &status);
    ck_assert_int_eq(status.error_state, CAN_ERROR_PASSIVE);
    ck_assert_uint_eq(status.tx_error_count, 130);
    ck_assert_uint_eq(status.rx_error_count, 5);

    other_reports(CAN_ERR_BUSOFF, 0, 0, 0);
    ck_assert(wait_for_frame(200));
    ck_assert_int_eq(can_bus_receive(&can, &message, NULL), CAN_OK);
    can_bus_get_status(&can, &status);
    ck_assert_int_eq(status.error_state, CAN_BUS_OFF);
    ck_assert_uint_eq(status.bus_off_count, 1);
    message = (struct can_msg){.id = 0x201};
    ck_assert_int_eq(can_bus_send(&can, &message), CAN_DOWN);
    can_bus_recover(&can); /* vcan has no controller to restart: must do no harm */

    other_reports(CAN_ERR_RESTARTED, 0, 0, 0);
    ck_assert(wait_for_frame(200));
    ck_assert_int_eq(can_bus_receive(&can, &message, NULL), CAN_OK);
    can_bus_get_status(&can, &status);
    ck_assert_int_eq(status.error_state, CAN_ERROR_ACTIVE);
    ck_assert_uint_eq(status.error_frames, 3);
    message = (struct can_msg){.id = 0x201};
    ck_assert_int_eq(can_bus_send(&can, &message), CAN_OK);
}
END_TEST

START_TEST(an_overflow_of_the_receive_queue_is_counted)
{
    struct can_msg message;
    struct can_bus_status status;
    enum { SENT = 4000 };
    const int room = 4096; /* small, so that it overflows */
    ck_assert_int_eq(setsockopt(bus.fd, SOL_SOCKET, SO_RCVBUF, &room, sizeof room), 0);
    for (int i = 0; i < SENT; i++) {
        other_sends(0x181, 6);
    }
    usleep(20000);
    while (can_bus_receive(&can, &message, NULL) == CAN_OK) {
    }
    /* The kernel tells of the loss with the next frame that gets through. */
    other_sends(0x181, 6);
    usleep(20000);
    ck_assert_int_eq(can_bus_receive(&can, &message, NULL), CAN_OK);
    can_bus_get_status(&can, &status);
    ck_assert_uint_gt(status.rx_overflow, 0);
    ck_assert_uint_eq(status.rx_overflow + status.rx_frames, SENT + 1);
}
END_TEST

START_TEST(an_interface_may_go_down_and_come_back)
{
    struct can_msg message = {.id = 0x201};
    run("ip link set vcan0 down");
    ck_assert_int_eq(can_bus_send(&can, &message), CAN_OK); /* not known yet */
    socketcan_bus_flush(&bus);
    ck_assert_int_eq(can_bus_send(&can, &message), CAN_DOWN);
    ck_assert_int_eq(can_bus_receive(&can, &message, NULL), CAN_DOWN);
    ck_assert_int_eq(socketcan_bus_wait(&bus, socketcan_now_ns() + 20000000), 0);
    struct can_bus_status status;
    can_bus_get_status(&can, &status);
    ck_assert_int_eq(status.error_state, CAN_BUS_OFF);
    run("ip link set vcan0 up");
    (void)socketcan_bus_wait(&bus, socketcan_now_ns() + 50000000);
    message = (struct can_msg){.id = 0x201};
    ck_assert_int_eq(can_bus_send(&can, &message), CAN_OK);
    close(other);
    other = open_other();
    other_sends(0x181, 6);
    ck_assert(wait_for_frame(200));
    ck_assert_int_eq(can_bus_receive(&can, &message, NULL), CAN_OK);
    ck_assert_uint_eq(bus.counters.went_down, 1);
    ck_assert_uint_eq(bus.counters.came_back, 1);
    can_bus_get_status(&can, &status);
    ck_assert_int_eq(status.error_state, CAN_ERROR_ACTIVE);
    ck_assert_uint_eq(status.bus_off_count, 0);
}
END_TEST

/* The next look at an interface that is down falls due at any moment, also between two looks at
 * the clock inside one wait: it must end at its deadline all the same. */
START_TEST(a_wait_ends_at_its_deadline_while_the_interface_is_down)
{
    struct can_msg message;
    run("ip link set vcan0 down");
    ck_assert_int_eq(can_bus_receive(&can, &message, NULL), CAN_DOWN);
    for (unsigned k = 0; k < 800; k++) {
        const uint64_t now_ns = socketcan_now_ns();
        bus.next_retry_ns = now_ns + 25u * k;
        ck_assert_int_eq(socketcan_bus_wait(&bus, now_ns + 50000), 0);
    }
}
END_TEST

START_TEST(an_interface_may_be_removed_and_made_again)
{
    struct can_msg message = {.id = 0x201};
    run("ip link del vcan0");
    usleep(10000);
    ck_assert_int_eq(can_bus_receive(&can, &message, NULL), CAN_DOWN);
    ck_assert_int_eq(can_bus_send(&can, &message), CAN_DOWN);
    run("ip link add dev vcan0 type vcan");
    run("ip link set vcan0 up");
    (void)socketcan_bus_wait(&bus, socketcan_now_ns() + 50000000);
    ck_assert_int_eq(can_bus_send(&can, &message), CAN_OK);
    close(other);
    other = open_other();
    other_sends(0x181, 6);
    ck_assert(wait_for_frame(200));
    ck_assert_int_eq(can_bus_receive(&can, &message, NULL), CAN_OK);
}
END_TEST

START_TEST(a_full_kernel_queue_keeps_frames_in_order_of_identifiers)
{
    /* A token bucket that lets one frame through every few milliseconds. */
    if (system("tc qdisc add dev vcan0 root tbf rate 32kbit burst 100 limit 120 "
               "2>/dev/null") != 0) {
        return; /* no traffic control in this kernel */
    }
    unsigned full = 0;
    for (int i = 0; i < 200 && bus.counters.kernel_full == 0; i++) {
        const struct can_msg message = {.id = 0x300};
        full += can_bus_send(&can, &message) == CAN_FULL ? 1 : 0;
        socketcan_bus_flush(&bus);
    }
    run("tc qdisc del dev vcan0 root");
    ck_assert_uint_gt(bus.counters.kernel_full, 0);
    ck_assert_uint_eq(full, 0); /* the own queue had room */
    (void)socketcan_bus_wait(&bus, socketcan_now_ns() + 5000000);
    ck_assert_uint_eq(bus.tx_count, 0);
}
END_TEST

START_TEST(opening_says_what_is_wrong)
{
    struct socketcan_bus none;
    ck_assert_int_eq(socketcan_bus_open(&none, "nosuchcan0", NULL, 0, false), -ENODEV);
}
END_TEST

START_TEST(wrong_arguments_are_refused)
{
    struct socketcan_bus none;
    ck_assert_int_lt(socketcan_bus_open(&none, "nosuchcan0", NULL, 0, false), 0);
    ck_assert_int_eq(none.fd, -1);
    ck_assert_int_eq(socketcan_bus_open(&none, "", NULL, 0, false), -EINVAL);
    ck_assert_int_eq(socketcan_bus_open(&none, "a_name_that_is_too_long", NULL, 0, false),
                     -ENAMETOOLONG);
}
END_TEST

/* A socket that takes no more stands for the kernel's full queue. */
START_TEST(a_full_queue_gives_up_its_least_urgent_frame_for_a_more_urgent_one)
{
    struct socketcan_bus full = {.name = "full"};
    const struct can_bus port = socketcan_bus_interface(&full);
    const struct can_msg stop = {.id = 0x000}, slow = {.id = 0x301}, last = {.id = 0x710};
    int ends[2];
    struct can_frame frame = {.can_id = 0x7FF};
    ck_assert_int_eq(socketpair(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK, 0, ends), 0);
    while (send(ends[0], &frame, sizeof frame, 0) == (ssize_t)sizeof frame) {
    }
    full.fd = ends[0];
    ck_assert_int_eq(can_bus_send(&port, &last), CAN_OK);
    for (unsigned i = 1; i < SOCKETCAN_TX_QUEUE; i++) {
        const struct can_msg message = {.id = 0x201, .length = 1, .data = {(uint8_t)i}};
        ck_assert_int_eq(can_bus_send(&port, &message), CAN_OK);
    }
    ck_assert_int_eq(can_bus_send(&port, &stop), CAN_OK);
    ck_assert_int_eq(can_bus_send(&port, &slow), CAN_FULL);
    ck_assert_uint_eq(full.status.tx_refused, 2);
    ck_assert_uint_gt(full.counters.kernel_full, 0);
    do { /* it empties: the filling, and then what waited */
        ck_assert_int_eq(recv(ends[1], &frame, sizeof frame, 0), (ssize_t)sizeof frame);
        socketcan_bus_flush(&full);
    } while (frame.can_id == 0x7FF);
    ck_assert_uint_eq(frame.can_id, 0x000);
    for (unsigned i = 1; i < SOCKETCAN_TX_QUEUE; i++) {
        ck_assert_int_eq(recv(ends[1], &frame, sizeof frame, 0), (ssize_t)sizeof frame);
        ck_assert_uint_eq(frame.can_id, 0x201);
        ck_assert_uint_eq(frame.data[0], i);
        socketcan_bus_flush(&full);
    }
    ck_assert_int_lt(recv(ends[1], &frame, sizeof frame, 0), 0);
    socketcan_bus_close(&full);
    close(ends[1]);
}
END_TEST

static void pair_reports(int fd, uint32_t id, unsigned length, unsigned controller,
                         unsigned protocol)
{
    struct can_frame frame = {.can_id = id, .can_dlc = (uint8_t)length};
    frame.data[1] = (uint8_t)controller;
    frame.data[2] = (uint8_t)protocol;
    ck_assert_int_eq(send(fd, &frame, sizeof frame, 0), (ssize_t)sizeof frame);
}

/* Drivers tell the end of bus-off in several ways (linux/can/error.h): restarted; error-active as the
 * controller's state (can_change_state) or, older ones, as an active error announcement. A frame that is
 * received is proof enough: off the bus none is. */
START_TEST(bus_off_ends_with_every_sign_of_life)
{
    static const struct {
        uint32_t id;
        unsigned length, controller, protocol;
        bool ends;
    } signs[] = {
        {CAN_ERR_FLAG | CAN_ERR_RESTARTED, 8, 0, 0, true},
        {CAN_ERR_FLAG | CAN_ERR_CRTL, 8, CAN_ERR_CRTL_ACTIVE, 0, true},
        {CAN_ERR_FLAG | CAN_ERR_PROT, 8, 0, CAN_ERR_PROT_ACTIVE, true},
        {CAN_ERR_FLAG | CAN_ERR_RESTARTED | CAN_ERR_BUSOFF, 8, 0, 0, true},
        {0x181, 6, 0, 0, true},
        {CAN_ERR_FLAG | CAN_ERR_PROT | CAN_ERR_BUSERROR, 8, 0, CAN_ERR_PROT_BIT0, false},
        {CAN_ERR_FLAG | CAN_ERR_CRTL, 8, CAN_ERR_CRTL_TX_PASSIVE, 0, false},
        {CAN_ERR_FLAG | CAN_ERR_CRTL, 8, 0, CAN_ERR_PROT_ACTIVE, false}, /* another class's byte */
    };
    struct socketcan_bus off = {.name = "off"};
    const struct can_bus port = socketcan_bus_interface(&off);
    const struct can_msg command = {.id = 0x201};
    struct can_msg message;
    struct can_bus_status status;
    int ends[2];
    ck_assert_int_eq(socketpair(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK, 0, ends), 0);
    off.fd = ends[0];
    pair_reports(ends[1], CAN_ERR_FLAG | CAN_ERR_BUSOFF, 8, 0, 0);
    ck_assert_int_eq(can_bus_receive(&port, &message, NULL), CAN_OK);
    ck_assert_int_eq(can_bus_send(&port, &command), CAN_DOWN);
    pair_reports(ends[1], signs[_i].id, signs[_i].length, signs[_i].controller, signs[_i].protocol);
    ck_assert_int_eq(can_bus_receive(&port, &message, NULL), CAN_OK);
    can_bus_get_status(&port, &status);
    ck_assert_int_eq(status.error_state == CAN_ERROR_ACTIVE, signs[_i].ends);
    ck_assert_uint_eq(status.bus_off_count, 1);
    ck_assert_int_eq(can_bus_send(&port, &command), signs[_i].ends ? CAN_OK : CAN_DOWN);
    socketcan_bus_close(&off);
    close(ends[1]);
}
END_TEST

/* A program that may not restart the controller says so once, and what to do. */
START_TEST(who_may_not_restart_the_controller_is_told_what_to_do)
{
    char advice[SOCKETCAN_ADVICE_MAX];
    struct can_msg message;
    ck_assert_int_eq(setuid(65534), 0); /* check runs each test in a process of its own */
    ck_assert(!socketcan_bus_advice(&bus, advice, sizeof advice));
    other_reports(CAN_ERR_BUSOFF, 0, 0, 0);
    ck_assert(wait_for_frame(200));
    ck_assert_int_eq(can_bus_receive(&can, &message, NULL), CAN_OK);
    ck_assert(!socketcan_bus_advice(&bus, advice, sizeof advice)); /* nobody has asked yet */
    can_bus_recover(&can);
    can_bus_recover(&can);
    ck_assert(socketcan_bus_advice(&bus, advice, sizeof advice));
    ck_assert_msg(strstr(advice, "ip link set vcan0 type can restart-ms 100") != NULL, "%s",
                  advice);
    ck_assert_msg(strstr(advice, "CAP_NET_ADMIN") != NULL, "%s", advice);
    ck_assert(!socketcan_bus_advice(&bus, advice, sizeof advice));
}
END_TEST

int main(int argc, char **argv)
{
    (void)argc;
    Suite *suite = suite_create("socketcan_bus");
    TCase *anywhere = tcase_create("anywhere");
    tcase_add_test(anywhere, wrong_arguments_are_refused);
    tcase_add_test(anywhere, a_full_queue_gives_up_its_least_urgent_frame_for_a_more_urgent_one);
    tcase_add_loop_test(anywhere, bus_off_ends_with_every_sign_of_life, 0, 8);
    suite_add_tcase(suite, anywhere);
    if (!in_vcan_is_possible()) {
        return run_suite(suite);
    }
    in_vcan_or_restart(argv);
    TCase *tcase = tcase_create("all");
    tcase_add_checked_fixture(tcase, setup, teardown);
    tcase_set_timeout(tcase, 30);
    tcase_add_test(tcase, frames_pass_the_filters_or_are_not_seen_at_all);
    tcase_add_test(tcase, only_the_own_sync_is_heard_and_in_its_place);
    tcase_add_test(tcase, what_is_sent_at_once_leaves_in_order_of_identifiers);
    tcase_add_test(tcase, a_frame_that_was_fetched_and_waits_is_seen);
    tcase_add_test(tcase, all_kinds_of_frames_go_out_as_they_are);
    tcase_add_test(tcase, error_frames_change_the_status);
    tcase_add_test(tcase, an_overflow_of_the_receive_queue_is_counted);
    tcase_add_test(tcase, an_interface_may_go_down_and_come_back);
    tcase_add_test(tcase, a_full_kernel_queue_keeps_frames_in_order_of_identifiers);
    tcase_add_test(tcase, who_may_not_restart_the_controller_is_told_what_to_do);
    tcase_add_test(tcase, opening_says_what_is_wrong);
    tcase_add_test(tcase, a_wait_ends_at_its_deadline_while_the_interface_is_down);
    tcase_add_test(tcase, an_interface_may_be_removed_and_made_again);
    suite_add_tcase(suite, tcase);
    return run_suite(suite);
}
