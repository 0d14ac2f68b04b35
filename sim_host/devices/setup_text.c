#include "sim_host/devices/setup_text.h"

#include <stdbool.h>
#include <stdio.h>

#include "hal/canopen/co_defs.h"
#include "hal/devices/device_config.h"

enum { ANY_SUB = 0x100 };

/* An object, by its name, unit and key. kind: 'x' hexadecimal, 'u' and 'd' a number with or without sign. */
struct object_text {
    uint16_t index, sub;
    char kind;
    const char *name, *unit, *key;
};

static const struct object_text texts[] = {
    {0x1000, 0, 'u', "device profile", "", ""},
    {0x1016, ANY_SUB, 'x', "heartbeat that it listens to", "", "lacks = heartbeat_consumer"},
    {0x1017, 0, 'u', "heartbeat time", " ms", ""},
    {0x1400, 5, 'u', "time-out of its targets", " ms", "lacks = rpdo_timer"},
    {0x2021, 0, 'u', "whether its ankle is a lever", "", "ankle"},
    {0x6001, 0, 'u', "counts a turn", "", "leg_counts_per_turn"},
    {0x6007, 0, 'd', "reaction to a lost link", "", "lacks = abort_option"},
    {0x605A, 0, 'd', "quick stop reaction", "", "lacks = option_codes"},
    {0x605B, 0, 'd', "shutdown reaction", "", "lacks = option_codes"},
    {0x605C, 0, 'd', "disable reaction", "", "lacks = option_codes"},
    {0x605E, 0, 'd', "fault reaction", "", "lacks = option_codes"},
    {0x6060, 0, 'd', "mode of operation", "", "mode"},
    {0x6061, 0, 'd', "mode of operation as it displays it", "", "mode"},
    {0x6065, 0, 'u', "following error window", " counts", "following_error_m"},
    {0x6066, 0, 'u', "following error time", " ms", "lacks = following_time"},
    {0x6076, 0, 'u', "motor's rated torque", " mNm", "rated_force_N"},
    {0x607D, ANY_SUB, 'd', "position limit", " counts", "stroke_max_m"},
    {0x6080, 0, 'u', "fastest motor speed", " counts/s", "speed_max_m_s"},
    {0x608F, ANY_SUB, 'u', "encoder resolution", "", "lacks = scaling"},
    {0x6091, ANY_SUB, 'u', "gear ratio", "", "lacks = scaling"},
    {0x6092, ANY_SUB, 'u', "scale", " counts/m", "counts_per_m"},
    {0x60C2, ANY_SUB, 'd', "interpolation period", "", "lacks = interpolation"},
    {0x60FE, 2, 'x', "mask of its outputs", "", "lacks = output_mask"},
    {0x6503, 0, 'x', "alarms of the sensor", "", ""},
};

/* What cannot be mapped, by the object that was to be. */
static const struct {
    uint16_t index;
    const char *key;
} mapped[] = {
    {0x0004, "lacks = dummy"},       {0x60FE, "lacks = outputs"},
    {0x6077, "lacks = torque"},      {0x2100, "lacks = temperature"},
    {0x6079, "lacks = bus_voltage"}, {0x607A, "mode = interpolated"},
    {0x60C1, "mode = csp"},
};

static bool is_mapping(uint16_t index)
{
    return (index >= 0x1600 && index < 0x1800) || (index >= 0x1A00 && index < 0x1C00);
}

static const char *key_of_mapped(uint16_t index)
{
    for (size_t i = 0; i < sizeof mapped / sizeof mapped[0]; i++) {
        if (mapped[i].index == index) {
            return mapped[i].key;
        }
    }
    return "";
}

static const struct object_text *find_text(uint16_t index, uint8_t sub)
{
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
        if (texts[i].index == index && (texts[i].sub == ANY_SUB || texts[i].sub == sub)) {
            return &texts[i];
        }
    }
    return NULL;
}

const char *setup_node_name(const struct device_description *device, uint8_t node)
{
    static const char *const names[NETWORK_NODES] = {
        "left drive",       "right drive",       "left leg sensor",   "right leg sensor",
        "left latch board", "right latch board", "left ankle sensor", "right ankle sensor"};
    struct node_setup_config config;
    device_node_setup(device, 1.0f, 1.0f, &config);
    for (unsigned role = 0; role < NETWORK_NODES; role++) {
        if (node != 0 && config.node[role] == node) {
            return names[role];
        }
    }
    return "node";
}

static const char *abort_text(uint32_t code)
{
    switch (code) {
    case CO_ABORT_NO_OBJECT:
        return "it has no such object";
    case CO_ABORT_NO_SUB:
        return "it has no such sub-index";
    case CO_ABORT_READ_ONLY:
        return "it can only be read";
    case CO_ABORT_NOT_MAPPABLE:
    case CO_ABORT_PDO_LENGTH:
        return "this cannot be mapped";
    case CO_ABORT_VALUE:
    case CO_ABORT_TOO_HIGH:
    case CO_ABORT_TOO_LOW:
        return "it does not take this value";
    default:
        return "it refuses";
    }
}

static void value_text(char kind, uint32_t value, const char *unit, char *text, size_t size)
{
    if (kind == 'x') {
        snprintf(text, size, "0x%X%s", value, unit);
    } else if (kind == 'd') {
        snprintf(text, size, "%d%s", (int32_t)value, unit);
    } else {
        snprintf(text, size, "%u%s", value, unit);
    }
}

/* The object's place and name: "0x6092:01 (scale)". */
static void object_name(const struct setup_failure *failure, const struct object_text *object,
                        char *text, size_t size)
{
    char what[64] = "";
    if (is_mapping(failure->index) && failure->sub > 0) {
        snprintf(what, sizeof what, " (0x%04X:%02X in a PDO)", failure->expected >> 16,
                 failure->expected >> 8 & 0xFFu);
    } else if (object != NULL) {
        snprintf(what, sizeof what, " (%s)", object->name);
    }
    snprintf(text, size, "0x%04X:%02X%s", failure->index, failure->sub, what);
}

void setup_refusal_text(const struct device_description *device,
                        const struct setup_failure *failure, char *text, size_t size)
{
    const struct object_text *object = find_text(failure->index, failure->sub);
    const char *unit = object != NULL ? object->unit : "";
    const char kind = object != NULL ? object->kind : 'x';
    const char *key = is_mapping(failure->index)
                          ? key_of_mapped((uint16_t)(failure->expected >> 16))
                      : object != NULL ? object->key
                                       : "";
    char name[112], expected[48], found[48], advice[64] = "";
    object_name(failure, object, name, sizeof name);
    value_text(kind, failure->expected, unit, expected, sizeof expected);
    value_text(kind, failure->found, unit, found, sizeof found);
    if (key[0] != '\0') {
        snprintf(advice, sizeof advice, "; key of the device file: %s", key);
    }
    const char *who = setup_node_name(device, failure->node);
    if (failure->verdict == SETUP_SILENT) {
        snprintf(text, size, "%s, node %u: silent at object %s", who, failure->node, name);
    } else if (failure->verdict == SETUP_ABORTED) {
        snprintf(text, size, "%s, node %u, refused: object %s: %s (abort code 0x%08X)%s", who,
                 failure->node, name, abort_text(failure->found), failure->found, advice);
    } else {
        snprintf(text, size, "%s, node %u, refused: object %s: expected %s, found %s%s", who,
                 failure->node, name, expected, found, advice);
    }
}
