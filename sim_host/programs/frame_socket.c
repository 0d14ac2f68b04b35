#include "sim_host/programs/frame_socket.h"

#include <errno.h>
#include <poll.h>
#include <string.h>
#include <sys/socket.h>

#include "hal/port_socketcan/socketcan_bus.h"
#include "sim_host/cli/bus_program.h"
#include "sim_host/loop/frame_stream.h"

enum { WAIT_MS = 20, WAITS_MAX = 100, NS_PER_MS = 1000000 };

static enum can_result put(void *context, const struct can_msg *message)
{
    struct frame_socket *socket = (struct frame_socket *)context;
    struct frame_record record = {.id = message->id, .length = message->length};
    memcpy(record.data, message->data, sizeof record.data);
    if (send(socket->fd, &record, sizeof record, MSG_DONTWAIT | MSG_NOSIGNAL) ==
        (ssize_t)sizeof record) {
        socket->status.tx_frames++;
        return CAN_OK;
    }
    if (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR) {
        socket->status.tx_refused++;
        return CAN_FULL;
    }
    socket->is_gone = true;
    return CAN_DOWN;
}

static enum can_result take(void *context, struct can_msg *message, uint64_t *time_ns)
{
    struct frame_socket *socket = (struct frame_socket *)context;
    struct frame_record record;
    const ssize_t got = recv(socket->fd, &record, sizeof record, MSG_DONTWAIT);
    if (got == (ssize_t)sizeof record && record.id <= CAN_ID_STANDARD_MAX &&
        record.length <= CAN_FRAME_DATA_MAX) {
        *message = (struct can_msg){.id = record.id, .length = record.length};
        memcpy(message->data, record.data, sizeof message->data);
        if (time_ns != NULL) {
            *time_ns = socketcan_now_ns();
        }
        socket->status.rx_frames++;
        return CAN_OK;
    }
    socket->is_gone = socket->is_gone || got == 0 ||
                      (got < 0 && errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR);
    return socket->is_gone ? CAN_DOWN : CAN_EMPTY;
}

static void get_status(void *context, struct can_bus_status *status)
{
    *status = ((const struct frame_socket *)context)->status;
}

static void recover(void *context)
{
    (void)context; /* whoever has the interface looks after it */
}

static const struct can_bus_ops ops = {put, take, get_status, recover};

int frame_socket_init(struct frame_socket *frames, int fd)
{
    int kind = 0;
    socklen_t length = sizeof kind;
    *frames = (struct frame_socket){.fd = fd};
    return getsockopt(fd, SOL_SOCKET, SO_TYPE, &kind, &length) == 0 && kind == SOCK_SEQPACKET ? 0
                                                                                              : -1;
}

struct can_bus frame_socket_bus(struct frame_socket *socket)
{
    return (struct can_bus){&ops, socket};
}

static bool goes_on(const struct frame_socket *socket)
{
    return !socket->is_gone && !bus_program_is_to_end();
}

bool frame_socket_wait(void *context, unsigned waits)
{
    struct frame_socket *socket = (struct frame_socket *)context;
    struct pollfd one = {.fd = socket->fd, .events = POLLIN};
    (void)poll(&one, 1, WAIT_MS);
    return waits < WAITS_MAX && goes_on(socket);
}

bool frame_socket_pause(void *context, unsigned milliseconds)
{
    struct frame_socket *socket = (struct frame_socket *)context;
    const uint64_t end_ns = socketcan_now_ns() + (uint64_t)milliseconds * NS_PER_MS;
    struct can_msg message;
    for (uint64_t now_ns = socketcan_now_ns(); goes_on(socket); now_ns = socketcan_now_ns()) {
        while (take(socket, &message, NULL) == CAN_OK) {
            /* heartbeats, and answers to other tools */
        }
        if (now_ns >= end_ns || socket->is_gone) {
            break;
        }
        struct pollfd one = {.fd = socket->fd, .events = POLLIN};
        (void)poll(&one, 1, (int)((end_ns - now_ns) / NS_PER_MS) + 1);
    }
    return goes_on(socket);
}
