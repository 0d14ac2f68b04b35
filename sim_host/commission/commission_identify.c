/* Who is on the bus: scanned, named, and compared with the device file. Only reading. */
#include <stdlib.h>
#include <string.h>

#include "hal/bus/frame_table.h"
#include "hal/canopen/co_defs.h"
#include "hal/devices/device_nodes.h"
#include "hal/devices/node_setup.h"
#include "sim_host/commission/commission_internal.h"
#include "sim_host/devices/device_text.h"
#include "sim_host/devices/setup_text.h"
#include "sim_host/text/ini.h"

enum {
    PROFILE_DRIVE = 402,
    PROFILE_SENSOR = 406,
    MODE_CSP = 8,
    CSP_BIT = 1 << 7,
    HEARTBEATS_HEARD = 8, /* of the controller: so long is listened */
    LISTEN_WAITS_MAX = 4000
};
/* A drive that has not worked yet is as warm as the room, or a little more. */
#define ROOM_LEAST_DEGC 8.0
#define ROOM_MOST_DEGC 55.0

/* ---- whether they are there once -------------------------------------------------- */

/* Everybody sends heartbeats at one period: who sends more often is two. */
static int count_heartbeats(struct commission *commission, unsigned counts[CO_NODE_MAX + 1])
{
    const struct ctl_link *link = &commission->ctl.link;
    struct can_msg message;
    for (unsigned waits = 0; waits < LISTEN_WAITS_MAX; waits++) {
        (void)link->wait(link->context, 0);
        while (can_bus_receive(&link->bus, &message, NULL) == CAN_OK) {
            if (message.flags == 0 && message.id > CO_COB_HEARTBEAT &&
                message.id <= (uint32_t)CO_COB_HEARTBEAT + CO_NODE_MAX) {
                counts[message.id - CO_COB_HEARTBEAT]++;
            }
        }
        if (counts[NODE_CONTROLLER] > HEARTBEATS_HEARD) {
            return 0;
        }
    }
    return -1;
}

static const char *unit_name(const struct device_unit *unit)
{
    return unit->key == DEVICE_LEG_drive_node        ? "drive"
           : unit->key == DEVICE_LEG_leg_sensor_node ? "leg sensor"
           : unit->key == DEVICE_LEG_latch_node      ? "latch board"
                                                     : "ankle sensor";
}

static void judge_heartbeats(struct commission *commission, struct commission_result *result)
{
    unsigned counts[CO_NODE_MAX + 1] = {0};
    struct device_unit units[DEVICE_UNITS_MAX];
    const unsigned count = device_units(&commission->device.description, units);
    if (count_heartbeats(commission, counts) != 0) {
        commission_find(result, "controller (node %d): no heartbeat heard", NODE_CONTROLLER);
        return;
    }
    const unsigned expected = counts[NODE_CONTROLLER];
    for (unsigned i = 0; i < count; i++) {
        const unsigned node = units[i].number;
        if (units[i].protocol != DEVICE_CIA402) {
            continue;
        }
        if (counts[node] == 0) {
            commission_find(result, "%s %s (node %u): no heartbeat", commission_leg(units[i].leg),
                            unit_name(&units[i]), node);
        } else if (2 * counts[node] > 3 * expected + 2) {
            commission_find(result,
                            "%s %s: two nodes have the number %u (%u heartbeats where %u were "
                            "expected); give one of them another",
                            commission_leg(units[i].leg), unit_name(&units[i]), node, counts[node],
                            expected);
        }
        counts[node] = 0;
    }
    for (unsigned node = 1; node <= CO_NODE_MAX; node++) {
        if (counts[node] > 0 && node != NODE_CONTROLLER) {
            commission_note(result, "Node %u is on the bus and not in the file.", node);
        }
    }
}

/* ---- what they are ------------------------------------------------------------------- */

static void judge_type(struct commission *commission, struct commission_result *result,
                       const struct device_unit *unit)
{
    const uint32_t expected = unit->key == DEVICE_LEG_drive_node ? PROFILE_DRIVE : PROFILE_SENSOR;
    const bool is_of_any = unit->key == DEVICE_LEG_latch_node; /* as at the set-up */
    uint32_t type, vendor, product;
    char message[OBJECT_MESSAGE_MAX];
    const char *leg = commission_leg(unit->leg), *name = unit_name(unit);
    if (commission_peek(commission, unit->number, 0x1000, 0, &type, message) != 0) {
        commission_find(result, "%s %s (node %u): %s", leg, name, unit->number, message);
        return;
    }
    if ((type & 0xFFFFu) != expected && !is_of_any) {
        commission_find(result, "%s %s (node %u): profile %u where %u was expected (0x1000)", leg,
                        name, unit->number, (unsigned)(type & 0xFFFFu), (unsigned)expected);
    }
    if (commission_peek(commission, unit->number, 0x1018, 1, &vendor, message) != 0 ||
        commission_peek(commission, unit->number, 0x1018, 2, &product, message) != 0) {
        commission_find(result, "%s %s (node %u): %s", leg, name, unit->number, message);
        return;
    }
    commission_note(result, "%s %s: node %u, vendor 0x%X, product 0x%X.", leg, name, unit->number,
                    (unsigned)vendor, (unsigned)product);
    const struct commission_identity *sheet = &commission->expected[unit->leg];
    const bool has_sheet = unit->key == DEVICE_LEG_drive_node && sheet->product != 0;
    if (has_sheet && (sheet->vendor != vendor || sheet->product != product)) {
        commission_find(result,
                        "%s drive (node %u): the EDS is of vendor 0x%X, product 0x%X; this is not "
                        "its data sheet",
                        leg, unit->number, (unsigned)sheet->vendor, (unsigned)sheet->product);
    }
}

/* What the controller found when it set the nodes up. */
static int judge_refusal(struct commission *commission, struct commission_result *result)
{
    double node, verdict, index, sub, expected, found;
    if (commission_get(commission, result, "refused_node.node", &node) != 0 ||
        commission_get(commission, result, "refused_node.verdict", &verdict) != 0 ||
        commission_get(commission, result, "refused_node.object_index", &index) != 0 ||
        commission_get(commission, result, "refused_node.object_sub_index", &sub) != 0 ||
        commission_get(commission, result, "refused_node.expected_value", &expected) != 0 ||
        commission_get(commission, result, "refused_node.found_value_or_abort_code", &found) != 0) {
        return -1;
    }
    if (node != 0.0) {
        const struct setup_failure failure = {.verdict = (enum setup_verdict)(-(int)verdict),
                                              .node = (uint8_t)node,
                                              .sub = (uint8_t)sub,
                                              .index = (uint16_t)index,
                                              .expected = (uint32_t)expected,
                                              .found = (uint32_t)found};
        char text[SETUP_TEXT_MAX];
        setup_refusal_text(&commission->device.description, &failure, text, sizeof text);
        commission_find(
            result, "%s%s", text,
            failure.verdict == SETUP_SILENT ? "; is it on, and has it this number alone?" : "");
    }
    return 0;
}

/* What a CiA 402 drive must offer. The set-up has written it; here it is read, as the drive holds it. */
static void judge_drive(struct commission *commission, struct commission_result *result, int leg)
{
    const struct device_leg *declared = &commission->device.description.leg[leg];
    const unsigned node = (unsigned)declared->drive_node;
    const char *name = commission_leg(leg);
    char message[OBJECT_MESSAGE_MAX];
    uint32_t value;
    if (declared->protocol != DEVICE_CIA402) {
        return;
    }
    if (commission_peek(commission, node, 0x6061, 0, &value, message) != 0) {
        commission_find(result, "%s drive (node %u): mode: %s", name, node, message);
    } else if ((value & 0xFFu) != MODE_CSP) {
        commission_find(result,
                        "%s drive (node %u): mode %u where 8, cyclic synchronous position, "
                        "was expected (0x6061)",
                        name, node, (unsigned)(value & 0xFFu));
    }
    if (!device_leg_lacks(declared, DEVICE_LACKS_SUPPORTED_MODES) &&
        commission_peek(commission, node, 0x6502, 0, &value, message) == 0 &&
        (value & CSP_BIT) == 0) {
        commission_find(result,
                        "%s drive (node %u): it has no cyclic synchronous position "
                        "(0x6502 bit 7)",
                        name, node);
    }
    if (!device_leg_lacks(declared, DEVICE_LACKS_HEARTBEAT_CONSUMER)) {
        const bool answered = commission_peek(commission, node, 0x1016, 1, &value, message) == 0;
        if (!answered || (value >> 16 & 0x7Fu) != NODE_CONTROLLER || (value & 0xFFFFu) == 0) {
            commission_find(result,
                            "%s drive (node %u): it does not watch the controller's "
                            "heartbeat (0x1016:01 is 0x%X); say so with lacks = heartbeat_consumer",
                            name, node, answered ? (unsigned)value : 0u);
        }
    }
    if (!device_leg_lacks(declared, DEVICE_LACKS_RPDO_TIMER)) {
        const bool answered = commission_peek(commission, node, 0x1400, 5, &value, message) == 0;
        if (!answered || (value & 0xFFFFu) == 0) {
            commission_find(result,
                            "%s drive (node %u): missing targets go unnoticed (0x1400:05 is "
                            "0 or absent); say so with lacks = rpdo_timer",
                            name, node);
        }
    }
}

static int judge_temperature(struct commission *commission, struct commission_result *result,
                             int leg)
{
    const struct device_leg *declared = &commission->device.description.leg[leg];
    double celsius, volts;
    if (declared->protocol == DEVICE_NO_DRIVE_PROTOCOL || declared->protocol == DEVICE_CANSIMPLE ||
        (declared->protocol == DEVICE_CIA402 &&
         device_leg_lacks(declared, DEVICE_LACKS_TEMPERATURE))) {
        return 0;
    }
    if (commission_get_leg(commission, result, "drives", (enum side)leg, "drive_temperature",
                           &celsius) != 0 ||
        commission_get_leg(commission, result, "drives", (enum side)leg, "drive_supply", &volts) !=
            0) {
        return -1;
    }
    if (declared->protocol == DEVICE_MIT && celsius == 0.0) {
        return 0; /* a motor that tells none */
    }
    commission_note(result, "%s drive: %.1f degC, %.1f V.", commission_leg(leg), celsius, volts);
    if (!(celsius >= ROOM_LEAST_DEGC && celsius <= ROOM_MOST_DEGC)) {
        commission_find(result,
                        "%s drive: %.1f degC where a drive at rest has %.0f to %.0f; is its "
                        "unit 0.1 degC?",
                        commission_leg(leg), celsius, ROOM_LEAST_DEGC, ROOM_MOST_DEGC);
    }
    return 0;
}

/* What the controller runs with is the file that is commissioned. */
static int judge_description(struct commission *commission, struct commission_result *result)
{
    const struct device_description *declared = &commission->declared.description;
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        for (unsigned key = 0; key < DEVICE_LEG_COUNT; key++) {
            const struct device_key *row = &device_leg_keys[key];
            char message[OBJECT_MESSAGE_MAX], file[DEVICE_VALUE_TEXT_MAX],
                runs[DEVICE_VALUE_TEXT_MAX];
            uint32_t number;
            if (!device_key_applies(&declared->leg[leg], key)) {
                continue;
            }
            if (commission_peek(commission, NODE_CONTROLLER, (uint16_t)(DEVICE_INDEX_LEFT + leg),
                                (uint8_t)(key + 1u), &number, message) != 0) {
                return commission_break(result, "%s", message);
            }
            const float expected = device_value(declared, leg, key);
            float found = (float)(int32_t)number;
            if (row->type == DEVICE_FLOAT) {
                memcpy(&found, &number, sizeof found);
            }
            if (found != expected) {
                device_value_text(row, (double)expected, file, sizeof file);
                device_value_text(row, (double)found, runs, sizeof runs);
                commission_find(result,
                                "%s leg, key \"%s\": the file says %.60s, and the controller runs "
                                "with %.60s; start it with this file",
                                commission_leg(leg), row->name, file, runs);
            }
        }
    }
    return 0;
}

int commission_identify(struct commission *commission, struct commission_result *result)
{
    struct device_unit units[DEVICE_UNITS_MAX];
    const unsigned count = device_units(&commission->device.description, units);
    double ticks;
    if (commission_get(commission, result, "counters.ticks", &ticks) != 0 ||
        judge_description(commission, result) != 0 || judge_refusal(commission, result) != 0) {
        return -1;
    }
    judge_heartbeats(commission, result);
    for (unsigned i = 0; i < count; i++) {
        if (units[i].protocol == DEVICE_CIA402) {
            judge_type(commission, result, &units[i]);
        }
    }
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        judge_drive(commission, result, leg);
        if (judge_temperature(commission, result, leg) != 0) {
            return -1;
        }
    }
    return 0;
}

/* ---- data sheets ------------------------------------------------------------------------ */

static int take_key(void *context, const char *section, const char *key, const char *value,
                    int line, char *message, size_t size)
{
    struct commission_identity *identity = (struct commission_identity *)context;
    (void)line;
    (void)message;
    (void)size;
    if (strcmp(section, "DeviceInfo") == 0 && strcmp(key, "VendorNumber") == 0) {
        identity->vendor = (uint32_t)strtoul(value, NULL, 0);
    } else if (strcmp(section, "DeviceInfo") == 0 && strcmp(key, "ProductNumber") == 0) {
        identity->product = (uint32_t)strtoul(value, NULL, 0);
    }
    return 0;
}

int commission_read_eds(struct commission_identity *identity, const char *path, char *message)
{
    *identity = (struct commission_identity){0, 0};
    if (ini_read(path, take_key, identity, message, OBJECT_MESSAGE_MAX) != 0) {
        return -1;
    }
    if (identity->product == 0) {
        (void)snprintf(message, OBJECT_MESSAGE_MAX, "%s has no ProductNumber in [DeviceInfo]",
                       path);
        return -1;
    }
    return 0;
}
