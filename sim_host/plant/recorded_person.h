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
 * wearer_load() is the only place of the plant that uses the heap and the file
 * system; wearer_free() gives all back. Playing back is O(1) per tick on average.
 */
#ifndef SIM_HOST_PLANT_RECORDED_PERSON_H
#define SIM_HOST_PLANT_RECORDED_PERSON_H

#include <stdbool.h>
#include <stddef.h>

#include "model/side.h"

enum { WEARER_NAME_MAX = 64, WEARER_ERROR_MAX = 512 };

/* Names of the columns and how to read them; wearer_format_default() gives the
 * names of the project's recordings. An empty name: not there (time: use
 * sample_rate_hz; contact: none; ankle: extension stays 0). */
struct wearer_format {
    char time_column[WEARER_NAME_MAX];
    char thigh_column[SIDE_COUNT][WEARER_NAME_MAX];
    char shank_column[SIDE_COUNT][WEARER_NAME_MAX];
    char ankle_column[SIDE_COUNT][WEARER_NAME_MAX];
    char contact_column[SIDE_COUNT][WEARER_NAME_MAX];
    double sample_rate_hz;    /* used without a time column */
    double angle_unit_rad;    /* of all angles: 1, or pi / 180 (the default) */
    double ankle_lever_m;     /* default 0.12 */
    double ankle_neutral_rad; /* plantarflexion at r = 0; default 0 */
    double largest_gap_s;     /* a longer one between samples is an error; default 0.1 */
};

struct wearer_sample {
    double time_s;
    double leg_angle_rad[SIDE_COUNT];
    double ankle_m[SIDE_COUNT];
    double plantarflexion_rad[SIDE_COUNT];
    bool contact[SIDE_COUNT];
};

struct wearer {
    struct wearer_sample *samples; /* owned; ascending in time, first at time 0 */
    size_t count;                  /* >= 2 after a successful load */
    double start_s; /* the first sample's time in the file; 0 without a time column */
    bool has_contact;
};

/* The person at one moment. Rates are the interpolation's. */
struct wearer_state {
    double leg_angle_rad[SIDE_COUNT];
    double leg_rate_rad_s[SIDE_COUNT];
    double ankle_m[SIDE_COUNT];
    double ankle_rate_m_s[SIDE_COUNT];
    bool contact[SIDE_COUNT];
    bool finished; /* time is past the last sample, which is held */
};

enum wearer_error {
    WEARER_OK = 0,
    WEARER_CANNOT_READ = -1, /* file missing, unreadable, or too big (1 GB) */
    WEARER_NO_MEMORY = -2,
    WEARER_BAD_HEADER = -3, /* a named column is missing or there twice */
    WEARER_BAD_VALUE =
        -4, /* not a number, not finite, angle beyond 180 degrees, contact not 0 or 1 */
    WEARER_BAD_ROW = -5,   /* too few or too many columns */
    WEARER_BAD_TIME = -6,  /* not ascending, or a gap beyond largest_gap_s */
    WEARER_TOO_SHORT = -7, /* fewer than two rows */
    WEARER_BAD_FORMAT = -8 /* format itself: rate, lever, gap out of range */
};

void wearer_format_default(struct wearer_format *format);

/* How far the leg that moves more has moved in all, rad: a plausibility check of the
 * angles' unit. Cost O(samples). */
double wearer_span_rad(const struct wearer *wearer);

/* Loads path. On failure nothing is allocated, *wearer is empty and message
 * (WEARER_ERROR_MAX bytes) says what, with line and column. Cost O(file). */
enum wearer_error wearer_load(struct wearer *wearer, const char *path,
                              const struct wearer_format *format, char *message);
void wearer_free(struct wearer *wearer);

/* The person time_s after the first sample (before it: the first sample).
 * *cursor remembers the place; start it at 0 and pass it back. */
void wearer_at(const struct wearer *wearer, double time_s, size_t *cursor,
               struct wearer_state *state);

#endif
