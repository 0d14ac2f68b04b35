/* Which of the interfaces in a log is the orthosis's bus. Another bus may be a CANopen bus as well, with
 * SYNCs and PDOs of its own, so not one frame decides but how many kinds of the controller's there are. */
#include <stdio.h>
#include <string.h>

#include "hal/bus/frame_table.h"
#include "sim_host/log/black_box_log.h"
#include "sim_host/log/replay_internal.h"

enum { INTERFACES_MAX = 16 };

/* Kinds of frames that the controller sends all the time, in their length. */
static const struct {
    uint32_t id;
    uint8_t length;
} kinds[] = {{FRAME_SYNC, FRAME_BYTES_SYNC},
             {FRAME_DRIVE_TARGETS, FRAME_BYTES_DRIVE_TARGETS},
             {FRAME_CONTROLLER_STATE, FRAME_BYTES_CONTROLLER_STATE},
             {FRAME_HEARTBEAT_CONTROLLER, FRAME_BYTES_HEARTBEAT_CONTROLLER}};
enum { KINDS = sizeof kinds / sizeof kinds[0] };

struct interface {
    char name[CANDUMP_INTERFACE_MAX];
    unsigned kinds; /* a bit each */
};

struct interfaces {
    struct interface found[INTERFACES_MAX];
    unsigned count;
};

/* NULL when there are too many. */
static struct interface *interface_of(struct interfaces *all, const char *name)
{
    for (unsigned i = 0; i < all->count; i++) {
        if (strcmp(all->found[i].name, name) == 0) {
            return &all->found[i];
        }
    }
    if (all->count == INTERFACES_MAX) {
        return NULL;
    }
    struct interface *interface = &all->found[all->count++];
    *interface = (struct interface){.kinds = 0};
    (void)snprintf(interface->name, sizeof interface->name, "%s", name);
    return interface;
}

static unsigned kinds_of(const struct can_msg *message)
{
    unsigned bits = 0;
    if (message->flags == CAN_FRAME_EXTENDED) { /* who recorded: no other bus has that */
        return message->id == BLACK_BOX_ID_IDENTITY ? 1u << KINDS : 0;
    }
    for (unsigned i = 0; i < KINDS; i++) {
        if (message->flags == 0 && message->id == kinds[i].id &&
            message->length == kinds[i].length) {
            bits |= 1u << i;
        }
    }
    return bits;
}

static unsigned score(const struct interface *interface)
{
    unsigned count = 0;
    for (unsigned bits = interface->kinds; bits != 0; bits >>= 1) {
        count += bits & 1u;
    }
    return count;
}

/* Reads on to the end of the log, or up to what it cannot read: the replay will say so. */
static void look_through(struct interfaces *all, FILE *log)
{
    struct candump_record record;
    struct candump_error error;
    unsigned long line = 0;
    while (candump_read(log, &line, &record, &error) == CANDUMP_RECORD) {
        struct interface *interface = interface_of(all, record.interface_name);
        if (interface != NULL) {
            interface->kinds |= kinds_of(&record.message);
        }
    }
}

static bool refuse(struct replay *replay, const struct interfaces *all)
{
    size_t used = (size_t)snprintf(replay->message, sizeof replay->message,
                                   "the log has no interface %s, but", replay->interface);
    for (unsigned i = 0; i < all->count && used < sizeof replay->message; i++) {
        used += (size_t)snprintf(replay->message + used, sizeof replay->message - used, "%s %s",
                                 i == 0 ? "" : ",", all->found[i].name);
    }
    return false;
}

bool replay_choose_interface(struct replay *replay, FILE *log)
{
    static struct interfaces all;
    const long start = ftell(log);
    all.count = 0;
    if (start <
        0) { /* a pipe: the one that was named, or the first, and then a second is refused */
        replay->interfaces = replay->interface[0] != '\0' ? 1 : 0;
        return true;
    }
    look_through(&all, log);
    clearerr(log);
    if (fseek(log, start, SEEK_SET) != 0) {
        snprintf(replay->message, sizeof replay->message, "the log cannot be read twice");
        return false;
    }
    replay->interfaces = all.count;
    if (replay->interface[0] != '\0') {
        for (unsigned i = 0; i < all.count; i++) {
            if (strcmp(all.found[i].name, replay->interface) == 0) {
                return true;
            }
        }
        return all.count == 0 ? true : refuse(replay, &all);
    }
    const struct interface *best = NULL;
    for (unsigned i = 0; i < all.count; i++) {
        if (best == NULL || score(&all.found[i]) > score(best)) {
            best = &all.found[i];
        }
    }
    if (best != NULL) {
        (void)snprintf(replay->interface, sizeof replay->interface, "%s", best->name);
    }
    return true;
}

bool replay_is_on_interface(struct replay *replay, const struct candump_record *record)
{
    if (replay->interface[0] == '\0') {
        (void)snprintf(replay->interface, sizeof replay->interface, "%s", record->interface_name);
    }
    return strcmp(replay->interface, record->interface_name) == 0;
}
