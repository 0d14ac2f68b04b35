/* What waits to be sent: sorted by identifier, handed to the kernel in one call. */
#include <errno.h>
#include <linux/can.h>
#include <string.h>
#include <sys/socket.h>

#include "hal/port_socketcan/socketcan_internal.h"

static void to_kernel(const struct can_msg *message, struct can_frame *frame)
{
    memset(frame, 0, sizeof *frame);
    frame->can_id = message->id;
    frame->can_id |= (message->flags & CAN_FRAME_EXTENDED) != 0 ? CAN_EFF_FLAG : 0;
    frame->can_id |= (message->flags & CAN_FRAME_REMOTE) != 0 ? CAN_RTR_FLAG : 0;
    frame->can_dlc = message->length;
    memcpy(frame->data, message->data, message->length);
}

/* Hands the queue to the kernel, most urgent first. Returns how many it took, or a
 * negative errno when it took none. */
static int send_queue(struct socketcan_bus *bus)
{
    struct can_frame frames[SOCKETCAN_TX_QUEUE];
    struct iovec parts[SOCKETCAN_TX_QUEUE];
    struct mmsghdr headers[SOCKETCAN_TX_QUEUE];
    memset(headers, 0, bus->tx_count * sizeof headers[0]);
    for (unsigned i = 0; i < bus->tx_count; i++) {
        to_kernel(&bus->tx[bus->tx_count - 1 - i], &frames[i]);
        parts[i] = (struct iovec){.iov_base = &frames[i], .iov_len = sizeof frames[i]};
        headers[i].msg_hdr.msg_iov = &parts[i];
        headers[i].msg_hdr.msg_iovlen = 1;
    }
    const int taken = sendmmsg(bus->fd, headers, bus->tx_count, 0);
    return taken < 0 ? -errno : taken;
}

void socketcan_flush(struct socketcan_bus *bus)
{
    while (bus->tx_count > 0) {
        const int taken = send_queue(bus);
        if (taken > 0) {
            bus->tx_count -= (unsigned)taken;
            bus->status.tx_frames += (uint32_t)taken;
            continue;
        }
        if (taken == -ENOBUFS || taken == -EAGAIN || taken == -EINTR) {
            socketcan_count(&bus->counters.kernel_full);
            return;
        }
        if (taken == -ENETDOWN || taken == -ENODEV || taken == -ENXIO) {
            socketcan_lose_interface(bus, -taken);
            return;
        }
        socketcan_count(&bus->counters.send_errors);
        bus->tx_count--; /* the kernel will never take this one */
    }
}

static uint32_t urgency(const struct can_msg *message)
{
    return (message->flags & CAN_FRAME_EXTENDED) != 0 ? message->id : message->id << 18;
}

bool socketcan_queue(struct socketcan_bus *bus, const struct can_msg *message)
{
    if (bus->tx_count == SOCKETCAN_TX_QUEUE) {
        socketcan_count(&bus->status.tx_refused);
        if (urgency(&bus->tx[0]) <= urgency(message)) {
            return false;
        }
        bus->tx_count--; /* the least urgent is lost */
        memmove(&bus->tx[0], &bus->tx[1], bus->tx_count * sizeof bus->tx[0]);
    }
    unsigned at = bus->tx_count;
    while (at > 0 && urgency(&bus->tx[at - 1]) <= urgency(message)) {
        bus->tx[at] = bus->tx[at - 1];
        at--;
    }
    bus->tx[at] = *message;
    bus->tx_count++;
    return true;
}
