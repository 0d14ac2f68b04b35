/* The in-process bus for another process: its frames go out as records over a socket, and requests come in.
 *
 * The walk never waits for who reads. What the socket does not take waits in a ring; what the ring does not take is
 * lost, and a record says how many frames that were. Requests are taken between two ticks, so a walk with a silent
 * reader, a slow one or none sends the same frames bit for bit. Of the reader's frames only SDO requests reach the bus:
 * those to the controller, because what a tool may ask there is its own matter (firmware/write_rules.h), and to other
 * nodes those that read.
 */
#ifndef SIM_HOST_LOOP_FRAME_STREAM_H
#define SIM_HOST_LOOP_FRAME_STREAM_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/storage/black_box.h"
#include "sim_host/loop/loop.h"

/* Records that are no frame have an identifier that no frame has. Their values are spoken by sim_host/view/source.py. */
enum frame_stream_note {
    FRAME_STREAM_LOST = 0x70000001,  /* out: data 0..3 = frames lost here */
    FRAME_STREAM_BEGIN = 0x70000002, /* out: a walk begins, its time at 0 */
    FRAME_STREAM_SNAPSHOT =
        0x70000003, /* in: say what the control task's state is (black_box_log.h) */
    FRAME_STREAM_RESTART = 0x70000004 /* in: switch everything off and on */
};

/* As on the socket: little-endian, 24 bytes. */
struct frame_record {
    uint64_t time_us;
    uint32_t id; /* bit 31: 29-bit identifier, bit 30: remote frame, as Linux has it */
    uint8_t length;
    uint8_t reserved[3];
    uint8_t data[CAN_FRAME_DATA_MAX];
};

/* 20 s of a full bus. */
enum { FRAME_STREAM_RECORDS = 1 << 18 };

struct frame_stream {
    int fd;       /* a connected stream socket, not ours to close; -1 = nobody reads */
    bool is_gone; /* the reader hung up */
    bool wants_snapshot, wants_restart;
    uint32_t lost;
    uint64_t refused;    /* records that were neither a request nor such an SDO request */
    uint64_t head, tail; /* of the ring, in bytes; both only grow */
    unsigned part_bytes; /* of a request that came in parts */
    struct frame_record part;
    struct loop *loop;
    int port;
    sim_bus_tap next_tap;
    void *next_context;
    uint8_t snapshot[BLACK_BOX_SNAPSHOT_MAX];
    struct frame_record ring[FRAME_STREAM_RECORDS];
};

/* Once, before any walk. The stream is large (6 MB): static. */
void frame_stream_init(struct frame_stream *stream, int fd);

/* Puts the stream at a loop that was just built, behind the log that it may have. Both must stay where they are.
 * Returns false when the bus has no port left. */
bool frame_stream_attach(struct frame_stream *stream, struct loop *loop);

/* Between two ticks: gives the socket what it takes, takes what has come, and answers a request for a snapshot as
 * soon as the bus is at rest. Never blocks; two system calls. */
void frame_stream_serve(struct frame_stream *stream);

#endif
