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
        sensors->reading[leg].leg_age_ticks = sensors->reading[leg].ankle_age_ticks = UINT16_MAX;
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

/* The way of the spring's end from neutral to this plantarflexion: the lever is a broken line, so the
 * trapezium is exact. Not below 0. */
static float table_way_m(const struct leg_sensor_config *config, float angle_rad)
{
    const float step_rad = config->ankle_table_rad;
    float way_m = 0.0f, lever_m = config->ankle_lever_m, left_rad = angle_rad;
    for (int i = 0; i < LEG_SENSOR_LEVERS && left_rad > 0.0f; i++) {
        const float next_m = config->ankle_table_m[i];
        const float part = left_rad < step_rad ? left_rad / step_rad : 1.0f;
        const float end_m = lever_m + part * (next_m - lever_m);
        way_m += 0.5f * part * step_rad * (lever_m + end_m);
        left_rad -= step_rad;
        lever_m = next_m;
    }
    return left_rad > 0.0f ? way_m + left_rad * lever_m : way_m;
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
    const float bent_rad = plantarflexion_rad - config->ankle_neutral_rad;
    const float extension = config->ankle_table_rad > 0.0f
                                ? table_way_m(config, bent_rad)
                                : config->ankle_lever_m * small_sin(bent_rad);
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

/* Both of a leg have one age: the older one's. */
static void combine_ages(struct leg_sensor_reading *reading)
{
    reading->age_ticks = reading->leg_age_ticks > reading->ankle_age_ticks
                             ? reading->leg_age_ticks
                             : reading->ankle_age_ticks;
}

/* A second, different answer in a cycle. */
static void notice_another(struct leg_sensor_reading *reading, bool differs)
{
    if (differs) {
        duplicate_id_seen(&reading->duplicate_id_count);
    }
}

static void take_angle(struct leg_sensor_reading *reading, const struct leg_sensor_config *config,
                       const uint8_t *from)
{
    const float raw_rad =
        (float)count_at(from, config->leg_bytes) * (TWO_PI / config->leg_counts_per_turn);
    const float angle_rad =
        wrap_turn((raw_rad - config->angle_zero_rad) * (float)config->angle_direction);
    notice_another(reading, reading->leg_age_ticks == 0 && reading->leg_angle_rad != angle_rad);
    reading->leg_angle_rad = angle_rad;
    reading->leg_age_ticks = 0;
}

static void take_ankle(struct leg_sensor_reading *reading, const struct leg_sensor_config *config,
                       const uint8_t *from)
{
    const float extension_m = ankle_extension_m(config, count_at(from, config->ankle_bytes));
    notice_another(reading,
                   reading->ankle_age_ticks == 0 && reading->ankle_extension_m != extension_m);
    reading->ankle_extension_m = extension_m;
    reading->ankle_age_ticks = 0;
}

static void receive_ankle(struct leg_sensors *sensors, const struct can_msg *message, enum side leg)
{
    const struct leg_sensor_config *config = &sensors->config[leg];
    if (message->length != config->ankle_bytes || message->flags != 0) {
        count_malformed(sensors);
        return;
    }
    take_ankle(&sensors->reading[leg], config, message->data);
    combine_ages(&sensors->reading[leg]);
}

static void receive_leg(struct leg_sensors *sensors, const struct can_msg *message, enum side leg)
{
    const struct leg_sensor_config *config = &sensors->config[leg];
    struct leg_sensor_reading *reading = &sensors->reading[leg];
    const unsigned ankle_bytes = config->ankle_is_apart ? 0u : config->ankle_bytes;
    if (message->length != config->leg_bytes + ankle_bytes || message->flags != 0) {
        count_malformed(sensors);
        return;
    }
    const int8_t before = reading->duplicate_id_count;
    take_angle(reading, config, message->data);
    if (!config->ankle_is_apart) {
        if (reading->duplicate_id_count != before) {
            reading->ankle_age_ticks = UINT16_MAX; /* one frame counts once */
        }
        take_ankle(reading, config, message->data + config->leg_bytes);
    }
    combine_ages(reading);
}

bool leg_sensors_receive(struct leg_sensors *sensors, const struct can_msg *message)
{
    switch (message->id) {
    case FRAME_FOOT_LEFT:
    case FRAME_FOOT_RIGHT:
        receive_foot(sensors, message);
        return true;
    case FRAME_LEG_STATE_LEFT:
    case FRAME_LEG_STATE_RIGHT:
        receive_leg(sensors, message,
                    message->id == FRAME_LEG_STATE_RIGHT ? SIDE_RIGHT : SIDE_LEFT);
        return true;
    case FRAME_ANKLE_STATE_LEFT:
    case FRAME_ANKLE_STATE_RIGHT: {
        const enum side leg = message->id == FRAME_ANKLE_STATE_RIGHT ? SIDE_RIGHT : SIDE_LEFT;
        if (!sensors->config[leg].ankle_is_apart) {
            return false;
        }
        receive_ankle(sensors, message, leg);
        return true;
    }
    default:
        return false;
    }
}

static void grow_older(uint16_t *age_ticks)
{
    if (*age_ticks < UINT16_MAX) {
        (*age_ticks)++;
    }
}

void leg_sensors_age(struct leg_sensors *sensors)
{
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        struct leg_sensor_reading *reading = &sensors->reading[leg];
        if (reading->age_ticks > 0) {
            duplicate_id_missed(&reading->duplicate_id_count, reading->age_ticks);
        }
        grow_older(&reading->leg_age_ticks);
        grow_older(&reading->ankle_age_ticks);
        combine_ages(reading);
        if (reading->foot_age_ticks < UINT16_MAX) {
            reading->foot_age_ticks++;
        }
        if (reading->foot_age_ticks > FOOT_AGE_MAX_TICKS) {
            reading->foot = FOOT_UNKNOWN;
        }
    }
}
