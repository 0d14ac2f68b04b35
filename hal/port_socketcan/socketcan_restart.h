/* Restart of a CAN controller that is bus-off, over netlink. */
#ifndef HAL_PORT_SOCKETCAN_SOCKETCAN_RESTART_H
#define HAL_PORT_SOCKETCAN_SOCKETCAN_RESTART_H

/* Asks the kernel to restart the interface's controller, as `ip link set NAME type can
 * restart` does (IFLA_CAN_RESTART, linux/can/netlink.h). Needs CAP_NET_ADMIN. Does not
 * wait for an answer: success shows as an error frame CAN_ERR_RESTARTED. */
void socketcan_restart(const char *interface_name);

#endif
