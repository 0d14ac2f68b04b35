#include "sim_host/loop/lock_step.h"

#include "hal/bus/frame_table.h"

/* So young an answer of a node that no heartbeat has told of yet is a sign that it answers. */
enum { LATE_TICKS = 5 };

/* A latch board answers no SYNC. */
static uint16_t age_of_answer(const struct control_task *task, unsigned role)
{
    struct sea_drive_reading drive;
    switch (role) {
    case NETWORK_SENSOR_LEFT:
    case NETWORK_SENSOR_RIGHT:
        return task->sensors.reading[role - NETWORK_SENSOR_LEFT].leg_age_ticks;
    case NETWORK_ANKLE_LEFT:
    case NETWORK_ANKLE_RIGHT:
        return task->sensors.reading[role - NETWORK_ANKLE_LEFT].ankle_age_ticks;
    case NETWORK_DRIVE_LEFT:
    case NETWORK_DRIVE_RIGHT:
        sea_drives_read(&task->config.drives, (enum side)(role - NETWORK_DRIVE_LEFT), &drive);
        return drive.age_ticks;
    default:
        return 0;
    }
}

/* Whether the node is in a state to answer, by what it and we have said last. */
static bool may_answer(const struct control_task *task, unsigned role)
{
    const struct network_node *node = &task->network.node[role];
    return node->state == NMT_OPERATIONAL || node->start_wait > 0 ||
           (node->state == NMT_UNKNOWN && age_of_answer(task, role) <= LATE_TICKS);
}

unsigned lock_step_expected(const struct control_task *task)
{
    unsigned expected = 0;
    for (unsigned i = 0; i < NETWORK_NODES; i++) {
        const struct network_node *node = &task->network.node[i];
        const bool taken_out = node->stop_pending || task->bring_up.setup.node == node->id;
        if (node->id != 0 && may_answer(task, i) && !taken_out) {
            expected |= 1u << i;
        }
    }
    return expected;
}

bool lock_step_answered(const struct control_task *task, unsigned expected)
{
    for (unsigned i = 0; i < NETWORK_NODES; i++) {
        if ((expected & 1u << i) != 0 && may_answer(task, i) && age_of_answer(task, i) != 0) {
            return false;
        }
    }
    return !node_setup_is_waiting(&task->bring_up.setup) &&
           !(task->audit.under_way && co_sdo_client_is_busy(&task->audit.client));
}

bool lock_step_knows_all(const struct control_task *task)
{
    for (unsigned i = 0; i < NETWORK_NODES; i++) {
        if (task->network.node[i].id != 0 && task->network.node[i].state == NMT_UNKNOWN) {
            return false;
        }
    }
    return true;
}
