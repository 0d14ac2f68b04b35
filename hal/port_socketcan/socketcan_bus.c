#include "hal/port_socketcan/socketcan_bus.h"

#include <errno.h>
#include <poll.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

#include "hal/port_socketcan/socketcan_internal.h"
#include "hal/port_socketcan/socketcan_restart.h"

static const uint64_t RETRY_FULL_NS = 200000; /* when the kernel's queue was full */

/* ---- sending -------------------------------------------------------------- */

void socketcan_bus_flush(struct socketcan_bus *bus)
{
    if (socketcan_is_usable(bus)) {
        socketcan_flush(bus);
    }
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
    if (!socketcan_is_usable(bus) || bus->status.error_state == CAN_BUS_OFF) {
        return CAN_DOWN;
    }
    /* A SYNC ends the cycle whose commands wait here: it must not overtake them. */
    if (bus->tx_count == SOCKETCAN_TX_QUEUE || message->id == SOCKETCAN_SYNC_ID) {
        socketcan_flush(bus);
    }
    if (bus->is_down) {
        return CAN_DOWN;
    }
    return socketcan_queue(bus, message) ? CAN_OK : CAN_FULL;
}

/* ---- receiving ------------------------------------------------------------ */

static enum can_result port_receive(void *context, struct can_msg *message, uint64_t *time_ns)
{
    struct socketcan_bus *bus = context;
    if (bus->rx_next == bus->rx_count) {
        if (!socketcan_is_usable(bus)) {
            return CAN_DOWN;
        }
        socketcan_flush(bus);
        if (bus->is_down || !socketcan_fetch(bus)) {
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
    if (bus->status.error_state == CAN_BUS_OFF && !bus->is_down) {
        bus->restart_error = socketcan_restart(bus->name);
    }
}

/* -EBUSY: the kernel does it by itself, after restart-ms (drivers/net/can/dev, can_restart_now). */
bool socketcan_bus_advice(struct socketcan_bus *bus, char *text, size_t size)
{
    const int error = bus->restart_error;
    bus->restart_error = 0;
    if (bus->was_advised || error == 0 || error == -EBUSY) {
        return false;
    }
    bus->was_advised = true;
    if (error == -EPERM || error == -EACCES) {
        snprintf(
            text, size,
            "%s is bus-off, and only CAP_NET_ADMIN may restart it. As root, let the kernel do it "
            "from now on: ip link set %s down, ip link set %s type can restart-ms 100, ip link "
            "set %s up (or once: ip link set %s type can restart)",
            bus->name, bus->name, bus->name, bus->name, bus->name);
    } else {
        snprintf(text, size,
                 "%s is bus-off, and its driver does not restart it (%s): ip link set %s down, ip "
                 "link set %s up",
                 bus->name, strerror(-error), bus->name, bus->name);
    }
    return true;
}

static const struct can_bus_ops port_ops = {.send = port_send,
                                            .receive = port_receive,
                                            .get_status = port_get_status,
                                            .recover = port_recover};

struct can_bus socketcan_bus_interface(struct socketcan_bus *bus)
{
    return (struct can_bus){.ops = &port_ops, .context = bus};
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
        if (socketcan_is_usable(bus)) {
            socketcan_flush(bus);
            if (!bus->is_down && socketcan_fetch(bus) && bus->rx_count > 0) {
                return 1;
            }
        }
        const uint64_t now_ns = socketcan_now_ns();
        socketcan_follow_clock(bus, now_ns);
        if (now_ns >= deadline_ns) {
            return 0;
        }
        const uint64_t left_ns = look_again_ns(bus, now_ns, deadline_ns) - now_ns;
        const struct timespec left = {.tv_sec = (time_t)(left_ns / (uint64_t)SOCKETCAN_NS_PER_S),
                                      .tv_nsec = (long)(left_ns % (uint64_t)SOCKETCAN_NS_PER_S)};
        struct pollfd waiting = {.fd = bus->is_down ? -1 : bus->fd, .events = POLLIN};
        if (ppoll(&waiting, 1, &left, NULL) < 0) {
            return -errno;
        }
    }
}
