#include "hal/devices/node_setup.h"

#include "hal/bus/bytes.h"
#include "hal/bus/frame_table.h"
#include "hal/canopen/co_defs.h"

#define NS_PER_MS UINT64_C(1000000)
#define COB_ID_MASK UINT32_C(0x800007FF) /* "exists" and the identifier; not the RTR bit */
#define COB_OFF UINT32_C(0x80000000)
#define COB_NO_RTR UINT32_C(0x40000000) /* CiA 301, 7.5.2.37: of TPDOs, no remote requests */
#define ALL_BITS UINT32_C(0xFFFFFFFF)

/* CiA 402-2: option codes that end in a controlled unload, then torque off. */
enum {
    ABORT_CONNECTION_IS_FAULT = 1,
    QUICK_STOP_RAMP = 2,
    SLOW_DOWN_RAMP = 1,
    MODE_CYCLIC_SYNCHRONOUS_POSITION = 8,
    FOLLOWING_ERROR_MS = 50,
    TARGET_TIMEOUT_MS = 50
};

/* The tick as object 0x60C2 says it: a value times a power of ten, in seconds. */
enum {
    TICK_IS_WHOLE_MS = TICK_PERIOD_US % 1000 == 0,
    INTERPOLATION_VALUE = TICK_IS_WHOLE_MS ? TICK_PERIOD_US / 1000 : TICK_PERIOD_US / 100,
    INTERPOLATION_EXPONENT = TICK_IS_WHOLE_MS ? 0xFD : 0xFC /* -3 or -4, INTEGER8 */
};

/* STEP_AWAIT: as STEP_EXPECT, but the value may take SETUP_SETTLE_MS to come. */
enum step_kind { STEP_EXPECT, STEP_AWAIT, STEP_AT_LEAST, STEP_WRITE, STEP_SCALING, STEP_END };

struct setup_step {
    enum step_kind kind;
    uint16_t index;
    uint8_t sub;
    uint8_t bytes;
    uint32_t value;
    uint32_t mask; /* of the comparison */
};

#define EXPECT(index, sub, value, mask) \
    ((struct setup_step){STEP_EXPECT, index, sub, 4, value, mask})
#define AWAIT(index, sub, value, mask) ((struct setup_step){STEP_AWAIT, index, sub, 4, value, mask})
#define AT_LEAST(index, sub, value) \
    ((struct setup_step){STEP_AT_LEAST, index, sub, 4, value, ALL_BITS})
#define WRITE(index, sub, bytes, value) \
    ((struct setup_step){STEP_WRITE, index, sub, bytes, value, ALL_BITS})
#define COB(index, value) ((struct setup_step){STEP_WRITE, index, 1, 4, value, COB_ID_MASK})
#define SCALING(index, sub) ((struct setup_step){STEP_SCALING, index, sub, 4, 0, 0})
#define END ((struct setup_step){STEP_END, 0, 0, 0, 0, 0})

enum { PDO_STEPS = 8 };

/* A PDO is switched off, mapped, typed and switched on (CiA 301, 7.5.2.36). */
struct pdo_plan {
    uint16_t communication; /* 0x1400.. or 0x1800.. */
    uint32_t cob_id;
    uint8_t type;
    uint8_t count;
    uint32_t map[3];
};

/* Nobody here sends remote requests, and many nodes answer none: those take the COB-ID of a TPDO
 * with "no RTR" only. Those that do not know that bit take it without only. */
static uint32_t cob_id_of(const struct pdo_plan *plan, bool with_rtr)
{
    const bool sends = plan->communication >= 0x1800;
    return plan->cob_id | (sends && !with_rtr ? COB_NO_RTR : 0);
}

static struct setup_step pdo_step(const struct pdo_plan *plan, unsigned part, bool with_rtr)
{
    const uint16_t mapping = (uint16_t)(plan->communication + 0x200);
    switch (part) {
    case 0:
        return COB(plan->communication, COB_OFF | cob_id_of(plan, with_rtr));
    case 1:
        return WRITE(mapping, 0, 1, 0);
    case 2:
    case 3:
    case 4:
        /* Fewer entries than three: write the last one again, which changes nothing. */
        part = part - 2u < plan->count ? part - 2u : plan->count - 1u;
        return WRITE(mapping, (uint8_t)(part + 1), 4, plan->map[part]);
    case 5:
        return WRITE(mapping, 0, 1, plan->count);
    case 6:
        return WRITE(plan->communication, 2, 1, plan->type);
    default:
        return COB(plan->communication, cob_id_of(plan, with_rtr));
    }
}

static struct setup_step common_step(unsigned step, uint32_t profile)
{
    switch (step) {
    case 0:
        return EXPECT(0x1000, 0, profile, 0xFFFF);
    case 1:
        return WRITE(0x1017, 0, 2, HEARTBEAT_PERIOD_MS);
    default:
        return WRITE(0x1016, 1, 4, (uint32_t)NODE_CONTROLLER << 16 | HEARTBEAT_TIMEOUT_MS);
    }
}

enum { COMMON_STEPS = 3, DRIVE_PDOS = 4, DRIVE_PDO_END = COMMON_STEPS + DRIVE_PDOS * PDO_STEPS };

static struct setup_step drive_pdo_step(enum side leg, uint32_t node, unsigned number,
                                        unsigned part, bool with_rtr)
{
    const uint32_t dummy = 0x00040020; /* INTEGER32: the other drive's half */
    const uint32_t target = 0x607A0020;
    const bool left = leg == SIDE_LEFT;
    const struct pdo_plan plans[DRIVE_PDOS] = {
        {0x1400, FRAME_DRIVE_TARGETS, 1, 2, {left ? target : dummy, left ? dummy : target, 0}},
        {0x1401, 0x300 + node, 255, 2, {0x60400010, 0x60FE0120, 0}},
        {0x1800, 0x180 + node, 1, 2, {0x60410010, 0x60640020, 0}},
        {0x1802, 0x380 + node, SLOW_PDO_TICKS, 3, {0x60770010, 0x21000010, 0x60790020}},
    };
    return pdo_step(&plans[number], part, with_rtr);
}

static struct setup_step drive_step(const struct node_setup *setup)
{
    const struct node_setup_config *config = setup->config;
    const uint8_t node = setup->node;
    const unsigned step = setup->step;
    const enum side leg = node == NODE_DRIVE_LEFT ? SIDE_LEFT : SIDE_RIGHT;
    if (step < COMMON_STEPS) {
        return common_step(step, 402);
    }
    if (step < DRIVE_PDO_END) {
        const unsigned i = step - COMMON_STEPS;
        return drive_pdo_step(leg, node, i / PDO_STEPS, i % PDO_STEPS, setup->with_rtr);
    }
    switch (step - DRIVE_PDO_END) {
    case 0:
        return WRITE(0x6060, 0, 1, MODE_CYCLIC_SYNCHRONOUS_POSITION);
    case 1:
        return AWAIT(0x6061, 0, MODE_CYCLIC_SYNCHRONOUS_POSITION, 0xFF);
    case 2:
        return WRITE(0x60C2, 1, 1, INTERPOLATION_VALUE);
    case 3:
        return WRITE(0x60C2, 2, 1, INTERPOLATION_EXPONENT);
    case 4:
        return WRITE(0x6007, 0, 2, ABORT_CONNECTION_IS_FAULT);
    case 5:
        return WRITE(0x605A, 0, 2, QUICK_STOP_RAMP);
    case 6:
        return WRITE(0x605B, 0, 2, SLOW_DOWN_RAMP);
    case 7:
        return WRITE(0x605C, 0, 2, SLOW_DOWN_RAMP);
    case 8:
        return WRITE(0x605E, 0, 2, QUICK_STOP_RAMP);
    case 9:
        return WRITE(0x6065, 0, 4, config->following_error_counts[leg]);
    case 10:
        return WRITE(0x6066, 0, 2, FOLLOWING_ERROR_MS);
    case 11:
        return WRITE(0x607D, 1, 4, (uint32_t)config->limit_min_counts[leg]);
    case 12:
        return WRITE(0x607D, 2, 4, (uint32_t)config->limit_max_counts[leg]);
    case 13:
        return WRITE(0x60FE, 2, 4, DRIVE_OUTPUT_LATCH_ARMED);
    case 14:
        return WRITE(0x1400, 5, 2, TARGET_TIMEOUT_MS);
    case 15:
        return SCALING(0x608F, 1);
    case 16:
        return SCALING(0x608F, 2);
    case 17:
        return SCALING(0x6091, 1);
    case 18:
        return SCALING(0x6091, 2);
    case 19:
        return SCALING(0x6092, 1);
    case 20:
        return SCALING(0x6092, 2);
    case 21:
        return SCALING(0x6076, 0);
    case 22:
        return AT_LEAST(0x6080, 0, config->speed_needed_counts_s[leg]);
    default:
        return END;
    }
}

static struct setup_step sensor_step(const struct node_setup *setup)
{
    const struct node_setup_config *config = setup->config;
    const uint8_t node = setup->node;
    const unsigned step = setup->step;
    const enum side leg = node == NODE_SENSOR_LEFT ? SIDE_LEFT : SIDE_RIGHT;
    const struct pdo_plan plan = {0x1801, 0x280u + node, 1, 2, {0x20200118, 0x20200210, 0}};
    if (step < COMMON_STEPS) {
        return common_step(step, 406);
    }
    if (step < COMMON_STEPS + PDO_STEPS) {
        return pdo_step(&plan, step - COMMON_STEPS, setup->with_rtr);
    }
    switch (step - COMMON_STEPS - PDO_STEPS) {
    case 0:
        return EXPECT(0x6001, 0, LEG_ANGLE_COUNTS_PER_TURN, ALL_BITS);
    case 1:
        return EXPECT(0x2021, 0, config->ankle_is_lever[leg] ? 1 : 0, 0xFF);
    case 2:
        return AWAIT(0x6503, 0, 0, 0xFFFF); /* alarms: none */
    default:
        return END;
    }
}

static bool is_drive(uint8_t node)
{
    switch (node) {
#define NODE_CASE(name, number, profile) \
    case (number):                       \
        return (profile) == 402;
        NODE_TABLE(NODE_CASE)
#undef NODE_CASE
    default:
        return false;
    }
}

static struct setup_step current_step(const struct node_setup *setup)
{
    return is_drive(setup->node) ? drive_step(setup) : sensor_step(setup);
}

void node_setup_start(struct node_setup *setup, const struct node_setup_config *config,
                      uint8_t node, uint64_t now_ns)
{
    (void)now_ns;
    *setup = (struct node_setup){.config = config, .node = node};
    co_sdo_client_init(&setup->client, node, SETUP_TIMEOUT_MS * NS_PER_MS);
}

bool node_setup_is_waiting(const struct node_setup *setup)
{
    return setup->under_way && co_sdo_client_is_busy(&setup->client);
}

bool node_setup_receive(struct node_setup *setup, const struct can_msg *message, uint64_t now_ns)
{
    return setup->under_way && co_sdo_client_receive(&setup->client, message, now_ns);
}

static enum setup_verdict fail(struct node_setup *setup, enum setup_verdict verdict,
                               const struct setup_step *step, uint32_t found)
{
    setup->failure =
        (struct setup_failure){verdict, setup->node, step->sub, step->index, step->value, found};
    return verdict;
}

static uint32_t value_read(const struct co_sdo_client *client)
{
    uint8_t bytes[4] = {0};
    for (unsigned i = 0; i < client->length && i < sizeof bytes; i++) {
        bytes[i] = client->buffer[i];
    }
    return bytes_get_u32(bytes);
}

/* Shaft turns of the motor per nanometre of spring: gear ratio / feed constant. The feed
 * constant is in nanometres per shaft turn (its unit, 0x60A8, is the maker's). 0 when the
 * drive gives none. */
static float turns_per_nm(const uint32_t *v)
{
    if (v[3] == 0 || v[4] == 0) {
        return 0.0f;
    }
    return ((float)v[2] / (float)v[3]) * ((float)v[5] / (float)v[4]);
}

/* counts per metre = counts per motor turn * motor turns per metre. */
static enum setup_verdict check_scaling(struct node_setup *setup, enum side leg)
{
    const uint32_t *v = setup->scaling;
    const uint32_t expected = setup->config->counts_per_m[leg];
    const struct setup_step step = {STEP_SCALING, 0x6092, 1, 4, expected, ALL_BITS};
    const float found = v[1] != 0 ? ((float)v[0] / (float)v[1]) * turns_per_nm(v) * 1.0e9f : 0.0f;
    const float difference = found - (float)expected;
    const float tolerance = 1.0e-4f * (float)expected;
    if (difference <= tolerance && difference >= -tolerance) {
        return SETUP_DONE;
    }
    return fail(setup, SETUP_DIFFERS, &step, found < 4.0e9f ? (uint32_t)found : ALL_BITS);
}

/* 0x6076 is the motor's rated torque in mNm (CiA 402-2), and the force is that torque times
 * the motor's angle per metre of spring: what 1000 per mille of 0x6077 mean. Without it
 * every force would be judged by a made-up scale. */
static enum setup_verdict check_rated_force(struct node_setup *setup, enum side leg)
{
    const float turn_rad_per_nm_to_N_per_mNm = 6.28318531f * 1.0e9f * 1.0e-3f;
    const float unit_N = turns_per_nm(setup->scaling) * turn_rad_per_nm_to_N_per_mNm;
    const float expected_mNm = setup->config->rated_force_N[leg] / unit_N;
    const uint32_t found = setup->scaling[SETUP_SCALING_VALUES - 1];
    const float difference = (float)found - expected_mNm;
    const float tolerance = 0.5f + 0.02f * expected_mNm; /* it is whole mNm */
    const struct setup_step step = {STEP_SCALING, 0x6076, 0, 4, (uint32_t)(expected_mNm + 0.5f),
                                    ALL_BITS};
    if (difference <= tolerance && difference >= -tolerance) {
        return SETUP_DONE;
    }
    return fail(setup, SETUP_DIFFERS, &step, found);
}

/* What the drive says of itself must be what the settings say of it. */
static enum setup_verdict check_drive(struct node_setup *setup)
{
    const enum side leg = setup->node == NODE_DRIVE_LEFT ? SIDE_LEFT : SIDE_RIGHT;
    const enum setup_verdict verdict = check_scaling(setup, leg);
    const bool has_force = setup->config->rated_force_N[leg] > 0.0f;
    return verdict == SETUP_DONE && has_force ? check_rated_force(setup, leg) : verdict;
}

/* The transfer of this step is done; compares, and goes on to the next one. */
static enum setup_verdict finish_step(struct node_setup *setup, const struct setup_step *step,
                                      uint64_t now_ns)
{
    if (step->kind == STEP_WRITE && !setup->reading_back) {
        setup->reading_back = true;
        return SETUP_BUSY;
    }
    const uint32_t found = value_read(&setup->client);
    if (step->kind == STEP_SCALING) {
        const unsigned next = setup->scaled++; /* in the order of the steps */
        setup->scaling[next < SETUP_SCALING_VALUES ? next : 0] = found;
    } else if (step->kind == STEP_AT_LEAST) {
        if (found != 0 && found < step->value) {
            return fail(setup, SETUP_DIFFERS, step, found);
        }
    } else {
        const uint32_t width = step->bytes == 4 ? ALL_BITS : (UINT32_C(1) << (8 * step->bytes)) - 1;
        const uint32_t mask = step->mask & width;
        if ((found & mask) != (step->value & mask)) {
            if (setup->differs_since_ns == 0) {
                setup->differs_since_ns = now_ns;
            }
            if (step->kind != STEP_EXPECT &&
                now_ns - setup->differs_since_ns < SETUP_SETTLE_MS * NS_PER_MS) {
                return SETUP_BUSY; /* read once more */
            }
            return fail(setup, SETUP_DIFFERS, step, found & mask);
        }
    }
    setup->reading_back = false;
    setup->differs_since_ns = 0;
    setup->step++;
    return SETUP_BUSY;
}

/* A node that knows no PDO without remote requests refuses the value: once more, with them. */
static bool try_with_rtr(struct node_setup *setup, const struct setup_step *step)
{
    const bool refused = step->kind == STEP_WRITE && step->index >= 0x1800 &&
                         step->index < 0x1A00 && step->sub == 1 && !setup->with_rtr;
    setup->with_rtr = setup->with_rtr || refused;
    return refused;
}

static void begin_transfer(struct node_setup *setup, const struct setup_step *step, uint64_t now_ns)
{
    if (step->kind == STEP_WRITE && !setup->reading_back) {
        uint8_t bytes[4];
        bytes_put_u32(bytes, step->value);
        co_sdo_client_write(&setup->client, step->index, step->sub, bytes, step->bytes, now_ns);
    } else {
        co_sdo_client_read(&setup->client, step->index, step->sub, now_ns);
    }
    setup->under_way = true;
}

enum setup_verdict node_setup_poll(struct node_setup *setup, const struct can_bus *bus,
                                   uint64_t now_ns)
{
    if (setup->failure.verdict != SETUP_DONE) {
        return setup->failure.verdict;
    }
    struct setup_step step = current_step(setup);
    if (setup->under_way) {
        const enum co_sdo_result result = co_sdo_client_poll(&setup->client, bus, now_ns);
        if (result == CO_SDO_BUSY) {
            return SETUP_BUSY;
        }
        setup->under_way = false;
        if (result == CO_SDO_ABORTED) {
            const uint32_t code = setup->client.abort_code;
            if (code == CO_ABORT_TIMEOUT && ++setup->timeouts < SETUP_TRIES) {
                begin_transfer(setup, &step, now_ns);
                (void)co_sdo_client_poll(&setup->client, bus, now_ns);
                return SETUP_BUSY;
            }
            if (code != CO_ABORT_TIMEOUT && try_with_rtr(setup, &step)) {
                step = current_step(setup);
                begin_transfer(setup, &step, now_ns);
                (void)co_sdo_client_poll(&setup->client, bus, now_ns);
                return SETUP_BUSY;
            }
            return fail(setup, code == CO_ABORT_TIMEOUT ? SETUP_SILENT : SETUP_ABORTED, &step,
                        code);
        }
        setup->timeouts = 0;
        if (finish_step(setup, &step, now_ns) < SETUP_DONE) {
            return setup->failure.verdict;
        }
        step = current_step(setup);
    }
    if (step.kind == STEP_END) {
        return is_drive(setup->node) ? check_drive(setup) : SETUP_DONE;
    }
    begin_transfer(setup, &step, now_ns);
    (void)co_sdo_client_poll(&setup->client, bus, now_ns);
    return SETUP_BUSY;
}
