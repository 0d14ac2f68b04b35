#include "hal/devices/device_check.h"

#include "hal/bus/frame_table.h"
#include "hal/devices/device_nodes.h"

enum { OBJECT_INDEX_MIN = 0x1000, SPRING_TOLERANCE_PERCENT = 2 };
enum { CANOPEN_NUMBER_MAX = 127, CANSIMPLE_NUMBER_MAX = 63, MIT_NUMBER_MAX = 31 };
#define SCALE_TOLERANCE 1.0e-4f
#define TORQUE_TOLERANCE 0.02f /* a data sheet's two digits */
#define LATENCY_TOLERANCE_S 0.0001f
/* Where the push begins to be smaller, in shares of the supply's limits; device_keys.h names them. */
#define SUPPLY_LOW_WARN 1.05f
#define SUPPLY_HIGH_WARN 0.95f
#define WARN_LEAST_K 1.0f
#define LEVER_LEAST_M 0.01f
#define TWO_PI 6.28318530717958647692f

enum device_verdict device_key_check(const struct device_key *row, float value)
{
    if (!(value - value == 0.0f)) {
        return DEVICE_BAD_NOT_FINITE;
    }
    if (value < row->minimum || value > row->maximum) {
        return DEVICE_BAD_RANGE;
    }
    const bool is_object = row->type == DEVICE_OBJECT && value != 0.0f;
    return is_object && value < (float)(OBJECT_INDEX_MIN << 8) ? DEVICE_BAD_OBJECT : DEVICE_OK;
}

static enum device_verdict refuse(struct device_refusal *refusal, enum device_verdict verdict,
                                  const struct device_description *device, int leg, unsigned key,
                                  float allowed)
{
    *refusal = (struct device_refusal){verdict, leg, key, device_value(device, leg, key), allowed};
    return verdict;
}

static enum device_verdict check_ranges(const struct device_description *device, int leg,
                                        struct device_refusal *refusal)
{
    const unsigned count = leg < 0 ? DEVICE_COMMON_COUNT : DEVICE_LEG_COUNT;
    for (unsigned key = 0; key < count; key++) {
        if (leg >= 0 && !device_key_applies(&device->leg[leg], key)) {
            continue;
        }
        const float value = device_value(device, leg, key);
        const enum device_verdict verdict = device_key_check(device_key_row(leg, key), value);
        if (verdict != DEVICE_OK) {
            return refuse(refusal, verdict, device, leg, key, 0.0f);
        }
    }
    return DEVICE_OK;
}

static bool differs(float a, float b, float relative)
{
    const float tolerance = relative * (b < 0.0f ? -b : b);
    return a - b > tolerance || b - a > tolerance;
}

/* What is told twice must be told alike. */
static enum device_verdict check_scale(const struct device_description *device, int leg,
                                       struct device_refusal *refusal)
{
    const struct device_leg *own = &device->leg[leg];
    if (own->travel_per_turn_m <= 0.0f) {
        return DEVICE_OK;
    }
    const float turns_per_m = own->gear / own->travel_per_turn_m;
    const float counts_per_m = own->counts_per_turn * turns_per_m;
    if (own->counts_per_turn > 0.0f && differs(own->counts_per_m, counts_per_m, SCALE_TOLERANCE)) {
        return refuse(refusal, DEVICE_BAD_SCALE, device, leg, DEVICE_LEG_counts_per_m,
                      counts_per_m);
    }
    if (own->protocol == DEVICE_CANSIMPLE &&
        differs(own->turns_per_m, turns_per_m, SCALE_TOLERANCE)) {
        return refuse(refusal, DEVICE_BAD_SCALE, device, leg, DEVICE_LEG_turns_per_m, turns_per_m);
    }
    if (own->protocol == DEVICE_MIT &&
        differs(own->rad_per_m, turns_per_m * TWO_PI, SCALE_TOLERANCE)) {
        return refuse(refusal, DEVICE_BAD_SCALE, device, leg, DEVICE_LEG_rad_per_m,
                      turns_per_m * TWO_PI);
    }
    const float force_N = own->rated_torque_Nm * turns_per_m * TWO_PI;
    if (own->rated_torque_Nm > 0.0f && differs(own->rated_force_N, force_N, TORQUE_TOLERANCE)) {
        return refuse(refusal, DEVICE_BAD_TORQUE, device, leg, DEVICE_LEG_rated_force_N, force_N);
    }
    return DEVICE_OK;
}

/* The whole stroke must fit the field that the motor is commanded in: beyond, every target would
 * silently be the last that fits. */
static enum device_verdict check_stroke(const struct device_description *device, int leg,
                                        struct device_refusal *refusal)
{
    const struct device_leg *own = &device->leg[leg];
    if (own->protocol == DEVICE_MIT) {
        const float end_rad =
            own->zero_rad + (float)own->direction * own->stroke_max_m * own->rad_per_m;
        const float range_rad = own->position_range_rad;
        if (own->zero_rad > range_rad || own->zero_rad < -range_rad || end_rad > range_rad ||
            end_rad < -range_rad) {
            return refuse(refusal, DEVICE_BAD_STROKE_FIELD, device, leg, DEVICE_LEG_zero_rad,
                          range_rad);
        }
    }
    return DEVICE_OK;
}

static enum device_verdict check_latch(const struct device_description *device, int leg,
                                       struct device_refusal *refusal)
{
    const struct device_leg *own = &device->leg[leg];
    if (own->latch == DEVICE_LATCH_DRIVE && own->protocol != DEVICE_CIA402) {
        return refuse(refusal, DEVICE_BAD_LATCH_BIT, device, leg, DEVICE_LEG_latch, 0.0f);
    }
    if (own->latch == DEVICE_LATCH_DRIVE && device_leg_lacks(own, DEVICE_LACKS_OUTPUTS)) {
        return refuse(refusal, DEVICE_BAD_LATCH_OUTPUT, device, leg, DEVICE_LEG_latch, 0.0f);
    }
    if (own->unload == DEVICE_UNLOAD_LATCH && !device_leg_reports_latch(own)) {
        return refuse(refusal, DEVICE_BAD_UNLOAD_LATCH, device, leg, DEVICE_LEG_unload, 0.0f);
    }
    return DEVICE_OK;
}

/* Only what a drive tells has limits; CANSimple asks for both by remote frames, which nobody sends. */
static bool tells_temperature(const struct device_leg *own)
{
    return own->protocol == DEVICE_MIT ||
           (own->protocol == DEVICE_CIA402 && !device_leg_lacks(own, DEVICE_LACKS_TEMPERATURE));
}

static bool tells_supply(const struct device_leg *own)
{
    return own->protocol == DEVICE_CIA402 && !device_leg_lacks(own, DEVICE_LACKS_BUS_VOLTAGE);
}

/* Between two limits there must be room to spare the drive in. */
static enum device_verdict check_limits(const struct device_description *device, int leg,
                                        struct device_refusal *refusal)
{
    const struct device_leg *own = &device->leg[leg];
    const float warn = own->temperature_warn_degC, stop = own->temperature_stop_degC;
    const float low = own->supply_min_V * SUPPLY_LOW_WARN,
                high = own->supply_max_V * SUPPLY_HIGH_WARN;
    if ((stop > 0.0f || warn > 0.0f) && !(warn > 0.0f && stop - warn >= WARN_LEAST_K)) {
        return refuse(refusal, DEVICE_BAD_LIMIT_ORDER, device, leg,
                      DEVICE_LEG_temperature_stop_degC, warn + WARN_LEAST_K);
    }
    if (own->supply_max_V > 0.0f && high <= low) {
        return refuse(refusal, DEVICE_BAD_LIMIT_ORDER, device, leg, DEVICE_LEG_supply_max_V,
                      low / SUPPLY_HIGH_WARN);
    }
    if (stop > 0.0f && !tells_temperature(own)) {
        return refuse(refusal, DEVICE_BAD_NOT_TOLD, device, leg, DEVICE_LEG_temperature_stop_degC,
                      0.0f);
    }
    if ((low > 0.0f || high > 0.0f) && !tells_supply(own)) {
        return refuse(refusal, DEVICE_BAD_NOT_TOLD, device, leg,
                      low > 0.0f ? (unsigned)DEVICE_LEG_supply_min_V
                                 : (unsigned)DEVICE_LEG_supply_max_V,
                      0.0f);
    }
    return DEVICE_OK;
}

/* An identifier has 11 bits: that leaves 6 for a CANSimple axis; the makers' motors take 5. */
static enum device_verdict check_number(const struct device_description *device, int leg,
                                        struct device_refusal *refusal)
{
    const struct device_leg *own = &device->leg[leg];
    const int32_t largest = own->protocol == DEVICE_CANSIMPLE ? CANSIMPLE_NUMBER_MAX
                            : own->protocol == DEVICE_MIT     ? MIT_NUMBER_MAX
                                                              : CANOPEN_NUMBER_MAX;
    return own->drive_node <= largest ? DEVICE_OK
                                      : refuse(refusal, DEVICE_BAD_NUMBER, device, leg,
                                               DEVICE_LEG_drive_node, (float)largest);
}

static enum device_verdict check_drive(const struct device_description *device, int leg,
                                       struct device_refusal *refusal)
{
    enum device_verdict verdict = DEVICE_OK;
    if (device->leg[leg].direction == 0) {
        return refuse(refusal, DEVICE_BAD_DIRECTION, device, leg, DEVICE_LEG_direction, 0.0f);
    }
    verdict = check_number(device, leg, refusal);
    verdict = verdict == DEVICE_OK ? check_scale(device, leg, refusal) : verdict;
    verdict = verdict == DEVICE_OK ? check_stroke(device, leg, refusal) : verdict;
    verdict = verdict == DEVICE_OK ? check_latch(device, leg, refusal) : verdict;
    return verdict == DEVICE_OK ? check_limits(device, leg, refusal) : verdict;
}

/* A table is whole, or there is none. */
static enum device_verdict check_lever(const struct device_description *device, int leg,
                                       struct device_refusal *refusal)
{
    const struct device_leg *own = &device->leg[leg];
    const float lever[] = {own->ankle_table_1_m, own->ankle_table_2_m, own->ankle_table_3_m,
                           own->ankle_table_4_m};
    for (unsigned i = 0; i < sizeof lever / sizeof lever[0]; i++) {
        if (own->ankle == DEVICE_ANKLE_LEVER && own->ankle_table_rad > 0.0f &&
            lever[i] < LEVER_LEAST_M) {
            return refuse(refusal, DEVICE_BAD_LEVER_TABLE, device, leg,
                          (unsigned)DEVICE_LEG_ankle_table_1_m + i, 0.0f);
        }
    }
    return DEVICE_OK;
}

static enum device_verdict check_sensors(const struct device_description *device, int leg,
                                         struct device_refusal *refusal)
{
    const struct device_leg *own = &device->leg[leg];
    if (own->leg_direction == 0) {
        return refuse(refusal, DEVICE_BAD_DIRECTION, device, leg, DEVICE_LEG_leg_direction, 0.0f);
    }
    if (own->ankle_direction == 0) {
        return refuse(refusal, DEVICE_BAD_DIRECTION, device, leg, DEVICE_LEG_ankle_direction, 0.0f);
    }
    if (own->leg_sensor_bits % 8 != 0) {
        return refuse(refusal, DEVICE_BAD_BITS, device, leg, DEVICE_LEG_leg_sensor_bits, 0.0f);
    }
    if (own->ankle_sensor_bits % 8 != 0) {
        return refuse(refusal, DEVICE_BAD_BITS, device, leg, DEVICE_LEG_ankle_sensor_bits, 0.0f);
    }
    if (own->ankle_side == DEVICE_AT_MOTOR) {
        return refuse(refusal, DEVICE_BAD_MOTOR_SIDE, device, leg, DEVICE_LEG_ankle_side, 0.0f);
    }
    return check_lever(device, leg, refusal);
}

/* What the controller has one number for. */
static enum device_verdict check_alike(const struct device_description *device,
                                       struct device_refusal *refusal)
{
    const struct device_leg *left = &device->leg[SIDE_LEFT], *right = &device->leg[SIDE_RIGHT];
    const float latency_s = left->leg_latency_s;
    if (device_leg_is_driven(left) && device_leg_is_driven(right) &&
        differs(right->spring_N_per_m, left->spring_N_per_m, SPRING_TOLERANCE_PERCENT * 0.01f)) {
        return refuse(refusal, DEVICE_BAD_SPRINGS, device, SIDE_RIGHT, DEVICE_LEG_spring_N_per_m,
                      left->spring_N_per_m);
    }
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        const float own[] = {device->leg[leg].leg_latency_s, device->leg[leg].ankle_latency_s};
        for (unsigned i = 0; i < 2; i++) {
            if (own[i] - latency_s > LATENCY_TOLERANCE_S ||
                latency_s - own[i] > LATENCY_TOLERANCE_S) {
                return refuse(refusal, DEVICE_BAD_LATENCIES, device, leg,
                              i == 0 ? (unsigned)DEVICE_LEG_leg_latency_s
                                     : (unsigned)DEVICE_LEG_ankle_latency_s,
                              latency_s);
            }
        }
    }
    return DEVICE_OK;
}

static enum device_verdict check_common(const struct device_description *device,
                                        struct device_refusal *refusal)
{
    const enum device_verdict verdict = check_ranges(device, -1, refusal);
    if (verdict != DEVICE_OK) {
        return verdict;
    }
    if (device->common.tick_us != TICK_PERIOD_US) {
        return refuse(refusal, DEVICE_BAD_TICK, device, -1, DEVICE_COMMON_tick_us,
                      (float)TICK_PERIOD_US);
    }
    if (device->common.bitrate_bit_s != BUS_BITRATE) {
        return refuse(refusal, DEVICE_BAD_BITRATE, device, -1, DEVICE_COMMON_bitrate_bit_s,
                      (float)BUS_BITRATE);
    }
    return DEVICE_OK;
}

enum device_verdict device_check(const struct device_description *device,
                                 struct device_refusal *refusal)
{
    bool driven = false;
    enum device_verdict verdict = check_common(device, refusal);
    for (int leg = 0; leg < SIDE_COUNT && verdict == DEVICE_OK; leg++) {
        verdict = check_ranges(device, leg, refusal);
        if (verdict == DEVICE_OK && device_leg_is_driven(&device->leg[leg])) {
            driven = true;
            verdict = check_drive(device, leg, refusal);
        }
        verdict = verdict == DEVICE_OK ? check_sensors(device, leg, refusal) : verdict;
    }
    if (verdict == DEVICE_OK && !driven) {
        verdict =
            refuse(refusal, DEVICE_BAD_NO_DRIVE, device, SIDE_LEFT, DEVICE_LEG_protocol, 0.0f);
    }
    verdict = verdict == DEVICE_OK ? check_alike(device, refusal) : verdict;
    if (verdict == DEVICE_OK) {
        struct device_node_clash clash;
        verdict = device_nodes_check(device, &clash);
        if (verdict != DEVICE_OK) {
            (void)refuse(refusal, verdict, device, clash.leg, clash.key, clash.id);
        }
    }
    return verdict;
}

enum device_verdict device_check_person(const struct device_description *device,
                                        struct device_refusal *refusal)
{
    const enum device_verdict verdict = device_check(device, refusal);
    for (int leg = 0; leg < SIDE_COUNT && verdict == DEVICE_OK; leg++) {
        const struct device_leg *own = &device->leg[leg];
        if (device_leg_is_driven(own) && !device_leg_reports_latch(own)) {
            return refuse(refusal, DEVICE_BAD_BENCH_ONLY, device, leg, DEVICE_LEG_latch, 0.0f);
        }
        if (device_leg_is_driven(own) && own->unload == DEVICE_UNLOAD_NONE) {
            return refuse(refusal, DEVICE_BAD_UNLOAD_PERSON, device, leg, DEVICE_LEG_unload, 0.0f);
        }
    }
    return verdict;
}
