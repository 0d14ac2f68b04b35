/* The FDCAN driver against the model of the peripheral. */
#include "hal/port_fdcan/fdcan.h"

#include <stddef.h>
#include <string.h>

#include "hal/bus/frame_table.h"
#include "sim_host/emulator/g474/fdcan_model.h"
#include "sim_host/emulator/g474/mmio_model.h"
#include "tests/support/assert_close.h"

enum { MESSAGE_BYTES = offsetof(struct can_msg, data) + CAN_FRAME_DATA_MAX };

static struct fdcan_model model;
static struct fdcan can;
static struct can_bus bus;

static const struct fdcan_filter filters[] = {
    {0x181, 0x182, 0}, {0x283, 0x284, 0}, {0x081, 0x084, 1}, {0x701, 0x704, 1}, {0x581, 0x584, 1}};

static uint64_t now_ns(void *context)
{
    (void)context;
    return (uint64_t)model.time_bits * 1000u + 5000000u;
}

static struct fdcan_config config(void)
{
    struct fdcan_config made = {24000000, filters, sizeof filters / sizeof filters[0], now_ns,
                                NULL};
    return made;
}

static void setup(void)
{
    struct fdcan_config made = config();

    mmio_model_reset();
    fdcan_model_init(&model);
    ck_assert_int_eq(fdcan_init(&can, &made), FDCAN_OK);
    bus = fdcan_bus(&can);
}

/* As on the board: nobody asks when a frame came. */
static void setup_without_a_clock(void)
{
    struct fdcan_config made = config();

    made.now_ns = NULL;
    mmio_model_reset();
    fdcan_model_init(&model);
    ck_assert_int_eq(fdcan_init(&can, &made), FDCAN_OK);
    bus = fdcan_bus(&can);
}

static void teardown(void)
{
    ck_assert_int_eq(mmio_model_locked(), 0);
    ck_assert_uint_eq(model.protected_writes, 0);
}

static void interrupts(void)
{
    for (int i = 0; fdcan_model_line0(&model); i++) {
        ck_assert_msg(i < 20, "the interrupt stays raised");
        fdcan_interrupt(&can);
    }
}

static bool arrive(uint32_t id, uint8_t length, uint8_t seed)
{
    struct model_frame frame = {id, length, {0}};
    bool accepted;

    for (uint8_t i = 0; i < length; i++) {
        frame.data[i] = (uint8_t)(seed + i);
    }
    accepted = fdcan_model_receive(&model, &frame, false, false, model.time_bits);
    model.time_bits += 47u + 8u * length;
    return accepted;
}

static enum can_result send(uint32_t id, uint8_t length, uint8_t seed)
{
    struct can_msg message = {id, length, 0, {0}};

    for (uint8_t i = 0; i < length && i < 8; i++) {
        message.data[i] = (uint8_t)(seed + i);
    }
    return can_bus_send(&bus, &message);
}

/* Sends until nothing waits; interrupts after every frame. */
static void drain(void)
{
    for (int i = 0; fdcan_model_begin(&model); i++) {
        ck_assert_int_lt(i, 100);
        fdcan_model_end_good(&model);
        model.time_bits += 100;
        interrupts();
    }
}

static void expect(uint32_t id, uint8_t flags)
{
    struct can_msg message;

    ck_assert_int_eq(can_bus_receive(&bus, &message, NULL), CAN_OK);
    ck_assert_uint_eq(message.id, id);
    ck_assert_uint_eq(message.flags, flags);
}

static void expect_nothing(void)
{
    struct can_msg message;
    ck_assert_int_eq(can_bus_receive(&bus, &message, NULL), CAN_EMPTY);
}

/* ---- Start ------------------------------------------------------------------- */

START_TEST(the_bit_timing_is_1_mbit_with_the_sample_at_87_5_percent)
{
    uint32_t nbtp = model.reg[0x1C / 4];
    /* RM0440, FDCAN_NBTP: each field holds one less than what it means. */
    uint32_t prescaler = ((nbtp >> 16) & 0x1FF) + 1, before = ((nbtp >> 8) & 0xFF) + 1;
    uint32_t after = (nbtp & 0x7F) + 1, jump = ((nbtp >> 25) & 0x7F) + 1;

    ck_assert_uint_eq(24000000u / prescaler / (1 + before + after), 1000000u);
    ck_assert_uint_eq(24000000u % (prescaler * (1 + before + after)), 0);
    assert_close((1.0 + before) / (1.0 + before + after), 0.875, 1e-9, 0);
    ck_assert_uint_le(jump, after);
    ck_assert_uint_eq(model.reg[0x20 / 4] & 3, 1); /* time stamps count bits */
    ck_assert_uint_eq((model.reg[0x20 / 4] >> 16) & 0xF, 0);
    ck_assert_uint_eq(model.reg[0x18 / 4] & 3, 0); /* on the bus */
}
END_TEST

START_TEST(a_clock_that_gives_no_exact_bit_rate_is_refused)
{
    static const uint32_t clocks[] = {0, 16000000, 23999999, 170000000, 24000000u * 513u / 512u};

    for (size_t i = 0; i < sizeof clocks / sizeof clocks[0]; i++) {
        struct fdcan_config made = config();
        made.kernel_clock_hz = clocks[i];
        ck_assert_int_eq(fdcan_init(&can, &made), FDCAN_BAD_CONFIG);
        ck_assert_int_eq(send(0x100, 0, 0), CAN_DOWN);
    }
    struct fdcan_config made = config();
    made.kernel_clock_hz = 48000000;
    ck_assert_int_eq(fdcan_init(&can, &made), FDCAN_OK);
    made.filter_count = 29;
    ck_assert_int_eq(fdcan_init(&can, &made), FDCAN_BAD_CONFIG);
}
END_TEST

START_TEST(a_core_that_does_not_leave_init_mode_is_given_up)
{
    struct fdcan_config made = config();

    mmio_model_reset();
    fdcan_model_init(&model);
    model.init_delay = 50;
    ck_assert_int_eq(fdcan_init(&can, &made), FDCAN_OK);
    mmio_model_reset();
    fdcan_model_init(&model);
    model.init_delay = -1;
    ck_assert_int_eq(fdcan_init(&can, &made), FDCAN_TIMEOUT);
    ck_assert_int_eq(send(0x100, 0, 0), CAN_DOWN);
}
END_TEST

/* Bit timing, time stamps, filters and their number, queue, interrupts. */
START_TEST(a_lost_write_is_told_and_keeps_it_off_the_bus)
{
    static const uint32_t address[] = {0x4000641C, 0x40006420, 0x40006480, 0x400064C0, 0x400064DC,
                                       0x400064E0, 0x40006454, 0x4000645C, 0x4000A400, 0x4000A404};
    struct fdcan_config made = config();

    mmio_model_reset();
    fdcan_model_init(&model);
    memset(model.ram, 0xA7, sizeof model.ram);
    mmio_model_lose(address[_i]);
    ck_assert_int_eq(fdcan_init(&can, &made), FDCAN_LOST_WRITE);
    ck_assert_uint_eq(can.lost_register, address[_i]);
    ck_assert_uint_eq(model.reg[0x18 / 4] & 1, 1);
    ck_assert_int_eq(send(0x100, 0, 0), CAN_DOWN);
    mmio_model_lose(0);
    ck_assert_int_eq(fdcan_init(&can, &made), FDCAN_OK);
    ck_assert_uint_eq(can.lost_register, 0);
}
END_TEST

/* ---- Receiving ---------------------------------------------------------------- */

START_TEST(only_what_the_filters_name_is_received)
{
    struct model_frame frame = {0x181, 6, {0}};

    for (uint32_t id = 0; id <= 0x7FF; id++) {
        bool named = false;
        for (size_t i = 0; i < sizeof filters / sizeof filters[0]; i++) {
            named = named || (id >= filters[i].first && id <= filters[i].last);
        }
        ck_assert_int_eq(arrive(id, 2, 0), named);
        interrupts();
        if (named) {
            expect(id, 0);
        }
        expect_nothing();
    }
    ck_assert(!fdcan_model_receive(&model, &frame, true, false, 0));
    ck_assert(!fdcan_model_receive(&model, &frame, false, true, 0));
    ck_assert(!fdcan_model_receive(&model, &frame, true, true, 0));
}
END_TEST

START_TEST(data_and_length_arrive_as_sent)
{
    for (uint8_t length = 0; length <= 8; length++) {
        struct can_msg message, want = {0x283, length, 0, {0}};
        for (uint8_t i = 0; i < length; i++) {
            want.data[i] = (uint8_t)(0xF0 + 3 * length + i);
        }
        arrive(0x283, length, (uint8_t)(0xF0 + 3 * length));
        interrupts();
        ck_assert_int_eq(can_bus_receive(&bus, &message, NULL), CAN_OK);
        ck_assert_mem_eq(&message, &want, MESSAGE_BYTES);
    }
}
END_TEST

START_TEST(a_data_length_code_above_8_means_8)
{
    struct model_frame frame = {0x283, 13, {1, 2, 3, 4, 5, 6, 7, 8}};
    struct can_msg message;

    fdcan_model_receive(&model, &frame, false, false, 0);
    interrupts();
    ck_assert_int_eq(can_bus_receive(&bus, &message, NULL), CAN_OK);
    ck_assert_uint_eq(message.length, 8);
    ck_assert_mem_eq(message.data, frame.data, 8);
}
END_TEST

START_TEST(frames_of_both_fifos_and_the_own_sync_come_in_the_order_of_the_bus)
{
    model.time_bits = (uint32_t)_i; /* also where the 16-bit stamps wrap */
    arrive(0x701, 1, 0);            /* FIFO 1 */
    arrive(0x181, 6, 0);            /* FIFO 0 */
    arrive(0x283, 5, 0);
    ck_assert_int_eq(send(FRAME_SYNC, 0, 0), CAN_OK);
    ck_assert(fdcan_model_begin(&model));
    fdcan_model_end_good(&model);
    model.time_bits += 47;
    arrive(0x182, 6, 0);
    arrive(0x081, 8, 0);
    interrupts(); /* all at once: the interrupt was kept out for a while */
    expect(0x701, 0);
    expect(0x181, 0);
    expect(0x283, 0);
    expect(FRAME_SYNC, CAN_FRAME_OWN);
    expect(0x182, 0);
    expect(0x081, 0);
    expect_nothing();
}
END_TEST

/* Each look of the loop costs: it comes for a batch, for what may want an answer, and for its SYNC. */
START_TEST(the_loop_is_called_for_a_batch_or_what_is_urgent)
{
    struct can_msg message = {.id = FRAME_SYNC};

    for (uint8_t i = 1; i <= 2 * FDCAN_BATCH; i++) {
        ck_assert(arrive(0x181, 8, i));
        interrupts();
        ck_assert(fdcan_is_due(&can) == (i >= FDCAN_BATCH));
    }
    while (can_bus_receive(&bus, &message, NULL) == CAN_OK) {
    }
    ck_assert(!fdcan_is_due(&can));
    ck_assert(arrive(0x181, 8, 0));
    interrupts();
    ck_assert(!fdcan_is_due(&can));
    ck_assert(arrive(0x701, 1, 0)); /* a heartbeat waits, too */
    interrupts();
    ck_assert(!fdcan_is_due(&can));
    ck_assert(arrive(0x581, 8, 0));
    interrupts();
    ck_assert(fdcan_is_due(&can));
    ck_assert_int_eq(can_bus_receive(&bus, &message, NULL), CAN_OK);
    ck_assert(fdcan_is_due(&can)); /* still behind the first two */
    ck_assert_int_eq(can_bus_receive(&bus, &message, NULL), CAN_OK);
    ck_assert_int_eq(can_bus_receive(&bus, &message, NULL), CAN_OK);
    ck_assert(!fdcan_is_due(&can));
}
END_TEST

START_TEST(time_stamps_are_the_starts_of_frames)
{
    struct can_msg message;
    uint64_t time_ns;

    model.time_bits = 70000;
    arrive(0x181, 6, 0); /* starts at 70000, read 95 bits later */
    interrupts();
    ck_assert_int_eq(can_bus_receive(&bus, &message, &time_ns), CAN_OK);
    ck_assert_uint_eq(time_ns, 70000u * 1000u + 5000000u);
}
END_TEST

/* Frames received, the own SYNC and errors: whatever slot of the ring they come to. */
START_TEST(without_a_clock_every_time_is_0)
{
    struct can_msg message;
    uint64_t time_ns;

    memset(can.ring, 0xA5, sizeof can.ring);
    model.time_bits = 70000;
    for (int i = 0; i < 2 * FDCAN_RX_RING; i++) {
        const bool own = i % 3 == 1, error = i % 3 == 2;
        if (own) {
            ck_assert_int_eq(send(FRAME_SYNC, 0, 0), CAN_OK);
            ck_assert(fdcan_model_begin(&model));
            fdcan_model_end_good(&model);
        } else if (error) {
            fdcan_model_receive_error(&model);
        } else {
            ck_assert(arrive(0x181, 6, (uint8_t)i));
        }
        interrupts();
        time_ns = 1;
        ck_assert_int_eq(can_bus_receive(&bus, &message, &time_ns), CAN_OK);
        ck_assert_uint_eq(message.flags, own ? CAN_FRAME_OWN : error ? CAN_FRAME_ERROR : 0u);
        ck_assert_uint_eq(time_ns, 0);
        expect_nothing();
    }
}
END_TEST

START_TEST(of_the_own_frames_only_sync_comes_back)
{
    send(FRAME_DRIVE_TARGETS, 8, 0);
    send(FRAME_SYNC, 0, 0);
    send(FRAME_HEARTBEAT_CONTROLLER, 1, 5);
    drain();
    ck_assert_uint_eq(model.sent_count, 3);
    expect(FRAME_SYNC, CAN_FRAME_OWN);
    expect_nothing();
}
END_TEST

START_TEST(an_overrun_of_a_hardware_fifo_is_counted)
{
    struct can_bus_status status;

    for (int i = 0; i < 5; i++) {
        ck_assert_int_eq(arrive(0x181, 1, (uint8_t)i), i < 3);
    }
    interrupts();
    can_bus_get_status(&bus, &status);
    ck_assert_uint_gt(status.rx_overflow, 0);
    ck_assert_uint_eq(status.rx_frames, 3);
    expect(0x181, 0);
    expect(0x181, 0);
    expect(0x181, 0);
    expect_nothing();
    arrive(0x182, 1, 0);
    interrupts();
    expect(0x182, 0);
}
END_TEST

START_TEST(a_loop_that_does_not_fetch_loses_the_newest_and_is_counted)
{
    struct can_bus_status status;

    for (int i = 0; i < FDCAN_RX_RING + 10; i++) {
        arrive(0x181, 1, (uint8_t)i);
        interrupts();
    }
    can_bus_get_status(&bus, &status);
    ck_assert_uint_eq(status.rx_overflow, 10);
    for (unsigned i = 0; i < FDCAN_RX_RING; i++) {
        struct can_msg message;
        ck_assert_int_eq(can_bus_receive(&bus, &message, NULL), CAN_OK);
        ck_assert_uint_eq(message.data[0], i);
    }
    expect_nothing();
}
END_TEST

/* ---- Sending ------------------------------------------------------------------- */

START_TEST(frames_leave_in_the_order_of_their_identifiers)
{
    static const uint16_t ids[] = {0x710, 0x301, 0x201, 0x302, 0x290, 0x190, 0x610, 0x080};

    for (size_t i = 0; i < 8; i++) {
        ck_assert_int_eq(send(ids[i], 2, (uint8_t)i), CAN_OK);
    }
    interrupts(); /* cancellations take effect before the next frame begins */
    drain();
    ck_assert_uint_eq(model.sent_count, 8);
    for (uint32_t i = 1; i < 8; i++) {
        ck_assert_uint_lt(model.sent[i - 1].id, model.sent[i].id);
    }
    ck_assert_uint_eq(model.sent[1].id, 0x190);
    ck_assert_uint_eq(model.sent[1].data[1], 5 + 1); /* data went with its identifier */
}
END_TEST

START_TEST(a_frame_on_the_wire_is_not_disturbed_by_a_more_urgent_one)
{
    send(0x710, 1, 0);
    ck_assert(fdcan_model_begin(&model));
    for (uint16_t id = 0x702; id <= 0x705; id++) {
        send(id, 1, 0);
    }
    ck_assert_int_eq(send(FRAME_SYNC, 0, 0), CAN_OK);
    interrupts();
    fdcan_model_end_good(&model);
    interrupts();
    drain();
    ck_assert_uint_eq(model.sent_count, 6);
    ck_assert_uint_eq(model.sent[0].id, 0x710);
    ck_assert_uint_eq(model.sent[1].id, FRAME_SYNC);
    for (uint32_t i = 2; i < 6; i++) {
        ck_assert_uint_eq(model.sent[i].id, 0x700 + i);
    }
}
END_TEST

START_TEST(a_cancelled_frame_that_was_disturbed_is_sent_later_not_lost_or_doubled)
{
    send(0x710, 1, 7);
    ck_assert(fdcan_model_begin(&model));
    send(0x601, 8, 0);
    send(0x602, 8, 0);
    send(FRAME_SYNC, 0, 0); /* asks 0x710 back while it is on the wire */
    fdcan_model_end_disturbed(&model);
    interrupts();
    drain();
    ck_assert_uint_eq(model.sent_count, 4);
    ck_assert_uint_eq(model.sent[0].id, FRAME_SYNC);
    ck_assert_uint_eq(model.sent[3].id, 0x710);
    ck_assert_uint_eq(model.sent[3].data[0], 7);
}
END_TEST

START_TEST(frames_of_one_identifier_keep_their_order)
{
    for (uint8_t i = 0; i < 8; i++) {
        ck_assert_int_eq(send(0x610, 1, i), CAN_OK);
        if (i == 3) {
            send(0x7F0, 1, 0);
            send(0x7F1, 1, 0);
        }
    }
    drain();
    for (uint32_t i = 0; i < 8; i++) {
        ck_assert_uint_eq(model.sent[i].id, 0x610);
        ck_assert_uint_eq(model.sent[i].data[0], i);
    }
}
END_TEST

START_TEST(a_full_queue_refuses_and_says_so)
{
    struct can_bus_status status;
    int taken = 0;

    while (taken < 100 && send(0x600, 1, (uint8_t)taken) == CAN_OK) {
        taken++;
    }
    ck_assert_int_ge(taken, FDCAN_TX_QUEUE);
    ck_assert_int_lt(taken, 100);
    ck_assert_int_eq(send(0x600, 1, 0), CAN_FULL);
    can_bus_get_status(&bus, &status);
    ck_assert_uint_eq(status.tx_refused, 2);
    drain();
    ck_assert_int_eq((int)model.sent_count, taken);
    ck_assert_int_eq(send(0x600, 1, 0), CAN_OK);
}
END_TEST

START_TEST(what_is_no_standard_data_frame_is_refused)
{
    struct can_msg extended = {0x181, 0, CAN_FRAME_EXTENDED, {0}};
    struct can_msg remote = {0x181, 0, CAN_FRAME_REMOTE, {0}};

    ck_assert_int_eq(send(0x800, 0, 0), CAN_INVALID);
    ck_assert_int_eq(send(0x100, 9, 0), CAN_INVALID);
    ck_assert_int_eq(can_bus_send(&bus, &extended), CAN_INVALID);
    ck_assert_int_eq(can_bus_send(&bus, &remote), CAN_INVALID);
}
END_TEST

/* The bus lets nothing through for a while: what stops everything must still find room. */
START_TEST(a_full_queue_gives_up_its_least_urgent_frame_for_a_more_urgent_one)
{
    struct can_bus_status status;
    uint32_t targets = 0;

    ck_assert_int_eq(send(0x710, 1, 0), CAN_OK); /* the least urgent, but in buffers */
    ck_assert_int_eq(send(0x711, 1, 0), CAN_OK);
    while (send(0x201, 1, (uint8_t)targets) == CAN_OK) {
        targets++;
    }
    ck_assert_int_eq(targets, FDCAN_TX_QUEUE + 1);
    ck_assert_int_eq(send(0x000, 2, 0x77), CAN_OK); /* for the newest target */
    can_bus_get_status(&bus, &status);
    ck_assert_uint_eq(status.tx_refused, 2); /* one was not taken, one was given up */
    interrupts();
    ck_assert_int_eq(send(0x301, 1, 0), CAN_OK); /* for 0x711, which is back from its buffer */
    ck_assert_int_eq(send(0x7FF, 1, 0), CAN_FULL);
    can_bus_get_status(&bus, &status);
    ck_assert_uint_eq(status.tx_refused, 4);
    drain();
    ck_assert_uint_eq(model.sent_count, targets + 2);
    ck_assert_uint_eq(model.sent[0].id, 0x000);
    ck_assert_uint_eq(model.sent[0].data[0], 0x77);
    for (uint32_t i = 1; i < targets; i++) {
        ck_assert_uint_eq(model.sent[i].id, 0x201);
        ck_assert_uint_eq(model.sent[i].data[0], i - 1);
    }
    ck_assert_uint_eq(model.sent[targets].id, 0x301);
    ck_assert_uint_eq(model.sent[targets + 1].id, 0x710);
}
END_TEST

/* Each frame is sent once, or counted once as refused. */
START_TEST(random_traffic_is_sent_or_counted_and_keeps_priorities)
{
    uint32_t state = 12345, tried = 0;
    struct can_bus_status status;

    for (int i = 0; i < 20000; i++) {
        state = state * 1664525u + 1013904223u;
        switch ((state >> 16) % 6) {
        case 0:
        case 1:
            (void)send((state >> 8) & 0x7FF, 1, (uint8_t)tried++);
            break;
        case 2:
            fdcan_model_begin(&model);
            break;
        case 3:
        case 4:
            if (model.on_wire >= 0) {
                fdcan_model_end_good(&model);
            }
            break;
        default:
            if (model.on_wire >= 0 && model.tec < 100) {
                fdcan_model_end_disturbed(&model);
            }
            break;
        }
        interrupts();
        struct can_msg message;
        while (can_bus_receive(&bus, &message, NULL) == CAN_OK) {
        }
    }
    if (model.on_wire >= 0) {
        fdcan_model_end_good(&model);
        interrupts();
    }
    drain();
    can_bus_get_status(&bus, &status);
    ck_assert_uint_eq(model.sent_count + status.tx_refused, tried);
    ck_assert_uint_gt(model.sent_count, 2000);
}
END_TEST

/* ---- Errors --------------------------------------------------------------------- */

/* Reads errors from the bus; returns the state in the last one, -1 when none came. */
static int last_error_state(void)
{
    struct can_msg message;
    int state = -1;

    while (can_bus_receive(&bus, &message, NULL) == CAN_OK) {
        if (message.flags == CAN_FRAME_ERROR) {
            state = message.data[1];
        }
    }
    return state;
}

static void disturb(int times)
{
    for (int i = 0; i < times && fdcan_model_begin(&model); i++) {
        fdcan_model_end_disturbed(&model);
        interrupts();
    }
}

START_TEST(error_states_follow_the_counters)
{
    struct can_bus_status status;

    send(0x201, 8, 0);
    disturb(11); /* 88 */
    can_bus_get_status(&bus, &status);
    ck_assert_int_eq(status.error_state, CAN_ERROR_ACTIVE);
    ck_assert_uint_eq(status.tx_error_count, 88);
    ck_assert_uint_eq(status.error_frames, 11);
    disturb(1); /* 96 */
    ck_assert_int_eq(last_error_state(), CAN_ERROR_WARNING);
    disturb(4); /* 128 */
    ck_assert_int_eq(last_error_state(), CAN_ERROR_PASSIVE);
    drain();
    can_bus_get_status(&bus, &status);
    ck_assert_uint_eq(status.tx_frames, 1);
    ck_assert_uint_eq(status.tx_error_count, 127);
    ck_assert_int_eq(status.error_state, CAN_ERROR_WARNING);
    ck_assert_uint_eq(status.bus_off_count, 0);
}
END_TEST

START_TEST(a_disturbed_bus_does_not_push_frames_out)
{
    for (int i = 0; i < 200; i++) {
        fdcan_model_receive_error(&model);
        interrupts();
    }
    arrive(0x181, 1, 9);
    interrupts();
    struct can_msg message = {0};
    while (can_bus_receive(&bus, &message, NULL) == CAN_OK && message.flags == CAN_FRAME_ERROR) {
    }
    ck_assert_uint_eq(message.id, 0x181);
    struct can_bus_status status;
    can_bus_get_status(&bus, &status);
    ck_assert_uint_eq(status.error_frames, 200);
    ck_assert_uint_eq(status.rx_overflow, 0);
}
END_TEST

START_TEST(bus_off_drops_what_waits_and_recovers_when_asked)
{
    struct can_bus_status status;
    struct can_msg message;

    for (uint32_t id = 0x201; id < 0x208; id++) {
        send(id, 8, 0);
    }
    disturb(32); /* 256 */
    can_bus_get_status(&bus, &status);
    ck_assert_int_eq(status.error_state, CAN_BUS_OFF);
    ck_assert_uint_eq(status.bus_off_count, 1);
    ck_assert_int_eq(send(0x201, 8, 0), CAN_DOWN);
    ck_assert_int_eq(last_error_state(), CAN_BUS_OFF);
    ck_assert_int_eq(can_bus_receive(&bus, &message, NULL), CAN_DOWN);

    for (int i = 0; i < 1000; i++) { /* nothing happens by itself */
        fdcan_model_recessive(&model);
        interrupts();
    }
    can_bus_get_status(&bus, &status);
    ck_assert_int_eq(status.error_state, CAN_BUS_OFF);

    can_bus_recover(&bus);
    for (int i = 0; i < 128; i++) {
        fdcan_model_recessive(&model);
        interrupts();
        ck_assert_int_eq(send(0x201, 8, 0), CAN_DOWN);
    }
    fdcan_model_recessive(&model); /* the 129th */
    interrupts();
    can_bus_get_status(&bus, &status);
    ck_assert_int_eq(status.error_state, CAN_ERROR_ACTIVE);
    ck_assert(!fdcan_model_begin(&model)); /* nothing stale is sent */
    ck_assert_int_eq(send(0x202, 8, 1), CAN_OK);
    drain();
    ck_assert_uint_eq(model.sent_count, 1);
    ck_assert_uint_eq(model.sent[0].data[0], 1);
    arrive(0x181, 1, 0);
    interrupts();
    ck_assert_int_eq(last_error_state(), CAN_ERROR_ACTIVE);
}
END_TEST

START_TEST(recovery_is_without_effect_in_any_other_state)
{
    send(0x201, 8, 0);
    can_bus_recover(&bus);
    ck_assert(fdcan_model_begin(&model));
    fdcan_model_end_good(&model);
    interrupts();
    ck_assert_uint_eq(model.sent_count, 1);
}
END_TEST

START_TEST(silence_keeps_everything_off_the_bus)
{
    send(FRAME_SYNC, 0, 0);
    fdcan_silence();
    ck_assert(!fdcan_model_begin(&model));
    ck_assert(!arrive(0x181, 1, 0));
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("fdcan");
    TCase *tcase = tcase_create("fdcan");

    tcase_add_checked_fixture(tcase, setup, teardown);
    tcase_add_test(tcase, the_bit_timing_is_1_mbit_with_the_sample_at_87_5_percent);
    tcase_add_test(tcase, a_clock_that_gives_no_exact_bit_rate_is_refused);
    tcase_add_test(tcase, a_core_that_does_not_leave_init_mode_is_given_up);
    tcase_add_loop_test(tcase, a_lost_write_is_told_and_keeps_it_off_the_bus, 0, 10);
    tcase_add_test(tcase, only_what_the_filters_name_is_received);
    tcase_add_test(tcase, data_and_length_arrive_as_sent);
    tcase_add_test(tcase, a_data_length_code_above_8_means_8);
    tcase_add_loop_test(tcase, frames_of_both_fifos_and_the_own_sync_come_in_the_order_of_the_bus,
                        65536 - 600, 65536 + 10);
    tcase_add_test(tcase, the_loop_is_called_for_a_batch_or_what_is_urgent);
    tcase_add_test(tcase, time_stamps_are_the_starts_of_frames);
    tcase_add_test(tcase, of_the_own_frames_only_sync_comes_back);
    tcase_add_test(tcase, an_overrun_of_a_hardware_fifo_is_counted);
    tcase_add_test(tcase, a_loop_that_does_not_fetch_loses_the_newest_and_is_counted);
    tcase_add_test(tcase, frames_leave_in_the_order_of_their_identifiers);
    tcase_add_test(tcase, a_frame_on_the_wire_is_not_disturbed_by_a_more_urgent_one);
    tcase_add_test(tcase, a_cancelled_frame_that_was_disturbed_is_sent_later_not_lost_or_doubled);
    tcase_add_test(tcase, frames_of_one_identifier_keep_their_order);
    tcase_add_test(tcase, a_full_queue_refuses_and_says_so);
    tcase_add_test(tcase, a_full_queue_gives_up_its_least_urgent_frame_for_a_more_urgent_one);
    tcase_add_test(tcase, what_is_no_standard_data_frame_is_refused);
    tcase_add_test(tcase, random_traffic_is_sent_or_counted_and_keeps_priorities);
    tcase_add_test(tcase, error_states_follow_the_counters);
    tcase_add_test(tcase, a_disturbed_bus_does_not_push_frames_out);
    tcase_add_test(tcase, bus_off_drops_what_waits_and_recovers_when_asked);
    tcase_add_test(tcase, recovery_is_without_effect_in_any_other_state);
    tcase_add_test(tcase, silence_keeps_everything_off_the_bus);
    suite_add_tcase(suite, tcase);

    TCase *clockless = tcase_create("without a clock");
    tcase_add_checked_fixture(clockless, setup_without_a_clock, teardown);
    tcase_add_test(clockless, without_a_clock_every_time_is_0);
    tcase_add_loop_test(clockless,
                        frames_of_both_fifos_and_the_own_sync_come_in_the_order_of_the_bus,
                        65536 - 600, 65536 + 10);
    tcase_add_test(clockless, data_and_length_arrive_as_sent);
    tcase_add_test(clockless, a_disturbed_bus_does_not_push_frames_out);
    suite_add_tcase(suite, clockless);
    return run_suite(suite);
}
