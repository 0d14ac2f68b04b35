/* States, transitions and option codes as in IEC 61800-7-201 (CiA 402-2): figure of
 * the drive state machine; masks of the statusword from can-facts and checked against
 * the Python package canopen (canopen/profiles/p402.py), a peer in the tests. */
#include "sim_host/nodes/drive_state.h"

enum controlword_bit {
    CONTROL_SWITCH_ON = 1 << 0,
    CONTROL_VOLTAGE = 1 << 1,
    CONTROL_NO_QUICK_STOP = 1 << 2,
    CONTROL_ENABLE = 1 << 3,
    CONTROL_FAULT_RESET = 1 << 7
};

enum statusword_bit {
    STATUS_VOLTAGE = 1 << 4,
    STATUS_CONTACT = 1 << 8,
    STATUS_REMOTE = 1 << 9,
    STATUS_LIMIT = 1 << 11,
    CONTROL_INTERPOLATE = 1 << 4,
    STATUS_FOLLOWS = 1 << 12,
    STATUS_FOLLOWING_ERROR = 1 << 13,
    STATUS_LATCH_CLOSED = 1 << 14,
    STATUS_AT_ZERO = 1 << 15
};

enum error_code {
    ERROR_UNDERVOLTAGE = 0x3220,
    ERROR_TEMPERATURE = 0x4310,
    ERROR_CONTACTS = 0x5440,
    ERROR_FOLLOWING = 0x8611,
    ERROR_SYNC = 0x8700
};

static const uint64_t NS_PER_MS = 1000000;
static const uint64_t SYNC_LIMIT_NS = UINT64_C(50000000);
static const uint64_t UNLOADING_LIMIT_NS = UINT64_C(5000000000);

static bool stage_is_on(const struct drive_node *node)
{
    return node->state == DRIVE_OPERATION_ENABLED || node->state == DRIVE_QUICK_STOP_ACTIVE ||
           node->state == DRIVE_FAULT_REACTION;
}

static void enter(struct drive_node *node, enum drive_machine state)
{
    node->state = state;
    node->unloading = false;
    node->following_since_ns = 0;
    node->objects.state = (uint8_t)state;
}

/* Lets the axis unload by itself, then enters `after`. */
static void unload_then(struct drive_node *node, enum drive_machine after)
{
    if (!node->unloading) {
        node->unloading_since_ns = 0; /* stamped by the next supervision */
        node->demand_counts = (double)node->objects.position_actual;
    }
    node->unloading = true;
    node->after_unloading = after;
    node->objects.outputs &= 1U; /* the latch is disarmed, and stays so until commanded */
}

bool drive_state_follows(const struct drive_node *node)
{
    return !node->config.interpolated || (node->objects.controlword & CONTROL_INTERPOLATE) != 0;
}

void drive_state_power_on(struct drive_node *node)
{
    enter(node, DRIVE_SWITCH_ON_DISABLED);
    node->last_controlword = 0;
    node->demand_counts = (double)node->objects.position_actual;
    node->objects.target_position = node->objects.position_actual;
}

static uint8_t register_of(uint16_t error_code)
{
    switch (error_code & 0xF000U) {
    case 0x2000:
        return CO_ERROR_CURRENT;
    case 0x3000:
        return CO_ERROR_VOLTAGE;
    case 0x4000:
        return CO_ERROR_TEMPERATURE;
    case 0x8000:
        return (error_code & 0xFF00U) == 0x8100 || (error_code & 0xFF00U) == 0x8200
                   ? CO_ERROR_COMMUNICATION
                   : CO_ERROR_PROFILE;
    default:
        return CO_ERROR_PROFILE;
    }
}

static void fault(struct drive_node *node, uint16_t error_code)
{
    if (node->state == DRIVE_IN_FAULT || node->state == DRIVE_FAULT_REACTION) {
        return; /* the first cause is the one to tell */
    }
    const bool was_on = stage_is_on(node);
    node->objects.error_code = error_code;
    co_device_raise(&node->device, error_code, register_of(error_code), NULL);
    if (was_on && node->objects.fault_reaction_option != 0) {
        enter(node, DRIVE_FAULT_REACTION);
        unload_then(node, DRIVE_IN_FAULT);
    } else {
        enter(node, DRIVE_IN_FAULT);
    }
}

void drive_state_lose_torque(struct drive_node *node)
{
    if (!stage_is_on(node) && node->state != DRIVE_SWITCHED_ON) {
        return;
    }
    if (node->objects.error_code == 0) {
        node->objects.error_code = ERROR_CONTACTS;
        co_device_raise(&node->device, ERROR_CONTACTS, register_of(ERROR_CONTACTS), NULL);
    }
    enter(node, DRIVE_IN_FAULT); /* no ramp: there is nothing to brake with */
}

static void quick_stop(struct drive_node *node)
{
    const int16_t option = node->objects.quick_stop_option;
    if (option == 0) {
        enter(node, DRIVE_SWITCH_ON_DISABLED);
        return;
    }
    enter(node, DRIVE_QUICK_STOP_ACTIVE);
    unload_then(node, option >= 5 ? DRIVE_QUICK_STOP_ACTIVE : DRIVE_SWITCH_ON_DISABLED);
}

void drive_state_connection_lost(struct drive_node *node, uint16_t error_code)
{
    enum { NO_ACTION = 0, FAULT = 1, DISABLE_VOLTAGE = 2, QUICK_STOP = 3 };
    if (!stage_is_on(node) && node->state != DRIVE_SWITCHED_ON) {
        return;
    }
    switch (node->objects.abort_connection_option) {
    case FAULT:
        fault(node, error_code);
        break;
    case DISABLE_VOLTAGE:
        enter(node, DRIVE_SWITCH_ON_DISABLED);
        break;
    case QUICK_STOP:
        quick_stop(node);
        break;
    case NO_ACTION:
    default:
        break;
    }
}

static uint32_t distance(int32_t a, int32_t b)
{
    const int64_t difference = (int64_t)a - b;
    return (uint32_t)(difference < 0 ? -difference : difference);
}

static bool is_at_zero(const struct drive_node *node)
{
    const struct drive_objects *objects = &node->objects;
    return distance(objects->position_actual, node->config.zero_counts) <=
           distance(objects->limit_max, objects->limit_min) / 100;
}

/* Slow enough to lose torque: a motor in motion would coast past its zero. */
static bool is_still(const struct drive_node *node)
{
    return distance(node->objects.velocity_actual, 0) <= node->objects.unload_rate / 200;
}

/* No kick: a target that is far from where the motor stands is refused. */
static void enable_operation(struct drive_node *node)
{
    struct drive_objects *objects = &node->objects;
    if (distance(objects->target_position, objects->position_actual) > objects->following_window) {
        fault(node, ERROR_FOLLOWING);
        return;
    }
    enter(node, DRIVE_OPERATION_ENABLED);
    node->demand_counts = (double)objects->position_actual;
}

static void reset_fault(struct drive_node *node)
{
    if (node->injected_fault != 0) {
        return; /* the cause is still there */
    }
    co_device_clear(&node->device, node->objects.error_code);
    node->objects.error_code = 0;
    enter(node, DRIVE_SWITCH_ON_DISABLED);
}

static void leave_operation(struct drive_node *node, enum drive_machine to, int16_t option)
{
    if (option == 0) {
        enter(node, to);
    } else {
        unload_then(node, to);
    }
}

/* Transitions out of the states in which the power stage is off. */
static void obey_stopped(struct drive_node *node, unsigned control)
{
    const bool shutdown = (control & 7U) == 6U;
    const bool switch_on = (control & 7U) == 7U;
    if (node->state == DRIVE_SWITCH_ON_DISABLED) {
        if (shutdown) {
            enter(node, DRIVE_READY_TO_SWITCH_ON);
        }
    } else if (shutdown) {
        enter(node, DRIVE_READY_TO_SWITCH_ON);
    } else if (switch_on) {
        const bool enable = (control & CONTROL_ENABLE) != 0;
        if (node->state == DRIVE_READY_TO_SWITCH_ON) {
            enter(node, DRIVE_SWITCHED_ON);
        }
        if (enable) {
            enable_operation(node);
        }
    } else {
        enter(node, DRIVE_SWITCH_ON_DISABLED); /* quick stop or disable voltage */
    }
}

static void obey_enabled(struct drive_node *node, unsigned control)
{
    const struct drive_objects *objects = &node->objects;
    if ((control & CONTROL_NO_QUICK_STOP) == 0) {
        quick_stop(node);
    } else if ((control & CONTROL_SWITCH_ON) == 0) {
        leave_operation(node, DRIVE_READY_TO_SWITCH_ON, objects->shutdown_option);
    } else if ((control & CONTROL_ENABLE) == 0) {
        leave_operation(node, DRIVE_SWITCHED_ON, objects->disable_option);
    } else if (node->unloading) {
        /* Enabled again while unloading for a shutdown: go on from here. */
        node->unloading = false;
        node->demand_counts = (double)objects->position_actual;
    }
}

void drive_state_controlword(struct drive_node *node)
{
    const unsigned control = node->objects.controlword;
    const unsigned rising = control & ~(unsigned)node->last_controlword;
    node->last_controlword = (uint16_t)control;
    if (node->state == DRIVE_IN_FAULT) {
        if ((rising & CONTROL_FAULT_RESET) != 0) {
            reset_fault(node);
        }
        return;
    }
    if (node->state == DRIVE_FAULT_REACTION || node->state == DRIVE_NOT_READY) {
        return;
    }
    if ((control & CONTROL_VOLTAGE) == 0) {
        enter(node, DRIVE_SWITCH_ON_DISABLED);
        return;
    }
    switch (node->state) {
    case DRIVE_OPERATION_ENABLED:
        obey_enabled(node, control);
        break;
    case DRIVE_QUICK_STOP_ACTIVE: /* transition 16, only where it stays in this state */
        if ((control & 0x0FU) == 0x0FU && node->objects.quick_stop_option >= 5) {
            enable_operation(node);
        }
        break;
    default:
        obey_stopped(node, control);
        break;
    }
}

static void watch_following(struct drive_node *node, uint64_t now_ns)
{
    const struct drive_objects *objects = &node->objects;
    if (node->state != DRIVE_OPERATION_ENABLED || node->unloading ||
        distance(objects->position_demand, objects->position_actual) <= objects->following_window) {
        node->following_since_ns = 0;
        return;
    }
    if (node->following_since_ns == 0) {
        node->following_since_ns = now_ns + 1; /* never 0 */
    } else if (now_ns - (node->following_since_ns - 1) >=
               objects->following_timeout_ms * NS_PER_MS) {
        fault(node, ERROR_FOLLOWING);
    }
}

void drive_state_supervise(struct drive_node *node, uint64_t now_ns)
{
    const struct drive_node_config *config = &node->config;
    const struct drive_axis_feedback *feedback = &node->feedback;
    if (node->injected_fault != 0) {
        fault(node, node->injected_fault);
    }
    if (config->temperature_limit_degC > 0.0 &&
        feedback->temperature_degC > config->temperature_limit_degC) {
        fault(node, ERROR_TEMPERATURE);
    }
    if (config->dc_link_minimum_V > 0.0 && stage_is_on(node) &&
        feedback->dc_link_V < config->dc_link_minimum_V) {
        fault(node, ERROR_UNDERVOLTAGE);
    }
    watch_following(node, now_ns);
    /* Targets that come without SYNC never take effect: the same as no targets. */
    if (now_ns > node->last_sync_ns + SYNC_LIMIT_NS) {
        drive_state_connection_lost(node, ERROR_SYNC);
    }
    if (!node->unloading) {
        return;
    }
    if (node->unloading_since_ns == 0) {
        node->unloading_since_ns = now_ns + 1;
    }
    const bool too_long = now_ns - (node->unloading_since_ns - 1) > UNLOADING_LIMIT_NS;
    if ((is_at_zero(node) && is_still(node)) || too_long) {
        enter(node, node->after_unloading);
    }
}

void drive_state_update_statusword(struct drive_node *node)
{
    static const uint16_t bits[] = {
        [DRIVE_NOT_READY] = 0x00,          [DRIVE_SWITCH_ON_DISABLED] = 0x40,
        [DRIVE_READY_TO_SWITCH_ON] = 0x21, [DRIVE_SWITCHED_ON] = 0x23,
        [DRIVE_OPERATION_ENABLED] = 0x27,  [DRIVE_QUICK_STOP_ACTIVE] = 0x07,
        [DRIVE_FAULT_REACTION] = 0x0F,     [DRIVE_IN_FAULT] = 0x08};
    const struct drive_objects *objects = &node->objects;
    unsigned status = (unsigned)bits[node->state] | STATUS_VOLTAGE;
    if (co_device_is_operational(&node->device)) {
        status |= STATUS_REMOTE;
    }
    if (node->state == DRIVE_OPERATION_ENABLED) {
        const int32_t target = objects->target_position;
        if (target < objects->limit_min || target > objects->limit_max) {
            status |= STATUS_LIMIT;
        }
        status |= node->unloading || !drive_state_follows(node) ? 0U : (unsigned)STATUS_FOLLOWS;
        status |= node->following_since_ns != 0 ? (unsigned)STATUS_FOLLOWING_ERROR : 0U;
    }
    if (objects->error_code == ERROR_FOLLOWING) {
        status |= STATUS_FOLLOWING_ERROR;
    }
    status |= node->objects.latch_closed != 0 ? (unsigned)STATUS_LATCH_CLOSED : 0U;
    status |= is_at_zero(node) ? (unsigned)STATUS_AT_ZERO : 0U;
    status |= node->feedback.contact ? (unsigned)STATUS_CONTACT : 0U;
    node->objects.statusword = (uint16_t)status;
}
