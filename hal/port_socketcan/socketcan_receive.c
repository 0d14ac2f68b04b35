/* What the kernel received, in batches: frames, error frames and what they say of the controller. */
#include <errno.h>
#include <linux/can.h>
#include <linux/can/error.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>

#include "hal/port_socketcan/socketcan_internal.h"

/* The controller takes part in the bus again: restarted (CAN_ERR_RESTARTED of can_restart() in
 * drivers/net/can/dev); or error-active, as can_change_state() tells it, or, in older drivers, as an
 * active error announcement. Each class has its own byte (linux/can/error.h). */
static bool is_error_active(const struct can_frame *frame)
{
    const uint32_t classes = frame->can_id;
    return (classes & CAN_ERR_RESTARTED) != 0 ||
           ((classes & CAN_ERR_CRTL) != 0 && (frame->data[1] & CAN_ERR_CRTL_ACTIVE) != 0) ||
           ((classes & CAN_ERR_PROT) != 0 && (frame->data[2] & CAN_ERR_PROT_ACTIVE) != 0);
}

static void take_error_frame(struct socketcan_bus *bus, const struct can_frame *frame)
{
    struct can_bus_status *status = &bus->status;
    socketcan_count(&status->error_frames);
    if (is_error_active(frame)) {
        status->error_state = CAN_ERROR_ACTIVE;
    } else if ((frame->can_id & CAN_ERR_BUSOFF) != 0) {
        if (status->error_state != CAN_BUS_OFF) {
            socketcan_count(&status->bus_off_count);
        }
        status->error_state = CAN_BUS_OFF;
        bus->tx_count = 0;
    } else if ((frame->can_id & CAN_ERR_CRTL) != 0 && status->error_state != CAN_BUS_OFF) {
        const unsigned what = frame->data[1];
        if ((what & (CAN_ERR_CRTL_RX_PASSIVE | CAN_ERR_CRTL_TX_PASSIVE)) != 0) {
            status->error_state = CAN_ERROR_PASSIVE;
        } else if ((what & (CAN_ERR_CRTL_RX_WARNING | CAN_ERR_CRTL_TX_WARNING)) != 0) {
            status->error_state = CAN_ERROR_WARNING;
        }
    }
    /* Drivers put their counters into the last two bytes (0 where they do not). */
    status->tx_error_count = frame->data[6];
    status->rx_error_count = frame->data[7];
}

static uint64_t read_control_data(struct socketcan_bus *bus, struct msghdr *header)
{
    uint64_t time_ns = 0;
    for (struct cmsghdr *cmsg = CMSG_FIRSTHDR(header); cmsg != NULL;
         cmsg = CMSG_NXTHDR(header, cmsg)) {
        if (cmsg->cmsg_level != SOL_SOCKET) {
            continue;
        }
        if (cmsg->cmsg_type == SO_TIMESTAMPNS) {
            struct timespec stamp;
            memcpy(&stamp, CMSG_DATA(cmsg), sizeof stamp);
            time_ns = (uint64_t)((int64_t)stamp.tv_sec * SOCKETCAN_NS_PER_S + stamp.tv_nsec -
                                 bus->realtime_minus_monotonic_ns);
        } else if (cmsg->cmsg_type == SO_RXQ_OVFL) {
            uint32_t drops;
            memcpy(&drops, CMSG_DATA(cmsg), sizeof drops);
            bus->status.rx_overflow += drops - bus->kernel_drops;
            bus->kernel_drops = drops;
        }
    }
    return time_ns != 0 ? time_ns : socketcan_now_ns();
}

static void translate(const struct can_frame *frame, struct can_msg *message)
{
    memset(message, 0, sizeof *message);
    if ((frame->can_id & CAN_ERR_FLAG) != 0) {
        message->id = frame->can_id & CAN_ERR_MASK;
        message->flags = CAN_FRAME_ERROR;
    } else if ((frame->can_id & CAN_EFF_FLAG) != 0) {
        message->id = frame->can_id & CAN_EFF_MASK;
        message->flags = CAN_FRAME_EXTENDED;
    } else {
        message->id = frame->can_id & CAN_SFF_MASK;
    }
    message->length = frame->can_dlc <= CAN_FRAME_DATA_MAX ? frame->can_dlc : CAN_FRAME_DATA_MAX;
    if ((frame->can_id & CAN_RTR_FLAG) != 0) {
        message->flags |= CAN_FRAME_REMOTE;
    } else {
        memcpy(message->data, frame->data, message->length);
    }
}

/* Space for the control data of one frame, aligned as cmsg(3) wants it. */
struct control {
    _Alignas(struct cmsghdr) char bytes[CMSG_SPACE(sizeof(struct timespec)) +
                                        CMSG_SPACE(sizeof(uint32_t))];
};

/* Puts one frame from the kernel into the batch, unless it is an own one that nobody
 * wants to hear. */
static void take_frame(struct socketcan_bus *bus, const struct can_frame *frame,
                       struct msghdr *header)
{
    struct socketcan_received *received = &bus->rx[bus->rx_count];
    struct can_msg *message = &received->message;
    const bool own = (header->msg_flags & MSG_CONFIRM) != 0;
    received->time_ns = read_control_data(bus, header);
    translate(frame, message);
    if (own && (message->id != SOCKETCAN_SYNC_ID || message->flags != 0)) {
        return;
    }
    if ((message->flags & CAN_FRAME_ERROR) != 0) {
        take_error_frame(bus, frame);
    } else if (own) {
        message->flags |= CAN_FRAME_OWN;
    } else {
        socketcan_count(&bus->status.rx_frames);
        if (bus->status.error_state == CAN_BUS_OFF) { /* off the bus nothing is received */
            bus->status.error_state = CAN_ERROR_ACTIVE;
        }
    }
    bus->rx_count++;
}

/* Fetches the next batch. Returns false when the interface is lost. */
bool socketcan_fetch(struct socketcan_bus *bus)
{
    struct can_frame frames[SOCKETCAN_RX_BATCH];
    struct control controls[SOCKETCAN_RX_BATCH];
    struct iovec parts[SOCKETCAN_RX_BATCH];
    struct mmsghdr headers[SOCKETCAN_RX_BATCH];
    memset(headers, 0, sizeof headers);
    memset(controls, 0, sizeof controls);
    for (unsigned i = 0; i < SOCKETCAN_RX_BATCH; i++) {
        parts[i] = (struct iovec){.iov_base = &frames[i], .iov_len = sizeof frames[i]};
        headers[i].msg_hdr = (struct msghdr){.msg_iov = &parts[i],
                                             .msg_iovlen = 1,
                                             .msg_control = controls[i].bytes,
                                             .msg_controllen = sizeof controls[i].bytes};
    }
    bus->rx_next = 0;
    bus->rx_count = 0;
    const int got = recvmmsg(bus->fd, headers, SOCKETCAN_RX_BATCH, MSG_DONTWAIT, NULL);
    if (got < 0) {
        if (errno == ENETDOWN || errno == ENODEV || errno == ENXIO) {
            socketcan_lose_interface(bus, errno);
            return false;
        }
        return true;
    }
    for (int i = 0; i < got; i++) {
        if (headers[i].msg_len == sizeof frames[i]) {
            take_frame(bus, &frames[i], &headers[i].msg_hdr);
        }
    }
    return true;
}
