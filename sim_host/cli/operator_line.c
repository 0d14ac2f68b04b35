#include "sim_host/cli/operator_line.h"

#include "hal/bus/frame_table.h"

enum { WISHES = 0x2000, IDENTITY = 0x2030, IDENTITY_BUILD = 2, IDENTITY_PARAMETERS = 3 };

/* The task answers when it looks at the bus next: at the latest a lost answer later. */
static const uint64_t ANSWER_LIMIT_NS = UINT64_C(3000000000);

void operator_line_init(struct operator_line *line, struct can_bus bus)
{
    line->bus = bus;
    line->under_way = false;
    line->identity_asked = 0;
    co_sdo_client_init(&line->client, NODE_CONTROLLER, ANSWER_LIMIT_NS);
}

void operator_line_ask(struct operator_line *line, enum operator_command wish, uint8_t value,
                       uint64_t now_ns)
{
    if (!line->under_way) {
        co_sdo_client_write(&line->client, WISHES, (uint8_t)wish, &value, sizeof value, now_ns);
        line->under_way = true;
    }
    operator_line_poll(line, now_ns);
}

bool operator_line_ask_identity(struct operator_line *line, uint64_t now_ns)
{
    if (!line->under_way && line->identity_asked < IDENTITY_PARAMETERS) {
        line->identity_asked =
            line->identity_asked == 0 ? IDENTITY_BUILD : (uint8_t)IDENTITY_PARAMETERS;
        co_sdo_client_read(&line->client, IDENTITY, line->identity_asked, now_ns);
        line->under_way = true;
        operator_line_poll(line, now_ns);
    }
    return line->identity_asked < IDENTITY_PARAMETERS || line->under_way;
}

void operator_line_poll(struct operator_line *line, uint64_t now_ns)
{
    struct can_msg message;
    if (!line->under_way) {
        return;
    }
    (void)co_sdo_client_poll(&line->client, &line->bus, now_ns);
    /* What was sent leaves with the receiving, too (hal/port_socketcan). */
    while (can_bus_receive(&line->bus, &message, NULL) == CAN_OK) {
        (void)co_sdo_client_receive(&line->client, &message, now_ns);
    }
    line->under_way = co_sdo_client_is_busy(&line->client);
}
