/* `struct can_bus` over a socket that another process gave: each packet is a frame record (loop/frame_stream.h). So a tool
 * reaches a bus that this process has no interface to, such as the one inside `afo view`. */
#ifndef SIM_HOST_PROGRAMS_FRAME_SOCKET_H
#define SIM_HOST_PROGRAMS_FRAME_SOCKET_H

#include <stdbool.h>

#include "hal/bus/can_bus.h"

struct frame_socket {
    int fd;       /* a connected AF_UNIX socket of whole packets (SOCK_SEQPACKET) */
    bool is_gone; /* the other side hung up: all waits end */
    struct can_bus_status status;
};

/* fd: inherited, not ours to close. Returns 0, or -1 when it is no such socket. */
int frame_socket_init(struct frame_socket *socket, int fd);

/* Valid as long as *socket stays where it is. Its send never waits: a full socket is CAN_FULL, one without another
 * side CAN_DOWN. */
struct can_bus frame_socket_bus(struct frame_socket *socket);

/* The waits of ctl_link.h; context: a struct frame_socket. Their bounds are those of bus_wait.h. */
bool frame_socket_wait(void *context, unsigned waits);
bool frame_socket_pause(void *context, unsigned milliseconds);

#endif
