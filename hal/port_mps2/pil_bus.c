#include "hal/port_mps2/pil_bus.h"

#include <string.h>

#include "hal/bus/frame_table.h"
#include "hal/port_mps2/mps2_registers.h"
#include "hal/port_mps2/semihosting.h"

/* With -icount shift=0 an instruction takes 1 ns of the emulator's time, so a
 * count of the 25 MHz timer is 40 of them. */
enum { INSTRUCTIONS_PER_COUNT = 40, EXIT_PROTOCOL = 3, STACK_PERIOD = 256 };

static void start_counting(void)
{
    TIMER1_CTRL = 0;
    TIMER1_RELOAD = UINT32_MAX;
    TIMER1_VALUE = UINT32_MAX;
    TIMER1_CTRL = TIMER_CTRL_ENABLE;
}

/* An upper bound: the count is rounded up. */
static uint32_t instructions_since_start(void)
{
    return (UINT32_MAX - TIMER1_VALUE + 1u) * INSTRUCTIONS_PER_COUNT;
}

static void begin_record(struct pil_bus *bus, enum pil_kind kind)
{
    bus->out.magic = PIL_MAGIC;
    bus->out.kind = (uint16_t)kind;
    bus->out.count = 0;
}

bool pil_bus_open(struct pil_bus *bus, const struct pil_hello *hello)
{
    memset(bus, 0, sizeof *bus);
    bus->inputs = PIL_EMERGENCY_STOP;
    bus->from_host = semihosting_open("pil-in", 6, SEMIHOSTING_READ);
    if (bus->from_host < 0) {
        return false;
    }
    bus->to_host = semihosting_open("pil-out", 7, SEMIHOSTING_WRITE);
    if (bus->to_host < 0) {
        return false;
    }
    begin_record(bus, PIL_HELLO);
    bus->out.body.hello = *hello;
    if (semihosting_write(bus->to_host, &bus->out, sizeof bus->out) != 0) {
        return false;
    }
    begin_record(bus, PIL_CYCLE);
    start_counting();
    return true;
}

static void read_answer(struct pil_bus *bus)
{
    if (semihosting_read(bus->from_host, &bus->in, sizeof bus->in) != 0 ||
        bus->in.magic != (uint32_t)PIL_MAGIC || bus->in.count > PIL_FRAMES) {
        semihosting_exit(EXIT_PROTOCOL); /* the host is gone */
    }
    bus->next_in = 0;
    bus->inputs = bus->in.inputs;
    if ((bus->inputs & PIL_END) != 0u) {
        semihosting_exit(0);
    }
}

static void exchange(struct pil_bus *bus)
{
    bus->out.instructions = instructions_since_start();
    if (bus->out.sequence % STACK_PERIOD == 0u && bus->stack_unused != NULL) {
        bus->out.stack_unused = bus->stack_unused();
    }
    bus->out.ticks = bus->ticks;
    if (semihosting_write(bus->to_host, &bus->out, sizeof bus->out) != 0) {
        semihosting_exit(EXIT_PROTOCOL);
    }
    bus->status.tx_frames += bus->out.count;
    bus->out.sequence++;
    begin_record(bus, PIL_CYCLE);
    bus->sync_queued = false;
    read_answer(bus);
    start_counting();
}

static enum can_result bus_send(void *context, const struct can_msg *message)
{
    struct pil_bus *bus = context;

    if (message->length > CAN_FRAME_DATA_MAX || message->id > (uint32_t)CAN_ID_STANDARD_MAX) {
        return CAN_INVALID;
    }
    if (bus->out.count >= PIL_FRAMES) {
        bus->status.tx_refused++;
        return CAN_FULL;
    }
    bus->out.body.frame[bus->out.count++] = *message;
    bus->sync_queued = bus->sync_queued || message->id == FRAME_SYNC;
    return CAN_OK;
}

static enum can_result bus_receive(void *context, struct can_msg *message, uint64_t *time_ns)
{
    struct pil_bus *bus = context;

    while (bus->next_in >= bus->in.count) {
        if (bus->in.kind == PIL_MORE) {
            read_answer(bus);
        } else if (bus->sync_queued) {
            exchange(bus);
        } else {
            return CAN_EMPTY;
        }
    }
    *message = bus->in.body.frame[bus->next_in++];
    if (time_ns != NULL) {
        *time_ns = (uint64_t)bus->out.sequence * TICK_PERIOD_US * 1000u;
    }
    bus->status.rx_frames++;
    return CAN_OK;
}

static void bus_get_status(void *context, struct can_bus_status *status)
{
    const struct pil_bus *bus = context;
    *status = bus->status;
}

static void bus_recover(void *context)
{
    (void)context; /* pipes do not go bus-off */
}

static const struct can_bus_ops bus_ops = {bus_send, bus_receive, bus_get_status, bus_recover};

struct can_bus pil_bus_interface(struct pil_bus *bus)
{
    struct can_bus interface = {&bus_ops, bus};
    return interface;
}

static bool is_pressed(void *context)
{
    const struct pil_bus *bus = context;
    return (bus->inputs & PIL_EMERGENCY_STOP) != 0u;
}

static const struct emergency_stop_ops stop_ops = {is_pressed};

struct emergency_stop pil_bus_emergency_stop(struct pil_bus *bus)
{
    struct emergency_stop interface = {&stop_ops, bus};
    return interface;
}
