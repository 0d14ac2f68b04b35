#include "tests/support/node_bench.h"

#include <check.h>
#include <string.h>

#include "hal/bus/bytes.h"

void bench_init(struct bench *bench, uint8_t node_id, void (*poll)(void *node, uint64_t now_ns),
                void (*period)(void *node), void *node)
{
    memset(bench, 0, sizeof *bench);
    sim_bus_init(&bench->bus, 1000000);
    bench->master = sim_bus_port(&bench->bus, sim_bus_attach(&bench->bus, "master", NULL, NULL));
    const int port = sim_bus_attach(&bench->bus, "node", poll, node);
    bench->node_bus = sim_bus_port(&bench->bus, port);
    bench->node_id = node_id;
    bench->poll = poll;
    bench->period = period;
    bench->node = node;
    co_sdo_client_init(&bench->sdo, node_id, 20 * (uint64_t)BENCH_TICK_NS);
}

void bench_send(struct bench *bench, uint32_t id, unsigned length, const uint8_t *data)
{
    struct can_msg message = {.id = id, .length = (uint8_t)length};
    memcpy(message.data, data, length);
    ck_assert_int_eq(can_bus_send(&bench->master, &message), CAN_OK);
}

void bench_nmt(struct bench *bench, uint8_t command)
{
    const uint8_t data[2] = {command, bench->node_id};
    bench_send(bench, 0x000, 2, data);
    bench_run(bench, 1);
}

static void collect(struct bench *bench)
{
    struct can_msg message;
    while (can_bus_receive(&bench->master, &message, NULL) == CAN_OK) {
        if (message.flags != 0 ||
            co_sdo_client_receive(&bench->sdo, &message, sim_bus_now_ns(&bench->bus))) {
            continue;
        }
        ck_assert_uint_lt(bench->seen_count, BENCH_SEEN_MAX);
        bench->seen[bench->seen_count++] = message;
    }
}

void bench_run(struct bench *bench, unsigned ticks)
{
    for (unsigned i = 0; i < ticks; i++) {
        const uint64_t start_ns = bench->tick * BENCH_TICK_NS;
        sim_bus_run_until(&bench->bus, start_ns);
        if (bench->syncs) {
            bench_send(bench, 0x080, 0, (const uint8_t[1]){0});
        }
        if (bench->heartbeats && bench->tick % 50 == 0) {
            bench_send(bench, 0x710, 1, (const uint8_t[1]){5});
        }
        bench->tick++;
        const uint64_t end_ns = bench->tick * BENCH_TICK_NS;
        sim_bus_run_until(&bench->bus, end_ns - 1);
        if (bench->poll != NULL) {
            bench->poll(bench->node, end_ns - 1);
        }
        if (bench->period != NULL) {
            bench->period(bench->node);
        }
        collect(bench);
    }
}

const struct can_msg *bench_last(const struct bench *bench, uint32_t id)
{
    for (unsigned i = bench->seen_count; i-- > 0;) {
        if (bench->seen[i].id == id) {
            return &bench->seen[i];
        }
    }
    return NULL;
}

unsigned bench_count(const struct bench *bench, uint32_t id)
{
    unsigned count = 0;
    for (unsigned i = 0; i < bench->seen_count; i++) {
        count += bench->seen[i].id == id ? 1 : 0;
    }
    return count;
}

void bench_forget(struct bench *bench)
{
    bench->seen_count = 0;
}

static uint32_t finish(struct bench *bench)
{
    for (int i = 0; i < 200; i++) {
        const enum co_sdo_result result =
            co_sdo_client_poll(&bench->sdo, &bench->master, sim_bus_now_ns(&bench->bus));
        if (result == CO_SDO_DONE) {
            return 0;
        }
        if (result == CO_SDO_ABORTED) {
            bench_run(bench, 1); /* lets an abort frame of the client out */
            return bench->sdo.abort_code;
        }
        bench_run(bench, 1);
    }
    ck_abort_msg("an SDO transfer does not end");
    return 1;
}

uint32_t bench_read(struct bench *bench, uint16_t index, uint8_t sub, uint8_t *bytes,
                    unsigned *length)
{
    co_sdo_client_read(&bench->sdo, index, sub, sim_bus_now_ns(&bench->bus));
    const uint32_t code = finish(bench);
    *length = code == 0 ? bench->sdo.length : 0;
    memcpy(bytes, bench->sdo.buffer, *length);
    return code;
}

uint32_t bench_write(struct bench *bench, uint16_t index, uint8_t sub, uint32_t value,
                     unsigned length)
{
    uint8_t bytes[4];
    bytes_put_u32(bytes, value);
    co_sdo_client_write(&bench->sdo, index, sub, bytes, length, sim_bus_now_ns(&bench->bus));
    return finish(bench);
}

uint32_t bench_value(struct bench *bench, uint16_t index, uint8_t sub)
{
    uint8_t bytes[CO_VALUE_MAX] = {0};
    unsigned length;
    const uint32_t code = bench_read(bench, index, sub, bytes, &length);
    ck_assert_msg(code == 0, "0x%04X:%u: abort 0x%08X", (unsigned)index, sub, (unsigned)code);
    ck_assert_uint_le(length, 4);
    return bytes_get_u32(bytes);
}
