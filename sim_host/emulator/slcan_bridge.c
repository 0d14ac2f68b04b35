#include "sim_host/emulator/slcan_bridge.h"

#include <string.h>

#include "hal/bus/frame_table.h"
#include "hal/bus/slcan_rate.h"

void slcan_bridge_init(struct slcan_bridge *bridge, struct emulator *emulator)
{
    memset(bridge, 0, sizeof *bridge);
    bridge->emulator = emulator;
    slcan_decoder_init(&bridge->decoder);
}

/* ---- the line ------------------------------------------------------------------- */

static void tell(struct slcan_bridge *bridge, const char *text, size_t length)
{
    bridge->bytes_out += length;
    if (emulator_uart_write(bridge->emulator, text, length) != 0) {
        bridge->failed = true;
    }
}

/* Commands of the adapter: closing, the bus's bit rate, no time stamps, opening; all else is
 * refused. */
static void obey(struct slcan_bridge *bridge, const char *line)
{
    static const char rate[] = {'S', SLCAN_RATE_DIGIT, '\0'};
    const bool is_known = strcmp(line, "C") == 0 || strcmp(line, rate) == 0 ||
                          strcmp(line, "Z0") == 0 || strcmp(line, "O") == 0;

    if (line[0] == 'C') {
        bridge->is_open = false;
    } else if (strcmp(line, "O") == 0) {
        bridge->is_open = true;
    }
    tell(bridge, is_known ? "\r" : "\a", 1);
}

/* Reads up to the board's next frame. Returns false, and the bridge has failed, when none comes. */
static bool next_frame(struct slcan_bridge *bridge, struct can_msg *message)
{
    while (!bridge->failed) {
        const int byte = emulator_uart_read(bridge->emulator);
        if (byte < 0) {
            break;
        }
        bridge->bytes_in++;
        switch (slcan_decode(&bridge->decoder, (char)byte)) {
        case SLCAN_FRAME:
            *message = bridge->decoder.message;
            bridge->failed = !bridge->is_open;
            return bridge->is_open;
        case SLCAN_OTHER:
            obey(bridge, bridge->decoder.line);
            break;
        case SLCAN_MALFORMED:
        case SLCAN_REFUSED:
            bridge->failed = true;
            break;
        default:
            break;
        }
    }
    bridge->failed = true;
    return false;
}

/* ---- comparing and passing on ------------------------------------------------------ */

static bool same(const struct can_msg *a, const struct can_msg *b)
{
    return a->id == b->id && a->length == b->length &&
           memcmp(a->data, b->data, sizeof a->data) == 0;
}

/* The board's next frame is the host's next, and goes onto the bus. */
static void take_frame(struct slcan_bridge *bridge, struct can_msg *message)
{
    bridge->compared++;
    if (bridge->compared == bridge->corrupt_frame && message->length > 0) {
        message->data[0] ^= 1u;
    }
    if (bridge->expected_count == 0 || !same(message, &bridge->expected[0])) {
        bridge->differences++;
    }
    if (bridge->expected_count > 0) {
        bridge->expected_count--;
        memmove(&bridge->expected[0], &bridge->expected[1],
                bridge->expected_count * sizeof bridge->expected[0]);
    }
    bridge->unacknowledged++;
    if (can_bus_send(&bridge->inner, message) != CAN_OK) {
        bridge->failed = true;
    }
}

/* What the host's task sent in this tick, the board sends as well. */
static void take_commands(struct slcan_bridge *bridge)
{
    struct can_msg message;

    while (bridge->expected_count > 0 && next_frame(bridge, &message)) {
        if (message.id == FRAME_SYNC) { /* it goes on without: frames are missing */
            bridge->failed = true;
            return;
        }
        take_frame(bridge, &message);
    }
}

/* Frames that nobody expects come before the SYNC that they do not belong to. */
static bool wait_for_sync(struct slcan_bridge *bridge)
{
    struct can_msg message;

    while (next_frame(bridge, &message)) {
        if (message.id == FRAME_SYNC) {
            bridge->syncs++;
            return true;
        }
        take_frame(bridge, &message);
    }
    return false;
}

static void pass_on(struct slcan_bridge *bridge, const struct can_msg *message)
{
    char line[SLCAN_LINE_MAX];

    if ((message->flags & CAN_FRAME_OWN) == 0) {
        tell(bridge, line, slcan_encode(message, line));
        return;
    }
    /* The SYNC is on the bus, and so is all that was sent before it. */
    for (; bridge->unacknowledged > 0; bridge->unacknowledged--) {
        tell(bridge, "z\r", 2);
    }
    tell(bridge, "z\r", 2);
}

/* ---- the host task's side --------------------------------------------------------- */

static enum can_result bus_send(void *context, const struct can_msg *message)
{
    struct slcan_bridge *bridge = context;

    if (message->id != FRAME_SYNC) {
        if (bridge->expected_count == SLCAN_EXPECTED_MAX) {
            return CAN_FULL;
        }
        bridge->expected[bridge->expected_count++] = *message;
        return CAN_OK;
    }
    if (bridge->failed || !wait_for_sync(bridge)) {
        return CAN_DOWN;
    }
    return can_bus_send(&bridge->inner, message);
}

static enum can_result bus_receive(void *context, struct can_msg *message, uint64_t *time_ns)
{
    struct slcan_bridge *bridge = context;

    if (bridge->in_tick) { /* the host's task has finished the tick: now the board's turn */
        bridge->in_tick = false;
        take_commands(bridge);
    }
    const enum can_result result = can_bus_receive(&bridge->inner, message, time_ns);
    if (result == CAN_OK && !bridge->failed) {
        pass_on(bridge, message);
        bridge->in_tick = message->id == FRAME_SYNC && (message->flags & CAN_FRAME_OWN) != 0;
    }
    return result;
}

static void bus_get_status(void *context, struct can_bus_status *status)
{
    const struct slcan_bridge *bridge = context;
    can_bus_get_status(&bridge->inner, status);
}

static void bus_recover(void *context)
{
    const struct slcan_bridge *bridge = context;
    can_bus_recover(&bridge->inner);
}

static const struct can_bus_ops bridge_ops = {bus_send, bus_receive, bus_get_status, bus_recover};

struct can_bus slcan_bridge_wrap(void *context, struct can_bus inner)
{
    struct slcan_bridge *bridge = context;
    const struct can_bus bus = {&bridge_ops, bridge};

    bridge->inner = inner;
    return bus;
}
