#include "hal/devices/setup_steps.h"

#include "hal/bus/bytes.h"
#include "hal/bus/frame_table.h"
#include "hal/canopen/co_defs.h"
#include "hal/devices/device_keys.h"

#define COB_ID_MASK UINT32_C(0x800007FF) /* "exists" and the identifier; not the RTR bit */
#define COB_OFF UINT32_C(0x80000000)
#define COB_NO_RTR UINT32_C(0x40000000) /* CiA 301, 7.5.2.37: of TPDOs, no remote requests */
#define ALL_BITS SETUP_ALL_BITS

/* CiA 402-2: option codes that end in a controlled unload, then torque off. */
enum {
    ABORT_CONNECTION_IS_FAULT = 1,
    QUICK_STOP_RAMP = 2,
    SLOW_DOWN_RAMP = 1,
    MODE_INTERPOLATED_POSITION = 7,
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
#define EXPECT(index, sub, value, mask) \
    ((struct setup_step){STEP_EXPECT, index, sub, 4, value, mask})
#define AWAIT(index, sub, value, mask) ((struct setup_step){STEP_AWAIT, index, sub, 4, value, mask})
#define SPEED(index, sub) ((struct setup_step){STEP_SPEED, index, sub, 4, 0, 0})
#define WRITE(index, sub, bytes, value) \
    ((struct setup_step){STEP_WRITE, index, sub, bytes, value, ALL_BITS})
#define COB(index, value) ((struct setup_step){STEP_WRITE, index, 1, 4, value, COB_ID_MASK})
#define SCALING(index, sub) ((struct setup_step){STEP_SCALING, index, sub, 4, 0, 0})
#define TRY(index, sub, bytes, value) ((struct setup_step){STEP_TRY, index, sub, bytes, value, 0})
#define SKIP ((struct setup_step){STEP_SKIP, 0, 0, 0, 0, 0})
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

static struct setup_step unless(bool lacking, struct setup_step step)
{
    return lacking ? SKIP : step;
}

static struct setup_step common_step(unsigned step, uint32_t profile, bool no_consumer)
{
    switch (step) {
    case 0:
        return EXPECT(0x1000, 0, profile, 0xFFFF);
    case 1:
        return WRITE(0x1017, 0, 2, HEARTBEAT_PERIOD_MS);
    default:
        return unless(no_consumer,
                      WRITE(0x1016, 1, 4, (uint32_t)NODE_CONTROLLER << 16 | HEARTBEAT_TIMEOUT_MS));
    }
}

enum { COMMON_STEPS = 3, DRIVE_PDOS = 4, DRIVE_PDO_END = COMMON_STEPS + DRIVE_PDOS * PDO_STEPS };

/* The target in its frame: both drives' halves, or this drive's alone. */
static struct pdo_plan target_plan(const struct node_setup_config *config, enum side leg)
{
    const uint32_t dummy = 0x00040020; /* INTEGER32: the other drive's half */
    const uint32_t target = config->interpolated[leg] ? 0x60C10120 : 0x607A0020;
    const bool left = leg == SIDE_LEFT;
    if (config->own_target[leg]) {
        return (struct pdo_plan){
            0x1400, left ? FRAME_DRIVE_TARGETS : FRAME_DRIVE_TARGET_RIGHT, 1, 1, {target}};
    }
    return (struct pdo_plan){
        0x1400, FRAME_DRIVE_TARGETS, 1, 2, {left ? target : dummy, left ? dummy : target, 0}};
}

/* Torque, temperature and voltage, as far as the drive has them. */
static struct pdo_plan slow_plan(const struct node_setup_config *config, enum side leg)
{
    static const struct {
        enum device_lack lack;
        uint32_t entry;
    } values[] = {{DEVICE_LACKS_TORQUE, 0x60770010},
                  {DEVICE_LACKS_TEMPERATURE, 0x21000010},
                  {DEVICE_LACKS_BUS_VOLTAGE, 0x60790020}};
    struct pdo_plan plan = {0x1802,
                            leg == SIDE_LEFT ? FRAME_DRIVE_SLOW_LEFT : FRAME_DRIVE_SLOW_RIGHT,
                            SLOW_PDO_TICKS,
                            0,
                            {0}};
    for (unsigned i = 0; i < sizeof values / sizeof values[0]; i++) {
        if (!setup_lacks(config, leg, values[i].lack)) {
            plan.map[plan.count++] = values[i].entry;
        }
    }
    return plan;
}

static struct pdo_plan drive_plan(const struct node_setup_config *config, enum side leg,
                                  unsigned number)
{
    const bool left = leg == SIDE_LEFT;
    switch (number) {
    case 0:
        return target_plan(config, leg);
    case 1:
        return (struct pdo_plan){0x1401,
                                 left ? FRAME_DRIVE_COMMAND_LEFT : FRAME_DRIVE_COMMAND_RIGHT,
                                 255,
                                 setup_lacks(config, leg, DEVICE_LACKS_OUTPUTS) ? 1 : 2,
                                 {0x60400010, 0x60FE0120, 0}};
    case 2:
        return (struct pdo_plan){0x1800,
                                 left ? FRAME_DRIVE_STATE_LEFT : FRAME_DRIVE_STATE_RIGHT,
                                 1,
                                 2,
                                 {0x60410010, 0x60640020, 0}};
    default:
        return slow_plan(config, leg);
    }
}

static struct setup_step drive_pdo_step(const struct node_setup_config *config,
                                        const struct setup_place *place, enum side leg,
                                        unsigned number, unsigned part)
{
    const struct pdo_plan plan = drive_plan(config, leg, number);
    if (plan.count == 0) {
        return SKIP; /* nothing of it is there */
    }
    return pdo_step(&plan, part, place->with_rtr);
}

/* A maker's drive may send and hear PDOs of its own that would crowd the bus, or be taken for others. */
static struct setup_step other_pdo_step(unsigned index, bool there, uint32_t node,
                                        bool slow_is_used)
{
    static const struct {
        uint16_t index;
        uint16_t cob_id;
    } others[] = {
        {0x1402, 0x400}, {0x1403, 0x500}, {0x1801, 0x280}, {0x1803, 0x480}, {0x1802, 0x380}};
    if (!there || (others[index].index == 0x1802 && slow_is_used)) {
        return SKIP;
    }
    return TRY(others[index].index, 1, 4, COB_OFF | (others[index].cob_id + node));
}

enum { OTHER_PDOS = 5 };

/* Mode, reactions, limits. */
static struct setup_step drive_object_step(const struct node_setup_config *config, enum side leg,
                                           unsigned step)
{
    const uint32_t mode =
        config->interpolated[leg] ? MODE_INTERPOLATED_POSITION : MODE_CYCLIC_SYNCHRONOUS_POSITION;
    const bool no_options = setup_lacks(config, leg, DEVICE_LACKS_OPTION_CODES);
    const bool no_interpolation = setup_lacks(config, leg, DEVICE_LACKS_INTERPOLATION);
    const bool no_limits = setup_lacks(config, leg, DEVICE_LACKS_POSITION_LIMITS);
    switch (step) {
    case 0:
        return WRITE(0x6060, 0, 1, mode);
    case 1:
        return AWAIT(0x6061, 0, mode, 0xFF);
    case 2:
        return unless(no_interpolation, WRITE(0x60C2, 1, 1, INTERPOLATION_VALUE));
    case 3:
        return unless(no_interpolation, WRITE(0x60C2, 2, 1, INTERPOLATION_EXPONENT));
    case 4:
        return unless(setup_lacks(config, leg, DEVICE_LACKS_ABORT_OPTION),
                      WRITE(0x6007, 0, 2, ABORT_CONNECTION_IS_FAULT));
    case 5:
        return unless(no_options, WRITE(0x605A, 0, 2, QUICK_STOP_RAMP));
    case 6:
        return unless(no_options, WRITE(0x605B, 0, 2, SLOW_DOWN_RAMP));
    case 7:
        return unless(no_options, WRITE(0x605C, 0, 2, SLOW_DOWN_RAMP));
    case 8:
        return unless(no_options, WRITE(0x605E, 0, 2, QUICK_STOP_RAMP));
    case 9:
        return unless(setup_lacks(config, leg, DEVICE_LACKS_FOLLOWING_WINDOW),
                      WRITE(0x6065, 0, 4, config->following_error_counts[leg]));
    case 10:
        return unless(setup_lacks(config, leg, DEVICE_LACKS_FOLLOWING_TIME),
                      WRITE(0x6066, 0, 2, FOLLOWING_ERROR_MS));
    case 11:
        return unless(no_limits, WRITE(0x607D, 1, 4, (uint32_t)config->limit_min_counts[leg]));
    case 12:
        return unless(no_limits, WRITE(0x607D, 2, 4, (uint32_t)config->limit_max_counts[leg]));
    case 13:
        return unless(setup_lacks(config, leg, DEVICE_LACKS_OUTPUT_MASK),
                      WRITE(0x60FE, 2, 4, DRIVE_OUTPUT_LATCH_ARMED));
    default:
        return unless(setup_lacks(config, leg, DEVICE_LACKS_RPDO_TIMER),
                      WRITE(0x1400, 5, 2, TARGET_TIMEOUT_MS));
    }
}

enum { DRIVE_OBJECTS = 15 };

/* What the drive says of itself. */
static struct setup_step drive_reading_step(const struct node_setup_config *config, enum side leg,
                                            unsigned step)
{
    static const struct {
        uint16_t index;
        uint8_t sub;
    } scaling[] = {{0x608F, 1}, {0x608F, 2}, {0x6091, 1}, {0x6091, 2}, {0x6092, 1}, {0x6092, 2}};
    if (step < sizeof scaling / sizeof scaling[0]) {
        return unless(setup_lacks(config, leg, DEVICE_LACKS_SCALING),
                      SCALING(scaling[step].index, scaling[step].sub));
    }
    return step == sizeof scaling / sizeof scaling[0]
               ? unless(setup_lacks(config, leg, DEVICE_LACKS_RATED_TORQUE), SCALING(0x6076, 0))
               : unless(setup_lacks(config, leg, DEVICE_LACKS_MAX_SPEED), SPEED(0x6080, 0));
}

enum { DRIVE_READINGS = 8 };

static struct setup_step drive_step(const struct node_setup_config *config,
                                    const struct setup_place *place)
{
    const enum side leg = setup_leg(place->role);
    unsigned step = place->step;
    if (step < COMMON_STEPS) {
        return common_step(step, 402, setup_lacks(config, leg, DEVICE_LACKS_HEARTBEAT_CONSUMER));
    }
    if (step < DRIVE_PDO_END) {
        const unsigned i = step - COMMON_STEPS;
        return drive_pdo_step(config, place, leg, i / PDO_STEPS, i % PDO_STEPS);
    }
    step -= DRIVE_PDO_END;
    if (step < DRIVE_OBJECTS) {
        return drive_object_step(config, leg, step);
    }
    step -= DRIVE_OBJECTS;
    if (step < DRIVE_READINGS) {
        return drive_reading_step(config, leg, step);
    }
    step -= DRIVE_READINGS;
    return step < OTHER_PDOS ? other_pdo_step(step, config->has_others_pdos[leg], place->node,
                                              slow_plan(config, leg).count > 0)
                             : END;
}

/* What a 0 in the configuration stands for. */
static uint32_t or_standard(uint32_t value, uint32_t standard)
{
    return value != 0 ? value : standard;
}

enum { LEG_OBJECT = 0x202001, ANKLE_OBJECT = 0x202002, LEG_BITS = 24, ANKLE_BITS = 16 };

/* A sensor with another number than here has its PDOs elsewhere: where others have theirs. */
static struct setup_step other_sensor_pdo(unsigned part, bool foot_switch, enum side leg,
                                          uint32_t node)
{
    const uint32_t foot = leg == SIDE_LEFT ? FRAME_FOOT_LEFT : FRAME_FOOT_RIGHT;
    switch (part) {
    case 0:
        return TRY(0x1800, 1, 4, COB_OFF | (0x180u + node));
    case 1:
        return TRY(0x1802, 1, 4, COB_OFF | (0x380u + node));
    default:
        return unless(!foot_switch, TRY(0x1802, 1, 4, foot));
    }
}

/* Whether the ankle's sensor is a node of its own. */
static bool is_apart(const struct node_setup_config *config, enum side leg)
{
    return config->node[NETWORK_ANKLE_LEFT + (unsigned)leg] != 0;
}

/* An ankle sensor on a node of its own; what else it may send is switched off. */
static struct setup_step ankle_step(const struct node_setup_config *config,
                                    const struct setup_place *place)
{
    const unsigned step = place->step;
    const enum side leg = setup_leg(place->role);
    const uint32_t ankle = or_standard(config->ankle_object[leg], ANKLE_OBJECT);
    const struct pdo_plan plan = {
        0x1801,
        leg == SIDE_LEFT ? FRAME_ANKLE_STATE_LEFT : FRAME_ANKLE_STATE_RIGHT,
        1,
        1,
        {ankle << 8 | or_standard(config->ankle_bits[leg], ANKLE_BITS), 0, 0}};
    if (step < COMMON_STEPS) {
        return common_step(step, 406, false);
    }
    if (step < COMMON_STEPS + PDO_STEPS) {
        return pdo_step(&plan, step - COMMON_STEPS, place->with_rtr);
    }
    switch (step - COMMON_STEPS - PDO_STEPS) {
    case 0:
        return unless(ankle != ANKLE_OBJECT,
                      EXPECT(0x2021, 0, config->ankle_is_lever[leg] ? 1 : 0, 0xFF));
    case 1:
        return AWAIT(0x6503, 0, 0, 0xFFFF); /* alarms: none */
    case 2:
    case 3:
        return other_sensor_pdo(step - COMMON_STEPS - PDO_STEPS - 2, false, leg, place->node);
    default:
        return END;
    }
}

static struct setup_step sensor_step(const struct node_setup_config *config,
                                     const struct setup_place *place)
{
    const unsigned step = place->step;
    const enum side leg = setup_leg(place->role);
    const uint32_t ankle = or_standard(config->ankle_object[leg], ANKLE_OBJECT);
    const struct pdo_plan plan = {0x1801,
                                  leg == SIDE_LEFT ? FRAME_LEG_STATE_LEFT : FRAME_LEG_STATE_RIGHT,
                                  1,
                                  is_apart(config, leg) ? 1 : 2,
                                  {or_standard(config->leg_object[leg], LEG_OBJECT) << 8 |
                                       or_standard(config->leg_bits[leg], LEG_BITS),
                                   ankle << 8 | or_standard(config->ankle_bits[leg], ANKLE_BITS),
                                   0}};
    if (step < COMMON_STEPS) {
        return common_step(step, 406, false);
    }
    if (step < COMMON_STEPS + PDO_STEPS) {
        return pdo_step(&plan, step - COMMON_STEPS, place->with_rtr);
    }
    switch (step - COMMON_STEPS - PDO_STEPS) {
    case 0:
        return EXPECT(0x6001, 0,
                      or_standard(config->leg_counts_per_turn[leg], LEG_ANGLE_COUNTS_PER_TURN),
                      ALL_BITS);
    case 1: /* the maker's word on its ankle is known of this project's sensors only */
        return unless(ankle != ANKLE_OBJECT || is_apart(config, leg),
                      EXPECT(0x2021, 0, config->ankle_is_lever[leg] ? 1 : 0, 0xFF));
    case 2:
        return AWAIT(0x6503, 0, 0, 0xFFFF); /* alarms: none */
    case 3:
    case 4:
    case 5:
        return config->sensor_has_others_pdos[leg]
                   ? other_sensor_pdo(step - COMMON_STEPS - PDO_STEPS - 3, config->foot_switch[leg],
                                      leg, place->node)
                   : SKIP;
    default:
        return END;
    }
}

/* A latch board: outputs in, and one byte out on change and every SLOW_PDO_TICKS. */
static struct setup_step latch_step(const struct node_setup_config *config,
                                    const struct setup_place *place)
{
    const unsigned step = place->step;
    const bool left = place->role == NETWORK_LATCH_LEFT;
    const enum side leg = setup_leg(place->role);
    const struct pdo_plan outputs = {
        0x1400, left ? FRAME_LATCH_COMMAND_LEFT : FRAME_LATCH_COMMAND_RIGHT, 255, 1, {0x60FE0120}};
    const struct pdo_plan state = {0x1800,
                                   left ? FRAME_LATCH_STATE_LEFT : FRAME_LATCH_STATE_RIGHT,
                                   255,
                                   1,
                                   {config->latch_object[leg] << 8 | 8u}};
    const bool tells = config->latch_object[leg] != 0;
    if (step == 0) {
        return SKIP; /* a board may be of any profile */
    }
    if (step < COMMON_STEPS) {
        return common_step(step, 0, false);
    }
    if (step < COMMON_STEPS + PDO_STEPS) {
        return pdo_step(&outputs, step - COMMON_STEPS, place->with_rtr);
    }
    if (step == COMMON_STEPS + PDO_STEPS) {
        return unless(!tells, WRITE(0x1800, 5, 2, HEARTBEAT_PERIOD_MS)); /* its slow repeat */
    }
    if (step <= COMMON_STEPS + 2 * PDO_STEPS) {
        return unless(!tells,
                      pdo_step(&state, step - COMMON_STEPS - PDO_STEPS - 1, place->with_rtr));
    }
    return END;
}

struct setup_step setup_step_at(const struct node_setup_config *config,
                                const struct setup_place *place)
{
    switch (place->role) {
    case NETWORK_DRIVE_LEFT:
    case NETWORK_DRIVE_RIGHT:
        return drive_step(config, place);
    case NETWORK_SENSOR_LEFT:
    case NETWORK_SENSOR_RIGHT:
        return sensor_step(config, place);
    case NETWORK_ANKLE_LEFT:
    case NETWORK_ANKLE_RIGHT:
        return ankle_step(config, place);
    default:
        return latch_step(config, place);
    }
}
