#include "sim_host/text/ini.h"

#include <ctype.h>
#include <errno.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

static char *trim(char *text)
{
    while (isspace((unsigned char)*text)) {
        text++;
    }
    size_t length = strlen(text);
    while (length > 0 && isspace((unsigned char)text[length - 1])) {
        text[--length] = '\0';
    }
    return text;
}

static bool is_blank_or_end(char sign)
{
    return sign == '\0' || isspace((unsigned char)sign);
}

/* Ends the text where a comment begins: ; or # as the line's first sign, or between blanks;
 * else it belongs to the value ("A;B #1"). */
static void cut_comment(char *text)
{
    bool first = true;
    for (size_t i = 0; text[i] != '\0'; i++) {
        const bool between = i > 0 && (is_blank_or_end(text[i - 1]) || text[i - 1] == ']') &&
                             is_blank_or_end(text[i + 1]);
        if ((text[i] == ';' || text[i] == '#') && (first || between)) {
            text[i] = '\0';
            return;
        }
        first = first && isspace((unsigned char)text[i]);
    }
}

static int read_line(const char *path, int line, char *text, char *section, ini_handler handler,
                     void *context, char *message, size_t message_size)
{
    static const char byte_order_mark[] = "\xEF\xBB\xBF"; /* UTF-8's, as editors write it */
    if (line == 1 && strncmp(text, byte_order_mark, sizeof byte_order_mark - 1) == 0) {
        text += sizeof byte_order_mark - 1;
    }
    cut_comment(text);
    char *content = trim(text);
    if (*content == '\0') {
        return 0;
    }
    if (*content == '[') {
        const size_t length = strlen(content);
        if (content[length - 1] != ']' || length < 3) {
            snprintf(message, message_size, "%s:%d: a section is written [name]", path, line);
            return -1;
        }
        content[length - 1] = '\0';
        snprintf(section, INI_LINE_MAX, "%s", trim(content + 1));
        return 0;
    }
    char *equals = strchr(content, '=');
    if (equals == NULL || equals == content) {
        snprintf(message, message_size, "%s:%d: expected key = value, found \"%.80s\"", path, line,
                 content);
        return -1;
    }
    *equals = '\0';
    char reason[256] = "";
    if (handler(context, section, trim(content), trim(equals + 1), line, reason, sizeof reason) !=
        0) {
        snprintf(message, message_size, "%s:%d: %s", path, line, reason);
        return -1;
    }
    return 0;
}

enum line_end { LINE_MORE, LINE_LAST, LINE_NUL, LINE_TOO_LONG, LINE_READ_ERROR };

/* The next line into text (INI_LINE_MAX + 1 bytes), without its newline; says what ended it. */
static enum line_end fetch_line(FILE *file, char *text)
{
    size_t length = 0;
    for (;;) {
        const int byte = getc(file);
        text[length] = '\0';
        if (byte == EOF) {
            return ferror(file) ? LINE_READ_ERROR : LINE_LAST;
        }
        if (byte == '\n') {
            return LINE_MORE;
        }
        if (byte == '\0') {
            return LINE_NUL;
        }
        if (length == INI_LINE_MAX) {
            return LINE_TOO_LONG;
        }
        text[length++] = (char)byte;
    }
}

int ini_read(const char *path, ini_handler handler, void *context, char *message,
             size_t message_size)
{
    FILE *file = fopen(path, "r");
    if (file == NULL) {
        snprintf(message, message_size, "%s: %s", path, strerror(errno));
        return -1;
    }
    char text[INI_LINE_MAX + 1] = "";
    char section[INI_LINE_MAX] = "";
    int result = 0;
    enum line_end end = LINE_MORE;
    for (int line = 1; result == 0 && end == LINE_MORE; line++) {
        end = fetch_line(file, text);
        if (end == LINE_READ_ERROR) {
            snprintf(message, message_size, "%s: %s", path, strerror(errno));
            result = -1;
        } else if (end == LINE_NUL) {
            snprintf(message, message_size, "%s:%d: a NUL byte in a text file", path, line);
            result = -1;
        } else if (end == LINE_TOO_LONG) {
            snprintf(message, message_size, "%s:%d: line longer than %d characters", path, line,
                     INI_LINE_MAX);
            result = -1;
        } else {
            result = read_line(path, line, text, section, handler, context, message, message_size);
        }
    }
    fclose(file);
    return result;
}
