#include "firmware/drive_audit.h"

#include <assert.h>

#include "hal/bus/bytes.h"
#include "hal/bus/frame_table.h"
#include "hal/canopen/co_defs.h"

#define OBJECT(index, sub) (UINT32_C(index) << 8 | (sub))
#define NS_PER_MS UINT64_C(1000000)

/* What the drive does when it is no longer led, what it listens to, how far and how fast it may go. */
static const uint32_t objects[] = {
    OBJECT(0x1016, 1), OBJECT(0x1400, 1), OBJECT(0x1400, 2), OBJECT(0x1400, 5), OBJECT(0x1401, 1),
    OBJECT(0x1401, 2), OBJECT(0x1600, 0), OBJECT(0x1600, 1), OBJECT(0x1600, 2), OBJECT(0x1601, 0),
    OBJECT(0x1601, 1), OBJECT(0x1601, 2), OBJECT(0x6007, 0), OBJECT(0x605A, 0), OBJECT(0x605B, 0),
    OBJECT(0x605C, 0), OBJECT(0x605E, 0), OBJECT(0x6061, 0), OBJECT(0x6065, 0), OBJECT(0x6066, 0),
    OBJECT(0x607D, 1), OBJECT(0x607D, 2), OBJECT(0x6080, 0), OBJECT(0x60C2, 1), OBJECT(0x60C2, 2),
    OBJECT(0x60FE, 2),
};
static_assert(sizeof objects / sizeof objects[0] == DRIVE_AUDIT_OBJECTS, "as the header says");
static_assert(DRIVE_AUDIT_OBJECTS <= 32, "a bit for each");
static_assert((uint64_t)DRIVE_AUDIT_OBJECTS * SIDE_COUNT * DRIVE_AUDIT_TICKS * TICK_PERIOD_US <=
                  (uint64_t)DRIVE_AUDIT_ROUND_S * 1000000u,
              "a round in its time");

static unsigned place_of(uint32_t object)
{
    unsigned at = 0;
    while (at < (unsigned)DRIVE_AUDIT_OBJECTS && objects[at] != object) {
        at++;
    }
    return at;
}

static uint32_t value_of(const uint8_t *bytes, unsigned length)
{
    uint32_t value = 0;
    for (unsigned i = 0; i < length && i < 4; i++) {
        value |= (uint32_t)bytes[i] << (8 * i);
    }
    return value;
}

static unsigned index_of(unsigned leg)
{
    return NETWORK_DRIVE_LEFT + leg;
}

/* An expedited upload (CiA 301, 7.2.4.3.6) with its size, on the way to the set-up. */
static void take_note(struct drive_audit *audit, const struct bring_up *bring_up,
                      const struct can_msg *message)
{
    const unsigned leg = (unsigned)bring_up->setup.role - NETWORK_DRIVE_LEFT;
    const bool is_value = message->length == 8 && (message->data[0] & 0xE3u) == 0x43u;
    if (leg >= SIDE_COUNT || !is_value ||
        message->id != (uint32_t)CO_COB_SDO_ANSWER + bring_up->setup.node) {
        return;
    }
    const unsigned at =
        place_of((uint32_t)bytes_get_u16(message->data + 1) << 8 | message->data[3]);
    if (at < (unsigned)DRIVE_AUDIT_OBJECTS) {
        audit->memory.expected[leg][at] =
            value_of(message->data + 4, 4u - (message->data[0] >> 2 & 3u));
        audit->memory.known[leg] |= UINT32_C(1) << at;
    }
}

bool drive_audit_receive(struct drive_audit *audit, const struct bring_up *bring_up,
                         const struct can_msg *message, uint64_t now_ns)
{
    if (audit->under_way && co_sdo_client_receive(&audit->client, message, now_ns)) {
        return true;
    }
    take_note(audit, bring_up, message);
    return false;
}

void drive_audit_give_way(struct drive_audit *audit)
{
    audit->memory.quiet_ticks = DRIVE_AUDIT_QUIET_TICKS;
}

/* A drive that is set up anew is trusted again. */
static void forgive(struct drive_audit *audit, const struct bring_up *bring_up)
{
    for (unsigned leg = 0; leg < SIDE_COUNT; leg++) {
        if (!bring_up_is_configured(bring_up, index_of(leg))) {
            audit->memory.deviates = (uint8_t)(audit->memory.deviates & ~(1u << leg));
        }
    }
}

static bool is_free(struct drive_audit *audit, const struct bring_up *bring_up)
{
    const bool somebody_talks =
        audit->memory.quiet_ticks > 0 && audit->memory.skips < DRIVE_AUDIT_SKIPS;
    audit->memory.skips = somebody_talks ? (uint8_t)(audit->memory.skips + 1u) : 0;
    return !somebody_talks && bring_up->setup.node == 0;
}

static void begin(struct drive_audit *audit, const struct bring_up *bring_up,
                  const struct network *network, uint32_t slot, uint64_t now_ns)
{
    const unsigned leg = slot % SIDE_COUNT;
    const unsigned at = slot / SIDE_COUNT % DRIVE_AUDIT_OBJECTS;
    const unsigned index = index_of(leg);
    if (!is_free(audit, bring_up) || !bring_up_is_configured(bring_up, index) ||
        network->node[index].state != NMT_OPERATIONAL ||
        (audit->memory.known[leg] >> at & 1u) == 0) {
        return;
    }
    audit->leg = (uint8_t)leg;
    audit->object = (uint8_t)at;
    audit->under_way = true;
    co_sdo_client_init(&audit->client, network->node[index].id, DRIVE_AUDIT_TIMEOUT_MS * NS_PER_MS);
    co_sdo_client_read(&audit->client, (uint16_t)(objects[at] >> 8), (uint8_t)(objects[at] & 0xFFu),
                       now_ns);
}

/* A node's next heartbeat falls into this tick or the next. */
static bool expects_heartbeat(const struct network *network)
{
    enum { PERIOD_TICKS = TICKS_OF_MS(HEARTBEAT_PERIOD_MS), AHEAD_TICKS = 2 };
    bool expected = false;
    for (unsigned i = 0; i < NETWORK_NODES; i++) {
        const struct network_node *node = &network->node[i];
        expected = expected || (node->id != 0 && node->silent_ticks + AHEAD_TICKS >= PERIOD_TICKS &&
                                node->silent_ticks <= PERIOD_TICKS);
    }
    return expected;
}

/* Once a tick: what a busy one puts off, the next ones do. */
static bool is_busy(struct drive_audit *audit, bool busy)
{
    enum { PUT_OFF_TICKS = 2 };
    if (busy) {
        audit->memory.busy_ticks = PUT_OFF_TICKS;
        return true;
    }
    if (audit->memory.busy_ticks > 0) {
        audit->memory.busy_ticks--;
        return true;
    }
    return false;
}

static bool compare(struct drive_audit *audit, enum co_sdo_result result,
                    struct setup_failure *failure)
{
    const struct co_sdo_client *client = &audit->client;
    const uint32_t expected = audit->memory.expected[audit->leg][audit->object];
    const bool is_read = result == CO_SDO_DONE;
    const uint32_t found = is_read ? value_of(client->buffer, client->length) : client->abort_code;
    if (is_read && found == expected) {
        return false;
    }
    *failure = (struct setup_failure){is_read ? SETUP_DIFFERS : SETUP_ABORTED,
                                      client->node,
                                      client->sub,
                                      client->index,
                                      expected,
                                      found};
    audit->memory.deviates = (uint8_t)(audit->memory.deviates | 1u << audit->leg);
    return true;
}

bool drive_audit_update(struct drive_audit *audit, const struct bring_up *bring_up,
                        const struct network *network, const struct can_bus *bus, uint32_t tick,
                        bool busy, uint64_t now_ns, struct setup_failure *failure,
                        uint32_t *unanswered)
{
    forgive(audit, bring_up);
    if (audit->memory.quiet_ticks > 0) {
        audit->memory.quiet_ticks--;
    }
    const bool is_put_off = is_busy(audit, busy);
    if (tick % DRIVE_AUDIT_TICKS == 0) {
        audit->memory.waits = true;
    }
    if (audit->memory.waits && !audit->under_way && !is_put_off && tick % SLOW_PDO_TICKS != 0 &&
        !expects_heartbeat(network)) {
        audit->memory.waits = false;
        begin(audit, bring_up, network, tick / DRIVE_AUDIT_TICKS, now_ns);
    }
    if (!audit->under_way) {
        return false;
    }
    const enum co_sdo_result result = co_sdo_client_poll(&audit->client, bus, now_ns);
    if (result == CO_SDO_BUSY) {
        return false;
    }
    audit->under_way = false;
    if (result == CO_SDO_ABORTED && audit->client.abort_code == CO_ABORT_TIMEOUT) {
        *unanswered += *unanswered < UINT32_MAX ? 1u : 0u;
        return false;
    }
    return compare(audit, result, failure);
}
