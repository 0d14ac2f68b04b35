/* From the middle of a walk: a black box's snapshot of the control task. */
#include <string.h>

#include "firmware/snapshot.h"
#include "hal/bus/bytes.h"
#include "sim_host/log/black_box_log.h"
#include "sim_host/log/replay_internal.h"

void replay_take_note(struct replay *replay, const struct can_msg *message)
{
    const uint32_t first = bytes_get_u32(message->data), second = bytes_get_u32(message->data + 4);
    if (message->id == BLACK_BOX_ID_IDENTITY) {
        replay->build_id = first;
        replay->parameter_crc = second;
    } else if (message->id == BLACK_BOX_ID_FOREIGN) {
        replay->next_is_foreign = true;
    } else if (message->id == BLACK_BOX_ID_BEGIN) {
        replay->snapshot_tick = first;
        replay->snapshot_bytes = second <= sizeof replay->snapshot ? second : 0;
        memset(replay->snapshot, 0, sizeof replay->snapshot);
    } else if (message->id >= BLACK_BOX_ID_DATA &&
               (message->id - BLACK_BOX_ID_DATA) * 8u + message->length <= replay->snapshot_bytes) {
        memcpy(replay->snapshot + (message->id - BLACK_BOX_ID_DATA) * 8u, message->data,
               message->length);
    }
}

bool replay_go_on_from_snapshot(struct replay *replay, unsigned long line)
{
    const struct snapshot_source source = {&replay->rig.task, &replay->rig.drives};
    struct control_task *task = &replay->rig.task;
    const uint32_t bytes = replay->snapshot_bytes;
    replay->snapshot_bytes = 0;
    if (snapshot_restore(&source, replay->snapshot, bytes) != 0) {
        snprintf(replay->message, sizeof replay->message,
                 "line %lu: a snapshot of %u bytes where this build's has %zu: recorded by build "
                 "%08x",
                 line, (unsigned)bytes, snapshot_size(&source), (unsigned)replay->build_id);
        return false;
    }
    if (params_guard_crc(&task->node.objects.params) != task->node.objects.params_crc) {
        snprintf(replay->message, sizeof replay->message,
                 "line %lu: the gait branch of this subject and law is not that of the recording "
                 "(parameter CRC %08x)",
                 line, (unsigned)task->node.objects.params_crc);
        return false;
    }
    replay->rig.stop_pressed = task->emergency_stop;
    replay->snapshots++;
    replay->runs++;
    replay->running = replay->fresh = replay->cut = false;
    replay->cycle_count = replay->next_count = 0;
    replay->queue_count = 0;
    return true;
}
