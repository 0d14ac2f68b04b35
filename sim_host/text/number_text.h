/* Numbers as a person writes them. */
#ifndef SIM_HOST_TEXT_NUMBER_TEXT_H
#define SIM_HOST_TEXT_NUMBER_TEXT_H

#include <stddef.h>

enum { NUMBER_TEXT_MAX = 32 };

/* The shortest decimal number, of at least 6 digits' precision, that is read back as the same double. */
void number_text(double value, char *text, size_t size);

#endif
