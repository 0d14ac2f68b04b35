#include "sim_host/text/number_text.h"

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
