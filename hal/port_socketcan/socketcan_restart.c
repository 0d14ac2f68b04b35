#include "hal/port_socketcan/socketcan_restart.h"

#include <errno.h>
#include <linux/can/netlink.h>
#include <linux/if_link.h>
#include <linux/netlink.h>
#include <linux/rtnetlink.h>
#include <net/if.h>
#include <stdint.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

enum { REQUEST_MAX = 128 };

struct request {
    struct nlmsghdr header;
    struct ifinfomsg link;
    char attributes[REQUEST_MAX];
};

/* Appends an attribute; data may be NULL for the start of a nest. */
static struct rtattr *append(struct request *request, unsigned short type, const void *data,
                             unsigned short length)
{
    char *end = (char *)request + NLMSG_ALIGN(request->header.nlmsg_len);
    struct rtattr *attribute = (struct rtattr *)(void *)end;
    attribute->rta_type = type;
    attribute->rta_len = (unsigned short)RTA_LENGTH(length);
    if (length > 0) {
        memcpy(RTA_DATA(attribute), data, length);
    }
    request->header.nlmsg_len =
        NLMSG_ALIGN(request->header.nlmsg_len) + (uint32_t)RTA_ALIGN(attribute->rta_len);
    return attribute;
}

static void close_nest(const struct request *request, struct rtattr *nest)
{
    const char *end = (const char *)request + request->header.nlmsg_len;
    nest->rta_len = (unsigned short)(end - (const char *)nest);
}

/* The kernel handles a request within send(): its answer is there at once. */
static int answer_of(int fd)
{
    struct {
        struct nlmsghdr header;
        struct nlmsgerr error;
        char rest[REQUEST_MAX + sizeof(struct request)];
    } answer;
    const ssize_t got = recv(fd, &answer, sizeof answer, MSG_DONTWAIT);
    if (got < 0) {
        return -errno;
    }
    return got >= (ssize_t)(sizeof answer.header + sizeof answer.error.error) &&
                   answer.header.nlmsg_type == NLMSG_ERROR
               ? answer.error.error
               : -EPROTO;
}

int socketcan_restart(const char *interface_name)
{
    const uint32_t restart = 1;
    struct request request;
    memset(&request, 0, sizeof request);
    request.header.nlmsg_len = NLMSG_LENGTH(sizeof request.link);
    request.header.nlmsg_type = RTM_NEWLINK;
    request.header.nlmsg_flags = NLM_F_REQUEST | NLM_F_ACK;
    request.link.ifi_index = (int)if_nametoindex(interface_name);
    struct rtattr *info = append(&request, IFLA_LINKINFO, NULL, 0);
    (void)append(&request, IFLA_INFO_KIND, "can", 3);
    struct rtattr *data = append(&request, IFLA_INFO_DATA, NULL, 0);
    (void)append(&request, IFLA_CAN_RESTART, &restart, sizeof restart);
    close_nest(&request, data);
    close_nest(&request, info);

    const int fd = socket(AF_NETLINK, SOCK_RAW | SOCK_CLOEXEC, NETLINK_ROUTE);
    if (fd < 0) {
        return -errno;
    }
    const ssize_t sent = send(fd, &request, request.header.nlmsg_len, MSG_DONTWAIT);
    const int error = sent < 0 ? -errno : answer_of(fd);
    close(fd);
    return error;
}
