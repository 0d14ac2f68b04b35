/* Fuzzer: an SDO server under any sequence of requests, and a client under any sequence
 * of answers. The first byte chooses; the rest are frames of 8 bytes. */
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "hal/canopen/co_sdo_client.h"
#include "sim_host/nodes/drive_node.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static enum can_result swallow(void *context, const struct can_msg *message)
{
    (void)context;
    if (message->length > CAN_FRAME_DATA_MAX || message->id > CAN_ID_STANDARD_MAX) {
        abort();
    }
    return CAN_OK;
}

static void good_status(void *context, struct can_bus_status *status)
{
    (void)context;
    memset(status, 0, sizeof *status);
}

static void no_recovery(void *context)
{
    (void)context;
}

static const struct can_bus_ops ops = {
    .send = swallow, .get_status = good_status, .recover = no_recovery};

static void feed_server(const uint8_t *data, size_t size)
{
    const struct drive_node_config config = {.side = SIDE_LEFT,
                                             .node_id = 1,
                                             .counts_per_m = 1000,
                                             .stroke_m = 0.3,
                                             .rated_force_N = 1.0,
                                             .following_error_m = 0.1,
                                             .unload_rate_m_per_s = 0.5};
    struct drive_node node;
    struct drive_axis_command command;
    if (drive_node_init(&node, &config, (struct can_bus){.ops = &ops}, 0) != 0) {
        abort();
    }
    uint64_t now_ns = 0;
    for (; size >= 8; data += 8, size -= 8) {
        struct can_msg request = {.id = 0x601, .length = 8};
        memcpy(request.data, data, 8);
        now_ns += 1000000;
        (void)drive_node_receive(&node, &request, now_ns);
        drive_node_command(&node, 1000000, &command);
        if (node.objects.limit_min > node.objects.limit_max || node.objects.mode_display != 8) {
            abort();
        }
        for (unsigned i = 0; i < CO_PDO_COUNT; i++) {
            if (node.device.comm.rpdo[i].length > 8 || node.device.comm.tpdo[i].length > 8) {
                abort();
            }
        }
    }
}

static void feed_client(const uint8_t *data, size_t size)
{
    struct co_sdo_client client;
    const struct can_bus bus = {.ops = &ops};
    const uint8_t value[20] = {1, 2, 3};
    co_sdo_client_init(&client, 1, 1000);
    if (size > 0 && (data[0] & 1U) != 0) {
        co_sdo_client_write(&client, 0x2000, 0, value, sizeof value, 0);
    } else {
        co_sdo_client_read(&client, 0x2000, 0, 0);
    }
    for (; size >= 8; data += 8, size -= 8) {
        struct can_msg answer = {.id = 0x581, .length = 8};
        memcpy(answer.data, data, 8);
        (void)co_sdo_client_poll(&client, &bus, 0);
        (void)co_sdo_client_receive(&client, &answer, 0);
        if (client.length > CO_VALUE_MAX || client.position > CO_VALUE_MAX) {
            abort();
        }
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    if (size > 0) {
        (data[0] & 0x80U) != 0 ? feed_client(data + 1, size - 1) : feed_server(data + 1, size - 1);
    }
    return 0;
}
