/* Maps of where a walker walks: the basin of attraction as a volume, and the plane of push-off and stiffness.
 *
 * Both are computed in chunks (sim_host/batch/chunks.h); one byte a point.
 */
#ifndef SIM_HOST_BATCH_ATLAS_H
#define SIM_HOST_BATCH_ATLAS_H

#include "sim_host/batch/chunks.h"

/* count points, both ends included; count >= 1. */
struct atlas_axis {
    double from, to;
    int32_t count;
};

/* Axes of the volume: forward apex speed rad/s, swing angle rad, swing rate rad/s. */
struct atlas_basin {
    double hip_mass_kg, leg_mass_kg, leg_length_m, ankle_stiffness_N_m, gravity_m_s2;
    double push_m, accuracy;
    struct atlas_axis speed, swing, rate;
    int32_t strides; /* 1..254 */
};
#define ATLAS_WALKS \
    255 /* still walking after all the strides; else the byte is the number of whole strides */

/* One chunk a speed: rows of swing rate, one for each swing angle. context: the struct. */
int atlas_basin_compute(void *basin, size_t chunk, void *result);
struct chunks_job atlas_basin_job(struct atlas_basin *basin, const char *path);

/* In the walker's own units: push-off r0 / l, stiffness k l / (M g), leg mass m / M. */
struct atlas_plane {
    double mass_ratio;
    struct atlas_axis push, stiffness;
};
#define ATLAS_PLANE_ROWS 32 /* stiffnesses in a chunk */
#define ATLAS_NO_GAIT 0     /* falls, or the period-1 gait was not found; 1..64: period */
#define ATLAS_APERIODIC 255 /* walks on without a period up to 64 */

/* Follows the long-period branch of period-1 gaits (stable or not) over the push-off at each stiffness. Starts a
 * walk beside each gait and stores how it ends. One chunk is ATLAS_PLANE_ROWS stiffnesses, rows of push-offs. */
int atlas_plane_compute(void *plane, size_t chunk, void *result);
struct chunks_job atlas_plane_job(struct atlas_plane *plane, const char *path);

/* Point i of an axis. */
double atlas_at(const struct atlas_axis *axis, int i);

#endif
