/* Recorded human walking, played back in the walker's place.
 *
 * A CSV file with a header line; columns by name (any order, further columns are
 * ignored). Leg pitch is that of the virtual leg from hip to ankle with equal
 * thigh and shank lengths, atan2(sin thigh + sin shank, cos thigh + cos shank),
 * which has the sign of the walker's theta. Ankle extension is
 * r = lever sin(plantarflexion - neutral), not below 0; plantarflexion is minus
 * the recorded dorsiflexion. Contact columns are the ground truth for heel
 * strike and toe-off. Between samples: cubic (Catmull-Rom) interpolation of
 * the angles; contact is held.
 *
 * recording_load() is the only place of the plant that uses the heap and the file
 * system; recording_free() gives all back. Playing back is O(1) per tick on average.
 */
#ifndef SIM_HOST_PLANT_RECORDED_PERSON_H
#define SIM_HOST_PLANT_RECORDED_PERSON_H

#include <stdbool.h>
#include <stddef.h>

#include "model/side.h"

enum { RECORDING_NAME_MAX = 64, RECORDING_ERROR_MAX = 512 };

/* Names of the columns and how to read them; recording_format_default() gives the
 * names of the project's recordings. An empty name: not there (time: use
 * sample_rate_hz; contact: none; ankle: extension stays 0). */
struct recording_format {
    char time_column[RECORDING_NAME_MAX];
    char thigh_column[SIDE_COUNT][RECORDING_NAME_MAX];
    char shank_column[SIDE_COUNT][RECORDING_NAME_MAX];
    char ankle_column[SIDE_COUNT][RECORDING_NAME_MAX];
    char contact_column[SIDE_COUNT][RECORDING_NAME_MAX];
    double sample_rate_hz;    /* used without a time column */
    double angle_unit_rad;    /* of all angles: 1, or pi / 180 (the default) */
    double ankle_lever_m;     /* default 0.12 */
    double ankle_neutral_rad; /* plantarflexion at r = 0; default 0 */
    double largest_gap_s;     /* a longer one between samples is an error; default 0.1 */
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

/* The person at one moment. Rates are the interpolation's. */
struct recorded_person_state {
    double leg_angle_rad[SIDE_COUNT];
    double leg_rate_rad_s[SIDE_COUNT];
    double ankle_m[SIDE_COUNT];
    double ankle_rate_m_s[SIDE_COUNT];
    bool contact[SIDE_COUNT];
    bool finished; /* time is past the last sample, which is held */
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

void recording_format_default(struct recording_format *format);

/* How far the leg that moves more has moved in all, rad: a plausibility check of the
 * angles' unit. Cost O(samples). */
double recording_span_rad(const struct recording *recording);

/* Loads path. On failure nothing is allocated, *recording is empty and message
 * (RECORDING_ERROR_MAX bytes) says what, with line and column. Cost O(file). */
enum recording_error recording_load(struct recording *recording, const char *path,
                                    const struct recording_format *format, char *message);
void recording_free(struct recording *recording);

/* The person time_s after the first sample (before it: the first sample).
 * *cursor remembers the place; start it at 0 and pass it back. */
void recorded_person_at(const struct recording *recording, double time_s, size_t *cursor,
                        struct recorded_person_state *state);

#endif
