#include "sim_host/cli/json_writer.h"

#include <inttypes.h>
#include <math.h>
#include <stddef.h>

void json_begin(struct json_writer *json, FILE *stream)
{
    *json = (struct json_writer){.stream = stream, .is_first = true};
}

static void put_text(FILE *stream, const char *text)
{
    fputc('"', stream);
    for (; *text != '\0'; text++) {
        const unsigned char c = (unsigned char)*text;
        if (c == '"' || c == '\\') {
            fprintf(stream, "\\%c", c);
        } else if (c < 0x20) {
            fprintf(stream, "\\u%04x", c);
        } else {
            fputc(c, stream);
        }
    }
    fputc('"', stream);
}

static void put_line(struct json_writer *json)
{
    if (json->line != NULL) {
        fputs(json->line, json->stream);
        json->line = NULL;
    }
}

static void put_key(struct json_writer *json, const char *key)
{
    if (!json->is_first) {
        fputs(json->line != NULL ? "," : ", ", json->stream);
    }
    put_line(json);
    json->is_first = false;
    if (key != NULL) {
        put_text(json->stream, key);
        fputs(": ", json->stream);
    }
}

static void open_with(struct json_writer *json, const char *key, char bracket)
{
    put_key(json, key);
    fputc(bracket, json->stream);
    json->is_first = true;
}

static void close_with(struct json_writer *json, char bracket)
{
    put_line(json);
    fputc(bracket, json->stream);
    json->is_first = false;
}

void json_open_object(struct json_writer *json, const char *key)
{
    open_with(json, key, '{');
}

void json_open_list(struct json_writer *json, const char *key)
{
    open_with(json, key, '[');
}

void json_close_object(struct json_writer *json)
{
    close_with(json, '}');
}

void json_close_list(struct json_writer *json)
{
    close_with(json, ']');
}

void json_null(struct json_writer *json, const char *key)
{
    put_key(json, key);
    fputs("null", json->stream);
}

void json_text(struct json_writer *json, const char *key, const char *text)
{
    if (text == NULL) {
        json_null(json, key);
        return;
    }
    put_key(json, key);
    put_text(json->stream, text);
}

void json_bool(struct json_writer *json, const char *key, bool value)
{
    put_key(json, key);
    fputs(value ? "true" : "false", json->stream);
}

void json_unsigned(struct json_writer *json, const char *key, uint64_t value)
{
    put_key(json, key);
    fprintf(json->stream, "%" PRIu64, value);
}

void json_integer(struct json_writer *json, const char *key, int64_t value)
{
    put_key(json, key);
    fprintf(json->stream, "%" PRId64, value);
}

void json_number(struct json_writer *json, const char *key, double value, int digits)
{
    if (!isfinite(value)) {
        json_null(json, key);
        return;
    }
    put_key(json, key);
    fprintf(json->stream, "%.*g", digits, value);
}

void json_fixed(struct json_writer *json, const char *key, double value, int decimals)
{
    if (!isfinite(value)) {
        json_null(json, key);
        return;
    }
    put_key(json, key);
    fprintf(json->stream, "%.*f", decimals, value);
}

void json_break(struct json_writer *json, const char *line)
{
    json->line = line;
}

void json_end(struct json_writer *json)
{
    fputc('\n', json->stream);
}
