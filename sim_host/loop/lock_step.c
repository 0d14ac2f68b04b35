#include "sim_host/loop/lock_step.h"

#include "hal/bus/frame_table.h"

/* So young an answer of a node that no heartbeat has told of yet is a sign that it answers. */
enum { LATE_TICKS = 5 };

static uint16_t age_of_answer(const struct control_task *task, uint8_t node)
{
    struct sea_drive_reading drive;
    switch (node) {
    case NODE_SENSOR_LEFT:
    case NODE_SENSOR_RIGHT:
        return task->sensors.reading[node - NODE_SENSOR_LEFT].age_ticks;
    default:
        sea_drives_read(&task->config.drives, (enum side)(node - NODE_DRIVE_LEFT), &drive);
        return drive.age_ticks;
    }
}

/* Whether the node is in a state to answer, by what it and we have said last. */
static bool may_answer(const struct control_task *task, const struct network_node *node)
{
    return node->state == NMT_OPERATIONAL || node->start_wait > 0 ||
           (node->state == NMT_UNKNOWN && age_of_answer(task, node->id) <= LATE_TICKS);
}

unsigned lock_step_expected(const struct control_task *task)
{
    unsigned expected = 0;
    for (unsigned i = 0; i < NETWORK_NODES; i++) {
        const struct network_node *node = &task->network.node[i];
        const bool taken_out = node->stop_pending || task->bring_up.setup.node == node->id;
        if (may_answer(task, node) && !taken_out) {
            expected |= 1u << i;
        }
    }
    return expected;
}

bool lock_step_answered(const struct control_task *task, unsigned expected)
{
    for (unsigned i = 0; i < NETWORK_NODES; i++) {
        const struct network_node *node = &task->network.node[i];
        if ((expected & 1u << i) != 0 && may_answer(task, node) &&
            age_of_answer(task, node->id) != 0) {
            return false;
        }
    }
    return !node_setup_is_waiting(&task->bring_up.setup) &&
           !(task->audit.under_way && co_sdo_client_is_busy(&task->audit.client));
}

bool lock_step_knows_all(const struct control_task *task)
{
    for (unsigned i = 0; i < NETWORK_NODES; i++) {
        if (task->network.node[i].state == NMT_UNKNOWN) {
            return false;
        }
    }
    return true;
}
