/* A device without a profile: every reaction is NULL, what is left is CiA 301 alone (clauses 7.2.7,
 * 7.2.8, 7.5.2). Its errors, its limits, and what it does when nobody listens. */
#include <check.h>
#include <signal.h>
#include <string.h>

#include "hal/bus/bytes.h"
#include "hal/canopen/co_device.h"
#include "hal/canopen/co_pdo_objects.h"
#include "tests/support/assert_close.h"
#include "tests/support/fake_bus.h"

enum { NODE = 5, MS = 1000000, REFUSED_VALUE = 0x06090030, REFUSED_ACCESS = 0x06010000 };

struct values {
    uint32_t number;
    int16_t small;
    int32_t narrow;
    uint8_t flag;
};

#define RW (CO_READ | CO_WRITE | CO_MAP_RX | CO_MAP_TX)
static const struct co_entry table[] = {
    CO_ANY(struct values, number, 0x2000, 0, CO_UNSIGNED32, RW, "number"),
    CO_ANY(struct values, small, 0x2001, 0, CO_INTEGER16, RW, "small"),
    CO_ANY(struct values, narrow, 0x2002, 0, CO_INTEGER24, RW, "narrow"),
    CO_ANY(struct values, flag, 0x2003, 0, CO_BOOLEAN, RW, "flag"),
};

static struct fake_bus fake;
static struct values values;
static struct co_pdo_four pdos;
static struct co_device device;
static uint32_t mapped;     /* what the first RPDO is mapped to by default */
static uint32_t mapped_out; /* and the second TPDO, which is cyclic; 0: to nothing */
static uint32_t out_cob_id;
static uint8_t map_count;
static uint16_t heartbeat_ms;
static uint64_t now_ns;

static void defaults(void *context, struct co_comm *comm)
{
    (void)context;
    comm->rpdo[0].cob_id = 0x205;
    comm->rpdo[0].event_ms = 20;
    comm->rpdo[0].map[0] = mapped;
    comm->rpdo[0].map_count = map_count;
    if (mapped_out != 0) {
        comm->tpdo[1].cob_id = out_cob_id;
        comm->tpdo[1].type = 1;
        comm->tpdo[1].map[0] = mapped_out;
        comm->tpdo[1].map_count = 1;
    }
    comm->heartbeat_ms = heartbeat_ms;
}

static const struct co_device_ops none = {.sync = NULL};
static const struct co_device_ops *ops = &none;

static int init(uint8_t node)
{
    static const struct co_dictionary dictionary = {table, sizeof table / sizeof table[0], &values};
    const struct co_device_config config = {.node_id = node,
                                            .application = &dictionary,
                                            .ops = ops,
                                            .pdos = co_pdo_four_init(&pdos),
                                            .defaults = defaults};
    return co_device_init(&device, &config, fake_bus_interface(&fake), now_ns);
}

static void setup(void)
{
    fake_bus_init(&fake);
    memset(&values, 0, sizeof values);
    memset(&pdos, 0, sizeof pdos);
    mapped = 0x20000020;
    mapped_out = 0;
    out_cob_id = 0x285;
    map_count = 1;
    heartbeat_ms = 0;
    now_ns = 1000 * (uint64_t)MS;
    ck_assert_int_eq(init(NODE), 0);
}

static bool give(uint32_t id, uint8_t length, uint64_t data)
{
    struct can_msg message = {.id = id, .length = length};
    memcpy(message.data, &data, 8);
    return co_device_receive(&device, &message, now_ns);
}

static void nmt(uint8_t command)
{
    ck_assert(give(0x000, 2, command | NODE << 8));
}

static void run(int ms)
{
    for (int i = 0; i < ms; i++) {
        now_ns += MS;
        co_device_process(&device, now_ns);
    }
}

static uint32_t sdo(uint8_t command, uint16_t index, uint8_t sub, uint32_t data)
{
    struct can_msg request = {.id = 0x600 + NODE, .length = 8, .data = {command}};
    bytes_put_u16(request.data + 1, index);
    request.data[3] = sub;
    bytes_put_u32(request.data + 4, data);
    ck_assert(co_device_receive(&device, &request, now_ns));
    const struct can_msg *answer = fake_bus_last(&fake, 0x580 + NODE);
    ck_assert_ptr_nonnull(answer);
    return answer->data[0] == 0x80 || command == 0x40 ? bytes_get_u32(answer->data + 4) : 0;
}

static const struct can_msg *emergency(void)
{
    return fake_bus_last(&fake, 0x080 + NODE);
}

START_TEST(an_unusable_configuration_is_refused)
{
    ck_assert_int_eq(init(0), -1);
    ck_assert_int_eq(init(128), -1);
    ck_assert_int_eq(init(127), 0);
    mapped = 0x20000010; /* 32 bits mapped as 16 */
    ck_assert_int_eq(init(NODE), -1);
    mapped = 0x21000020; /* no such object */
    ck_assert_int_eq(init(NODE), -1);
    mapped = 0x20000020;
    map_count = CO_PDO_MAP_MAX + 1;
    ck_assert_int_eq(init(NODE), -1);
    map_count = 1;
    mapped_out = 0x21000020;
    ck_assert_int_eq(init(NODE), -1);
    mapped_out = 0x20000020;
    ck_assert_int_eq(init(NODE), 0);
}
END_TEST

START_TEST(it_lives_without_a_profile)
{
    ck_assert_uint_eq(fake_bus_last(&fake, 0x705)->data[0], 0); /* boot-up */
    nmt(1);
    ck_assert_int_eq(device.state, CO_STATE_OPERATIONAL);
    ck_assert(give(0x205, 4, 0x12345678));
    ck_assert_uint_eq(values.number, 0x12345678);
    ck_assert(give(0x080, 0, 0));
    run(25); /* the RPDO's event timer runs out, and it comes again */
    ck_assert(co_device_has_error(&device, CO_EMCY_RPDO_TIMEOUT));
    ck_assert(give(0x205, 4, 1));
    ck_assert(!co_device_has_error(&device, CO_EMCY_RPDO_TIMEOUT));
    nmt(129);
    ck_assert_int_eq(device.state, CO_STATE_PRE_OPERATIONAL);
    ck_assert_uint_eq(sdo(0x23, 0x2000, 0, 77), 0);
    ck_assert_uint_eq(sdo(0x40, 0x2000, 0, 0), 77);
    ck_assert_uint_eq(values.number, 77);
}
END_TEST

/* A cyclic TPDO comes with the SYNC and with nothing else. */
START_TEST(a_cyclic_pdo_is_not_triggered)
{
    mapped_out = 0x20000020;
    ck_assert_int_eq(init(NODE), 0);
    nmt(1);
    fake_bus_clear(&fake);
    co_device_trigger_tpdo(&device, 1);
    run(5);
    ck_assert_ptr_null(fake_bus_last(&fake, 0x285));
    ck_assert(give(0x080, 0, 0));
    ck_assert_uint_eq(fake_bus_count(&fake, 0x285), 1);
    ck_assert(give(0x080, 0, 0));
    ck_assert_uint_eq(fake_bus_count(&fake, 0x285), 2);
}
END_TEST

/* Bit 31 of the identifier takes a PDO out of use (CiA 301 clause 7.5.2.35): what had come is not
 * used at the next SYNC, and nobody waits for another. */
START_TEST(a_pdo_that_was_switched_off_is_forgotten)
{
    ck_assert_uint_eq(sdo(0x23, 0x1400, 1, 0x80000205), 0);
    ck_assert_uint_eq(sdo(0x2F, 0x1400, 2, 1), 0); /* taken at the SYNC */
    ck_assert_uint_eq(sdo(0x23, 0x1400, 1, 0x205), 0);
    nmt(1);
    ck_assert(give(0x205, 4, 0x11));
    ck_assert(give(0x080, 0, 0));
    ck_assert_uint_eq(values.number, 0x11);
    ck_assert(give(0x205, 4, 0x22));
    ck_assert_uint_eq(sdo(0x23, 0x1400, 1, 0x80000205), 0);
    ck_assert(give(0x080, 0, 0));
    ck_assert_uint_eq(values.number, 0x11);
    run(50); /* its event timer is 20 ms */
    ck_assert(!co_device_has_error(&device, CO_EMCY_RPDO_TIMEOUT));
}
END_TEST

START_TEST(what_is_not_for_it_is_left_to_others)
{
    struct can_msg message = {.id = 0x205, .length = 4, .flags = CAN_FRAME_EXTENDED};
    ck_assert(!co_device_receive(&device, &message, now_ns));
    message.flags = CAN_FRAME_REMOTE;
    ck_assert(!co_device_receive(&device, &message, now_ns));
    ck_assert(!give(0x185, 8, 0));
    ck_assert(!give(0x700, 1, 0));                  /* node 0 has no heartbeat */
    ck_assert(give(0x000, 2, 1 | (NODE + 1) << 8)); /* NMT to another node */
    ck_assert_int_eq(device.state, CO_STATE_PRE_OPERATIONAL);
    ck_assert(give(0x000, 2, 1)); /* to all */
    ck_assert_int_eq(device.state, CO_STATE_OPERATIONAL);
    ck_assert_uint_eq(device.counters.malformed, 0);
}
END_TEST

/* Its time-out is a number beside the PDO (CiA 301, 7.5.2.35): a change of it takes nothing away that waits
 * for the SYNC, however often it is written, and the new time begins with it. */
START_TEST(a_new_time_out_drops_no_pdo)
{
    ck_assert_uint_eq(sdo(0x23, 0x1400, 1, 0x80000205), 0);
    ck_assert_uint_eq(sdo(0x2F, 0x1400, 2, 1), 0); /* taken at the SYNC */
    ck_assert_uint_eq(sdo(0x23, 0x1400, 1, 0x205), 0);
    nmt(1);
    ck_assert(give(0x205, 4, 0x55));
    ck_assert_uint_eq(sdo(0x2B, 0x1400, 5, 30), 0);
    ck_assert_uint_eq(values.number, 0);
    ck_assert(give(0x080, 0, 0));
    ck_assert_uint_eq(values.number, 0x55);
    run(25);
    ck_assert(!co_device_has_error(&device, CO_EMCY_RPDO_TIMEOUT));
    run(10);
    ck_assert(co_device_has_error(&device, CO_EMCY_RPDO_TIMEOUT));
    ck_assert_uint_eq(sdo(0x2B, 0x1400, 5, 0), 0); /* not watched any more: it is over */
    ck_assert(!co_device_has_error(&device, CO_EMCY_RPDO_TIMEOUT));
}
END_TEST

START_TEST(a_pdo_of_a_wrong_length)
{
    nmt(1);
    ck_assert(give(0x205, 3, 0x0102));
    ck_assert(co_device_has_error(&device, CO_EMCY_PDO_TOO_SHORT));
    ck_assert_uint_eq(values.number, 0); /* too short is not taken */
    ck_assert(give(0x205, 8, 0x99));
    ck_assert(co_device_has_error(&device, CO_EMCY_PDO_TOO_LONG));
    ck_assert_uint_eq(values.number, 0x99); /* too long is, its first bytes */
    ck_assert_uint_eq(device.counters.rpdo_length_errors, 2);
    ck_assert(give(0x205, 4, 0x55));
    ck_assert(!co_device_has_error(&device, CO_EMCY_PDO_TOO_LONG));
    ck_assert(!co_device_has_error(&device, CO_EMCY_PDO_TOO_SHORT));
    ck_assert_uint_eq(device.comm.error_register, 0);
}
END_TEST

/* 0x1029:1 says what a lost heartbeat does: 0 pre-operational, 1 nothing, 2 stopped. */
START_TEST(the_error_behaviour_is_obeyed)
{
    static const enum co_nmt_state after[] = {CO_STATE_PRE_OPERATIONAL, CO_STATE_OPERATIONAL,
                                              CO_STATE_STOPPED};
    ck_assert_uint_eq(sdo(0x2F, 0x1029, 1, (uint32_t)_i), 0);
    ck_assert_uint_eq(sdo(0x23, 0x1016, 1, 0x0011000A), 0); /* node 17, 10 ms */
    nmt(1);
    ck_assert(give(0x711, 8, 5)); /* a heartbeat has one byte */
    ck_assert_uint_eq(device.counters.malformed, 1);
    run(20);
    ck_assert(!co_device_has_error(&device, CO_EMCY_HEARTBEAT)); /* not monitored yet */
    ck_assert(give(0x711, 1, 5));
    run(8);
    ck_assert_int_eq(device.state, CO_STATE_OPERATIONAL);
    run(4);
    ck_assert_int_eq(device.state, after[_i]);
    ck_assert(co_device_has_error(&device, CO_EMCY_HEARTBEAT));
    ck_assert(give(0x711, 1, 5));
    ck_assert(!co_device_has_error(&device, CO_EMCY_HEARTBEAT));
}
END_TEST

START_TEST(a_stopped_node_is_silent)
{
    nmt(2);
    fake_bus_clear(&fake);
    co_device_raise(&device, 0x2310, CO_ERROR_GENERIC, NULL);
    run(5);
    ck_assert_ptr_null(emergency());
    ck_assert(give(0x605, 8, 0x200040));
    ck_assert_ptr_null(fake_bus_last(&fake, 0x585));
    ck_assert_uint_eq(device.comm.history[0], 0x2310); /* remembered all the same */
    nmt(128);
    run(5);
    ck_assert_ptr_null(emergency()); /* what was not said then is not news now */
}
END_TEST

/* More emergencies than the queue holds, on a bus that takes none: kept are the newest, which tell
 * how things are now, and the loss of the oldest is counted. */
START_TEST(emergencies_wait_for_the_bus)
{
    run(1);
    fake.verdict = CAN_FULL;
    for (uint16_t i = 0; i < CO_EMCY_QUEUE + 2; i++) {
        co_device_raise(&device, (uint16_t)(0x6100 + i), CO_ERROR_GENERIC, NULL);
        co_device_raise(&device, (uint16_t)(0x6100 + i), CO_ERROR_GENERIC, NULL); /* said once */
    }
    ck_assert_uint_eq(device.counters.emcy_lost, 2);
    run(3);
    fake.verdict = CAN_OK;
    fake_bus_clear(&fake);
    run(20);
    ck_assert_uint_eq(fake_bus_count(&fake, 0x085), CO_EMCY_QUEUE);
    for (unsigned i = 0; i < CO_EMCY_QUEUE; i++) {
        ck_assert_uint_eq(bytes_get_u16(fake.sent[i].data), 0x6102U + i);
    }
    co_device_clear(&device, 0x1234);       /* what was never raised is not cleared, */
    co_device_clear(&device, CO_EMCY_NONE); /* nor is what is no error */
    run(2);
    ck_assert_uint_eq(fake_bus_count(&fake, 0x085), CO_EMCY_QUEUE);
}
END_TEST

/* As many emergencies as wait, and then the news that all is over: it is what must arrive. */
START_TEST(the_end_of_an_error_is_told_also_through_a_full_queue)
{
    run(1);
    fake.verdict = CAN_FULL;
    for (uint16_t i = 0; i < CO_EMCY_QUEUE; i++) {
        co_device_raise(&device, (uint16_t)(0x6100 + i), CO_ERROR_GENERIC, NULL);
    }
    for (uint16_t i = 0; i < CO_EMCY_QUEUE; i++) {
        co_device_clear(&device, (uint16_t)(0x6100 + i));
    }
    fake.verdict = CAN_OK;
    run(20);
    ck_assert_uint_eq(bytes_get_u16(emergency()->data), 0x0000);
    ck_assert_uint_eq(emergency()->data[2], 0);
    ck_assert_uint_eq(device.counters.emcy_lost, CO_EMCY_QUEUE);
}
END_TEST

/* Counts the emergencies with this code. */
static unsigned emergencies(uint16_t code)
{
    unsigned count = 0;
    for (unsigned i = 0; i < fake.sent_count; i++) {
        count += fake.sent[i].id == 0x080 + NODE && bytes_get_u16(fake.sent[i].data) == code;
    }
    return count;
}

/* Time-outs of RPDOs (CiA 301 clause 7.5.2.35, event timer) end with the RPDO, with its use, and
 * with the state operational; the next one is told again. */
START_TEST(a_time_out_is_over_when_its_pdo_is_not_used_any_more)
{
    nmt(1);
    ck_assert(give(0x205, 4, 1));
    run(25);
    ck_assert_uint_eq(emergencies(CO_EMCY_RPDO_TIMEOUT), 1);
    ck_assert_uint_eq(device.comm.error_register, CO_ERROR_GENERIC | CO_ERROR_COMMUNICATION);
    if (_i == 0) {
        ck_assert_uint_eq(sdo(0x23, 0x1400, 1, 0x80000205), 0);
    } else {
        nmt(128);
    }
    run(5);
    ck_assert(!co_device_has_error(&device, CO_EMCY_RPDO_TIMEOUT));
    ck_assert_uint_eq(device.comm.error_register, 0);
    ck_assert_uint_eq(bytes_get_u16(emergency()->data), 0);
    ck_assert_uint_eq(sdo(0x40, 0x1001, 0, 0), 0);
    if (_i == 0) {
        ck_assert_uint_eq(sdo(0x23, 0x1400, 1, 0x205), 0);
    } else {
        nmt(1);
    }
    ck_assert(give(0x205, 4, 1));
    run(25);
    ck_assert_uint_eq(emergencies(CO_EMCY_RPDO_TIMEOUT), 2);
}
END_TEST

/* An event timer that is written anew, or 0, watches anew. */
START_TEST(a_time_out_is_over_when_its_timer_is_written)
{
    nmt(1);
    ck_assert(give(0x205, 4, 1));
    run(25);
    ck_assert_uint_eq(sdo(0x2B, 0x1400, 5, 0), 0);
    run(5);
    ck_assert_uint_eq(device.comm.error_register, 0);
}
END_TEST

/* The first RPDO has never come, and the second, which did, is late: that is told. */
START_TEST(a_pdo_that_never_came_hides_no_late_one)
{
    ck_assert_uint_eq(sdo(0x23, 0x1601, 1, 0x20010010), 0);
    ck_assert_uint_eq(sdo(0x2F, 0x1601, 0, 1), 0);
    ck_assert_uint_eq(sdo(0x2B, 0x1401, 5, 20), 0);
    ck_assert_uint_eq(sdo(0x23, 0x1401, 1, 0x305), 0);
    nmt(1);
    ck_assert(give(0x305, 2, 1));
    run(25);
    ck_assert_uint_eq(emergencies(CO_EMCY_RPDO_TIMEOUT), 1);
}
END_TEST

/* Two RPDOs are late, one of them comes back: the other's error lasts and says so. */
START_TEST(each_pdo_has_errors_of_its_own)
{
    ck_assert_uint_eq(sdo(0x23, 0x1601, 1, 0x20010010), 0);
    ck_assert_uint_eq(sdo(0x2F, 0x1601, 0, 1), 0);
    ck_assert_uint_eq(sdo(0x2B, 0x1401, 5, 20), 0);
    ck_assert_uint_eq(sdo(0x23, 0x1401, 1, 0x305), 0);
    nmt(1);
    ck_assert(give(0x205, 4, 1));
    ck_assert(give(0x305, 2, 1));
    run(25);
    ck_assert_uint_eq(emergencies(CO_EMCY_RPDO_TIMEOUT), 2);
    ck_assert(give(0x205, 4, 1));
    run(1);
    ck_assert(co_device_has_error(&device, CO_EMCY_RPDO_TIMEOUT));
    ck_assert_uint_eq(bytes_get_u16(emergency()->data), 0);
    ck_assert_uint_eq(emergency()->data[2], CO_ERROR_GENERIC | CO_ERROR_COMMUNICATION);
    ck_assert(give(0x305, 1, 0));
    ck_assert(give(0x205, 4, 1)); /* that one is right, the other was too short */
    ck_assert(co_device_has_error(&device, CO_EMCY_PDO_TOO_SHORT));
    ck_assert_uint_eq(sdo(0x23, 0x1401, 1, 0x80000305), 0);
    run(5);
    ck_assert_uint_eq(device.comm.error_register, 0);
    ck_assert_uint_eq(emergency()->data[2], 0);
}
END_TEST

/* A consumer that is written anew (0x1016, CiA 301 clause 7.5.2.19) waits for its node anew. */
START_TEST(a_lost_heartbeat_is_over_when_its_consumer_is_written)
{
    ck_assert_uint_eq(sdo(0x2F, 0x1029, 1, 1), 0);
    ck_assert_uint_eq(sdo(0x23, 0x1016, 1, 0x0011000A), 0);
    ck_assert_uint_eq(sdo(0x23, 0x1016, 2, 0x0012000A), 0);
    ck_assert(give(0x711, 1, 5));
    ck_assert(give(0x712, 1, 5));
    run(12);
    ck_assert_uint_eq(emergencies(CO_EMCY_HEARTBEAT), 2); /* both nodes' */
    ck_assert_uint_eq(sdo(0x23, 0x1016, 1, 0x0011000A), 0);
    run(1);
    ck_assert_uint_eq(bytes_get_u16(emergency()->data), 0);
    ck_assert_uint_eq(emergency()->data[2], CO_ERROR_GENERIC | CO_ERROR_COMMUNICATION);
    ck_assert_uint_eq(sdo(0x23, 0x1016, 2, 0), 0);
    run(1);
    ck_assert_uint_eq(device.comm.error_register, 0);
    ck_assert(give(0x711, 1, 5));
    run(12);
    ck_assert_uint_eq(emergencies(CO_EMCY_HEARTBEAT), 3);
}
END_TEST

/* The port's state alone tells that it is over: not every driver sends a frame of it. */
START_TEST(the_end_of_its_bus_off_is_seen_without_an_error_frame)
{
    struct can_msg error = {.flags = CAN_FRAME_ERROR};
    fake.status.error_state = CAN_BUS_OFF;
    ck_assert(co_device_receive(&device, &error, now_ns));
    fake.status.error_state = CAN_ERROR_PASSIVE;
    run(5);
    ck_assert_uint_eq(emergencies(CO_EMCY_BUS_OFF_RECOVERED), 1);
    ck_assert(co_device_has_error(&device, CO_EMCY_CAN_PASSIVE));
    fake.status.error_state = CAN_ERROR_WARNING; /* not passive any more */
    run(5);
    ck_assert_uint_eq(device.comm.error_register, 0);
}
END_TEST

START_TEST(its_own_bus_off_is_survived)
{
    nmt(1);
    struct can_msg error = {.flags = CAN_FRAME_ERROR};
    fake.status.error_state = CAN_BUS_OFF;
    ck_assert(co_device_receive(&device, &error, now_ns));
    ck_assert(co_device_receive(&device, &error, now_ns)); /* asked for once */
    ck_assert_uint_eq(fake.recoveries, 1);
    ck_assert_int_eq(device.state, CO_STATE_PRE_OPERATIONAL); /* 0x1029:1 = 0 */
    fake.status.error_state = CAN_ERROR_PASSIVE;
    ck_assert(co_device_receive(&device, &error, now_ns));
    ck_assert(co_device_has_error(&device, CO_EMCY_CAN_PASSIVE));
    fake.status.error_state = CAN_ERROR_ACTIVE;
    ck_assert(co_device_receive(&device, &error, now_ns));
    ck_assert(!co_device_has_error(&device, CO_EMCY_CAN_PASSIVE));
    run(5);
    ck_assert_uint_eq(bytes_get_u16(fake_bus_last(&fake, 0x085)->data), 0);
    ck_assert_uint_eq(device.comm.history[device.comm.history_count - 1],
                      CO_EMCY_BUS_OFF_RECOVERED);
}
END_TEST

/* Without a heartbeat there is no time to wait for; the boot-up is repeated until the bus takes it. */
START_TEST(the_boot_up_waits_for_the_bus)
{
    fake.verdict = CAN_FULL;
    ck_assert_int_eq(init(NODE), 0);
    run(3);
    ck_assert_uint_eq(device.counters.send_failures, 4);
    fake.verdict = CAN_OK;
    fake_bus_clear(&fake);
    run(50);
    ck_assert_uint_eq(fake_bus_count(&fake, 0x705), 1);
    ck_assert_uint_eq(sdo(0x2B, 0x1017, 0, 10), 0);
    run(50);
    ck_assert_uint_ge(fake_bus_count(&fake, 0x705), 5);
}
END_TEST

/* Nobody has heard yet that it is there: a heartbeat of 20 ms is no reason to let the boot-up wait
 * for it, and none to be heard before it. */
START_TEST(the_boot_up_comes_before_the_first_heartbeat)
{
    heartbeat_ms = 20;
    fake.verdict = CAN_FULL;
    ck_assert_int_eq(init(NODE), 0);
    run(5);
    fake.verdict = CAN_OK;
    fake_bus_clear(&fake);
    run(1);
    ck_assert_uint_eq(fake_bus_count(&fake, 0x705), 1);
    ck_assert_uint_eq(fake_bus_last(&fake, 0x705)->data[0], 0);
    run(19);
    ck_assert_uint_eq(fake_bus_count(&fake, 0x705), 1);
    run(1);
    ck_assert_uint_eq(fake_bus_count(&fake, 0x705), 2);
    ck_assert_uint_eq(fake_bus_last(&fake, 0x705)->data[0], 127);
}
END_TEST

/* CiA 301 clause 7.5.2.4. */
START_TEST(an_error_that_was_not_is_not_read)
{
    ck_assert_uint_eq(sdo(0x40, 0x1003, 1, 0), CO_ABORT_NO_DATA);
    co_device_raise(&device, 0x6100, CO_ERROR_GENERIC, NULL);
    ck_assert_uint_eq(sdo(0x40, 0x1003, 1, 0), 0x6100);
    ck_assert_uint_eq(sdo(0x40, 0x1003, 2, 0), CO_ABORT_NO_DATA);
    ck_assert_uint_eq(sdo(0x2F, 0x1003, 0, 1), REFUSED_VALUE);
    ck_assert_uint_eq(sdo(0x2F, 0x1003, 0, 0), 0);
    ck_assert_uint_eq(sdo(0x40, 0x1003, 1, 0), CO_ABORT_NO_DATA);
}
END_TEST

START_TEST(sync_is_listened_to_and_never_made)
{
    ck_assert_uint_eq(sdo(0x23, 0x1005, 0, 0x40000080), REFUSED_VALUE);
    ck_assert_uint_eq(sdo(0x23, 0x1005, 0, 0x800), REFUSED_VALUE);
    ck_assert_uint_eq(sdo(0x23, 0x1005, 0, 0x20000080), REFUSED_VALUE);
    ck_assert_uint_eq(sdo(0x23, 0x1005, 0, 0x80000080), REFUSED_VALUE);
    ck_assert_uint_eq(sdo(0x23, 0x1005, 0, 0x205),
                      REFUSED_VALUE); /* an RPDO's: one would be dead */
    ck_assert_uint_eq(sdo(0x23, 0x1005, 0, 0x81), 0);
    ck_assert(!give(0x080, 0, 0));
    ck_assert(give(0x081, 0, 0));
}
END_TEST

/* A node whose SYNC has the identifier of its SDO requests, or of NMT, is deaf. */
START_TEST(sync_does_not_take_what_is_restricted)
{
    static const uint32_t restricted[] = {0x000, 0x001, 0x07F, 0x101, 0x180, 0x581, 0x5FF,
                                          0x601, 0x605, 0x67F, 0x6E0, 0x6FF, 0x701, 0x7FF};
    for (size_t i = 0; i < sizeof restricted / sizeof restricted[0]; i++) {
        ck_assert_uint_eq(sdo(0x23, 0x1005, 0, restricted[i]), REFUSED_VALUE);
        ck_assert_uint_eq(sdo(0x40, 0x1005, 0, 0), 0x80);
    }
}
END_TEST

/* Bit 30 of an RPDO's COB-ID has no meaning, and tools set it (canopen.pdo of Python does for every
 * PDO without RTR); encoders demand it (Lika RD4: default 0x40000200 + node). */
START_TEST(a_pdo_without_remote_request_lives)
{
    ck_assert_uint_eq(sdo(0x23, 0x1400, 1, 0xC0000205), 0);
    ck_assert_uint_eq(sdo(0x23, 0x1400, 1, 0x40000205), 0);
    ck_assert_uint_eq(sdo(0x40, 0x1400, 1, 0), 0x40000205);
    nmt(1);
    ck_assert(give(0x205, 4, 0x4711));
    ck_assert_uint_eq(values.number, 0x4711);
    ck_assert_uint_eq(sdo(0x23, 0x1400, 1, 0x60000205), REFUSED_VALUE);
    ck_assert_uint_eq(sdo(0x23, 0x1400, 1, 0xA0000205), REFUSED_VALUE); /* also switched off */
    ck_assert_uint_eq(sdo(0x23, 0x1400, 1, 0x80000A05), REFUSED_VALUE);
}
END_TEST

/* Remote requests are not answered, so no TPDO says that they are: with bit 30 or without, it is set. */
START_TEST(no_pdo_promises_to_answer_a_remote_request)
{
    mapped_out = 0x20000020;
    ck_assert_int_eq(init(NODE), 0);
    ck_assert_uint_eq(sdo(0x40, 0x1801, 1, 0), 0x40000285);
    ck_assert_uint_eq(sdo(0x40, 0x1800, 1, 0), 0xC0000185);
    ck_assert_uint_eq(sdo(0x23, 0x1801, 1, 0x80000285), 0);
    ck_assert_uint_eq(sdo(0x40, 0x1801, 1, 0), 0xC0000285);
    ck_assert_uint_eq(sdo(0x23, 0x1801, 1, 0x285), 0);
    ck_assert_uint_eq(sdo(0x40, 0x1801, 1, 0), 0x40000285);
    nmt(1);
    ck_assert(give(0x080, 0, 0));
    ck_assert_ptr_nonnull(fake_bus_last(&fake, 0x285));
}
END_TEST

/* Two RPDOs of one identifier both take its frames. */
START_TEST(two_pdos_may_share_an_identifier)
{
    ck_assert_uint_eq(sdo(0x23, 0x1601, 1, 0x20010010), 0);
    ck_assert_uint_eq(sdo(0x23, 0x1601, 2, 0x00060010), 0);
    ck_assert_uint_eq(sdo(0x2F, 0x1601, 0, 2), 0);
    ck_assert_uint_eq(sdo(0x23, 0x1401, 1, 0x205), 0);
    nmt(1);
    ck_assert(give(0x205, 4, 0x12345678));
    ck_assert_uint_eq(values.number, 0x12345678);
    ck_assert_int_eq(values.small, 0x5678);
}
END_TEST

/* CiA 301 table 41: identifiers no PDO may take, at the ends of each range. */
START_TEST(restricted_identifiers)
{
    static const uint32_t restricted[] = {0x000, 0x001, 0x07F, 0x080, 0x101, 0x180, 0x581, 0x5FF,
                                          0x601, 0x67F, 0x6E0, 0x6FF, 0x701, 0x77F, 0x7FF};
    static const uint32_t free_ones[] = {0x081, 0x0FF, 0x100, 0x181, 0x580,
                                         0x600, 0x680, 0x6DF, 0x700};
    for (size_t i = 0; i < sizeof restricted / sizeof restricted[0]; i++) {
        ck_assert_uint_eq(sdo(0x23, 0x1801, 1, restricted[i]), REFUSED_VALUE);
    }
    ck_assert_uint_eq(sdo(0x23, 0x1801, 1, 0x800), REFUSED_VALUE); /* more than 11 bits */
    for (size_t i = 0; i < sizeof free_ones / sizeof free_ones[0]; i++) {
        ck_assert_uint_eq(sdo(0x23, 0x1801, 1, free_ones[i]), 0);
        ck_assert_uint_eq(sdo(0x23, 0x1801, 1, free_ones[i]), 0); /* the same again */
        ck_assert_uint_eq(sdo(0x23, 0x1801, 1, 0x80000000 | free_ones[i]), 0);
    }
}
END_TEST

START_TEST(heartbeat_consumers_are_one_a_node)
{
    ck_assert_uint_eq(sdo(0x23, 0x1016, 1, 0x00110032), 0);
    ck_assert_uint_eq(sdo(0x23, 0x1016, 2, 0x00110064), CO_ABORT_INCOMPATIBLE);
    ck_assert_uint_eq(sdo(0x23, 0x1016, 2, 0x00110000), 0); /* time 0: no consumer */
    ck_assert_uint_eq(sdo(0x23, 0x1016, 2, 0x00000064), 0); /* node 0: none either */
    ck_assert_uint_eq(sdo(0x23, 0x1016, 2, 0x00120064), 0);
    ck_assert_uint_eq(sdo(0x23, 0x1016, 1, 0x00110000), 0);
    ck_assert_uint_eq(sdo(0x23, 0x1016, 3, 0x00110064), 0); /* the first one's is off now */
    ck_assert_uint_eq(sdo(0x23, 0x1016, 4, 0x00800064), REFUSED_VALUE); /* node 128 */
    ck_assert_uint_eq(sdo(0x23, 0x1016, 3, 0), 0);
    ck_assert(give(0x711, 8, 5)); /* node 17 has no consumer any more: not even malformed */
    run(150);
    ck_assert(!co_device_has_error(&device, CO_EMCY_HEARTBEAT));
    ck_assert_uint_eq(device.counters.malformed, 0);
}
END_TEST

/* Dummies (CiA 301 clause 7.4.6) by every type that can be one, in an RPDO only. */
START_TEST(dummies_have_the_size_of_their_type)
{
    static const struct {
        uint32_t map;
        bool good;
    } maps[] = {{0x00010008, true},  {0x00020008, true},  {0x00030010, true},  {0x00040020, true},
                {0x00050008, true},  {0x00060010, true},  {0x00070020, true},  {0x00080020, true},
                {0x00100018, true},  {0x00160018, true},  {0x00090008, false}, {0x000A0008, false},
                {0x00070010, false}, {0x00070120, false}, {0x001F0008, false}};
    for (size_t i = 0; i < sizeof maps / sizeof maps[0]; i++) {
        ck_assert_uint_eq(sdo(0x23, 0x1601, 1, maps[i].map), maps[i].good ? 0 : 0x06040041);
        ck_assert_uint_eq(sdo(0x23, 0x1A01, 1, maps[i].map), 0x06040041);
    }
    ck_assert_uint_eq(sdo(0x23, 0x1601, 1, 0), 0); /* nothing mapped */
}
END_TEST

START_TEST(counters_stay_at_their_ends)
{
    device.counters = (struct co_device_counters){UINT32_MAX, UINT32_MAX, UINT32_MAX,
                                                  UINT32_MAX, UINT32_MAX, UINT32_MAX};
    device.sdo.aborts = UINT32_MAX;
    ck_assert(give(0x000, 8, 0));
    ck_assert(give(0x605, 7, 0));
    (void)sdo(0x40, 0x5000, 0, 0);
    ck_assert_uint_eq(device.counters.malformed, UINT32_MAX);
    ck_assert_uint_eq(device.counters.sdo_requests, UINT32_MAX);
    ck_assert_uint_eq(device.sdo.aborts, UINT32_MAX);
}
END_TEST

START_TEST(no_error_cannot_be_raised)
{
    co_device_raise(&device, CO_EMCY_NONE, CO_ERROR_GENERIC, NULL);
}
END_TEST

START_TEST(a_pdo_that_is_not_there_cannot_be_triggered)
{
    co_device_trigger_tpdo(&device, CO_PDO_COUNT);
}
END_TEST

/* No remote requests, whether the profile's defaults say so or not: bit 30 is set, and nothing else changes. */
START_TEST(a_tpdo_is_not_asked_for_by_remote_frames)
{
    static const uint32_t defaults_say[] = {0x285, 0x40000285, 0xC0000285};
    mapped_out = 0x20000020;
    for (size_t i = 0; i < sizeof defaults_say / sizeof defaults_say[0]; i++) {
        out_cob_id = defaults_say[i];
        ck_assert_int_eq(init(NODE), 0);
        ck_assert_uint_eq(sdo(0x40, 0x1801, 1, 0), defaults_say[i] | 0x40000000);
        ck_assert_uint_eq(sdo(0x40, 0x1800, 1, 0), 0xC0000185);
    }
}
END_TEST

/* SYNC may have any identifier that no PDO of this device has, be it above or below theirs. */
START_TEST(sync_may_lie_beside_the_pdos)
{
    static const uint32_t free_ids[] = {0x185, 0x204, 0x206, 0x284, 0x286, 0x300, 0x57F};
    mapped_out = 0x20000020;
    ck_assert_int_eq(init(NODE), 0);
    for (size_t i = 0; i < sizeof free_ids / sizeof free_ids[0]; i++) {
        ck_assert_uint_eq(sdo(0x23, 0x1005, 0, free_ids[i]), 0);
        ck_assert_uint_eq(sdo(0x40, 0x1005, 0, 0), free_ids[i]);
    }
    ck_assert_uint_eq(sdo(0x23, 0x1005, 0, 0x205), REFUSED_VALUE); /* the RPDO's */
    ck_assert_uint_eq(sdo(0x23, 0x1005, 0, 0x285), REFUSED_VALUE); /* the TPDO's */
}
END_TEST

static struct {
    unsigned off, back, lost, alive, states;
    uint8_t node;
    enum co_nmt_state state;
} told;

static void tell_bus_off(void *context, bool is_off, uint64_t at_ns)
{
    (void)context;
    (void)at_ns;
    told.off += is_off ? 1 : 0;
    told.back += is_off ? 0 : 1;
}

static void tell_heartbeat(void *context, uint8_t node, bool alive, uint64_t at_ns)
{
    (void)context;
    (void)at_ns;
    told.node = node;
    told.lost += alive ? 0 : 1;
    told.alive += alive ? 1 : 0;
}

static void tell_state(void *context, enum co_nmt_state state, uint64_t at_ns)
{
    (void)context;
    (void)at_ns;
    told.state = state;
    told.states++;
}

/* What a profile reacts to: the own bus that is off and comes back, a heartbeat that is lost and returns, each new
 * state; each told once. */
START_TEST(a_profile_is_told_once_of_each_change)
{
    static const struct co_device_ops reactions = {
        .bus_off = tell_bus_off, .heartbeat = tell_heartbeat, .state_changed = tell_state};
    struct can_msg error = {.flags = CAN_FRAME_ERROR};
    memset(&told, 0, sizeof told);
    ops = &reactions;
    ck_assert_int_eq(init(NODE), 0);
    ck_assert_uint_eq(told.states, 1);
    ck_assert_int_eq(told.state, CO_STATE_PRE_OPERATIONAL);
    nmt(1);
    nmt(1);
    ck_assert_uint_eq(told.states, 2);
    ck_assert_int_eq(told.state, CO_STATE_OPERATIONAL);
    for (unsigned round = 1; round <= 2; round++) {
        fake.status.error_state = CAN_BUS_OFF;
        ck_assert(co_device_receive(&device, &error, now_ns));
        ck_assert(co_device_receive(&device, &error, now_ns));
        ck_assert_uint_eq(told.off, round);
        ck_assert_uint_eq(told.back, round - 1);
        fake.status.error_state = CAN_ERROR_ACTIVE;
        run(3);
        ck_assert_uint_eq(told.off, round);
        ck_assert_uint_eq(told.back, round);
    }
    ck_assert_int_eq(told.state, CO_STATE_PRE_OPERATIONAL); /* 0x1029:1 = 0 */
    ck_assert_uint_eq(sdo(0x23, 0x1016, 1, 0x00110032), 0);
    ck_assert(give(0x711, 1, 5));
    run(49);
    ck_assert_uint_eq(told.lost, 0);
    run(2);
    ck_assert_uint_eq(told.lost, 1);
    ck_assert_uint_eq(told.node, 17);
    run(200);
    ck_assert_uint_eq(told.lost, 1);
    ck_assert_uint_eq(told.alive, 0);
    ck_assert(give(0x711, 1, 5));
    ck_assert(give(0x711, 1, 5));
    ck_assert_uint_eq(told.alive, 1);
    ops = &none;
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("co_device bare");
    TCase *tcase = tcase_create("all");
    tcase_add_checked_fixture(tcase, setup, NULL);
    tcase_add_test(tcase, an_unusable_configuration_is_refused);
    tcase_add_test(tcase, it_lives_without_a_profile);
    tcase_add_test(tcase, a_cyclic_pdo_is_not_triggered);
    tcase_add_test(tcase, a_pdo_that_was_switched_off_is_forgotten);
    tcase_add_test(tcase, the_boot_up_comes_before_the_first_heartbeat);
    tcase_add_test(tcase, what_is_not_for_it_is_left_to_others);
    tcase_add_test(tcase, a_new_time_out_drops_no_pdo);
    tcase_add_test(tcase, a_pdo_of_a_wrong_length);
    tcase_add_loop_test(tcase, the_error_behaviour_is_obeyed, 0, 3);
    tcase_add_test(tcase, a_stopped_node_is_silent);
    tcase_add_test(tcase, emergencies_wait_for_the_bus);
    tcase_add_test(tcase, the_end_of_an_error_is_told_also_through_a_full_queue);
    tcase_add_loop_test(tcase, a_time_out_is_over_when_its_pdo_is_not_used_any_more, 0, 2);
    tcase_add_test(tcase, a_time_out_is_over_when_its_timer_is_written);
    tcase_add_test(tcase, a_pdo_that_never_came_hides_no_late_one);
    tcase_add_test(tcase, each_pdo_has_errors_of_its_own);
    tcase_add_test(tcase, a_lost_heartbeat_is_over_when_its_consumer_is_written);
    tcase_add_test(tcase, the_end_of_its_bus_off_is_seen_without_an_error_frame);
    tcase_add_test(tcase, its_own_bus_off_is_survived);
    tcase_add_test(tcase, the_boot_up_waits_for_the_bus);
    tcase_add_test(tcase, an_error_that_was_not_is_not_read);
    tcase_add_test(tcase, sync_is_listened_to_and_never_made);
    tcase_add_test(tcase, sync_does_not_take_what_is_restricted);
    tcase_add_test(tcase, a_pdo_without_remote_request_lives);
    tcase_add_test(tcase, no_pdo_promises_to_answer_a_remote_request);
    tcase_add_test(tcase, two_pdos_may_share_an_identifier);
    tcase_add_test(tcase, restricted_identifiers);
    tcase_add_test(tcase, heartbeat_consumers_are_one_a_node);
    tcase_add_test(tcase, dummies_have_the_size_of_their_type);
    tcase_add_test(tcase, counters_stay_at_their_ends);
    tcase_add_test_raise_signal(tcase, no_error_cannot_be_raised, SIGILL);
    tcase_add_test_raise_signal(tcase, a_pdo_that_is_not_there_cannot_be_triggered, SIGILL);
    tcase_add_test(tcase, a_tpdo_is_not_asked_for_by_remote_frames);
    tcase_add_test(tcase, sync_may_lie_beside_the_pdos);
    tcase_add_test(tcase, a_profile_is_told_once_of_each_change);
    suite_add_tcase(suite, tcase);
    return run_suite(suite);
}
