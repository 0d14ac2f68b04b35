/* Numbers as a person writes them. */
#ifndef SIM_HOST_TEXT_NUMBER_TEXT_H
#define SIM_HOST_TEXT_NUMBER_TEXT_H

#include <stddef.h>

enum { NUMBER_TEXT_MAX = 32 };

/* The shortest decimal number, of at least 6 digits' precision, that is read back as the same double. */
void number_text(double value, char *text, size_t size);

/* Reads the number of a file's key. Returns 0 and *result, or -1 with the reason in message (size bytes): no
 * number, not finite, or outside minimum to maximum. meaning: of the key, for the message. */
int number_text_read(const char *key, const char *value, double minimum, double maximum,
                     const char *meaning, double *result, char *message, size_t size);

#endif
