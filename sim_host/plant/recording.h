/* A recording of human walking: samples of both legs over time, loaded from a CSV file.
 *
 * The file has a header line. Columns are found by name, in any order; further columns are ignored. What
 * is kept of a row, in radians and metres:
 *   - leg angle: pitch of the virtual leg from hip to ankle with equal thigh and shank lengths,
 *     atan2(sin thigh + sin shank, cos thigh + cos shank), with the sign of the walker's theta;
 *   - plantarflexion: minus the recorded dorsiflexion;
 *   - ankle extension r = lever sin(plantarflexion - neutral), not below 0;
 *   - contact: true while the foot is on the ground; it tells heel strike and toe-off.
 */
#ifndef SIM_HOST_PLANT_RECORDING_H
#define SIM_HOST_PLANT_RECORDING_H

#include <stdbool.h>
#include <stddef.h>

#include "model/side.h"
#include "sim_host/plant/sea_config.h"

enum { RECORDING_NAME_MAX = 64, RECORDING_ERROR_MAX = 512 };

/* How a leg's device sees its ankle: extension = way of the lever over plantarflexion less neutral. */
struct recording_ankle {
    double lever_m;               /* default 0.12 */
    double neutral_rad;           /* plantarflexion at r = 0; default 0 */
    struct sea_table lever_table; /* in lever_m's place, over plantarflexion from neutral */
};

/* Names of the columns, and how to read them. An empty name says that the file has no such column. Without
 * time, sample_rate_hz counts; without contact, there are no contacts; without an ankle, its extension
 * stays 0. Thigh and shank must be there. */
struct recording_format {
    char time_column[RECORDING_NAME_MAX];
    char thigh_column[SIDE_COUNT][RECORDING_NAME_MAX];
    char shank_column[SIDE_COUNT][RECORDING_NAME_MAX];
    char ankle_column[SIDE_COUNT][RECORDING_NAME_MAX];
    char contact_column[SIDE_COUNT][RECORDING_NAME_MAX];
    double sample_rate_hz;                    /* used without a time column */
    double angle_unit_rad;                    /* of all angles: 1, or pi / 180 (the default) */
    struct recording_ankle ankle[SIDE_COUNT]; /* what the device has there */
    double largest_gap_s; /* a longer one between samples is an error; default 0.15 */
};

struct recording_sample {
    double time_s;
    double leg_angle_rad[SIDE_COUNT];
    double ankle_m[SIDE_COUNT];
    double plantarflexion_rad[SIDE_COUNT];
    bool contact[SIDE_COUNT];
};

struct recording {
    struct recording_sample *samples; /* owned; ascending in time, first at time 0 */
    size_t count;                     /* >= 2 after a successful load */
    double start_s; /* the first sample's time in the file; 0 without a time column */
    bool has_contact;
};

enum recording_error {
    RECORDING_OK = 0,
    RECORDING_CANNOT_READ = -1, /* file missing, unreadable, or too big (1 GB) */
    RECORDING_NO_MEMORY = -2,
    RECORDING_BAD_HEADER = -3, /* a named column is missing or there twice */
    RECORDING_BAD_VALUE =
        -4, /* not a number, not finite, angle beyond 180 degrees, contact not 0 or 1 */
    RECORDING_BAD_ROW = -5,   /* too few or too many columns */
    RECORDING_BAD_TIME = -6,  /* not ascending, or a gap beyond largest_gap_s */
    RECORDING_TOO_SHORT = -7, /* fewer than two rows */
    RECORDING_BAD_FORMAT = -8 /* format itself: rate, lever, gap out of range */
};

/* The names and units of the project's own recordings. */
void recording_format_default(struct recording_format *format);

/* Extension of an ankle at this plantarflexion, m. Cost O(1). */
double recording_ankle_m(const struct recording_ankle *ankle, double plantarflexion_rad);

/* Largest minus smallest leg angle, of the leg that moves more, rad: shows whether the angles' unit is
 * plausible. Cost O(samples). */
double recording_span_rad(const struct recording *recording);

/* Loads path. On failure nothing is allocated, *recording is empty and message (RECORDING_ERROR_MAX bytes)
 * says what is wrong, with line and column. The caller frees a loaded recording. Not for the control loop:
 * uses the heap and the file system. Cost O(file). */
enum recording_error recording_load(struct recording *recording, const char *path,
                                    const struct recording_format *format, char *message);
/* Gives the samples back; *recording is empty then. Also for an empty one. */
void recording_free(struct recording *recording);

#endif
