/* JSON, member by member, onto a stream: commas, quotes and escapes are its own, and a number that is
 * none (NaN, infinity) becomes null, so that what it writes can always be read.
 *
 * Plain types only: callable from code of either precision. Errors stay in the stream.
 */
#ifndef SIM_HOST_CLI_JSON_WRITER_H
#define SIM_HOST_CLI_JSON_WRITER_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

struct json_writer {
    FILE *stream;
    bool is_first;    /* in its object or list */
    const char *line; /* begins the next member on a line of its own; NULL = on the same */
};

void json_begin(struct json_writer *json, FILE *stream);

/* An object or a list; key: NULL within a list and at the top. */
void json_open_object(struct json_writer *json, const char *key);
void json_open_list(struct json_writer *json, const char *key);
void json_close_object(struct json_writer *json);
void json_close_list(struct json_writer *json);

/* A value. text NULL writes null. */
void json_text(struct json_writer *json, const char *key, const char *text);
void json_bool(struct json_writer *json, const char *key, bool value);
void json_null(struct json_writer *json, const char *key);
void json_unsigned(struct json_writer *json, const char *key, uint64_t value);
void json_integer(struct json_writer *json, const char *key, int64_t value);

/* A number with so many significant digits, or with so many decimals. */
void json_number(struct json_writer *json, const char *key, double value, int digits);
void json_fixed(struct json_writer *json, const char *key, double value, int decimals);

/* The next member, or the end of the object or list, begins with this text ("\n" and an indent), which
 * must stay readable until then. */
void json_break(struct json_writer *json, const char *line);

/* Ends the line behind the outermost object. */
void json_end(struct json_writer *json);

#endif
