#include "hal/devices/device_nodes.h"

#include "hal/bus/frame_table.h"

enum { STANDARD_ID_MAX = 0x7FF };

static unsigned add(struct device_unit *units, unsigned count, int leg, unsigned key,
                    uint8_t protocol, int32_t number)
{
    units[count] = (struct device_unit){leg, key, protocol, (uint8_t)number, 0};
    return count + 1;
}

unsigned device_units(const struct device_description *device,
                      struct device_unit units[DEVICE_UNITS_MAX])
{
    unsigned count = 0;
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        const struct device_leg *own = &device->leg[leg];
        if (device_leg_is_driven(own)) {
            count = add(units, count, leg, DEVICE_LEG_drive_node, (uint8_t)own->protocol,
                        own->drive_node);
            units[count - 1].answer_id = own->protocol == DEVICE_MIT ? (uint8_t)own->answer_id : 0;
        }
        if (device_leg_is_driven(own) && own->latch == DEVICE_LATCH_BOARD) {
            count = add(units, count, leg, DEVICE_LEG_latch_node, DEVICE_CIA402, own->latch_node);
        }
        count =
            add(units, count, leg, DEVICE_LEG_leg_sensor_node, DEVICE_CIA402, own->leg_sensor_node);
        if (device_leg_ankle_is_apart(own)) {
            count = add(units, count, leg, DEVICE_LEG_ankle_sensor_node, DEVICE_CIA402,
                        own->ankle_sensor_node);
        }
    }
    return count;
}

/* Whether a CANopen node's number gives it this identifier; every bus has NMT and SYNC. */
static bool is_canopen(uint32_t id, uint32_t node)
{
    const uint32_t function = id & ~UINT32_C(0x7F);
    const bool has_function = function == 0x080 || (function >= 0x180 && function <= 0x580) ||
                              function == 0x600 || function == 0x700;
    return id == FRAME_NMT || id == FRAME_SYNC || (has_function && (id & 0x7Fu) == node);
}

/* Whether a unit sends or listens to an identifier. */
static bool has_id(const struct device_unit *unit, uint32_t id)
{
    switch (unit->protocol) {
    case DEVICE_CANSIMPLE:
        return id >> 5 == unit->number;
    case DEVICE_MIT:
        return id == unit->number || id == unit->answer_id;
    default:
        return is_canopen(id, unit->number);
    }
}

static uint32_t first_shared_id(const struct device_unit *a, const struct device_unit *b)
{
    for (uint32_t id = 0; id <= STANDARD_ID_MAX; id++) {
        if (has_id(a, id) && has_id(b, id)) {
            return id;
        }
    }
    return STANDARD_ID_MAX + 1;
}

static enum device_verdict judge(const struct device_unit *unit, const struct device_unit *other,
                                 struct device_node_clash *clash)
{
    *clash = (struct device_node_clash){unit->leg, unit->key, (float)unit->number};
    if (unit->protocol == DEVICE_CIA402 && other->protocol == DEVICE_CIA402) {
        return unit->number == other->number ? DEVICE_BAD_NODE_TAKEN : DEVICE_OK;
    }
    const uint32_t id = first_shared_id(unit, other);
    clash->id = (float)id;
    return id <= STANDARD_ID_MAX ? DEVICE_BAD_ID_TAKEN : DEVICE_OK;
}

enum device_verdict device_nodes_check(const struct device_description *device,
                                       struct device_node_clash *clash)
{
    static const struct device_unit controller = {.protocol = DEVICE_CIA402,
                                                  .number = NODE_CONTROLLER};
    struct device_unit units[DEVICE_UNITS_MAX];
    const unsigned count = device_units(device, units);
    for (unsigned i = 0; i < count; i++) {
        enum device_verdict verdict = judge(&units[i], &controller, clash);
        for (unsigned j = 0; j < i && verdict == DEVICE_OK; j++) {
            verdict = judge(&units[i], &units[j], clash);
        }
        if (verdict != DEVICE_OK) {
            return verdict;
        }
    }
    return DEVICE_OK;
}
