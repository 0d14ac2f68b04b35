/* Whose a frame is, and what its bytes are called. */
#include "hal/bus/frame_table.h"
#include "hal/devices/device_nodes.h"
#include "hal/devices/sea_drive_cansimple.h"
#include "sim_host/log/replay.h"

#define SENDER(name, id, bytes, period_us, deadline_us, node, kind) {id, node},
static const struct {
    uint32_t id;
    uint8_t sender;
} senders[] = {FRAME_TABLE(SENDER) FRAME_OPTIONAL_TABLE(SENDER)};
#undef SENDER

/* What the table does not know: nodes of other numbers, and drives of other protocols. */
static bool is_to_unit(const struct device_unit *unit, uint32_t id)
{
    switch (unit->protocol) {
    case DEVICE_CANSIMPLE:
        return id >> 5 == unit->number && (id & 0x1Fu) != CANSIMPLE_HEARTBEAT &&
               (id & 0x1Fu) != CANSIMPLE_ENCODER_ESTIMATES;
    case DEVICE_MIT:
        return id == unit->number;
    default:
        return id == (uint32_t)(FRAME_SDO_REQUEST_DRIVE_LEFT - NODE_DRIVE_LEFT + unit->number);
    }
}

bool replay_is_controllers(const struct device_description *device, uint32_t id)
{
    struct device_unit units[DEVICE_UNITS_MAX];
    const unsigned count = device != NULL ? device_units(device, units) : 0;
    for (unsigned i = 0; i < count; i++) {
        if (is_to_unit(&units[i], id)) {
            return true;
        }
    }
    for (size_t i = 0; i < sizeof senders / sizeof senders[0]; i++) {
        if (senders[i].id == id) {
            return senders[i].sender == NODE_CONTROLLER;
        }
    }
    return false;
}

const char *replay_field_name(uint32_t id, unsigned byte)
{
    switch (id) {
    case FRAME_DRIVE_TARGETS:
        return byte < 4 ? "target position left" : "target position right";
    case FRAME_DRIVE_COMMAND_LEFT:
    case FRAME_DRIVE_COMMAND_RIGHT:
        return byte < 2 ? "controlword" : "digital outputs (latch)";
    case FRAME_TELEMETRY:
        return byte < 2   ? "measured speed"
               : byte < 4 ? "commanded speed"
               : byte < 6 ? "precompression"
               : byte < 7 ? "step number"
                          : "side and fault";
    case FRAME_CONTROLLER_STATE:
        return byte < 1   ? "supervisor state"
               : byte < 2 ? "latched fault"
                          : "digest of the input: a frame within the last 100 ticks was changed, "
                            "lost or added";
    case FRAME_NMT:
        return byte < 1 ? "NMT command" : "NMT node";
    case FRAME_HEARTBEAT_CONTROLLER:
        return "heartbeat";
    default:
        return "data";
    }
}
