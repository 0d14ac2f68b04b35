#include "firmware/bus_recorder.h"

#include "hal/bus/frame_table.h"

/* The SYNC, four answers, the targets. */
enum { QUIET_FRAMES = 6 };

static enum can_result bus_send(void *context, const struct can_msg *message)
{
    struct bus_recorder *recorder = context;
    enum can_result result = can_bus_send(&recorder->inner, message);

    if (result == CAN_OK && message->id != FRAME_SYNC) { /* the SYNC counts when it comes back */
        struct can_msg own = *message;
        own.flags |= CAN_FRAME_OWN;
        recorder->frames++;
        black_box_record(recorder->box, &own);
    }
    return result;
}

/* In the ticks of gait events the controller has much to do, in those of heartbeats and
 * the like the CANopen node: a snapshot waits for a quieter one. None while a node is being
 * set up: what was asked of it is not kept, and its answer would mean nothing to a replay. */
static bool was_dear(const struct bus_recorder *recorder)
{
    return recorder->frames > QUIET_FRAMES || control_task_was_busy(recorder->source.task);
}

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
    if (!was_dear(recorder)) {
        black_box_end_tick(recorder->box, task->tick, snapshot_save, &recorder->source);
    }
    recorder->in_tick = false;
    recorder->frames = 0;
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
        black_box_record(recorder->box, message);
        recorder->frames++;
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
    recorder->frames = 0;
}

struct can_bus bus_recorder_interface(struct bus_recorder *recorder)
{
    struct can_bus interface = {&recorder_ops, recorder};
    return interface;
}
