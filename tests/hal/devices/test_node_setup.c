/* The master configures a drive that others' rules define (sim_host/nodes), and
 * refuses one that is not what the device file says. */
#include "hal/bus/frame_table.h"
#include "hal/devices/device_keys.h"
#include "hal/devices/node_setup.h"
#include "sim_host/bus/sim_bus.h"
#include "sim_host/nodes/drive_node.h"
#include "tests/support/assert_close.h"
#include "tests/support/fake_bus.h"

#include <string.h>

enum { ANSWERS_MAX = 8 };

struct answer {
    struct can_msg message;
    uint64_t due_ns;
};

struct bench {
    struct sim_bus bus;
    struct can_bus master;
    struct drive_node drive;
    struct node_setup_config config;
    struct node_setup setup;
    uint64_t now_ns;
    uint64_t delay_ns; /* of every answer; then they wait here, oldest first */
    struct answer waiting[ANSWERS_MAX];
    unsigned waiting_count;
};

static struct bench b;
static void (*spoil)(struct can_msg *answer); /* of the drive's SDO server, on its way; or NULL */

static const struct node_setup_config as_the_drive_is = {
    .counts_per_m = {13107200, 13107200},
    .limit_max_counts = {4587520, 4587520},
    .following_error_counts = {1310720, 1310720},
    .rated_force_N = {50.0f, 50.0f},
};

static void start(void)
{
    const struct drive_node_config drive = {.side = SIDE_LEFT,
                                            .node_id = 1,
                                            .counts_per_m = 13107200,
                                            .stroke_m = 0.35,
                                            .max_speed_m_per_s = 1.9,
                                            .rated_force_N = 50.0,
                                            .following_error_m = 0.05,
                                            .unload_rate_m_per_s = 0.5};
    memset(&b, 0, sizeof b);
    spoil = NULL;
    sim_bus_init(&b.bus, 1000000);
    b.master = sim_bus_port(&b.bus, sim_bus_attach(&b.bus, "master", NULL, NULL));
    const int port = sim_bus_attach(&b.bus, "drive", NULL, NULL);
    ck_assert_int_eq(drive_node_init(&b.drive, &drive, sim_bus_port(&b.bus, port), 0), 0);
    b.config = as_the_drive_is;
    node_setup_start(&b.setup, &b.config, 1, 0);
}

static void hand_over(const struct can_msg *message)
{
    if (message != NULL) {
        ck_assert_uint_lt(b.waiting_count, ANSWERS_MAX);
        b.waiting[b.waiting_count++] = (struct answer){*message, b.now_ns + b.delay_ns};
    }
    while (b.waiting_count > 0 && b.waiting[0].due_ns <= b.now_ns) {
        (void)node_setup_receive(&b.setup, &b.waiting[0].message, b.now_ns);
        b.waiting_count--;
        memmove(b.waiting, b.waiting + 1, b.waiting_count * sizeof b.waiting[0]);
    }
}

/* Runs the setup to its end, at most thirty seconds. */
static enum setup_verdict finish(bool drive_answers)
{
    enum setup_verdict verdict = SETUP_BUSY;
    for (int tick = 0; tick < 30000 && verdict == SETUP_BUSY; tick++) {
        struct can_msg message;
        b.now_ns += 1000000;
        sim_bus_run_until(&b.bus, b.now_ns);
        if (drive_answers) {
            (void)drive_node_poll(&b.drive, b.now_ns);
            sim_bus_run_until(&b.bus, b.now_ns + 500000);
        }
        hand_over(NULL);
        while (can_bus_receive(&b.master, &message, NULL) == CAN_OK) {
            if (spoil != NULL && message.id == 0x581) {
                spoil(&message);
            }
            hand_over(&message);
        }
        verdict = node_setup_poll(&b.setup, &b.master, b.now_ns);
    }
    return verdict;
}

START_TEST(a_drive_as_expected_is_configured)
{
    start();
    ck_assert_int_eq(finish(true), SETUP_DONE);
    ck_assert_int_eq(b.drive.objects.mode_display, 8);
    ck_assert_uint_eq(b.drive.objects.following_window, 1310720);
    ck_assert_int_eq(b.drive.objects.limit_max, 4587520);
    ck_assert_uint_eq(b.drive.device.comm.rpdo[0].cob_id, 0x201);
    ck_assert_uint_eq(b.drive.device.comm.rpdo[0].map[0], 0x607A0020);
    ck_assert_uint_eq(b.drive.device.comm.rpdo[0].map[1], 0x00040020);
    ck_assert_uint_eq(b.drive.device.comm.tpdo[2].type, SLOW_PDO_TICKS);
    ck_assert_uint_eq(b.drive.device.comm.consumer[0], 16u << 16 | 250);
    /* What it does when it is left alone: CiA 402-2, 6007 = 1 is a fault, the option codes end in a ramp and then
     * torque off. 50 ms without a target are a lost master. */
    ck_assert_int_eq(b.drive.objects.abort_connection_option, 1);
    ck_assert_int_eq(b.drive.objects.quick_stop_option, 2);
    ck_assert_int_eq(b.drive.objects.shutdown_option, 1);
    ck_assert_int_eq(b.drive.objects.disable_option, 1);
    ck_assert_int_eq(b.drive.objects.fault_reaction_option, 2);
    ck_assert_uint_eq(b.drive.objects.following_timeout_ms, 50);
    ck_assert_uint_eq(b.drive.device.comm.rpdo[0].event_ms, 50);
    /* Nobody asks for PDOs by remote frames (CiA 301, 7.5.2.37, bit 30). */
    ck_assert_uint_eq(b.drive.device.comm.tpdo[0].cob_id, 0x40000181);
    ck_assert_uint_eq(b.drive.device.comm.tpdo[2].cob_id, 0x40000381);
}
END_TEST

/* A motor slower than the reference may ask for is refused before it walks, with both speeds. */
START_TEST(a_drive_that_is_too_slow_is_refused)
{
    start(); /* 1.9 m/s of 13,107,200 counts a metre */
    ck_assert_uint_eq(b.drive.objects.max_speed, 24903680);
    b.config.speed_needed_counts_s[SIDE_LEFT] = 24903681;
    ck_assert_int_eq(finish(true), SETUP_DIFFERS);
    ck_assert_uint_eq(b.setup.failure.index, 0x6080);
    ck_assert_uint_eq(b.setup.failure.expected, 24903681);
    ck_assert_uint_eq(b.setup.failure.found, 24903680);
    start();
    b.config.speed_needed_counts_s[SIDE_LEFT] = 24903680;
    ck_assert_int_eq(finish(true), SETUP_DONE);
    start();
    b.config.speed_needed_counts_s[SIDE_LEFT] = UINT32_MAX;
    b.drive.objects.max_speed = 0; /* no limit */
    ck_assert_int_eq(finish(true), SETUP_DONE);
    /* Counts of another size: that is what is wrong, and not the speed told in them. */
    start();
    b.config.counts_per_m[SIDE_LEFT] *= 2;
    b.config.speed_needed_counts_s[SIDE_LEFT] = 2 * 24903680;
    ck_assert_int_eq(finish(true), SETUP_DIFFERS);
    ck_assert_uint_eq(b.setup.failure.index, 0x6092);
}
END_TEST

/* A drive that answers PDOs to remote frames and knows no "no RTR": it is asked without the bit then. */
static bool no_rtr_refused;

static void knows_no_bit_30(struct can_msg *answer)
{
    if (answer->data[0] == 0x60 && answer->data[1] == 0x00 && answer->data[2] == 0x18 &&
        answer->data[3] == 1 && !no_rtr_refused) {
        const uint8_t value_range[8] = {0x80, 0x00, 0x18, 0x01, 0x30, 0x00, 0x09, 0x06};
        memcpy(answer->data, value_range, sizeof value_range);
        no_rtr_refused = true;
    }
}

START_TEST(a_drive_that_knows_no_bit_30_is_asked_without_it)
{
    no_rtr_refused = false;
    start();
    spoil = knows_no_bit_30;
    ck_assert_int_eq(finish(true), SETUP_DONE);
    ck_assert(no_rtr_refused);
    ck_assert_uint_eq(b.drive.device.comm.tpdo[0].cob_id & 0x800007FF, 0x181);
}
END_TEST

/* Any TPDO's COB-ID is tried once more, not only the first one's; an RPDO's has no such bit. */
static uint16_t refused_pdo;
static unsigned refused_times;

static void refuses_a_cob_id(struct can_msg *answer)
{
    if (answer->data[0] == 0x60 && (answer->data[1] | answer->data[2] << 8) == refused_pdo &&
        answer->data[3] == 1 && refused_times == 0) {
        const uint8_t value_range[8] = {
            0x80, (uint8_t)refused_pdo, (uint8_t)(refused_pdo >> 8), 0x01, 0x30, 0x00, 0x09, 0x06};
        memcpy(answer->data, value_range, sizeof value_range);
        refused_times++;
    }
}

START_TEST(only_a_tpdos_cob_id_is_tried_once_more)
{
    static const uint16_t pdos[] = {0x1800, 0x1802, 0x1400, 0x1401};
    refused_pdo = pdos[_i];
    refused_times = 0;
    start();
    spoil = refuses_a_cob_id;
    ck_assert_int_eq(finish(true), _i < 2 ? SETUP_DONE : SETUP_ABORTED);
    ck_assert_uint_eq(refused_times, 1);
    if (_i >= 2) {
        ck_assert_uint_eq(b.setup.failure.index, refused_pdo);
    }
}
END_TEST

/* 0x6061 and what is read back show the old value for a while after it was written: a drive changes its mode in
 * its own loop. Within 200 ms it is asked again, and then believed. */
static struct {
    uint16_t index;
    uint8_t sub, old;
    uint64_t first_ns, late_ns; /* asked first, and late from there on */
    unsigned asked;
} slow;

static void shows_the_old_value(struct can_msg *answer)
{
    const bool upload = (answer->data[0] & 0xE0) == 0x40;
    if (upload && (answer->data[1] | answer->data[2] << 8) == slow.index &&
        answer->data[3] == slow.sub) {
        slow.first_ns = slow.asked++ == 0 ? b.now_ns : slow.first_ns;
        if (b.now_ns - slow.first_ns < slow.late_ns) {
            answer->data[4] = slow.old;
        }
    }
}

START_TEST(a_value_that_comes_late_is_waited_for)
{
    static const struct {
        uint16_t index;
        uint8_t sub;
    } objects[] = {{0x6061, 0}, {0x6065, 0}, {0x1017, 0}, {0x1600, 0}};
    start();
    slow.index = objects[_i].index;
    slow.sub = objects[_i].sub;
    slow.old = 0x55;
    slow.late_ns = 150000000;
    slow.asked = 0;
    spoil = shows_the_old_value;
    ck_assert_int_eq(finish(true), SETUP_DONE);
    ck_assert_uint_ge(slow.asked, 3);
    start();
    spoil = shows_the_old_value;
    slow.late_ns = UINT64_MAX; /* it never comes */
    ck_assert_int_eq(finish(true), SETUP_DIFFERS);
    ck_assert_uint_eq(b.setup.failure.index, slow.index);
    ck_assert_uint_eq(b.setup.failure.found & 0xFF, 0x55);
}
END_TEST

START_TEST(another_scaling_is_refused_with_both_values)
{
    start();
    b.config.counts_per_m[SIDE_LEFT] = 10000000;
    ck_assert_int_eq(finish(true), SETUP_DIFFERS);
    ck_assert_uint_eq(b.setup.failure.node, 1);
    ck_assert_uint_eq(b.setup.failure.index, 0x6092);
    ck_assert_uint_eq(b.setup.failure.expected, 10000000);
    assert_close(b.setup.failure.found, 13107200.0, 2.0, 0.0);
}
END_TEST

/* A drive without the object says so (0x06020000, CiA 301 table 22): not asked again. */
static unsigned refused_6060;

static void knows_no_6060(struct can_msg *answer)
{
    if (answer->data[1] == 0x60 && answer->data[2] == 0x60) {
        refused_6060++;
        const uint8_t no_such_object[8] = {0x80, 0x60, 0x60, 0x00, 0x00, 0x00, 0x02, 0x06};
        memcpy(answer->data, no_such_object, sizeof no_such_object);
    }
}

START_TEST(a_drive_without_an_object_is_refused_with_its_abort_code)
{
    refused_6060 = 0;
    start();
    ck_assert(!node_setup_is_waiting(&b.setup)); /* nothing is asked yet */
    ck_assert_int_eq(node_setup_poll(&b.setup, &b.master, 0), SETUP_BUSY);
    ck_assert(node_setup_is_waiting(&b.setup));
    const struct can_msg type = {
        .id = 0x581, .length = 8, .data = {0x43, 0x00, 0x10, 0x00, 0x92, 0x01, 0x02, 0x00}};
    ck_assert(node_setup_receive(&b.setup, &type, 0));
    ck_assert(!node_setup_is_waiting(&b.setup)); /* answered, if not looked at yet */
    spoil = knows_no_6060;
    ck_assert_int_eq(finish(true), SETUP_ABORTED);
    ck_assert_uint_eq(b.setup.failure.index, 0x6060);
    ck_assert_uint_eq(b.setup.failure.found, 0x06020000);
    ck_assert_uint_eq(refused_6060, 1); /* final: only a PDO's COB-ID is tried once more */
    ck_assert_uint_eq(b.setup.timeouts, 0);
    ck_assert(!node_setup_is_waiting(&b.setup));
}
END_TEST

/* Asked for its type, 4 bytes, it answers with 8 in two segments: its first four are looked at. */
static unsigned segments;

static void type_has_8_bytes(struct can_msg *answer)
{
    static const uint8_t answers[3][8] = {{0x41, 0x00, 0x10, 0x00, 8},
                                          {0x00, 0x91, 0x01, 0x77, 0x77, 0x11, 0x22, 0x33},
                                          {0x1D, 0x44}};
    memcpy(answer->data, answers[segments], sizeof answers[segments]);
    segments += segments < 2 ? 1 : 0;
}

START_TEST(more_than_was_asked_for_is_cut)
{
    segments = 0;
    start();
    spoil = type_has_8_bytes;
    ck_assert_int_eq(finish(true), SETUP_DIFFERS);
    ck_assert_uint_eq(b.setup.failure.index, 0x1000);
    ck_assert_uint_eq(b.setup.failure.found, 0x0191); /* 401, not 402 */
    ck_assert_uint_eq(b.setup.failure.expected, 402);
}
END_TEST

static struct scaling_answer {
    uint8_t index, sub; /* of 60xxh */
    uint32_t value;
} case_of;

static void another_scaling(struct can_msg *answer)
{
    if (answer->data[1] == case_of.index && answer->data[2] == 0x60 &&
        answer->data[3] == case_of.sub) {
        for (unsigned i = 0; i < 4; i++) {
            answer->data[4 + i] = (uint8_t)(case_of.value >> (8 * i));
        }
    }
}

/* CiA 402-2: counts per turn (608Fh), gear ratio (6091h) and feed constant (6092h) are fractions; a
 * drive that gives a zero below or above the line has no scaling, and none is made up. */
START_TEST(a_scaling_of_nothing_is_refused)
{
    static const struct {
        uint8_t index, sub;
        uint32_t value, found;
    } cases[] = {{0x8F, 2, 0, 0},
                 {0x91, 2, 0, 0},
                 {0x92, 1, 0, 0},
                 {0x8F, 1, 0, 0},
                 {0x8F, 1, 1000, 0},                 /* far too few counts */
                 {0x8F, 1, UINT32_MAX, UINT32_MAX}}; /* more than fits 32 bits */
    start();
    case_of = (struct scaling_answer){cases[_i].index, cases[_i].sub, cases[_i].value};
    spoil = another_scaling;
    ck_assert_int_eq(finish(true), SETUP_DIFFERS);
    ck_assert_uint_eq(b.setup.failure.index, 0x6092);
    ck_assert_uint_eq(b.setup.failure.expected, 13107200);
    if (cases[_i].value == 1000) {
        ck_assert_uint_gt(b.setup.failure.found, 0);
        ck_assert_uint_lt(b.setup.failure.found, 13107200);
    } else {
        ck_assert_uint_eq(b.setup.failure.found, cases[_i].found);
    }
}
END_TEST

/* 50 N through a screw of 5 mm a turn: 50 * 0.005 / 2 pi = 39.8 mNm, told as 40. */
START_TEST(another_rated_torque_is_refused_with_both_values)
{
    start();
    ck_assert_uint_eq(b.drive.objects.rated_torque_mNm, 40);
    b.drive.objects.rated_torque_mNm = 42;
    ck_assert_int_eq(finish(true), SETUP_DIFFERS);
    ck_assert_uint_eq(b.setup.failure.index, 0x6076);
    ck_assert_uint_eq(b.setup.failure.expected, 40);
    ck_assert_uint_eq(b.setup.failure.found, 42);
    start();
    b.drive.objects.rated_torque_mNm = 42; /* however small the force that is made of it */
    b.config.rated_force_N[SIDE_LEFT] = 0.05f;
    ck_assert_int_eq(finish(true), SETUP_DIFFERS);
    ck_assert_uint_eq(b.setup.failure.index, 0x6076);
    start();
    b.drive.objects.rated_torque_mNm = 0; /* a drive that does not know */
    ck_assert_int_eq(finish(true), SETUP_DIFFERS);
    start();
    b.drive.objects.rated_torque_mNm = 42;
    b.config.rated_force_N[SIDE_LEFT] = 0.0f; /* no force is made of it: not compared */
    ck_assert_int_eq(finish(true), SETUP_DONE);
    for (uint32_t told_mNm = 0; told_mNm <= 40; told_mNm += 40) {
        start(); /* without scaling the device's file tells it, or nobody does */
        b.drive.objects.rated_torque_mNm = 42;
        b.config.lacks[SIDE_LEFT] = 1u << (unsigned)DEVICE_LACKS_SCALING;
        b.config.rated_torque_mNm[SIDE_LEFT] = told_mNm;
        ck_assert_int_eq(finish(true), told_mNm == 0 ? SETUP_DONE : SETUP_DIFFERS);
    }
    for (uint32_t found_mNm = 72; found_mNm <= 78;
         found_mNm++) { /* 75 and 2 %, and half of one: 2 */
        start();
        b.drive.objects.rated_torque_mNm = found_mNm;
        b.config.lacks[SIDE_LEFT] = 1u << (unsigned)DEVICE_LACKS_SCALING;
        b.config.rated_torque_mNm[SIDE_LEFT] = 75;
        const bool is_alike = found_mNm >= 73 && found_mNm <= 77;
        ck_assert_int_eq(finish(true), is_alike ? SETUP_DONE : SETUP_DIFFERS);
    }
}
END_TEST

/* Whose steps a node gets, its number says: as configured, else as the standard numbers go. */
START_TEST(a_number_says_what_a_node_is)
{
    uint8_t numbers[NETWORK_NODES];
    for (uint8_t role = 0; role < NETWORK_NODES; role++) {
        numbers[role] = (uint8_t)(21 + role);
    }
    for (uint8_t role = 0; role < NETWORK_NODES; role++) {
        struct node_setup setup;
        struct node_setup_config config = as_the_drive_is;
        node_setup_start(&setup, &config, (uint8_t)(role + 1), 0);
        ck_assert_uint_eq(setup.role, role < 4 ? role : (uint8_t)NETWORK_LATCH_LEFT);
        memcpy(config.node, numbers, sizeof config.node);
        node_setup_start(&setup, &config, numbers[role], 0);
        ck_assert_uint_eq(setup.role, role);
    }
}
END_TEST

START_TEST(another_kind_of_device_is_refused)
{
    start();
    b.drive.device.comm.device_type = 401;
    ck_assert_int_eq(finish(true), SETUP_DIFFERS);
    ck_assert_uint_eq(b.setup.failure.index, 0x1000);
    ck_assert_uint_eq(b.setup.failure.found, 401);
}
END_TEST

START_TEST(a_silent_node_is_named)
{
    start();
    ck_assert_int_eq(finish(false), SETUP_SILENT);
    ck_assert_uint_eq(b.setup.failure.node, 1);
}
END_TEST

/* Loses every 17th answer of the drive. */
static struct sim_bus_fault lose_some(void *context, const struct can_msg *message, unsigned sender,
                                      uint64_t time_ns)
{
    unsigned *answers = context;
    struct sim_bus_fault fault = {.kind = SIM_BUS_FAULT_NONE};
    (void)sender;
    (void)time_ns;
    if (message->id == 0x581 && ++*answers % 17 == 0) {
        fault.kind = SIM_BUS_FAULT_DROP;
    }
    return fault;
}

START_TEST(lost_frames_delay_but_do_not_refuse)
{
    unsigned answers = 0;
    start();
    sim_bus_set_fault_hook(&b.bus, lose_some, &answers);
    ck_assert_int_eq(finish(true), SETUP_DONE);
    ck_assert_uint_ge(answers, 34);
}
END_TEST

/* Asked again after 100 ms, the node answers twice: the second answer comes into the next
 * transfer, and is none to it. */
START_TEST(late_answers_delay_but_do_not_refuse)
{
    start();
    b.delay_ns = UINT64_C(130000000);
    ck_assert_int_eq(finish(true), SETUP_DONE);
    ck_assert_int_eq(b.drive.objects.limit_max, 4587520);
    ck_assert_uint_gt(b.now_ns, 34 * b.delay_ns);
}
END_TEST

START_TEST(nothing_is_sent_after_a_refusal)
{
    start();
    b.drive.device.comm.device_type = 0;
    ck_assert_int_eq(finish(true), SETUP_DIFFERS);
    const uint64_t frames = b.bus.stats.frames;
    for (int i = 0; i < 100; i++) {
        ck_assert_int_eq(node_setup_poll(&b.setup, &b.master, b.now_ns), SETUP_DIFFERS);
    }
    sim_bus_run_until(&b.bus, b.now_ns + 10000000);
    ck_assert_uint_eq(b.bus.stats.frames, frames);
}
END_TEST

START_TEST(what_was_not_answered_is_asked_again_at_once)
{
    static struct fake_bus fake;
    const struct can_bus bus = fake_bus_interface(&fake);
    fake_bus_init(&fake);
    start();
    for (uint64_t ms = 0; ms <= SETUP_TIMEOUT_MS + 1; ms++) {
        ck_assert_int_eq(node_setup_poll(&b.setup, &bus, ms * 1000000), SETUP_BUSY);
        ck_assert_uint_eq(fake_bus_count(&fake, 0x601), ms <= SETUP_TIMEOUT_MS ? 1 : 3);
    }
    ck_assert_uint_eq(fake_bus_last(&fake, 0x601)->data[0], 0x40); /* behind the abort */
}
END_TEST

static void heartbeat_has_a_high_bit(struct can_msg *answer)
{
    if (answer->data[0] == 0x4B && answer->data[1] == 0x17 && answer->data[2] == 0x10) {
        answer->data[5] |= 0x80;
    }
}

/* All bits of an object are compared: a heartbeat of 32,868 ms is none of 100. */
START_TEST(every_bit_of_a_value_is_compared)
{
    start();
    spoil = heartbeat_has_a_high_bit;
    ck_assert_int_eq(finish(true), SETUP_DIFFERS);
    ck_assert_uint_eq(b.setup.failure.index, 0x1017);
    ck_assert_uint_eq(b.setup.failure.expected, HEARTBEAT_PERIOD_MS);
    ck_assert_uint_eq(b.setup.failure.found, HEARTBEAT_PERIOD_MS | 0x8000);
}
END_TEST

static void mode_has_four_bytes(struct can_msg *answer)
{
    if (answer->data[0] == 0x4F && answer->data[1] == 0x60 && answer->data[2] == 0x60) {
        answer->data[0] = 0x43;
        memset(answer->data + 5, 0x55, 3);
    }
}

/* And none beyond its size: a mode is one byte, whatever stands behind it. */
START_TEST(bytes_behind_a_value_are_not_compared)
{
    start();
    spoil = mode_has_four_bytes;
    ck_assert_int_eq(finish(true), SETUP_DONE);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("node_setup");
    TCase *tests = tcase_create("all");
    tcase_add_test(tests, a_drive_as_expected_is_configured);
    tcase_add_test(tests, another_scaling_is_refused_with_both_values);
    tcase_add_test(tests, a_drive_without_an_object_is_refused_with_its_abort_code);
    tcase_add_test(tests, more_than_was_asked_for_is_cut);
    tcase_add_loop_test(tests, a_scaling_of_nothing_is_refused, 0, 6);
    tcase_add_test(tests, another_rated_torque_is_refused_with_both_values);
    tcase_add_test(tests, another_kind_of_device_is_refused);
    tcase_add_test(tests, a_number_says_what_a_node_is);
    tcase_add_loop_test(tests, only_a_tpdos_cob_id_is_tried_once_more, 0, 4);
    tcase_add_test(tests, a_silent_node_is_named);
    tcase_add_test(tests, lost_frames_delay_but_do_not_refuse);
    tcase_add_test(tests, late_answers_delay_but_do_not_refuse);
    tcase_add_test(tests, nothing_is_sent_after_a_refusal);
    tcase_add_test(tests, a_drive_that_knows_no_bit_30_is_asked_without_it);
    tcase_add_loop_test(tests, a_value_that_comes_late_is_waited_for, 0, 4);
    tcase_add_test(tests, a_drive_that_is_too_slow_is_refused);
    tcase_add_test(tests, what_was_not_answered_is_asked_again_at_once);
    tcase_add_test(tests, every_bit_of_a_value_is_compared);
    tcase_add_test(tests, bytes_behind_a_value_are_not_compared);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
