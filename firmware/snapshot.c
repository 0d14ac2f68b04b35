#include "firmware/snapshot.h"

#include <assert.h>
#include <stddef.h>
#include <string.h>

#include "hal/storage/black_box.h"

/* The controller behind its pointer to the parameters, as one block: a field that
 * somebody adds is in it. No pointer may be, which tests/firmware/test_snapshot_layout.py
 * holds: it compares the sizes on both targets. Rounded up to what it takes with 64 bits. */
enum {
    CONTROLLER_BYTES = sizeof(struct controller) - offsetof(struct controller, observer),
    CONTROLLER_BLOCK = (CONTROLLER_BYTES + 7) / 8 * 8
};
static_assert(offsetof(struct controller, observer) <= sizeof(void *),
              "nothing but the pointer to the parameters stands before the observer");

/* What else decides about the frames: commands, and with the clocks and errors of the
 * CANopen node also its heartbeats, telemetry and emergencies. Not an SDO transfer under way,
 * nor the set-up of the other nodes. Words first, they copy faster. */
#define TASK_FIELDS(X)                  \
    X(network)                          \
    X(sensors)                          \
    X(output)                           \
    X(now_ns)                           \
    X(node.device.heartbeat_due_ns)     \
    X(node.device.next_due_ns)          \
    X(node.device.emcy_sent_ns)         \
    X(node.device.emcy_queue)           \
    X(node.device.errors)               \
    X(node.comm.tpdo[0].last_ns)        \
    X(node.comm.tpdo[1].last_ns)        \
    X(node.objects.input_digest)        \
    X(node.objects.params_crc)          \
    X(node.objects.desired_speed_rad_s) \
    X(node.objects.motion_share)        \
    X(node.objects.motion_seconds)      \
    X(node.objects.motion_frequency_Hz) \
    X(tick)                             \
    X(node.objects.walk_requested)      \
    X(node.objects.reset_requested)     \
    X(node.objects.zero_requested)      \
    X(node.objects.wearer_button)       \
    X(node.objects.wearer_pin)          \
    X(node.objects.motion_order)        \
    X(node.objects.motion_renewal)      \
    X(node.objects.motion_kind)         \
    X(node.objects.motion_side)         \
    X(node.objects.state)               \
    X(node.objects.fault)               \
    X(node.rules.powered)               \
    X(node.rules.lock)                  \
    X(node.objects.unlocked_by)         \
    X(node.telemetry.sent_state)        \
    X(node.telemetry.sent_fault)        \
    X(node.device.emcy_count)           \
    X(node.device.comm.error_register)  \
    X(node.comm.tpdo[0].waiting)        \
    X(node.comm.tpdo[1].waiting)        \
    X(bring_up.configured)              \
    X(watch.disobeys)                   \
    X(tools)                            \
    X(audit.memory)                     \
    X(emergency_stop)

#define FIELD_SIZE(field) +sizeof(((struct control_task *)0)->field)
enum {
    LARGEST_BYTES = (int)CONTROLLER_BLOCK + sizeof(struct device_drives_state) +
                    PARAMS_GUARD_OWN_BYTES TASK_FIELDS(FIELD_SIZE)
};
#undef FIELD_SIZE

static_assert((int)LARGEST_BYTES <= (int)BLACK_BOX_SNAPSHOT_MAX, "the black box takes it");
static_assert(sizeof(enum supervisor_state) == 4, "enumerations are 32 bits on every target");

size_t snapshot_size(const struct snapshot_source *source)
{
    return LARGEST_BYTES - sizeof source->drives->state + device_drives_state_bytes(source->drives);
}

size_t snapshot_save(const void *context, uint8_t *out, size_t capacity)
{
    const struct snapshot_source *source = context;
    const struct control_task *task = source->task;

    const size_t drives_bytes = device_drives_state_bytes(source->drives);

    if (capacity < snapshot_size(source)) {
        return 0;
    }
    memset(out + CONTROLLER_BLOCK - 8, 0, 8);
    memcpy(out, (const uint8_t *)&task->controller + offsetof(struct controller, observer),
           CONTROLLER_BYTES);
    out += CONTROLLER_BLOCK;
    memcpy(out, &source->drives->state, drives_bytes);
    out += drives_bytes;
    memcpy(out, &task->node.objects.params, PARAMS_GUARD_OWN_BYTES);
    out += PARAMS_GUARD_OWN_BYTES;
#define SAVE(field)                                \
    memcpy(out, &task->field, sizeof task->field); \
    out += sizeof task->field;
    TASK_FIELDS(SAVE)
#undef SAVE
    return snapshot_size(source);
}

int snapshot_restore(const struct snapshot_source *source, const uint8_t *bytes, size_t size)
{
    struct control_task *task = source->task;

    const size_t drives_bytes = device_drives_state_bytes(source->drives);

    if (size != snapshot_size(source)) {
        return -1;
    }
    memcpy((uint8_t *)&task->controller + offsetof(struct controller, observer), bytes,
           CONTROLLER_BYTES);
    bytes += CONTROLLER_BLOCK;
    memcpy(&source->drives->state, bytes, drives_bytes);
    bytes += drives_bytes;
    memcpy(&task->node.objects.params, bytes, PARAMS_GUARD_OWN_BYTES);
    bytes += PARAMS_GUARD_OWN_BYTES;
#define RESTORE(field)                               \
    memcpy(&task->field, bytes, sizeof task->field); \
    bytes += sizeof task->field;
    TASK_FIELDS(RESTORE)
#undef RESTORE
    return 0;
}
