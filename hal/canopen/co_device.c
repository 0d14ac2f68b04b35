#include "hal/canopen/co_device.h"

#include <string.h>

#include "hal/canopen/co_device_internal.h"

enum { BEHAVIOUR_PRE_OPERATIONAL = 0, BEHAVIOUR_STOPPED = 2 };

/* ---- NMT ---------------------------------------------------------------- */

static void enter_state(struct co_device *device, enum co_nmt_state state, uint64_t now_ns)
{
    if (device->state == state) {
        return;
    }
    device->state = state;
    device->next_due_ns = 0;
    for (unsigned i = 0; i < device->comm.rpdo_count; i++) {
        co_device_forget_rpdo(device, i);
    }
    for (unsigned i = 0; i < device->comm.tpdo_count; i++) {
        struct co_pdo *tpdo = &device->comm.tpdo[i];
        tpdo->sync_count = 0;
        /* Event-driven PDOs tell their value when they come to life. */
        tpdo->waiting = tpdo->type >= CO_EVENT_MANUFACTURER;
    }
    if (state == CO_STATE_STOPPED) {
        co_sdo_server_reset(&device->sdo);
    }
    if (device->config.ops->state_changed != NULL) {
        device->config.ops->state_changed(device->config.context, state, now_ns);
    }
}

static void predefined_pdos(struct co_pdo *pdo, unsigned count, uint32_t cob_id)
{
    for (unsigned i = 0; i < count; i++, cob_id += CO_COB_PDO_STEP) {
        memset(&pdo[i], 0, sizeof pdo[i]);
        pdo[i].cob_id = CO_PDO_INVALID | cob_id;
        pdo[i].type = CO_EVENT_PROFILE;
    }
}

static void predefined_values(struct co_device *device)
{
    struct co_comm *comm = &device->comm;
    const struct co_pdos *pdos = &device->config.pdos;
    const uint32_t node = device->config.node_id;
    memset(comm, 0, sizeof *comm);
    comm->rpdo = pdos->rpdo;
    comm->tpdo = pdos->tpdo;
    comm->rpdo_count = pdos->rpdo_count;
    comm->tpdo_count = pdos->tpdo_count;
    comm->sync_cob_id = CO_COB_SYNC;
    comm->emcy_cob_id = CO_COB_EMCY + node;
    comm->heartbeat_consumers = CO_HEARTBEATS_MAX;
    comm->identity_count = 4;
    comm->behaviour_count = 1;
    comm->sdo_count = 2;
    comm->sdo_request_id = CO_COB_SDO_REQUEST + node;
    comm->sdo_answer_id = CO_COB_SDO_ANSWER + node;
    predefined_pdos(comm->rpdo, comm->rpdo_count, CO_COB_RPDO1 + node);
    predefined_pdos(comm->tpdo, comm->tpdo_count, CO_COB_TPDO1 + node);
    device->config.defaults(device->config.context, comm);
    for (unsigned i = 0; i < comm->tpdo_count; i++) {
        comm->tpdo[i].cob_id |= CO_PDO_NO_RTR; /* remote requests are not answered */
    }
}

static bool resolve(const struct co_device *device, struct co_pdo *pdo, unsigned count,
                    enum co_access direction)
{
    for (unsigned i = 0; i < count; i++) {
        if (co_pdo_resolve(&pdo[i], pdo[i].map_count, device->dictionaries, CO_DICTIONARIES,
                           direction) != CO_ABORT_NONE) {
            return false;
        }
    }
    return true;
}

static int start_communication(struct co_device *device, uint64_t now_ns)
{
    predefined_values(device);
    co_sdo_server_init(&device->sdo, device->dictionaries, CO_DICTIONARIES, &device->hooks, device);
    memset(device->consumers, 0, sizeof device->consumers);
    memset(device->errors, 0, sizeof device->errors);
    device->emcy_count = 0;
    if (!resolve(device, device->comm.rpdo, device->comm.rpdo_count, CO_MAP_RX) ||
        !resolve(device, device->comm.tpdo, device->comm.tpdo_count, CO_MAP_TX)) {
        return -1;
    }
    device->boot_unsent = true;
    device->heartbeat_due_ns = now_ns + device->comm.heartbeat_ms * CO_NS_PER_MS;
    device->state = CO_STATE_BOOT_UP;
    enter_state(device, CO_STATE_PRE_OPERATIONAL, now_ns);
    co_device_process(device, now_ns);
    return 0;
}

int co_device_init(struct co_device *device, const struct co_device_config *config,
                   struct can_bus bus, uint64_t now_ns)
{
    if (config->node_id < 1 || config->node_id > CO_NODE_MAX) {
        return -1;
    }
    memset(device, 0, sizeof *device);
    device->config = *config;
    device->bus = bus;
    device->dictionaries[0] =
        (struct co_dictionary){co_comm_objects, co_comm_object_count, &device->comm};
    device->dictionaries[1] = config->pdos.objects;
    device->dictionaries[2] = *config->application;
    device->hooks = (struct co_access_hooks){.writing = co_comm_writing,
                                             .written = co_comm_written,
                                             .reading = co_comm_reading,
                                             .begin = co_comm_begin,
                                             .take = co_comm_take};
    return start_communication(device, now_ns);
}

static void obey_nmt(struct co_device *device, const struct can_msg *message, uint64_t now_ns)
{
    if (message->length != 2) {
        co_device_count(&device->counters.malformed);
        return;
    }
    if (message->data[1] != 0 && message->data[1] != device->config.node_id) {
        return;
    }
    switch (message->data[0]) {
    case CO_NMT_START:
        enter_state(device, CO_STATE_OPERATIONAL, now_ns);
        break;
    case CO_NMT_STOP:
        enter_state(device, CO_STATE_STOPPED, now_ns);
        break;
    case CO_NMT_ENTER_PRE_OPERATIONAL:
        enter_state(device, CO_STATE_PRE_OPERATIONAL, now_ns);
        break;
    case CO_NMT_RESET_NODE:
    case CO_NMT_RESET_COMMUNICATION:
        if (device->config.ops->reset != NULL) {
            device->config.ops->reset(device->config.context, message->data[0] == CO_NMT_RESET_NODE,
                                      now_ns);
        }
        (void)start_communication(device, now_ns); /* was valid at init */
        break;
    default:
        co_device_count(&device->counters.malformed);
        break;
    }
}

/* ---- bus errors --------------------------------------------------------- */

static void communication_failed(struct co_device *device, uint64_t now_ns)
{
    if (device->state != CO_STATE_OPERATIONAL) {
        return;
    }
    if (device->comm.communication_error_behaviour == BEHAVIOUR_PRE_OPERATIONAL) {
        enter_state(device, CO_STATE_PRE_OPERATIONAL, now_ns);
    } else if (device->comm.communication_error_behaviour == BEHAVIOUR_STOPPED) {
        enter_state(device, CO_STATE_STOPPED, now_ns);
    }
}

static void look_at_bus(struct co_device *device, uint64_t now_ns)
{
    struct can_bus_status status;
    can_bus_get_status(&device->bus, &status);
    if (status.error_state == CAN_BUS_OFF && !device->was_bus_off) {
        device->was_bus_off = true;
        if (device->config.ops->bus_off != NULL) {
            device->config.ops->bus_off(device->config.context, true, now_ns);
        }
        communication_failed(device, now_ns);
        can_bus_recover(&device->bus);
    } else if (status.error_state != CAN_BUS_OFF && device->was_bus_off) {
        device->was_bus_off = false;
        co_device_raise_for(device, CO_EMCY_BUS_OFF_RECOVERED, CO_CAUSE_BUS, CO_ERROR_COMMUNICATION,
                            NULL);
        co_device_clear_for(device, CO_EMCY_BUS_OFF_RECOVERED, CO_CAUSE_BUS);
        if (device->config.ops->bus_off != NULL) {
            device->config.ops->bus_off(device->config.context, false, now_ns);
        }
    }
    if (status.error_state == CAN_ERROR_PASSIVE) {
        device->was_passive = true;
        co_device_raise_for(device, CO_EMCY_CAN_PASSIVE, CO_CAUSE_BUS, CO_ERROR_COMMUNICATION,
                            NULL);
    } else if (status.error_state != CAN_BUS_OFF) {
        device->was_passive = false;
        co_device_clear_for(device, CO_EMCY_CAN_PASSIVE, CO_CAUSE_BUS);
    }
}

/* ---- receiving ---------------------------------------------------------- */

static void take_heartbeat(struct co_device *device, const struct can_msg *message, uint64_t now_ns)
{
    const uint32_t node = message->id - CO_COB_HEARTBEAT;
    for (unsigned i = 0; i < CO_HEARTBEATS_MAX; i++) {
        const uint32_t wanted = device->comm.consumer[i];
        if ((wanted >> 16 & 0xFFU) != node || (wanted & 0xFFFFU) == 0) {
            continue;
        }
        if (message->length != 1) {
            co_device_count(&device->counters.malformed);
            return;
        }
        struct co_consumer_state *consumer = &device->consumers[i];
        consumer->last_ns = now_ns;
        consumer->state = message->data[0] & 0x7FU;
        if (!consumer->monitoring) {
            consumer->monitoring = true;
            device->next_due_ns = 0;
        }
        if (consumer->lost) {
            consumer->lost = false;
            co_device_clear_for(device, CO_EMCY_HEARTBEAT, (uint8_t)(CO_CAUSE_FIRST + i));
            if (device->config.ops->heartbeat != NULL) {
                device->config.ops->heartbeat(device->config.context, (uint8_t)node, true, now_ns);
            }
        }
        return;
    }
}

static void take_sdo(struct co_device *device, const struct can_msg *message, uint64_t now_ns)
{
    uint8_t answer[8];
    if (device->state == CO_STATE_STOPPED) {
        return;
    }
    if (message->length != 8) {
        co_device_count(&device->counters.malformed);
        return;
    }
    co_device_count(&device->counters.sdo_requests);
    if (co_sdo_server_handle(&device->sdo, message->data, now_ns, answer)) {
        (void)co_device_send(device, device->comm.sdo_answer_id & CAN_ID_STANDARD_MAX, answer, 8);
    }
}

bool co_device_receive(struct co_device *device, const struct can_msg *message, uint64_t now_ns)
{
    const uint32_t id = message->id;
    if ((message->flags & CAN_FRAME_ERROR) != 0) {
        look_at_bus(device, now_ns);
        return true;
    }
    if (message->flags != 0) {
        return false; /* remote, extended or own */
    }
    if (id == (device->comm.sync_cob_id & CAN_ID_STANDARD_MAX)) {
        co_device_take_sync(device, now_ns);
        return true;
    }
    bool is_rpdo = false;
    for (unsigned i = 0; i < device->comm.rpdo_count; i++) {
        const struct co_pdo *rpdo = &device->comm.rpdo[i];
        if (co_pdo_is_valid(rpdo) && id == co_pdo_id(rpdo)) {
            co_device_take_rpdo(device, i, message, now_ns);
            is_rpdo = true;
        }
    }
    if (is_rpdo) {
        return true;
    }
    if (id == device->comm.sdo_request_id) {
        take_sdo(device, message, now_ns);
        return true;
    }
    if (id == CO_COB_NMT) {
        obey_nmt(device, message, now_ns);
        return true;
    }
    if (id > CO_COB_HEARTBEAT && id <= (uint32_t)CO_COB_HEARTBEAT + CO_NODE_MAX) {
        take_heartbeat(device, message, now_ns);
        return true;
    }
    return false;
}

/* ---- by time ------------------------------------------------------------ */

static uint64_t process_heartbeat(struct co_device *device, uint64_t now_ns)
{
    const uint64_t period_ns = device->comm.heartbeat_ms * CO_NS_PER_MS;
    if (device->boot_unsent) {
        const uint8_t boot = CO_STATE_BOOT_UP;
        device->boot_unsent =
            !co_device_send(device, CO_COB_HEARTBEAT + device->config.node_id, &boot, 1);
        device->heartbeat_due_ns = now_ns + period_ns;
    }
    if (period_ns == 0) {
        return device->boot_unsent ? now_ns : UINT64_MAX;
    }
    if (now_ns >= device->heartbeat_due_ns) {
        const uint8_t state = (uint8_t)device->state;
        if (co_device_send(device, CO_COB_HEARTBEAT + device->config.node_id, &state, 1)) {
            device->heartbeat_due_ns += period_ns;
            if (device->heartbeat_due_ns <= now_ns) { /* after a pause: no burst */
                device->heartbeat_due_ns = now_ns + period_ns;
            }
        }
    }
    return device->boot_unsent ? now_ns : device->heartbeat_due_ns;
}

static uint64_t process_consumers(struct co_device *device, uint64_t now_ns)
{
    uint64_t due_ns = UINT64_MAX;
    for (unsigned i = 0; i < CO_HEARTBEATS_MAX; i++) {
        struct co_consumer_state *consumer = &device->consumers[i];
        const uint64_t limit_ns = (device->comm.consumer[i] & 0xFFFFU) * CO_NS_PER_MS;
        if (limit_ns == 0 || !consumer->monitoring || consumer->lost) {
            continue;
        }
        if (now_ns - consumer->last_ns < limit_ns) {
            due_ns = co_device_sooner(due_ns, consumer->last_ns + limit_ns);
            continue;
        }
        const uint8_t node = (uint8_t)(device->comm.consumer[i] >> 16 & 0xFFU);
        const uint8_t vendor[5] = {node};
        consumer->lost = true;
        co_device_raise_for(device, CO_EMCY_HEARTBEAT, (uint8_t)(CO_CAUSE_FIRST + i),
                            CO_ERROR_COMMUNICATION, vendor);
        if (device->config.ops->heartbeat != NULL) {
            device->config.ops->heartbeat(device->config.context, node, false, now_ns);
        }
        communication_failed(device, now_ns);
    }
    return due_ns;
}

void co_device_process(struct co_device *device, uint64_t now_ns)
{
    if (device->was_bus_off || device->was_passive) { /* its end may bring no error frame */
        look_at_bus(device, now_ns);
    }
    if (now_ns < device->next_due_ns) {
        return;
    }
    /* Reactions below may set next_due_ns to 0 ("plan again"): keep that. */
    device->next_due_ns = UINT64_MAX;
    uint64_t due_ns = process_heartbeat(device, now_ns);
    due_ns = co_device_sooner(due_ns, process_consumers(device, now_ns));
    due_ns = co_device_sooner(due_ns, co_device_process_rpdos(device, now_ns));
    due_ns = co_device_sooner(due_ns, co_device_process_tpdos(device, now_ns));
    due_ns = co_device_sooner(due_ns, co_device_process_emcy(device, now_ns));
    device->next_due_ns = co_device_sooner(device->next_due_ns, due_ns);
}
