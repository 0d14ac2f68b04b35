#include "firmware/snapshot.h"

#include <assert.h>
#include <stddef.h>
#include <string.h>

#include "hal/black_box.h"

/* The controller behind its pointer to the parameters, as one block: a field that
 * somebody adds is in it. Rounded up to what it takes with 64-bit pointers. */
enum {
    CONTROLLER_BYTES = sizeof(struct controller) - offsetof(struct controller, observer),
    CONTROLLER_BLOCK = (CONTROLLER_BYTES + 7) / 8 * 8
};
static_assert(offsetof(struct controller, observer) <= sizeof(void *),
              "nothing but the pointer to the parameters stands before the observer");

/* What else decides about the commands. Not the clocks of the CANopen node: its
 * heartbeats may come at other ticks in a replay. Words first, they copy faster. */
#define TASK_FIELDS(X)                  \
    X(network)                          \
    X(sensors)                          \
    X(output)                           \
    X(node.objects.desired_speed_rad_s) \
    X(tick)                             \
    X(node.objects.walk_requested)      \
    X(node.objects.reset_requested)     \
    X(node.objects.zero_requested)      \
    X(node.objects.state)               \
    X(node.objects.fault)               \
    X(node.powered)                     \
    X(node.sent_state)                  \
    X(node.sent_fault)                  \
    X(configured)                       \
    X(emergency_stop)

#define FIELD_SIZE(field) +sizeof(((struct control_task *)0)->field)
enum {
    SNAPSHOT_BYTES = (int)CONTROLLER_BLOCK + sizeof(struct cia402_drives) TASK_FIELDS(FIELD_SIZE)
};
#undef FIELD_SIZE

static_assert((int)SNAPSHOT_BYTES <= (int)BLACK_BOX_SNAPSHOT_MAX, "the black box takes it");
static_assert(sizeof(enum supervisor_state) == 4, "enumerations are 32 bits on every target");

size_t snapshot_size(void)
{
    return SNAPSHOT_BYTES;
}

/* memcpy that takes eight words at a time: a snapshot must not cost a tick its budget. */
static inline void copy(void *to, const void *from, size_t length)
{
    struct block {
        uint32_t word[8];
    };
    struct block *target = to;
    const struct block *source = from;

    if ((((uintptr_t)to | (uintptr_t)from) & 3u) == 0u) {
        for (; length >= 4 * sizeof *target; length -= 4 * sizeof *target) {
            target[0] = source[0];
            target[1] = source[1];
            target[2] = source[2];
            target[3] = source[3];
            target += 4;
            source += 4;
        }
    }
    memcpy(target, source, length);
}

size_t snapshot_save(const void *context, uint8_t *out, size_t capacity)
{
    const struct snapshot_source *source = context;
    const struct control_task *task = source->task;

    if (capacity < SNAPSHOT_BYTES) {
        return 0;
    }
    memset(out + CONTROLLER_BLOCK - 8, 0, 8);
    copy(out, (const uint8_t *)&task->controller + offsetof(struct controller, observer),
         CONTROLLER_BYTES);
    out += CONTROLLER_BLOCK;
    copy(out, source->drives, sizeof *source->drives);
    out += sizeof *source->drives;
#define SAVE(field)                              \
    copy(out, &task->field, sizeof task->field); \
    out += sizeof task->field;
    TASK_FIELDS(SAVE)
#undef SAVE
    return SNAPSHOT_BYTES;
}

int snapshot_restore(const struct snapshot_source *source, const uint8_t *bytes, size_t size)
{
    struct control_task *task = source->task;

    if (size != SNAPSHOT_BYTES) {
        return -1;
    }
    memcpy((uint8_t *)&task->controller + offsetof(struct controller, observer), bytes,
           CONTROLLER_BYTES);
    bytes += CONTROLLER_BLOCK;
    memcpy(source->drives, bytes, sizeof *source->drives);
    bytes += sizeof *source->drives;
#define RESTORE(field)                               \
    memcpy(&task->field, bytes, sizeof task->field); \
    bytes += sizeof task->field;
    TASK_FIELDS(RESTORE)
#undef RESTORE
    return 0;
}
