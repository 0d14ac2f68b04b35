/* A bench for one virtual node: the in-process bus, the node, and a master's port
 * with which the test speaks CANopen by hand. */
#ifndef TESTS_SUPPORT_NODE_BENCH_H
#define TESTS_SUPPORT_NODE_BENCH_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/canopen/co_sdo_client.h"
#include "sim_host/bus/sim_bus.h"

enum { BENCH_SEEN_MAX = 4096, BENCH_TICK_NS = 1000000 };

struct bench {
    struct sim_bus bus;
    struct can_bus master;
    struct can_bus node_bus;
    uint64_t tick;
    uint8_t node_id;
    void (*poll)(void *node, uint64_t now_ns);
    void (*period)(void *node); /* once a tick after the traffic, or NULL */
    void *node;
    bool heartbeats; /* the master's, node 16, every 50 ms */
    bool syncs;      /* a SYNC every tick */
    unsigned seen_count;
    struct can_msg seen[BENCH_SEEN_MAX]; /* all but SYNC and the master's heartbeat */
    struct co_sdo_client sdo;
};

/* Empties the bench and attaches both ports. poll and node as in struct bench. */
void bench_init(struct bench *bench, uint8_t node_id, void (*poll)(void *node, uint64_t now_ns),
                void (*period)(void *node), void *node);

void bench_run(struct bench *bench, unsigned ticks);
void bench_send(struct bench *bench, uint32_t id, unsigned length, const uint8_t *data);
void bench_nmt(struct bench *bench, uint8_t command);

/* The last frame seen with this identifier, or NULL; and how many there were. */
const struct can_msg *bench_last(const struct bench *bench, uint32_t id);
unsigned bench_count(const struct bench *bench, uint32_t id);
void bench_forget(struct bench *bench);

/* One SDO transfer, run to its end. Returns the abort code (0: done). */
uint32_t bench_read(struct bench *bench, uint16_t index, uint8_t sub, uint8_t *bytes,
                    unsigned *length);
uint32_t bench_write(struct bench *bench, uint16_t index, uint8_t sub, uint32_t value,
                     unsigned length);
/* The number at index:sub; the test fails when it cannot be read. */
uint32_t bench_value(struct bench *bench, uint16_t index, uint8_t sub);

#endif
