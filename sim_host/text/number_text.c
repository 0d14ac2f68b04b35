#include "sim_host/text/number_text.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

void number_text(double value, char *text, size_t size)
{
    if (value == floor(value) && fabs(value) < 1e9) {
        snprintf(text, size, "%.0f", value);
        return;
    }
    for (int digits = 6; digits <= 17; digits++) {
        snprintf(text, size, "%.*g", digits, value);
        if (strtod(text, NULL) == value) {
            return;
        }
    }
}

int number_text_read(const char *key, const char *value, double minimum, double maximum,
                     const char *meaning, double *result, char *message, size_t size)
{
    char *end = NULL;
    errno = 0;
    const double number = strtod(value, &end);
    if (end == value || *end != '\0' || errno == ERANGE || !isfinite(number)) {
        snprintf(message, size, "key \"%s\" (%s): \"%.40s\" is not a number", key, meaning, value);
        return -1;
    }
    if (number < minimum || number > maximum) {
        snprintf(message, size, "key \"%s\" (%s): %.40s is out of range, allowed is %g to %g", key,
                 meaning, value, minimum, maximum);
        return -1;
    }
    *result = number;
    return 0;
}
