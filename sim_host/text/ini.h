/* INI files: [section], key = value. A comment goes from ; or # to the end of the line; the
 * sign is the line's first or stands between blanks. A UTF-8 byte order mark is read over.
 *
 * Written here and not taken from a library because the walk must build on a
 * machine that has a C compiler and make and nothing else.
 */
#ifndef SIM_HOST_TEXT_INI_H
#define SIM_HOST_TEXT_INI_H

#include <stddef.h>

enum { INI_LINE_MAX = 512 };

/* Called for each key; line counts from 1. Returns 0 to go on, other values stop
 * the reading (and message should say why). */
typedef int (*ini_handler)(void *context, const char *section, const char *key, const char *value,
                           int line, char *message, size_t message_size);

/* Reads path and calls handler for each key in order. Returns 0, or -1 with the
 * file, the line and the reason in message. A file that cannot be read, a line
 * that is none of the above, an unclosed section, an overlong line and a NUL byte
 * are errors. */
int ini_read(const char *path, ini_handler handler, void *context, char *message,
             size_t message_size);

#endif
