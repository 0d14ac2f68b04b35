#include "sim_host/plant/recording.h"

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "model/trig.h"
#include "sim_host/plant/csv_text.h"
#include "sim_host/plant/range.h"

static const double HALF_TURN_RAD = 3.14159265358979323846;

enum column {
    TIME,
    THIGH_L,
    THIGH_R,
    SHANK_L,
    SHANK_R,
    ANKLE_L,
    ANKLE_R,
    CONTACT_L,
    CONTACT_R,
    COLUMN_COUNT
};

enum { ABSENT = -1, SHOWN_CHARACTERS = 40 };

struct reader {
    const char *path;
    const struct recording_format *format;
    struct csv_text csv;
    long index[COLUMN_COUNT]; /* place of each column in a row, or ABSENT */
    long columns;             /* per row */
    struct recording *recording;
    size_t capacity;
    char *message;
};

static const char *column_name(const struct recording_format *format, int column)
{
    switch ((enum column)column) {
    case TIME:
        return format->time_column;
    case THIGH_L:
    case THIGH_R:
        return format->thigh_column[column - THIGH_L];
    case SHANK_L:
    case SHANK_R:
        return format->shank_column[column - SHANK_L];
    case ANKLE_L:
    case ANKLE_R:
        return format->ankle_column[column - ANKLE_L];
    case CONTACT_L:
    case CONTACT_R:
        return format->contact_column[column - CONTACT_L];
    case COLUMN_COUNT:
        break;
    }
    return "";
}

static enum recording_error fail_at(const struct reader *reader, enum recording_error error,
                                    long column, const char *what)
{
    if (column >= 0) {
        (void)snprintf(reader->message, RECORDING_ERROR_MAX, "%.200s: line %zu, column %ld: %.200s",
                       reader->path, reader->csv.line, column + 1, what);
    } else {
        (void)snprintf(reader->message, RECORDING_ERROR_MAX, "%.200s: line %zu: %.200s",
                       reader->path, reader->csv.line, what);
    }
    return error;
}

void recording_format_default(struct recording_format *format)
{
    *format = (struct recording_format){
        .time_column = "time_s",
        .thigh_column = {"thigh_l_deg", "thigh_r_deg"},
        .shank_column = {"shank_l_deg", "shank_r_deg"},
        .ankle_column = {"ankle_l_deg", "ankle_r_deg"},
        .contact_column = {"contact_l", "contact_r"},
        .sample_rate_hz = 200.0,
        .angle_unit_rad = 3.14159265358979323846 / 180.0,
        .ankle = {{.lever_m = 0.12}, {.lever_m = 0.12}},
        .largest_gap_s = 0.15,
    };
}

static enum recording_error check_format(const struct recording_format *format, char *message)
{
    const struct range ranges[] = {
        {"sample_rate_hz", format->sample_rate_hz, 1.0, 1e5},
        {"left ankle's lever_m", format->ankle[SIDE_LEFT].lever_m, 1e-3, 10.0},
        {"right ankle's lever_m", format->ankle[SIDE_RIGHT].lever_m, 1e-3, 10.0},
        {"left ankle's neutral_rad", format->ankle[SIDE_LEFT].neutral_rad, -1.5, 1.5},
        {"right ankle's neutral_rad", format->ankle[SIDE_RIGHT].neutral_rad, -1.5, 1.5},
        {"largest_gap_s", format->largest_gap_s, 1e-5, 1e3},
        {"angle_unit_rad", format->angle_unit_rad, 1e-6, 1.0},
    };
    const char *bad = range_first_bad(ranges, sizeof ranges / sizeof ranges[0]);
    for (int column = THIGH_L; column <= SHANK_R && bad == NULL; column++) {
        if (column_name(format, column)[0] == '\0') {
            bad = "a thigh or shank column's name (empty)";
        }
    }
    if (bad == NULL) {
        return RECORDING_OK;
    }
    (void)snprintf(message, RECORDING_ERROR_MAX, "recording's format: %s is out of range", bad);
    return RECORDING_BAD_FORMAT;
}

static enum recording_error read_file(struct reader *reader)
{
    const char *why;
    const enum csv_text_error error = csv_text_read(&reader->csv, reader->path, &why);
    if (error == CSV_TEXT_OK) {
        return RECORDING_OK;
    }
    (void)snprintf(reader->message, RECORDING_ERROR_MAX, "%.200s: %.200s", reader->path, why);
    return error == CSV_TEXT_NO_MEMORY ? RECORDING_NO_MEMORY : RECORDING_CANNOT_READ;
}

static enum recording_error read_header(struct reader *reader)
{
    char what[RECORDING_NAME_MAX + 64];
    bool more = true;
    for (int column = 0; column < COLUMN_COUNT; column++) {
        reader->index[column] = ABSENT;
    }
    if (!csv_text_next_line(&reader->csv)) {
        return fail_at(reader, RECORDING_BAD_HEADER, ABSENT, "the file is empty");
    }
    for (; more; reader->columns++) {
        const struct csv_field field = csv_text_next_field(&reader->csv, &more);
        for (int column = 0; column < COLUMN_COUNT; column++) {
            const char *name = column_name(reader->format, column);
            if (name[0] == '\0' || !csv_field_is(field, name)) {
                continue;
            }
            if (reader->index[column] != ABSENT) {
                (void)snprintf(what, sizeof what, "column '%s' is there twice", name);
                return fail_at(reader, RECORDING_BAD_HEADER, reader->columns, what);
            }
            reader->index[column] = reader->columns;
        }
    }
    for (int column = 0; column < COLUMN_COUNT; column++) {
        const char *name = column_name(reader->format, column);
        if (name[0] != '\0' && reader->index[column] == ABSENT) {
            (void)snprintf(what, sizeof what, "no column named '%s'", name);
            return fail_at(reader, RECORDING_BAD_HEADER, ABSENT, what);
        }
    }
    return RECORDING_OK;
}

static bool is_contact(int column)
{
    return column == CONTACT_L || column == CONTACT_R;
}

static enum recording_error read_value(const struct reader *reader, struct csv_field field,
                                       int column, long place, double *value)
{
    char text[SHOWN_CHARACTERS], what[SHOWN_CHARACTERS + 80];
    char *end;
    const size_t length = (size_t)(field.end - field.begin);
    const size_t kept = length < sizeof text ? length : sizeof text - 1;
    memcpy(text, field.begin, kept);
    text[kept] = '\0';
    *value = strtod(text, &end);
    const char *wrong = NULL;
    if (length == 0 || length >= sizeof text || *end != '\0' || !(*value - *value == 0.0)) {
        wrong = "is not a number";
    } else if (is_contact(column) && *value != 0.0 && *value != 1.0) {
        wrong = "is not a contact (0 or 1)";
    } else if (column != TIME && !is_contact(column) &&
               !(*value * reader->format->angle_unit_rad >= -HALF_TURN_RAD &&
                 *value * reader->format->angle_unit_rad <= HALF_TURN_RAD)) {
        wrong = "is not an angle (-180 to 180 degrees)";
    }
    if (wrong == NULL) {
        return RECORDING_OK;
    }
    (void)snprintf(what, sizeof what, "'%s' %s", text, wrong);
    return fail_at(reader, RECORDING_BAD_VALUE, place, what);
}

static enum recording_error read_row(struct reader *reader, double values[COLUMN_COUNT])
{
    bool more = true;
    long place = 0;
    for (; more; place++) {
        const struct csv_field field = csv_text_next_field(&reader->csv, &more);
        for (int column = 0; column < COLUMN_COUNT; column++) {
            if (reader->index[column] != place) {
                continue;
            }
            const enum recording_error error =
                read_value(reader, field, column, place, &values[column]);
            if (error != RECORDING_OK) {
                return error;
            }
        }
    }
    if (place != reader->columns) {
        char what[80];
        (void)snprintf(what, sizeof what, "%ld columns where the header has %ld", place,
                       reader->columns);
        return fail_at(reader, RECORDING_BAD_ROW, ABSENT, what);
    }
    return RECORDING_OK;
}

static enum recording_error make_room(struct reader *reader)
{
    struct recording *recording = reader->recording;
    if (recording->count < reader->capacity) {
        return RECORDING_OK;
    }
    const size_t wanted = reader->capacity == 0 ? 4096 : 2 * reader->capacity;
    struct recording_sample *grown = wanted > SIZE_MAX / sizeof *grown
                                         ? NULL
                                         : realloc(recording->samples, wanted * sizeof *grown);
    if (grown == NULL) {
        return fail_at(reader, RECORDING_NO_MEMORY, ABSENT, "not enough memory");
    }
    recording->samples = grown;
    reader->capacity = wanted;
    return RECORDING_OK;
}

/* Time since the first row; *origin_s is that row's own. */
static enum recording_error row_time(struct reader *reader, const double values[COLUMN_COUNT],
                                     double *origin_s, double *time_s)
{
    const struct recording *recording = reader->recording;
    if (reader->index[TIME] == ABSENT) {
        *time_s = (double)recording->count / reader->format->sample_rate_hz;
        return RECORDING_OK;
    }
    if (recording->count == 0) {
        *origin_s = values[TIME];
    }
    *time_s = values[TIME] - *origin_s;
    if (recording->count > 0) {
        const double gap_s = *time_s - recording->samples[recording->count - 1].time_s;
        if (!(gap_s > 0.0)) {
            return fail_at(reader, RECORDING_BAD_TIME, reader->index[TIME], "time does not ascend");
        }
        if (gap_s > reader->format->largest_gap_s) {
            return fail_at(reader, RECORDING_BAD_TIME, reader->index[TIME],
                           "too long a gap since the row before");
        }
    }
    return RECORDING_OK;
}

double recording_ankle_m(const struct recording_ankle *ankle, double plantarflexion_rad)
{
    const double lifted_m = sea_lever_way_m(&ankle->lever_table, ankle->lever_m,
                                            plantarflexion_rad - ankle->neutral_rad);
    return lifted_m > 0.0 ? lifted_m : 0.0;
}

static enum recording_error fill_sample(const struct reader *reader,
                                        const double values[COLUMN_COUNT],
                                        struct recording_sample *sample)
{
    for (int side = 0; side < SIDE_COUNT; side++) {
        const double unit_rad = reader->format->angle_unit_rad;
        const struct recording_ankle *ankle = &reader->format->ankle[side];
        const double thigh_rad = values[THIGH_L + side] * unit_rad;
        const double shank_rad = values[SHANK_L + side] * unit_rad;
        const double knee_rad = thigh_rad - shank_rad;
        if (!(knee_rad > -HALF_TURN_RAD && knee_rad < HALF_TURN_RAD)) {
            return fail_at(reader, RECORDING_BAD_VALUE, reader->index[SHANK_L + side],
                           "thigh and shank point in opposite directions: no leg pitch");
        }
        /* The sum of two unit vectors points half way between them: this is
         * atan2(sin thigh + sin shank, cos thigh + cos shank). */
        sample->leg_angle_rad[side] = 0.5 * (thigh_rad + shank_rad);
        sample->plantarflexion_rad[side] = -values[ANKLE_L + side] * unit_rad;
        const bool has_ankle = reader->index[ANKLE_L + side] != ABSENT;
        sample->ankle_m[side] =
            has_ankle ? recording_ankle_m(ankle, sample->plantarflexion_rad[side]) : 0.0;
        sample->contact[side] = values[CONTACT_L + side] != 0.0;
    }
    return RECORDING_OK;
}

static enum recording_error read_rows(struct reader *reader)
{
    double origin_s = 0.0;
    while (csv_text_next_line(&reader->csv)) {
        double values[COLUMN_COUNT] = {0.0};
        struct recording_sample sample = {0};
        enum recording_error error = make_room(reader);
        if (error == RECORDING_OK) {
            error = read_row(reader, values);
        }
        if (error == RECORDING_OK) {
            error = row_time(reader, values, &origin_s, &sample.time_s);
        }
        if (error == RECORDING_OK) {
            error = fill_sample(reader, values, &sample);
        }
        if (error != RECORDING_OK) {
            return error;
        }
        reader->recording->samples[reader->recording->count++] = sample;
    }
    reader->recording->start_s = origin_s;
    if (!csv_text_is_whole(&reader->csv)) {
        return fail_at(reader, RECORDING_BAD_VALUE, ABSENT, "a zero byte: this is not a text file");
    }
    if (reader->recording->count < 2) {
        return fail_at(reader, RECORDING_TOO_SHORT, ABSENT, "fewer than two rows of data");
    }
    return RECORDING_OK;
}

enum recording_error recording_load(struct recording *recording, const char *path,
                                    const struct recording_format *format, char *message)
{
    struct reader reader = {
        .path = path, .format = format, .recording = recording, .message = message};
    *recording = (struct recording){0};
    message[0] = '\0';
    enum recording_error error = check_format(format, message);
    if (error == RECORDING_OK) {
        error = read_file(&reader);
    }
    if (error == RECORDING_OK) {
        error = read_header(&reader);
    }
    if (error == RECORDING_OK) {
        error = read_rows(&reader);
    }
    recording->has_contact = reader.index[CONTACT_L] != ABSENT && reader.index[CONTACT_R] != ABSENT;
    csv_text_free(&reader.csv);
    if (error != RECORDING_OK) {
        recording_free(recording);
    }
    return error;
}

void recording_free(struct recording *recording)
{
    free(recording->samples);
    *recording = (struct recording){0};
}

double recording_span_rad(const struct recording *recording)
{
    double widest_rad = 0.0;
    for (int side = 0; side < SIDE_COUNT && recording->count > 0; side++) {
        double low = recording->samples[0].leg_angle_rad[side], high = low;
        for (size_t i = 1; i < recording->count; i++) {
            const double angle = recording->samples[i].leg_angle_rad[side];
            low = angle < low ? angle : low;
            high = angle > high ? angle : high;
        }
        widest_rad = high - low > widest_rad ? high - low : widest_rad;
    }
    return widest_rad;
}
