#include "sim_host/emulator/g474/gdb_link.h"

#include <arpa/inet.h>
#include <errno.h>
#include <netinet/tcp.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

enum { INTERRUPT = 3, RESEND_MAX = 5 };

static int refuse(struct gdb_link *link, const char *what)
{
    snprintf(link->message, sizeof link->message, "%s: %s", what, strerror(errno));
    gdb_link_close(link);
    return -1;
}

int gdb_link_listen(struct gdb_link *link, unsigned port)
{
    struct sockaddr_in address = {.sin_family = AF_INET,
                                  .sin_port = htons((uint16_t)port),
                                  .sin_addr = {htonl(INADDR_LOOPBACK)}};
    socklen_t length = sizeof address;
    const int yes = 1;
    char where[64];

    *link = (struct gdb_link){.listener = -1, .peer = -1};
    snprintf(where, sizeof where, "--gdb: 127.0.0.1:%u", port);
    link->listener = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    if (link->listener < 0) {
        return refuse(link, where);
    }
    (void)setsockopt(link->listener, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    if (bind(link->listener, (struct sockaddr *)&address, sizeof address) != 0 ||
        listen(link->listener, 1) != 0 ||
        getsockname(link->listener, (struct sockaddr *)&address, &length) != 0) {
        return refuse(link, where);
    }
    return ntohs(address.sin_port);
}

int gdb_link_accept(struct gdb_link *link)
{
    const int yes = 1;

    link->peer = accept(link->listener, NULL, NULL);
    if (link->peer < 0) {
        return refuse(link, "--gdb: no debugger");
    }
    link->no_acks = false;
    (void)setsockopt(link->peer, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
    return 0;
}

void gdb_link_drop(struct gdb_link *link)
{
    if (link->peer >= 0) {
        (void)close(link->peer);
        link->peer = -1;
    }
}

void gdb_link_close(struct gdb_link *link)
{
    gdb_link_drop(link);
    if (link->listener >= 0) {
        (void)close(link->listener);
        link->listener = -1;
    }
}

/* -1 when nobody is there any more. */
static int get(struct gdb_link *link)
{
    unsigned char byte;
    ssize_t got;

    do {
        got = link->peer >= 0 ? recv(link->peer, &byte, 1, 0) : 0;
    } while (got < 0 && errno == EINTR);
    return got == 1 ? byte : -1;
}

static void put(struct gdb_link *link, const char *bytes, size_t count)
{
    while (link->peer >= 0 && count > 0) {
        const ssize_t sent = send(link->peer, bytes, count, MSG_NOSIGNAL);
        if (sent <= 0 && errno != EINTR) {
            return;
        }
        bytes += sent > 0 ? sent : 0;
        count -= sent > 0 ? (size_t)sent : 0;
    }
}

static int digit(int character)
{
    return character >= '0' && character <= '9'   ? character - '0'
           : character >= 'a' && character <= 'f' ? character - 'a' + 10
                                                  : -1;
}

int gdb_link_receive(struct gdb_link *link, char packet[GDB_PACKET_MAX])
{
    for (;;) {
        unsigned sum = 0;
        int length = 0, byte = get(link);
        while (byte >= 0 && byte != '$') { /* acknowledgements, and what is left of another one */
            byte = get(link);
        }
        for (byte = byte < 0 ? byte : get(link); byte >= 0 && byte != '#'; byte = get(link)) {
            sum += (unsigned)byte;
            if (length < GDB_PACKET_MAX - 1) {
                packet[length++] = (char)byte;
            }
        }
        const int high = byte < 0 ? -1 : digit(get(link)), low = byte < 0 ? -1 : digit(get(link));
        if (byte < 0) {
            return -1;
        }
        const bool good = high >= 0 && low >= 0 && (sum & 0xFFu) == (unsigned)(high * 16 + low);
        if (!link->no_acks) {
            put(link, good ? "+" : "-", 1);
        }
        if (good) {
            packet[length] = '\0';
            return length;
        }
    }
}

void gdb_link_send(struct gdb_link *link, const char *packet)
{
    char tail[4];
    unsigned sum = 0;

    for (const char *c = packet; *c != '\0'; c++) {
        sum += (unsigned char)*c;
    }
    snprintf(tail, sizeof tail, "#%02x", sum & 0xFFu);
    for (int turn = 0; turn < RESEND_MAX; turn++) {
        put(link, "$", 1);
        put(link, packet, strlen(packet));
        put(link, tail, 3);
        const int answer = link->no_acks ? '+' : get(link);
        if (answer != '-') {
            return;
        }
    }
}

bool gdb_link_interrupts(struct gdb_link *link)
{
    unsigned char byte = 0;
    const ssize_t got = link->peer >= 0 ? recv(link->peer, &byte, 1, MSG_DONTWAIT) : -1;

    return got == 0 || (got == 1 && byte == INTERRUPT);
}
