/* The inside of a drive node, public only so that its owner can allocate it. */
#ifndef SIM_HOST_NODES_DRIVE_NODE_TYPE_H
#define SIM_HOST_NODES_DRIVE_NODE_TYPE_H

#include "sim_host/nodes/drive_node.h"

struct drive_node {
    struct drive_node_config config;
    struct can_bus bus;
    struct drive_axis_feedback feedback;
    struct drive_axis_command command;
};

#endif
