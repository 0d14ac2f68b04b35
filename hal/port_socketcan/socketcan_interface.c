/* Opening, losing and finding again the network interface. */
#include <errno.h>
#include <linux/can.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include "hal/port_socketcan/socketcan_internal.h"

static const uint64_t RETRY_DOWN_NS = 5000000; /* how often a lost interface is tried */

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
        filters[n].can_id = SOCKETCAN_SYNC_ID;
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
    bus->realtime_minus_monotonic_ns = socketcan_realtime_minus_monotonic_ns();
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
void socketcan_lose_interface(struct socketcan_bus *bus, int error)
{
    if (!bus->is_down) {
        socketcan_count(&bus->counters.went_down);
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
bool socketcan_is_usable(struct socketcan_bus *bus)
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
        socketcan_count(&bus->counters.came_back);
        bus->status.error_state = CAN_ERROR_ACTIVE;
    }
    return !bus->is_down;
}
