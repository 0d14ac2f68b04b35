#include "sim_host/ctl/ctl.h"

#include <string.h>

#include "hal/bus/frame_table.h"
#include "sim_host/text/nearest.h"

const struct ctl_verb_row ctl_verbs[] = {
    {"names", ctl_names, 0, -1, "[NAME..]", "what can be asked: names, access, ranges, meaning",
     false},
    {"get", ctl_get, 1, -1, "NAME..", "read objects or groups of them", false},
    {"set", ctl_set, 1, -1, "NAME=VALUE..", "write objects, each read back", false},
    {"watch", ctl_watch, 1, -1, "NAME..", "read again and again, and print what changes", false},
    {"dump", ctl_dump, 0, -1, "[NAME..]", "the settings as a file that diff reads", false},
    {"diff", ctl_diff, 1, 1, "FILE", "what differs between a dump's file and the node", false},
    {"changes", ctl_changes, 0, 0, "", "who changed what, when, from what to what", true},
    {"save", ctl_save, 0, 0, "", "keep the settings over power cycles", false},
    {"walk", ctl_walk, 0, 0, "", "ask for assistance, and wait until it engages", true},
    {"stop", ctl_stop, 0, 0, "", "end it, and wait until both springs are unloaded", true},
    {"press", ctl_press, 0, 1, "[SECONDS]", "the wearer's button: pause, or go on; 1.5 s stop",
     true},
    {"reset", ctl_reset, 0, 0, "", "clear a latched fault, at standstill", true},
    {"board", ctl_board, 0, 0, "", "a check-list of the board: clock, supply, lines, tests", true},
    {"zero", ctl_zero, 0, 0, "", "find the leg sensors' offsets: stand still for 3 s", true},
};
const size_t ctl_verb_count = sizeof ctl_verbs / sizeof ctl_verbs[0];

enum object_list_kind ctl_kind_of_node(uint8_t node)
{
    switch (node) {
    case NODE_CONTROLLER:
        return OBJECTS_OF_CONTROLLER;
    case NODE_DRIVE_LEFT:
    case NODE_DRIVE_RIGHT:
        return OBJECTS_OF_DRIVE;
    case NODE_SENSOR_LEFT:
    case NODE_SENSOR_RIGHT:
        return OBJECTS_OF_LEG_SENSOR;
    default:
        return OBJECTS_OF_ANY_NODE;
    }
}

static bool is_virtual_drive(struct ctl *ctl)
{
    static const char name[] = "AFO virtual SEA drive";
    static struct object_value value;
    char message[OBJECT_MESSAGE_MAX];
    struct named_object object;
    struct co_entry entry;
    ctl_link_any_object(0x1008, 0, &object, &entry);
    return ctl_link_read(&ctl->link, &object, &value, message) == 0 &&
           value.length == sizeof name - 1 && memcmp(value.bytes, name, value.length) == 0;
}

void ctl_open(struct ctl *ctl)
{
    const enum object_list_kind kind = ctl_kind_of_node(ctl->link.node);
    object_list_make(&ctl->objects, kind == OBJECTS_OF_DRIVE && !is_virtual_drive(ctl)
                                        ? OBJECTS_OF_ANY_DRIVE
                                        : kind);
}

enum exit_status ctl_run(struct ctl *ctl, int count, char **words)
{
    char message[OBJECT_MESSAGE_MAX];
    if (count == 0) {
        ctl_complain(ctl, "what shall be done? `afo ctl --help' lists the verbs");
        return EXIT_USAGE;
    }
    for (size_t i = 0; i < ctl_verb_count; i++) {
        const struct ctl_verb_row *verb = &ctl_verbs[i];
        if (strcmp(verb->name, words[0]) != 0) {
            continue;
        }
        if (count - 1 < verb->least_words ||
            (verb->most_words >= 0 && count - 1 > verb->most_words)) {
            ctl_complain(ctl, "usage: afo ctl %s %s", verb->name, verb->words);
            return EXIT_USAGE;
        }
        if (verb->controllers && ctl->link.node != NODE_CONTROLLER) {
            ctl_complain(ctl, "only the controller (node %d) can do that, not node %u",
                         NODE_CONTROLLER, ctl->link.node);
            return EXIT_USAGE;
        }
        return verb->run(ctl, count - 1, words + 1);
    }
    nearest_refuse(words[0], ctl_verbs, ctl_verb_count, sizeof ctl_verbs[0], message,
                   sizeof message);
    ctl_complain(ctl, "%s", message);
    return EXIT_USAGE;
}
