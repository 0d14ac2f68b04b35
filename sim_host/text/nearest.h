/* A mistyped name and the names that are allowed: which one was meant. */
#ifndef SIM_HOST_TEXT_NEAREST_H
#define SIM_HOST_TEXT_NEAREST_H

#include <stddef.h>

/* How far text is from name: the number of letters to insert, leave out, exchange or swap with their
 * neighbour. Longer words than 63 letters are cut. */
unsigned nearest_distance(const char *text, const char *name);

/* The one of `count` names that is nearest to text (the first of several), or NULL when half of its
 * letters or more are others. names[i * stride_bytes] is the i-th pointer, so that a name may be the
 * first member of a table's rows. */
const char *nearest_name(const char *text, const void *names, size_t count, size_t stride_bytes);

/* Writes `"TEXT" is unknown, allowed is A, B or C; nearest: B` into message (size bytes). Names as above. */
void nearest_refuse(const char *text, const void *names, size_t count, size_t stride_bytes,
                    char *message, size_t size);

#endif
