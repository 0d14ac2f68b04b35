#include "sim_host/plant/sensors.h"

#include <stddef.h>
#include <string.h>

#include "hal/bus/frame_table.h"
#include "model/trig.h"
#include "sim_host/plant/range.h"

static const double TURN_RAD = 6.28318530717958647692;
static const double HALF_PI = 1.57079632679489661923;

static double clamp(double x, double low, double high)
{
    return x < low ? low : (x > high ? high : x);
}

/* To the nearest integer, halves away from zero; NaN becomes 0. */
static double nearest(double x)
{
    const double limited = clamp(x, -2147483000.0, 2147483000.0);
    if (!(limited - limited == 0.0)) {
        return 0.0;
    }
    return (double)(int32_t)(limited < 0.0 ? limited - 0.5 : limited + 0.5);
}

void sensor_preset(enum sensor_preset_kind kind, struct sensor_params *params)
{
    static const struct {
        double bits, ankle_m, ankle_turn, noise_counts, latency_s;
    } PRESETS[] = {
        [SENSORS_IDEAL] = {16777216.0, 1e-5, 65536.0, 0.0, 0.0},
        [SENSORS_17BIT] = {131072.0, 1e-5, 65536.0, 1.0, 1e-4},
        [SENSORS_14BIT] = {16384.0, 5e-5, 16384.0, 1.0, 1e-4},
        [SENSORS_12BIT] = {4096.0, 2e-4, 4096.0, 1.0, 1e-4},
    };
    memset(params, 0, sizeof *params);
    params->angle_resolution_rad = TURN_RAD / PRESETS[kind].bits;
    params->angle_noise_counts = PRESETS[kind].noise_counts;
    params->angle_coloured_hz = 1.0;
    params->ankle_resolution_m = PRESETS[kind].ankle_m;
    params->ankle_resolution_rad = TURN_RAD / PRESETS[kind].ankle_turn;
    params->ankle_noise_counts = PRESETS[kind].noise_counts;
    params->latency_s = PRESETS[kind].latency_s;
    params->ankle_lever_m = 0.12;
}

bool sensor_preset_from_name(const char *name, enum sensor_preset_kind *kind)
{
    static const char *const NAMES[] = {[SENSORS_IDEAL] = "ideal",
                                        [SENSORS_17BIT] = "17bit",
                                        [SENSORS_14BIT] = "14bit",
                                        [SENSORS_12BIT] = "12bit"};
    for (size_t i = 0; i < sizeof NAMES / sizeof NAMES[0]; i++) {
        if (strcmp(name, NAMES[i]) == 0) {
            *kind = (enum sensor_preset_kind)i;
            return true;
        }
    }
    return false;
}

const char *sensor_params_check(const struct sensor_params *params)
{
    const struct range ranges[] = {
        {"angle_resolution_rad", params->angle_resolution_rad, 1e-8, 1.0},
        {"angle_noise_counts", params->angle_noise_counts, 0.0, 1e4},
        {"angle_coloured_rad", params->angle_coloured_rad, 0.0, 1.0},
        {"angle_coloured_hz", params->angle_coloured_hz, 1e-3, 500.0},
        {"angle_offset_rad", params->angle_offset_rad, -3.0, 3.0},
        {"ankle_resolution_m", params->ankle_resolution_m, 1e-8, 1.0},
        {"ankle_resolution_rad", params->ankle_resolution_rad, 1e-8, 1.0},
        {"ankle_noise_counts", params->ankle_noise_counts, 0.0, 1e4},
        {"ankle_offset_m", params->ankle_offset_m, -1.0, 1.0},
        {"latency_s", params->latency_s, 0.0, 0.005},
        {"drop_probability", params->drop_probability, 0.0, 1.0},
        {"ankle_lever_m", params->ankle_lever_m, 1e-3, 10.0},
        {"ankle_neutral_rad", params->ankle_neutral_rad, -1.5, 1.5},
    };
    return range_first_bad(ranges, sizeof ranges / sizeof ranges[0]);
}

void sensor_init(struct sensor *sensor, const struct sensor_params *params, uint64_t seed,
                 uint64_t stream)
{
    memset(sensor, 0, sizeof *sensor);
    sensor->params = *params;
    rng_init(&sensor->rng, seed, stream);
}

static void remember(struct sensor *sensor, const struct sensor_truth *truth)
{
    sensor->history_head = (sensor->history_head + 1u) % SENSOR_DELAY_TICKS;
    sensor->history[sensor->history_head] = *truth;
    if (sensor->history_count < SENSOR_DELAY_TICKS) {
        sensor->history_count++;
    }
}

static const struct sensor_truth *ticks_ago(const struct sensor *sensor, uint32_t ticks)
{
    const uint32_t oldest = sensor->history_count - 1u;
    const uint32_t back = ticks < oldest ? ticks : oldest;
    return &sensor
                ->history[(sensor->history_head + SENSOR_DELAY_TICKS - back) % SENSOR_DELAY_TICKS];
}

/* Cubic through both values and rates: exact to 1e-9 rad between ticks of a smooth
 * motion, where a straight line would be off by 1e-6. */
static double hermite(double from, double from_rate, double to, double to_rate, double tick_s,
                      double u)
{
    const double v = 1.0 - u;
    return v * v * (1.0 + 2.0 * u) * from + u * u * (1.0 + 2.0 * v) * to +
           u * v * tick_s * (v * from_rate - u * to_rate);
}

static void delayed(const struct sensor *sensor, double tick_s, double *angle_rad, double *ankle_m)
{
    const double ticks = sensor->params.latency_s / tick_s;
    const uint32_t whole = (uint32_t)ticks;
    const double part = ticks - (double)whole;
    const struct sensor_truth *late = ticks_ago(sensor, whole);
    const struct sensor_truth *later = ticks_ago(sensor, whole + 1u);
    *angle_rad = hermite(late->leg_angle_rad, -late->leg_rate_rad_s, later->leg_angle_rad,
                         -later->leg_rate_rad_s, tick_s, part);
    *ankle_m = hermite(late->ankle_extension_m, -late->ankle_rate_m_s, later->ankle_extension_m,
                       -later->ankle_rate_m_s, tick_s, part);
    if (*ankle_m < 0.0) {
        *ankle_m = 0.0; /* the cubic may swing below the heel where the ankle lands */
    }
}

/* Inverse sine through the shared inverse cosine; clamps to the lever's reach. */
static double arcsine(double x)
{
    return HALF_PI - trig_acos_f64(x);
}

static double coloured_noise(struct sensor *sensor, double tick_s)
{
    const struct sensor_params *p = &sensor->params;
    if (p->angle_coloured_rad <= 0.0) {
        return 0.0;
    }
    /* First-order low pass, exact variance for any corner: x' = c x + sqrt(1 - c^2) w. */
    const double corner = TURN_RAD * p->angle_coloured_hz * tick_s;
    const double keep = 1.0 / (1.0 + corner);
    sensor->coloured_rad = keep * sensor->coloured_rad + __builtin_sqrt(1.0 - keep * keep) *
                                                             p->angle_coloured_rad *
                                                             rng_normal(&sensor->rng);
    return sensor->coloured_rad;
}

/* Value plus noise, in whole counts of the resolution. */
static double counts_of(struct sensor *sensor, double value, double resolution, double noise_counts)
{
    const double noise = noise_counts > 0.0 ? noise_counts * rng_normal(&sensor->rng) : 0.0;
    return nearest(value / resolution + noise);
}

static void measure_angle(struct sensor *sensor, double angle_rad, double tick_s)
{
    const struct sensor_params *p = &sensor->params;
    const double seen_rad = angle_rad + p->angle_offset_rad + coloured_noise(sensor, tick_s);
    const double counts =
        counts_of(sensor, seen_rad, p->angle_resolution_rad, p->angle_noise_counts);
    const double unit_rad = TURN_RAD / (double)LEG_ANGLE_COUNTS_PER_TURN;
    const double frame =
        clamp(nearest(counts * (p->angle_resolution_rad / unit_rad)), -8388608.0, 8388607.0);
    sensor->last.leg_angle_counts = (int32_t)frame;
    sensor->last.leg_angle_rad = frame * unit_rad;
}

static void measure_ankle(struct sensor *sensor, double ankle_m)
{
    const struct sensor_params *p = &sensor->params;
    double resolution = p->ankle_resolution_m, value = ankle_m + p->ankle_offset_m;
    double unit = 1.0 / (double)ANKLE_COUNTS_PER_METRE;
    if (p->ankle_is_lever) {
        resolution = p->ankle_resolution_rad;
        value = p->ankle_neutral_rad +
                (p->ankle_table.count > 0
                     ? sea_lever_angle_rad(&p->ankle_table, p->ankle_lever_m, ankle_m)
                     : arcsine(ankle_m / p->ankle_lever_m));
        unit = TURN_RAD / (double)ANKLE_COUNTS_PER_TURN;
    }
    const double counts = counts_of(sensor, value, resolution, p->ankle_noise_counts);
    const double frame = clamp(nearest(counts * (resolution / unit)), -32768.0, 32767.0);
    sensor->last.ankle_counts = (int16_t)frame;
    sensor->last.ankle_extension_m = frame * unit;
    if (p->ankle_is_lever) {
        const double lifted_m =
            sea_lever_way_m(&p->ankle_table, p->ankle_lever_m, frame * unit - p->ankle_neutral_rad);
        sensor->last.ankle_extension_m = lifted_m > 0.0 ? lifted_m : 0.0;
    }
}

void sensor_sample(struct sensor *sensor, const struct sensor_truth *truth, double tick_s,
                   struct sensor_sample *sample)
{
    double angle_rad, ankle_m;
    remember(sensor, truth);
    if (sensor->params.drop_probability > 0.0 &&
        rng_uniform(&sensor->rng) < sensor->params.drop_probability) {
        sensor->last.sent = false;
    } else {
        delayed(sensor, tick_s, &angle_rad, &ankle_m);
        measure_angle(sensor, angle_rad, tick_s);
        measure_ankle(sensor, ankle_m);
        sensor->last.sent = true;
    }
    *sample = sensor->last;
}
