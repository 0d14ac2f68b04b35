#include "firmware/bus_recorder.h"

#include "hal/bus/frame_table.h"

/* Fixed point of what is usual. */
enum { PARTS = 8 };

/* Frames that have come are told from what waits in the port: an answer to a tool costs more than it shows. */
static bool is_usual(const struct bus_recorder *recorder)
{
    return !recorder->special && recorder->frames <= (recorder->usual_parts + PARTS / 2) / PARTS;
}

/* SDO, heartbeats: not of each tick. */
static bool is_special(const struct can_msg *message)
{
    return message->id >= (uint32_t)FRAME_SDO_ANSWER_BASE;
}

static void count_frame(struct bus_recorder *recorder, const struct can_msg *message)
{
    recorder->frames++;
    recorder->special = recorder->special || is_special(message);
    black_box_record(recorder->box, message);
}

/* Towards the median of the frames of a tick: a device with more on the bus has quiet ticks, too. */
static void follow_usual(struct bus_recorder *recorder)
{
    const uint32_t now_parts = recorder->frames * PARTS;

    if (now_parts > recorder->usual_parts) {
        recorder->usual_parts++;
    } else if (now_parts < recorder->usual_parts) {
        recorder->usual_parts--;
    }
}

/* In the ticks of gait events the controller has much to do, in those of heartbeats and
 * the like the CANopen node: a snapshot waits for a quieter one, unless the block is full before. None
 * while a node is being set up or asked: what was asked of it is not kept, and its answer would mean nothing to
 * a replay. */
static bool may_open(const struct bus_recorder *recorder, bool quiet)
{
    const struct control_task *task = recorder->source.task;
    const bool asks = task->bring_up.setup.under_way || task->audit.under_way;

    return quiet || (!asks && black_box_is_full(recorder->box));
}

static void record_snapshot(struct bus_recorder *recorder)
{
    const struct black_box *box = recorder->box;
    const uint32_t next = box->header.next_sequence;
    const bool quiet = is_usual(recorder) && !control_task_was_busy(recorder->source.task);

    follow_usual(recorder);
    black_box_freeze_when_due(recorder->box, recorder->source.task->tick);
    if (may_open(recorder, quiet)) {
        black_box_end_tick(recorder->box, recorder->source.task->tick, snapshot_save,
                           &recorder->source);
    }
    recorder->special = false;
    recorder->frames = 0;
    recorder->quiet = quiet && box->header.next_sequence == next;
}

bool bus_recorder_take_quiet(struct bus_recorder *recorder)
{
    const bool quiet = recorder->quiet;

    recorder->quiet = false;
    return quiet;
}

static enum can_result bus_send(void *context, const struct can_msg *message)
{
    struct bus_recorder *recorder = context;
    const enum can_result result = can_bus_send(&recorder->inner, message);

    if (result == CAN_OK && message->id != FRAME_SYNC) { /* which counts when it comes back */
        struct can_msg own = *message;
        own.flags |= CAN_FRAME_OWN;
        count_frame(recorder, &own);
    }
    return result;
}

/* All that was fetched has been digested, and nothing fetched since: the state is that of the tick's end. */
static void end_tick(struct bus_recorder *recorder)
{
    const struct control_task *task = recorder->source.task;
    const uint8_t fault = (uint8_t)task->output.fault;

    if (fault != recorder->fault) {
        if (recorder->fault == SUPERVISOR_FAULT_NONE) {
            black_box_trigger(recorder->box, 1u << fault, task->tick,
                              BUS_RECORDER_AFTER_FAULT_TICKS);
        }
        recorder->fault = fault;
    }
    record_snapshot(recorder);
    recorder->in_tick = false;
}

static enum can_result bus_receive(void *context, struct can_msg *message, uint64_t *time_ns)
{
    struct bus_recorder *recorder = context;
    enum can_result result;

    if (recorder->in_tick) {
        end_tick(recorder);
    }
    result = can_bus_receive(&recorder->inner, message, time_ns);
    if (result == CAN_OK) {
        count_frame(recorder, message);
        recorder->in_tick = message->id == FRAME_SYNC && (message->flags & CAN_FRAME_OWN) != 0;
    }
    return result;
}

static void bus_get_status(void *context, struct can_bus_status *status)
{
    struct bus_recorder *recorder = context;
    can_bus_get_status(&recorder->inner, status);
}

static void bus_recover(void *context)
{
    struct bus_recorder *recorder = context;
    can_bus_recover(&recorder->inner);
}

static const struct can_bus_ops recorder_ops = {bus_send, bus_receive, bus_get_status, bus_recover};

void bus_recorder_init(struct bus_recorder *recorder, const struct can_bus *inner,
                       struct black_box *box, const struct snapshot_source *source)
{
    recorder->inner = *inner;
    recorder->box = box;
    recorder->source = *source;
    recorder->in_tick = false;
    recorder->fault = SUPERVISOR_FAULT_NONE;
    recorder->quiet = recorder->special = false;
    recorder->frames = recorder->usual_parts = 0;
}

struct can_bus bus_recorder_interface(struct bus_recorder *recorder)
{
    struct can_bus interface = {&recorder_ops, recorder};
    return interface;
}
