#include "hal/port_socketcan/socketcan_bus.h"

#include <errno.h>
#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <poll.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#include "hal/port_socketcan/socketcan_restart.h"

enum { SYNC_ID = 0x080 };

static const int64_t NS_PER_S = 1000000000;
static const uint64_t RETRY_DOWN_NS = 5000000; /* how often a lost interface is tried */
static const uint64_t RETRY_FULL_NS = 200000;  /* when the kernel's queue was full */

static void count(uint32_t *counter)
{
    if (*counter < UINT32_MAX) {
        (*counter)++;
    }
}

static int64_t clock_ns(clockid_t clock)
{
    struct timespec now;
    clock_gettime(clock, &now);
    return (int64_t)now.tv_sec * NS_PER_S + now.tv_nsec;
}

/* How far one clock is ahead of the other: of a few readings the one that was least interrupted. */
static int64_t realtime_minus_monotonic(void)
{
    int64_t ahead = 0, least = INT64_MAX;
    for (int i = 0; i < 5; i++) {
        const int64_t before = clock_ns(CLOCK_MONOTONIC);
        const int64_t real = clock_ns(CLOCK_REALTIME);
        const int64_t took = clock_ns(CLOCK_MONOTONIC) - before;
        if (took < least) {
            least = took;
            ahead = real - (before + took / 2);
        }
    }
    return ahead;
}

uint64_t socketcan_now_ns(void)
{
    return (uint64_t)clock_ns(CLOCK_MONOTONIC);
}

/* ---- opening and losing the interface ----------------------------------- */

static int set_filters(const struct socketcan_bus *bus, int fd)
{
    struct can_filter filters[SOCKETCAN_FILTERS_MAX + 1];
    unsigned n = 0;
    for (; n < bus->filter_count; n++) {
        filters[n].can_id = bus->filters[n].id;
        /* With these bits in the mask only standard data frames match. */
        filters[n].can_mask = bus->filters[n].mask | CAN_EFF_FLAG | CAN_RTR_FLAG;
    }
    if (n > 0 && bus->hear_own_sync) {
        filters[n].can_id = SYNC_ID;
        filters[n].can_mask = CAN_SFF_MASK | CAN_EFF_FLAG | CAN_RTR_FLAG;
        n++;
    }
    if (n == 0) { /* one that matches every data and remote frame */
        filters[n++] = (struct can_filter){.can_id = 0, .can_mask = 0};
    }
    return setsockopt(fd, SOL_CAN_RAW, CAN_RAW_FILTER, filters,
                      (socklen_t)(n * sizeof filters[0])) == 0
               ? 0
               : -errno;
}

static int set_options(const struct socketcan_bus *bus, int fd)
{
    const int on = 1;
    const int own = bus->hear_own_sync ? 1 : 0;
    const can_err_mask_t errors = CAN_ERR_MASK;
    if (setsockopt(fd, SOL_CAN_RAW, CAN_RAW_RECV_OWN_MSGS, &own, sizeof own) != 0 ||
        setsockopt(fd, SOL_CAN_RAW, CAN_RAW_ERR_FILTER, &errors, sizeof errors) != 0 ||
        setsockopt(fd, SOL_SOCKET, SO_TIMESTAMPNS, &on, sizeof on) != 0 ||
        setsockopt(fd, SOL_SOCKET, SO_RXQ_OVFL, &on, sizeof on) != 0) {
        return -errno;
    }
    return set_filters(bus, fd);
}

static bool interface_is_up(const struct socketcan_bus *bus, int fd)
{
    struct ifreq request;
    memset(&request, 0, sizeof request);
    memcpy(request.ifr_name, bus->name, sizeof bus->name);
    return ioctl(fd, SIOCGIFFLAGS, &request) == 0 && (request.ifr_flags & IFF_UP) != 0;
}

/* Binding to an interface that is down leaves ENETDOWN for the next call. */
static void clear_pending_error(int fd)
{
    int error;
    socklen_t size = sizeof error;
    (void)getsockopt(fd, SOL_SOCKET, SO_ERROR, &error, &size);
}

static int open_socket(struct socketcan_bus *bus)
{
    const int fd = socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW);
    if (fd < 0) {
        return -errno;
    }
    struct sockaddr_can address = {.can_family = AF_CAN};
    address.can_ifindex = (int)if_nametoindex(bus->name);
    int error = address.can_ifindex == 0 ? -ENODEV : set_options(bus, fd);
    if (error == 0 && bind(fd, (struct sockaddr *)&address, sizeof address) != 0) {
        error = -errno;
    }
    if (error != 0) {
        close(fd);
        return error;
    }
    bus->fd = fd;
    bus->kernel_drops = 0;
    bus->is_down = !interface_is_up(bus, fd);
    return 0;
}

int socketcan_bus_open(struct socketcan_bus *bus, const char *interface_name,
                       const struct socketcan_filter *filters, unsigned filter_count,
                       bool hear_own_sync)
{
    const size_t length = strlen(interface_name);
    memset(bus, 0, sizeof *bus);
    bus->fd = -1;
    if (length >= SOCKETCAN_NAME_MAX) {
        return -ENAMETOOLONG;
    }
    if (length == 0 || filter_count > SOCKETCAN_FILTERS_MAX) {
        return -EINVAL;
    }
    memcpy(bus->name, interface_name, length);
    if (filter_count > 0) {
        memcpy(bus->filters, filters, filter_count * sizeof filters[0]);
    }
    bus->filter_count = filter_count;
    bus->hear_own_sync = hear_own_sync;
    bus->realtime_minus_monotonic_ns = realtime_minus_monotonic();
    return open_socket(bus);
}

int socketcan_bus_set_filters(struct socketcan_bus *bus, const struct socketcan_filter *filters,
                              unsigned filter_count)
{
    if (filter_count > SOCKETCAN_FILTERS_MAX) {
        return -EINVAL;
    }
    if (filter_count > 0) {
        memcpy(bus->filters, filters, filter_count * sizeof filters[0]);
    }
    bus->filter_count = filter_count;
    return bus->fd >= 0 ? set_filters(bus, bus->fd) : 0;
}

void socketcan_bus_close(struct socketcan_bus *bus)
{
    if (bus->fd >= 0) {
        close(bus->fd);
    }
    bus->fd = -1;
    bus->is_down = true;
}

/* The interface is down or gone. What waited here is lost, as in a controller that
 * is switched off. */
static void lose_interface(struct socketcan_bus *bus, int error)
{
    if (!bus->is_down) {
        count(&bus->counters.went_down);
    }
    bus->is_down = true;
    bus->status.error_state = CAN_BUS_OFF; /* until it is back */
    bus->tx_count = 0;
    bus->next_retry_ns = socketcan_now_ns() + RETRY_DOWN_NS;
    if ((error == ENODEV || error == ENXIO) && bus->fd >= 0) {
        close(bus->fd); /* the index is dead; a new interface needs a new binding */
        bus->fd = -1;
    }
}

/* True when the interface can be used; tries a lost one now and then. */
static bool is_usable(struct socketcan_bus *bus)
{
    if (!bus->is_down) {
        return true;
    }
    const uint64_t now_ns = socketcan_now_ns();
    if (now_ns < bus->next_retry_ns) {
        return false;
    }
    bus->next_retry_ns = now_ns + RETRY_DOWN_NS;
    /* An interface that was removed and made again has a new index: open anew. */
    if (bus->fd >= 0 && !interface_is_up(bus, bus->fd)) {
        close(bus->fd);
        bus->fd = -1;
    }
    if (bus->fd < 0 && open_socket(bus) != 0) {
        return false;
    }
    bus->is_down = !interface_is_up(bus, bus->fd);
    if (!bus->is_down) {
        clear_pending_error(bus->fd);
        count(&bus->counters.came_back);
        bus->status.error_state = CAN_ERROR_ACTIVE;
    }
    return !bus->is_down;
}

/* ---- sending -------------------------------------------------------------- */

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

static void flush(struct socketcan_bus *bus)
{
    while (bus->tx_count > 0) {
        const int taken = send_queue(bus);
        if (taken > 0) {
            bus->tx_count -= (unsigned)taken;
            bus->status.tx_frames += (uint32_t)taken;
            continue;
        }
        if (taken == -ENOBUFS || taken == -EAGAIN || taken == -EINTR) {
            count(&bus->counters.kernel_full);
            return;
        }
        if (taken == -ENETDOWN || taken == -ENODEV || taken == -ENXIO) {
            lose_interface(bus, -taken);
            return;
        }
        count(&bus->counters.send_errors);
        bus->tx_count--; /* the kernel will never take this one */
    }
}

void socketcan_bus_flush(struct socketcan_bus *bus)
{
    if (is_usable(bus)) {
        flush(bus);
    }
}

static uint32_t urgency(const struct can_msg *message)
{
    return (message->flags & CAN_FRAME_EXTENDED) != 0 ? message->id : message->id << 18;
}

static enum can_result port_send(void *context, const struct can_msg *message)
{
    struct socketcan_bus *bus = context;
    const uint32_t id_max = (message->flags & CAN_FRAME_EXTENDED) != 0
                                ? (uint32_t)CAN_ID_EXTENDED_MAX
                                : (uint32_t)CAN_ID_STANDARD_MAX;
    if (message->length > CAN_FRAME_DATA_MAX || message->id > id_max ||
        (message->flags & CAN_FRAME_ERROR) != 0) {
        return CAN_INVALID;
    }
    if (!is_usable(bus) || bus->status.error_state == CAN_BUS_OFF) {
        return CAN_DOWN;
    }
    /* A SYNC ends the cycle whose commands wait here: it must not overtake them. */
    if (bus->tx_count == SOCKETCAN_TX_QUEUE || message->id == SYNC_ID) {
        flush(bus);
    }
    if (bus->is_down) {
        return CAN_DOWN;
    }
    if (bus->tx_count == SOCKETCAN_TX_QUEUE) {
        count(&bus->status.tx_refused);
        if (urgency(&bus->tx[0]) <= urgency(message)) {
            return CAN_FULL;
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
    return CAN_OK;
}

/* ---- receiving ------------------------------------------------------------ */

static void take_error_frame(struct socketcan_bus *bus, const struct can_frame *frame)
{
    struct can_bus_status *status = &bus->status;
    count(&status->error_frames);
    if ((frame->can_id & CAN_ERR_BUSOFF) != 0) {
        if (status->error_state != CAN_BUS_OFF) {
            count(&status->bus_off_count);
        }
        status->error_state = CAN_BUS_OFF;
        bus->tx_count = 0;
    } else if ((frame->can_id & CAN_ERR_RESTARTED) != 0) {
        status->error_state = CAN_ERROR_ACTIVE;
    } else if ((frame->can_id & CAN_ERR_CRTL) != 0 && status->error_state != CAN_BUS_OFF) {
        const unsigned what = frame->data[1];
        if ((what & (CAN_ERR_CRTL_RX_PASSIVE | CAN_ERR_CRTL_TX_PASSIVE)) != 0) {
            status->error_state = CAN_ERROR_PASSIVE;
        } else if ((what & (CAN_ERR_CRTL_RX_WARNING | CAN_ERR_CRTL_TX_WARNING)) != 0) {
            status->error_state = CAN_ERROR_WARNING;
        } else if ((what & CAN_ERR_CRTL_ACTIVE) != 0) {
            status->error_state = CAN_ERROR_ACTIVE;
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
            time_ns = (uint64_t)((int64_t)stamp.tv_sec * NS_PER_S + stamp.tv_nsec -
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
    if (own && (message->id != SYNC_ID || message->flags != 0)) {
        return;
    }
    if ((message->flags & CAN_FRAME_ERROR) != 0) {
        take_error_frame(bus, frame);
    } else if (own) {
        message->flags |= CAN_FRAME_OWN;
    } else {
        count(&bus->status.rx_frames);
    }
    bus->rx_count++;
}

/* Fetches the next batch. Returns false when the interface is lost. */
static bool fetch(struct socketcan_bus *bus)
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
            lose_interface(bus, errno);
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

static enum can_result port_receive(void *context, struct can_msg *message, uint64_t *time_ns)
{
    struct socketcan_bus *bus = context;
    if (bus->rx_next == bus->rx_count) {
        if (!is_usable(bus)) {
            return CAN_DOWN;
        }
        flush(bus);
        if (bus->is_down || !fetch(bus)) {
            return CAN_DOWN;
        }
        if (bus->rx_count == 0) {
            return CAN_EMPTY;
        }
    }
    const struct socketcan_received *received = &bus->rx[bus->rx_next++];
    *message = received->message;
    if (time_ns != NULL) {
        *time_ns = received->time_ns;
    }
    return CAN_OK;
}

bool socketcan_bus_has_fetched(const struct socketcan_bus *bus, uint32_t id)
{
    for (unsigned i = bus->rx_next; i < bus->rx_count; i++) {
        if (bus->rx[i].message.id == id && bus->rx[i].message.flags == 0) {
            return true;
        }
    }
    return false;
}

static void port_get_status(void *context, struct can_bus_status *status)
{
    const struct socketcan_bus *bus = context;
    *status = bus->status;
}

static void port_recover(void *context)
{
    struct socketcan_bus *bus = context;
    if (bus->status.error_state == CAN_BUS_OFF) {
        socketcan_restart(bus->name);
    }
}

static const struct can_bus_ops port_ops = {.send = port_send,
                                            .receive = port_receive,
                                            .get_status = port_get_status,
                                            .recover = port_recover};

struct can_bus socketcan_bus_interface(struct socketcan_bus *bus)
{
    return (struct can_bus){.ops = &port_ops, .context = bus};
}

/* The kernel stamps with CLOCK_REALTIME, which may be set: measured again each second. */
static void follow_clock(struct socketcan_bus *bus, uint64_t now_ns)
{
    if (now_ns - bus->offset_age_ns > (uint64_t)NS_PER_S) {
        bus->offset_age_ns = now_ns;
        bus->realtime_minus_monotonic_ns = realtime_minus_monotonic();
    }
}

/* When to look again although nothing came: from now_ns to deadline_ns, which must not lie
 * before it. The next try of an interface that is down may have fallen due meanwhile. */
static uint64_t look_again_ns(const struct socketcan_bus *bus, uint64_t now_ns,
                              uint64_t deadline_ns)
{
    uint64_t until_ns = deadline_ns;
    if (bus->is_down) {
        until_ns = bus->next_retry_ns;
    } else if (bus->tx_count > 0) {
        until_ns = now_ns + RETRY_FULL_NS; /* POLLOUT does not tell of a full device queue */
    }
    if (until_ns < now_ns) {
        return now_ns;
    }
    return until_ns < deadline_ns ? until_ns : deadline_ns;
}

int socketcan_bus_wait(struct socketcan_bus *bus, uint64_t deadline_ns)
{
    for (;;) {
        if (bus->rx_next < bus->rx_count) {
            return 1;
        }
        if (is_usable(bus)) {
            flush(bus);
            if (!bus->is_down && fetch(bus) && bus->rx_count > 0) {
                return 1;
            }
        }
        const uint64_t now_ns = socketcan_now_ns();
        follow_clock(bus, now_ns);
        if (now_ns >= deadline_ns) {
            return 0;
        }
        const uint64_t left_ns = look_again_ns(bus, now_ns, deadline_ns) - now_ns;
        const struct timespec left = {.tv_sec = (time_t)(left_ns / (uint64_t)NS_PER_S),
                                      .tv_nsec = (long)(left_ns % (uint64_t)NS_PER_S)};
        struct pollfd waiting = {.fd = bus->is_down ? -1 : bus->fd, .events = POLLIN};
        if (ppoll(&waiting, 1, &left, NULL) < 0) {
            return -errno;
        }
    }
}
