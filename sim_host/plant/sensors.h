/* One leg's sensor: leg angle and ankle extension as a node would send them.
 *
 * At every SYNC the true state goes in and a sample comes out. It is delayed by latency_s
 * (interpolated between the ticks), has offset and noise, and is quantised to the sensor's own
 * resolution. Its units are the frame's (hal/bus/frame_table.h): 2*pi/2^24 rad; 10 um, or 2*pi/2^16 rad
 * for a lever ankle.
 *
 * No heap, no globals; O(1); plain data, a copy is a snapshot; same seed, same
 * samples on every machine.
 */
#ifndef SIM_HOST_PLANT_SENSORS_H
#define SIM_HOST_PLANT_SENSORS_H

#include <stdbool.h>
#include <stdint.h>

#include "sim_host/plant/sea_config.h"
#include "sim_host/random/rng.h"

struct sensor_params {
    double angle_resolution_rad; /* > 0 */
    double angle_noise_counts;   /* white, RMS, in counts of the resolution above */
    double angle_coloured_rad;   /* first-order (Gauss-Markov) noise, RMS */
    double angle_coloured_hz;    /* its corner, > 0 where the RMS is > 0 */
    double angle_offset_rad;     /* mounting: measured = true + this */
    double ankle_resolution_m;   /* linear ankle, > 0 */
    double ankle_resolution_rad; /* lever ankle, > 0 */
    double ankle_noise_counts;
    double ankle_offset_m;   /* linear; a lever ankle has its neutral angle */
    double latency_s;        /* 0 .. 5 ms */
    double drop_probability; /* a sample that is not sent, 0 .. 1 */
    bool ankle_is_lever;     /* r = lever sin(plantarflexion - neutral), not below 0 */
    double ankle_lever_m;
    double ankle_neutral_rad;
    struct sea_table ankle_table; /* in ankle_lever_m's place; count 0: none */
};

enum sensor_preset_kind {
    SENSORS_IDEAL = 0,
    SENSORS_17BIT = 1,
    SENSORS_14BIT = 2,
    SENSORS_12BIT = 3
};

/* Fills every field. All presets have a linear ankle, no offset, no coloured noise and no drops. Choose
 * a lever ankle afterwards by ankle_is_lever.
 *            angle res.   angle noise  ankle res.        ankle noise  latency
 *   ideal    2*pi/2^24    0            10 um / 2*pi/2^16 0            0
 *   17bit    2*pi/2^17    1 count      10 um / 2*pi/2^16 1 count      0.1 ms
 *   14bit    2*pi/2^14    1 count      50 um / 2*pi/2^14 1 count      0.1 ms
 *   12bit    2*pi/2^12    1 count      200 um/ 2*pi/2^12 1 count      0.1 ms  */
void sensor_preset(enum sensor_preset_kind kind, struct sensor_params *params);
/* "ideal", "17bit", "14bit", "12bit" -> kind; false for any other name. */
bool sensor_preset_from_name(const char *name, enum sensor_preset_kind *kind);
/* NULL if every field is in range, else the name of the first that is not. */
const char *sensor_params_check(const struct sensor_params *params);

/* What the sensor would see if it were perfect. */
struct sensor_truth {
    double leg_angle_rad;
    double leg_rate_rad_s;
    double ankle_extension_m;
    double ankle_rate_m_s;
};

struct sensor_sample {
    bool sent;                /* false: dropped, the rest is the last sample sent */
    int32_t leg_angle_counts; /* 2*pi/2^24 rad, saturating at 24 bits */
    int16_t ankle_counts;     /* 10 um, or 2*pi/2^16 rad, saturating */
    double leg_angle_rad;     /* the same values in SI, for tests and logs */
    double ankle_extension_m; /* through the lever equation, if a lever */
};

enum { SENSOR_DELAY_TICKS = 8 };

struct sensor {
    struct sensor_params params;
    struct rng rng;
    struct sensor_truth history[SENSOR_DELAY_TICKS];
    uint32_t history_count; /* how many are filled */
    uint32_t history_head;  /* index of the newest */
    double coloured_rad;
    struct sensor_sample last;
};

/* Params are copied and must have passed sensor_params_check(). */
void sensor_init(struct sensor *sensor, const struct sensor_params *params, uint64_t seed,
                 uint64_t stream);
/* One SYNC: takes the truth, gives the sample. tick_s is the SYNC period. Before
 * enough history exists, the oldest truth is used. */
void sensor_sample(struct sensor *sensor, const struct sensor_truth *truth, double tick_s,
                   struct sensor_sample *sample);

#endif
