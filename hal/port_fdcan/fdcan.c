#include "hal/port_fdcan/fdcan.h"

#include <string.h>

#include "hal/bus/bytes.h"
#include "hal/bus/frame_table.h"
#include "hal/contract.h"
#include "hal/port_cortex_m/mmio.h"
#include "hal/port_fdcan/fdcan_registers.h"

enum { NS_PER_BIT = 1000000000 / BUS_BITRATE };

/* Error state and kind of a CAN_FRAME_ERROR message, bytes 0..3. */
enum {
    ERROR_LAST_CODE = 0,
    ERROR_STATE = 1,
    ERROR_TX_COUNT = 2,
    ERROR_RX_COUNT = 3,
    ERROR_LENGTH = 4
};

#define ERROR_INTERRUPTS                                                                     \
    (FDCAN_IR_MRAF | FDCAN_IR_ELO | FDCAN_IR_EP | FDCAN_IR_EW | FDCAN_IR_BO | FDCAN_IR_PEA | \
     FDCAN_IR_ARA)

#define FRAME_INTERRUPTS \
    (FDCAN_IR_RF0N | FDCAN_IR_RF0L | FDCAN_IR_RF1N | FDCAN_IR_RF1L | FDCAN_IR_TEFN | FDCAN_IR_TEFL)

static uint32_t get(uint32_t offset)
{
    return mmio_read(FDCAN1_BASE + offset);
}

static void put(uint32_t offset, uint32_t value)
{
    mmio_write(FDCAN1_BASE + offset, value);
}

static void count(uint32_t *counter, uint32_t by)
{
    *counter = *counter > UINT32_MAX - by ? UINT32_MAX : *counter + by;
}

/* ---- Receiving ------------------------------------------------------------- */

static bool ring_has_room_for(const struct fdcan *can, uint32_t frames)
{
    return FDCAN_RX_RING - (can->ring_in - can->ring_out) >= frames;
}

/* Where the next frame goes; there must be room. */
static struct fdcan_received *ring_slot(struct fdcan *can)
{
    return &can->ring[can->ring_in % FDCAN_RX_RING];
}

/* Frames of that kind do not wait for the tick to end. */
static bool is_urgent(const struct can_msg *message)
{
    return (message->flags & CAN_FRAME_OWN) != 0U ||
           message->id - (uint32_t)FDCAN_URGENT_ID <=
               (uint32_t)(FDCAN_URGENT_LAST - FDCAN_URGENT_ID);
}

/* The slot is filled: hands it to the loop. */
static void ring_close(struct fdcan *can)
{
    const uint32_t before = can->ring_in, in = before + 1U;
    const struct can_msg *message = &can->ring[before % FDCAN_RX_RING].message;

    mmio_barrier(); /* the slot is complete before the loop can see it */
    can->ring_in = in;
    if (is_urgent(message) || in - can->ring_out >= (uint32_t)FDCAN_BATCH) {
        can->ring_due = in;
    }
}

/* 0 where nobody asks for times. */
static uint64_t now_ns(const struct fdcan *can)
{
    return can->config.now_ns != NULL ? can->config.now_ns(can->config.now_context) : 0U;
}

/* How long ago the frame of an element began: the core counts bit times in 16 bits. */
static uint32_t age_in_bits(uint32_t address)
{
    return (get(FDCAN_TSCV) - mmio_read(address + 4U)) & FDCAN_E1_TIME_MASK;
}

/* When it began; likewise. */
static uint64_t time_ns(const struct fdcan *can, uint32_t address)
{
    return can->config.now_ns != NULL ? now_ns(can) - (uint64_t)age_in_bits(address) * NS_PER_BIT
                                      : 0U;
}

struct fifo {
    uint32_t status; /* offsets of registers and of elements in the RAM */
    uint32_t acknowledge;
    uint32_t ram;
    uint32_t element_bytes;
};

enum { FIFO_RX0 = 0, FIFO_RX1 = 1, FIFO_EVENTS = 2, FIFO_COUNT = 3 };

static const struct fifo fifos[FIFO_COUNT] = {
    [FIFO_RX0] = {FDCAN_RXF0S, FDCAN_RXF0A, FDCAN_RAM_RX0, FDCAN_ELEMENT_BYTES},
    [FIFO_RX1] = {FDCAN_RXF1S, FDCAN_RXF1A, FDCAN_RAM_RX1, FDCAN_ELEMENT_BYTES},
    [FIFO_EVENTS] = {FDCAN_TXEFS, FDCAN_TXEFA, FDCAN_RAM_TX_EVENTS, FDCAN_EVENT_BYTES},
};

/* Address of the oldest element, 0 when the FIFO is empty; *index for the
 * acknowledgement. Adds how many wait to *waiting. */
static uint32_t oldest(const struct fifo *fifo, uint32_t *index, uint32_t *waiting)
{
    uint32_t status = get(fifo->status);

    if ((status & FDCAN_FIFO_FILL_MASK) == 0U) {
        return 0;
    }
    *waiting += status & FDCAN_FIFO_FILL_MASK;
    *index = (status >> FDCAN_FIFO_GET_POS) & FDCAN_FIFO_GET_MASK;
    return FDCAN1_RAM_BASE + fifo->ram + *index * fifo->element_bytes;
}

/* A mask of the first `count` bytes of a word. */
static uint32_t first_bytes(uint32_t count)
{
    return count >= 4U ? UINT32_MAX : (1U << (8U * count)) - 1U;
}

/* One store: the core is little-endian, as the bus is. */
static void put_word(uint8_t *at, uint32_t word)
{
    memcpy(at, &word, sizeof word);
}

static void read_element(uint32_t address, bool is_event, struct can_msg *message)
{
    uint32_t word0 = mmio_read(address), word1 = mmio_read(address + 4U);
    uint32_t length = (word1 >> FDCAN_E1_DLC_POS) & FDCAN_E1_DLC_MASK;

    uint32_t data0 = 0, data1 = 0;
    message->id = (word0 >> FDCAN_E0_STANDARD_ID_POS) & (uint32_t)CAN_ID_STANDARD_MAX;
    message->length = (uint8_t)(length > CAN_FRAME_DATA_MAX ? CAN_FRAME_DATA_MAX : length);
    message->flags = 0;
    if (is_event) {
        message->flags = CAN_FRAME_OWN;
    } else if ((word0 & FDCAN_E0_RTR) != 0U) { /* filtered out; a second line of defence */
        message->flags = CAN_FRAME_REMOTE;
    } else {
        data0 = mmio_read(address + 8U) & first_bytes(length);
        data1 = length > 4U ? mmio_read(address + 12U) & first_bytes(length - 4U) : 0U;
    }
    put_word(message->data, data0);
    put_word(message->data + 4, data1);
}

/* A frame for which there is no room is lost, and counted. */
static void take(struct fdcan *can, uint32_t address, bool is_event)
{
    struct fdcan_received *slot = ring_slot(can);

    if (!is_event) {
        count(&can->status.rx_frames, 1);
    }
    if (!ring_has_room_for(can, 1)) {
        count(&can->status.rx_overflow, 1);
        return;
    }
    read_element(address, is_event, &slot->message);
    slot->time_ns = time_ns(can, address);
    ring_close(can);
}

/* Empties both receive FIFOs and the event FIFO in the order of the bus, which
 * is the order of start-of-frame times. */
static void receive_all(struct fdcan *can)
{
    /* A FIFO cannot refill more often than this while the interrupt runs. */
    for (int guard = 0; guard < 4 * FIFO_COUNT * (int)FDCAN_FIFO_DEPTH; guard++) {
        uint32_t best_index = 0, best_address = 0, waiting = 0;
        int best = -1;

        for (int i = 0; i < FIFO_COUNT; i++) {
            uint32_t index = 0, address = oldest(&fifos[i], &index, &waiting);
            if (address != 0U && (best < 0 || age_in_bits(address) > age_in_bits(best_address))) {
                best = i;
                best_index = index;
                best_address = address;
            }
        }
        if (best < 0) {
            return;
        }
        take(can, best_address, best == FIFO_EVENTS);
        put(fifos[best].acknowledge, best_index);
        if (waiting ==
            1U) { /* what has come since interrupts again: the flags were cleared before */
            return;
        }
    }
}

/* ---- Sending --------------------------------------------------------------- */

/* The queue is sorted by falling identifier; among equals the older leaves first. */
static void queue_put(struct fdcan *can, const struct can_msg *message)
{
    uint32_t place = can->queued;

    while (place > 0 && can->queue[place - 1U].id <= message->id) {
        can->queue[place] = can->queue[place - 1U];
        place--;
    }
    can->queue[place] = *message;
    can->queued++;
}

/* Puts back a frame that was cancelled: it is older than its equals. */
static void queue_put_back(struct fdcan *can, const struct can_msg *message)
{
    uint32_t place = can->queued;

    while (place > 0 && can->queue[place - 1U].id < message->id) {
        can->queue[place] = can->queue[place - 1U];
        place--;
    }
    can->queue[place] = *message;
    can->queued++;
}

/* Takes the frame at place out of the queue. */
static void queue_remove(struct fdcan *can, uint32_t place)
{
    can->queued--;
    for (uint32_t i = place; i < can->queued; i++) {
        can->queue[i] = can->queue[i + 1U];
    }
}

static void load_buffer(struct fdcan *can, uint32_t buffer, const struct can_msg *message)
{
    uint32_t address = FDCAN1_RAM_BASE + FDCAN_RAM_TX + buffer * FDCAN_ELEMENT_BYTES;
    mmio_write(address, message->id << FDCAN_E0_STANDARD_ID_POS);
    mmio_write(address + 4U, ((uint32_t)message->length << FDCAN_E1_DLC_POS) |
                                 (message->id == FRAME_SYNC ? FDCAN_E1_EFC : 0U));
    mmio_write(address + 8U, bytes_get_u32(message->data));
    mmio_write(address + 12U, bytes_get_u32(message->data + 4));
    can->in_buffer[buffer] = *message;
    can->pending |= 1U << buffer;
    mmio_barrier();
    put(FDCAN_TXBAR, 1U << buffer);
}

/* Frames of one identifier must not overtake each other: of equals, the core
 * sends the lowest buffer number first, so only one is loaded at a time. */
static bool is_loaded(const struct fdcan *can, uint32_t id)
{
    for (uint32_t buffer = 0; buffer < FDCAN_TX_BUFFERS; buffer++) {
        if ((can->pending & (1U << buffer)) != 0U && can->in_buffer[buffer].id == id) {
            return true;
        }
    }
    return false;
}

static uint32_t free_buffer(const struct fdcan *can)
{
    uint32_t taken = can->pending | get(FDCAN_TXBRP);

    for (uint32_t buffer = 0; buffer < FDCAN_TX_BUFFERS; buffer++) {
        if ((taken & (1U << buffer)) == 0U) {
            return buffer;
        }
    }
    return FDCAN_TX_BUFFERS;
}

/* All buffers are taken: asks the least urgent back when a more urgent waits. */
static void make_room(struct fdcan *can, uint32_t urgent_id)
{
    uint32_t last = 0;

    if (can->cancelling != 0U) {
        return;
    }
    for (uint32_t buffer = 1; buffer < FDCAN_TX_BUFFERS; buffer++) {
        if (can->in_buffer[buffer].id > can->in_buffer[last].id) {
            last = buffer;
        }
    }
    if (can->in_buffer[last].id > urgent_id) {
        can->cancelling = 1U << last;
        put(FDCAN_TXBCR, 1U << last);
    }
}

static void refill(struct fdcan *can)
{
    for (uint32_t place = can->queued; place > 0; place--) {
        const struct can_msg *message = &can->queue[place - 1U];
        if (is_loaded(can, message->id)) {
            continue;
        }
        const uint32_t buffer = free_buffer(can);
        if (buffer == FDCAN_TX_BUFFERS) {
            make_room(can, message->id);
            return;
        }
        load_buffer(can, buffer, message);
        queue_remove(can, place - 1U);
    }
}

/* With nothing waiting and a buffer free, a frame need not go through the queue. */
static bool load_directly(struct fdcan *can, const struct can_msg *message)
{
    const uint32_t buffer = can->queued == 0U ? free_buffer(can) : FDCAN_TX_BUFFERS;

    if (buffer == FDCAN_TX_BUFFERS || is_loaded(can, message->id)) {
        return false;
    }
    load_buffer(can, buffer, message);
    return true;
}

/* Buffers whose request is gone were sent or cancelled. Returns true when there are any: then others can be
 * loaded. */
static bool collect_sent(struct fdcan *can)
{
    const uint32_t done = can->pending != 0U ? can->pending & ~get(FDCAN_TXBRP) : 0U;

    if (done == 0U) {
        return false;
    }
    const uint32_t sent = get(FDCAN_TXBTO);
    for (uint32_t buffer = 0; buffer < FDCAN_TX_BUFFERS; buffer++) {
        uint32_t bit = 1U << buffer;
        if ((done & bit) == 0U) {
            continue;
        }
        can->pending &= ~bit;
        can->cancelling &= ~bit;
        if ((sent & bit) != 0U) {
            count(&can->status.tx_frames, 1);
        } else { /* there is room: one at a time is cancelled */
            queue_put_back(can, &can->in_buffer[buffer]);
        }
    }
    return true;
}

static void drop_waiting(struct fdcan *can)
{
    can->queued = 0;
    put(FDCAN_TXBCR, can->pending);
    can->pending = 0;
    can->cancelling = 0;
}

/* ---- Errors ---------------------------------------------------------------- */

static void read_error_state(struct fdcan *can, uint32_t *last_code)
{
    uint32_t psr = get(FDCAN_PSR), ecr = get(FDCAN_ECR);
    enum can_error_state before = can->status.error_state;

    if ((psr & FDCAN_PSR_BO) != 0U) {
        can->status.error_state = CAN_BUS_OFF;
    } else if ((psr & FDCAN_PSR_EP) != 0U) {
        can->status.error_state = CAN_ERROR_PASSIVE;
    } else if ((psr & FDCAN_PSR_EW) != 0U) {
        can->status.error_state = CAN_ERROR_WARNING;
    } else {
        can->status.error_state = CAN_ERROR_ACTIVE;
    }
    can->status.tx_error_count = (uint8_t)((ecr >> FDCAN_ECR_TEC_POS) & FDCAN_ECR_TEC_MASK);
    can->status.rx_error_count = (uint8_t)((ecr >> FDCAN_ECR_REC_POS) & FDCAN_ECR_REC_MASK);
    if ((ecr & FDCAN_ECR_RP) != 0U) {
        can->status.rx_error_count = 128; /* the counter itself stops at 127 */
    }
    count(&can->status.error_frames, (ecr >> FDCAN_ECR_CEL_POS) & FDCAN_ECR_CEL_MASK);
    if (can->status.error_state == CAN_BUS_OFF && before != CAN_BUS_OFF) {
        count(&can->status.bus_off_count, 1);
        drop_waiting(can);
    }
    *last_code = psr & FDCAN_PSR_LEC_MASK;
}

static void report_error(struct fdcan *can)
{
    struct can_msg message = {.flags = CAN_FRAME_ERROR, .length = ERROR_LENGTH};
    enum can_error_state before = can->status.error_state;
    uint32_t last_code, room_needed;

    read_error_state(can, &last_code);
    message.data[ERROR_LAST_CODE] = (uint8_t)last_code;
    message.data[ERROR_STATE] = (uint8_t)can->status.error_state;
    message.data[ERROR_TX_COUNT] = can->status.tx_error_count;
    message.data[ERROR_RX_COUNT] = can->status.rx_error_count;
    /* A disturbed bus brings errors faster than frames: they may not push frames
     * out. Changes of state are few and always told. */
    room_needed = can->status.error_state == before ? FDCAN_RX_RING / 2 : 1U;
    if (ring_has_room_for(can, room_needed)) {
        *ring_slot(can) = (struct fdcan_received){message, now_ns(can)};
        ring_close(can);
    }
}

void fdcan_interrupt(struct fdcan *can)
{
    uint32_t flags = get(FDCAN_IR) & FDCAN_INTERRUPTS;

    put(FDCAN_IR, flags); /* cleared first: what comes later interrupts again */
    if ((flags & (FDCAN_IR_RF0L | FDCAN_IR_RF1L | FDCAN_IR_TEFL)) != 0U) {
        count(&can->status.rx_overflow, 1); /* at least one; the core does not count them */
    }
    if ((flags & FRAME_INTERRUPTS) != 0U) { /* else something was sent, or went wrong */
        receive_all(can);
    }
    const bool changed = collect_sent(can);
    if ((flags & ERROR_INTERRUPTS) != 0U) {
        report_error(can);
    }
    if (changed && can->status.error_state != CAN_BUS_OFF) {
        refill(can);
    }
}

/* ---- The bus interface ------------------------------------------------------ */

static enum can_result bus_send(void *context, const struct can_msg *message)
{
    struct fdcan *can = context;
    enum can_result result = CAN_OK;
    uint32_t state;

    if (message->length > CAN_FRAME_DATA_MAX || message->flags != 0U ||
        message->id > (uint32_t)CAN_ID_STANDARD_MAX) {
        return CAN_INVALID;
    }
    state = mmio_lock();
    if (!can->started || can->status.error_state == CAN_BUS_OFF) {
        result = CAN_DOWN;
    } else if (!load_directly(can, message)) {
        HAL_ASSERT(can->queued <= FDCAN_TX_QUEUE); /* what came back was loaded again, or another */
        queue_put(can, message);
        refill(can);
        if (can->queued > FDCAN_TX_QUEUE) { /* one too many: the newest of the least urgent */
            count(&can->status.tx_refused, 1);
            result = can->queue[0].id == message->id ? CAN_FULL : CAN_OK;
            queue_remove(can, 0);
        }
    }
    mmio_unlock(state);
    return result;
}

static enum can_result bus_receive(void *context, struct can_msg *message, uint64_t *time_ns)
{
    struct fdcan *can = context;
    const struct fdcan_received *slot = &can->ring[can->ring_out % FDCAN_RX_RING];

    if (can->ring_out == can->ring_in) {
        return can->status.error_state == CAN_BUS_OFF ? CAN_DOWN : CAN_EMPTY;
    }
    mmio_barrier();
    *message = slot->message;
    if (time_ns != NULL) {
        *time_ns = slot->time_ns;
    }
    mmio_barrier(); /* copied before the interrupt may reuse the slot */
    can->ring_out = can->ring_out + 1U;
    return CAN_OK;
}

static void bus_get_status(void *context, struct can_bus_status *status)
{
    struct fdcan *can = context;
    uint32_t state = mmio_lock();
    uint32_t last_code;

    read_error_state(can, &last_code);
    *status = can->status;
    mmio_unlock(state);
}

static void bus_recover(void *context)
{
    struct fdcan *can = context;
    uint32_t state = mmio_lock();

    /* Bus-off sets INIT; clearing it starts the wait for 129 x 11 recessive bits
     * (M_CAN user manual, bus-off; ISO 11898-1). PSR.BO goes when it is over.
     * CCE in between resets all transmit requests, so that nothing old is sent. */
    if (can->status.error_state == CAN_BUS_OFF && (get(FDCAN_CCCR) & FDCAN_CCCR_INIT) != 0U) {
        put(FDCAN_CCCR, FDCAN_CCCR_INIT | FDCAN_CCCR_CCE);
        put(FDCAN_CCCR, 0);
    }
    mmio_unlock(state);
}

static const struct can_bus_ops bus_ops = {bus_send, bus_receive, bus_get_status, bus_recover};

struct can_bus fdcan_bus(struct fdcan *can)
{
    struct can_bus bus = {&bus_ops, can};
    return bus;
}
