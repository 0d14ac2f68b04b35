/* A CSV file in memory, read line by line and field by field. Nothing is known of what it means.
 *
 * Fields are separated by commas; blanks and quotes around a field are not part of it, and a quoted
 * field must hold no comma. Lines end with LF or CR LF, empty ones are passed over.
 */
#ifndef SIM_HOST_PLANT_CSV_TEXT_H
#define SIM_HOST_PLANT_CSV_TEXT_H

#include <stdbool.h>
#include <stddef.h>

enum csv_text_error {
    CSV_TEXT_OK = 0,
    CSV_TEXT_CANNOT_READ = -1, /* file missing, unreadable, or larger than 1 GB */
    CSV_TEXT_NO_MEMORY = -2
};

struct csv_text {
    char *text; /* owned, zero-terminated */
    size_t bytes;
    const char *at;
    size_t line; /* of *at, from 1 */
};

/* A field: [begin, end) in the text. */
struct csv_field {
    const char *begin, *end;
};

/* Reads the whole file and stands at its beginning, behind a byte order mark. On failure nothing is held
 * and *why says what is wrong. Cost O(file). */
enum csv_text_error csv_text_read(struct csv_text *csv, const char *path, const char **why);
void csv_text_free(struct csv_text *csv);

/* Goes to the next line that has anything in it; false at the end of the text. */
bool csv_text_next_line(struct csv_text *csv);

/* The next field of the line; *more tells whether a comma followed. */
struct csv_field csv_text_next_field(struct csv_text *csv, bool *more);

bool csv_field_is(struct csv_field field, const char *text);

/* False when a zero byte ended the text before the file's end: it is not a text file. */
bool csv_text_is_whole(const struct csv_text *csv);

#endif
