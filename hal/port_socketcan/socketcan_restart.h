/* Restart of a CAN controller that is bus-off, over netlink. */
#ifndef HAL_PORT_SOCKETCAN_SOCKETCAN_RESTART_H
#define HAL_PORT_SOCKETCAN_SOCKETCAN_RESTART_H

/* Asks the kernel to restart the interface's controller, as `ip link set NAME type can
 * restart` does (IFLA_CAN_RESTART, linux/can/netlink.h). Returns 0 when the kernel has done so, which
 * shows as an error frame CAN_ERR_RESTARTED, or a negative errno: -EPERM without CAP_NET_ADMIN,
 * -EBUSY while the kernel does it by itself (restart-ms) or the controller is not bus-off. Never blocks. */
int socketcan_restart(const char *interface_name);

#endif
