#include "hal/devices/leg_sensors.h"

#include "hal/bus/bytes.h"
#include "hal/bus/frame_table.h"
#include "hal/devices/duplicate_id.h"
#include "hal/devices/small_trig.h"

#define TWO_PI 6.28318530717958647692f

static void set_default(float *value, float standard)
{
    *value = *value != 0.0f ? *value : standard;
}

/* What is 0 is as in the frame table. */
static void fill_in(struct leg_sensor_config *config)
{
    set_default(&config->leg_counts_per_turn, (float)LEG_ANGLE_COUNTS_PER_TURN);
    set_default(&config->ankle_counts_per_unit, config->ankle_is_lever
                                                    ? (float)ANKLE_COUNTS_PER_TURN
                                                    : (float)ANKLE_COUNTS_PER_METRE);
    config->leg_bytes = config->leg_bytes != 0 ? config->leg_bytes : 3;
    config->ankle_bytes = config->ankle_bytes != 0 ? config->ankle_bytes : 2;
}

void leg_sensors_init(struct leg_sensors *sensors, const struct leg_sensor_config *config)
{
    *sensors = (struct leg_sensors){0};
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        sensors->config[leg] = config[leg];
        fill_in(&sensors->config[leg]);
        sensors->reading[leg].age_ticks = UINT16_MAX;
        sensors->reading[leg].foot_age_ticks = UINT16_MAX;
    }
}

static int32_t count_at(const uint8_t *from, unsigned bytes)
{
    return bytes == 2   ? bytes_get_i16(from)
           : bytes == 3 ? bytes_get_i24(from)
                        : bytes_get_i32(from);
}

static float wrap_turn(float angle_rad)
{
    if (angle_rad > 0.5f * TWO_PI) {
        return angle_rad - TWO_PI;
    }
    if (angle_rad <= -0.5f * TWO_PI) {
        return angle_rad + TWO_PI;
    }
    return angle_rad;
}

static float ankle_extension_m(const struct leg_sensor_config *config, int32_t counts)
{
    const float sign = config->ankle_reversed ? -1.0f : 1.0f;
    if (!config->ankle_is_lever) {
        return ((float)counts * (1.0f / config->ankle_counts_per_unit) - config->ankle_zero_m) *
               sign;
    }
    const float plantarflexion_rad =
        (float)counts * (TWO_PI / config->ankle_counts_per_unit) * sign;
    const float extension =
        config->ankle_lever_m * small_sin(plantarflexion_rad - config->ankle_neutral_rad);
    return extension > 0.0f ? extension : 0.0f;
}

static void count_malformed(struct leg_sensors *sensors)
{
    if (sensors->rx_malformed < UINT32_MAX) {
        sensors->rx_malformed++;
    }
}

static void receive_foot(struct leg_sensors *sensors, const struct can_msg *message)
{
    const enum side leg = message->id == FRAME_FOOT_RIGHT ? SIDE_RIGHT : SIDE_LEFT;
    struct leg_sensor_reading *reading = &sensors->reading[leg];
    if (message->length != FRAME_BYTES_FOOT_LEFT || message->flags != 0) {
        count_malformed(sensors);
        return;
    }
    const unsigned bits = message->data[0];
    reading->foot_age_ticks = 0;
    if ((bits & FOOT_HAS_FAULT) != 0) {
        reading->foot = FOOT_UNKNOWN;
    } else {
        reading->foot = (bits & FOOT_IS_DOWN) != 0 ? FOOT_DOWN : FOOT_UP;
    }
}

bool leg_sensors_receive(struct leg_sensors *sensors, const struct can_msg *message)
{
    if (message->id == FRAME_FOOT_LEFT || message->id == FRAME_FOOT_RIGHT) {
        receive_foot(sensors, message);
        return true;
    }
    const enum side leg = message->id == FRAME_LEG_STATE_RIGHT ? SIDE_RIGHT : SIDE_LEFT;
    if (message->id != FRAME_LEG_STATE_LEFT && message->id != FRAME_LEG_STATE_RIGHT) {
        return false;
    }
    const struct leg_sensor_config *config = &sensors->config[leg];
    if (message->length != config->leg_bytes + config->ankle_bytes || message->flags != 0) {
        count_malformed(sensors);
        return true;
    }
    const float raw_rad =
        (float)count_at(message->data, config->leg_bytes) * (TWO_PI / config->leg_counts_per_turn);
    const float angle_rad =
        wrap_turn((raw_rad - config->angle_zero_rad) * (float)config->angle_direction);
    const float extension_m =
        ankle_extension_m(config, count_at(message->data + config->leg_bytes, config->ankle_bytes));
    struct leg_sensor_reading *reading = &sensors->reading[leg];
    if (reading->age_ticks == 0 &&
        (reading->leg_angle_rad != angle_rad || reading->ankle_extension_m != extension_m)) {
        duplicate_id_seen(&reading->duplicate_id_count);
    }
    reading->leg_angle_rad = angle_rad;
    reading->ankle_extension_m = extension_m;
    reading->age_ticks = 0;
    return true;
}

void leg_sensors_age(struct leg_sensors *sensors)
{
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        struct leg_sensor_reading *reading = &sensors->reading[leg];
        if (reading->age_ticks > 0) {
            duplicate_id_missed(&reading->duplicate_id_count);
        }
        if (reading->age_ticks < UINT16_MAX) {
            reading->age_ticks++;
        }
        if (reading->foot_age_ticks < UINT16_MAX) {
            reading->foot_age_ticks++;
        }
        if (reading->foot_age_ticks > FOOT_AGE_MAX_TICKS) {
            reading->foot = FOOT_UNKNOWN;
        }
    }
}
