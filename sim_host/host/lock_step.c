#include "sim_host/host/lock_step.h"

#include "hal/frame_table.h"

static bool has_answered(const struct control_task *task, uint8_t node)
{
    struct sea_drive_reading drive;
    switch (node) {
    case NODE_SENSOR_LEFT:
    case NODE_SENSOR_RIGHT:
        return task->sensors.reading[node - NODE_SENSOR_LEFT].age_ticks == 0;
    default:
        sea_drives_read(&task->config.drives, (enum leg)(node - NODE_DRIVE_LEFT), &drive);
        return drive.age_ticks == 0;
    }
}

unsigned lock_step_expected(const struct control_task *task)
{
    unsigned expected = 0;
    for (unsigned i = 0; i < NETWORK_NODES; i++) {
        const struct network_node *node = &task->network.node[i];
        if (node->state == NMT_OPERATIONAL || node->start_wait > 0 ||
            has_answered(task, node->id)) {
            expected |= 1u << i;
        }
    }
    return expected;
}

bool lock_step_answered(const struct control_task *task, unsigned expected)
{
    for (unsigned i = 0; i < NETWORK_NODES; i++) {
        if ((expected & 1u << i) != 0 && !has_answered(task, task->network.node[i].id)) {
            return false;
        }
    }
    return !node_setup_is_waiting(&task->setup);
}
