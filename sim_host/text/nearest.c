#include "sim_host/text/nearest.h"

#include <stdio.h>
#include <string.h>

enum { LETTERS_MAX = 63 };

static unsigned least(unsigned a, unsigned b)
{
    return a < b ? a : b;
}

/* Optimal string alignment: row by row, with the row before the last for the swaps. */
unsigned nearest_distance(const char *text, const char *name)
{
    unsigned rows[3][LETTERS_MAX + 1];
    const size_t n = strnlen(text, LETTERS_MAX), m = strnlen(name, LETTERS_MAX);
    for (size_t j = 0; j <= m; j++) {
        rows[0][j] = (unsigned)j;
    }
    for (size_t i = 1; i <= n; i++) {
        unsigned *row = rows[i % 3];
        const unsigned *above = rows[(i + 2) % 3], *second = rows[(i + 1) % 3];
        row[0] = (unsigned)i;
        for (size_t j = 1; j <= m; j++) {
            const unsigned exchanged = above[j - 1] + (text[i - 1] != name[j - 1] ? 1u : 0u);
            row[j] = least(exchanged, least(above[j], row[j - 1]) + 1);
            if (i > 1 && j > 1 && text[i - 1] == name[j - 2] && text[i - 2] == name[j - 1]) {
                row[j] = least(row[j], second[j - 2] + 1);
            }
        }
    }
    return rows[n % 3][m];
}

static const char *name_at(const void *names, size_t i, size_t stride_bytes)
{
    const char *name;
    memcpy(&name, (const char *)names + i * stride_bytes, sizeof name);
    return name;
}

const char *nearest_name(const char *text, const void *names, size_t count, size_t stride_bytes)
{
    const char *best = NULL;
    unsigned best_distance = 0;
    for (size_t i = 0; i < count; i++) {
        const char *name = name_at(names, i, stride_bytes);
        const unsigned distance = nearest_distance(text, name);
        if (2 * distance < strlen(name) + 1 && (best == NULL || distance < best_distance)) {
            best = name;
            best_distance = distance;
        }
    }
    return best;
}

void nearest_refuse(const char *text, const void *names, size_t count, size_t stride_bytes,
                    char *message, size_t size)
{
    const char *best = nearest_name(text, names, count, stride_bytes);
    int used = snprintf(message, size, "\"%.40s\" is unknown, allowed is", text);
    for (size_t i = 0; i < count && used >= 0 && (size_t)used < size; i++) {
        const char *before = i == 0 ? " " : i + 1 < count ? ", " : " or ";
        used += snprintf(message + used, size - (size_t)used, "%s%s", before,
                         name_at(names, i, stride_bytes));
    }
    if (best != NULL && used >= 0 && (size_t)used < size) {
        (void)snprintf(message + used, size - (size_t)used, "; nearest: %s", best);
    }
}
