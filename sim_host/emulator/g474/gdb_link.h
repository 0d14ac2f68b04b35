/* The wire to a debugger: gdb's remote serial protocol over TCP on the loopback interface, its packets
 * and acknowledgements (GDB manual, appendix E, "Remote Protocol": "Overview").
 */
#ifndef SIM_HOST_EMULATOR_G474_GDB_LINK_H
#define SIM_HOST_EMULATOR_G474_GDB_LINK_H

#include <stdbool.h>
#include <stddef.h>

enum { GDB_PACKET_MAX = 4096, GDB_MESSAGE_MAX = 160 };

struct gdb_link {
    int listener, peer; /* -1 = none */
    bool no_acks;
    char message[GDB_MESSAGE_MAX];
};

/* Listens at 127.0.0.1; port 0: one that is free. Returns the port, or -1 with the reason in message. */
int gdb_link_listen(struct gdb_link *link, unsigned port);
/* Waits for a debugger. Returns 0, or -1 with the reason in message. */
int gdb_link_accept(struct gdb_link *link);
/* The debugger goes; the next may come. */
void gdb_link_drop(struct gdb_link *link);
void gdb_link_close(struct gdb_link *link);

/* Waits for a packet and acknowledges it. Returns its length, without a zero behind it counted, or -1
 * when the debugger is gone. */
int gdb_link_receive(struct gdb_link *link, char packet[GDB_PACKET_MAX]);
/* Sends a packet and waits for its acknowledgement. */
void gdb_link_send(struct gdb_link *link, const char *packet);
/* Whether the debugger asks to stop (byte 3) or is gone, without waiting. */
bool gdb_link_interrupts(struct gdb_link *link);

#endif
