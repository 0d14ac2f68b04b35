#include "sim_host/plant/csv_text.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LARGEST_FILE_BYTES = 1 << 30 };

enum csv_text_error csv_text_read(struct csv_text *csv, const char *path, const char **why)
{
    enum csv_text_error error = CSV_TEXT_CANNOT_READ;
    FILE *file = fopen(path, "rb");
    long size;
    *csv = (struct csv_text){.line = 1};
    *why = "";
    if (file == NULL) {
        *why = strerror(errno);
    } else if (fseek(file, 0, SEEK_END) != 0 || (size = ftell(file)) < 0 ||
               fseek(file, 0, SEEK_SET) != 0) {
        *why = "cannot tell its size";
    } else if (size > LARGEST_FILE_BYTES) {
        *why = "larger than 1 GB";
    } else if ((csv->text = malloc((size_t)size + 1)) == NULL) {
        *why = "not enough memory";
        error = CSV_TEXT_NO_MEMORY;
    } else if (fread(csv->text, 1, (size_t)size, file) != (size_t)size) {
        *why = "cannot be read";
    } else {
        csv->text[size] = '\0';
        csv->bytes = (size_t)size;
        csv->at = csv->text + (strncmp(csv->text, "\xEF\xBB\xBF", 3) == 0 ? 3 : 0);
        error = CSV_TEXT_OK;
    }
    if (file != NULL) {
        (void)fclose(file);
    }
    if (error != CSV_TEXT_OK) {
        csv_text_free(csv);
    }
    return error;
}

void csv_text_free(struct csv_text *csv)
{
    free(csv->text);
    *csv = (struct csv_text){0};
}

bool csv_text_next_line(struct csv_text *csv)
{
    for (;;) {
        if (*csv->at == '\n') {
            csv->at++;
            csv->line++;
        } else if (*csv->at == '\r' && csv->at[1] == '\n') {
            csv->at++;
        } else {
            return *csv->at != '\0';
        }
    }
}

struct csv_field csv_text_next_field(struct csv_text *csv, bool *more)
{
    const char *begin = csv->at;
    const char *end = begin + strcspn(begin, ",\n");
    *more = *end == ',';
    csv->at = *more ? end + 1 : end;
    while (begin < end && (*begin == ' ' || *begin == '\t' || *begin == '"')) {
        begin++;
    }
    while (end > begin &&
           (end[-1] == ' ' || end[-1] == '\t' || end[-1] == '\r' || end[-1] == '"')) {
        end--;
    }
    return (struct csv_field){begin, end};
}

bool csv_field_is(struct csv_field field, const char *text)
{
    const size_t length = (size_t)(field.end - field.begin);
    return strlen(text) == length && memcmp(field.begin, text, length) == 0;
}

bool csv_text_is_whole(const struct csv_text *csv)
{
    return csv->at == csv->text + csv->bytes;
}
