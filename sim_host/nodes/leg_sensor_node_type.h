/* The inside of a leg sensor node, public only so that its owner can allocate it. */
#ifndef SIM_HOST_NODES_LEG_SENSOR_NODE_TYPE_H
#define SIM_HOST_NODES_LEG_SENSOR_NODE_TYPE_H

#include "sim_host/nodes/leg_sensor_node.h"

struct leg_sensor_node {
    struct leg_sensor_node_config config;
    struct can_bus bus;
};

#endif
