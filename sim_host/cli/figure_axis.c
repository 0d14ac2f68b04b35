#include <math.h>

#include "sim_host/cli/figure_internal.h"

void figure_escape(FILE *stream, const char *text)
{
    for (; *text != '\0'; text++) {
        const char *const as = *text == '<'   ? "&lt;"
                               : *text == '>' ? "&gt;"
                               : *text == '&' ? "&amp;"
                                              : NULL;
        if (as != NULL) {
            fputs(as, stream);
        } else {
            fputc(*text, stream);
        }
    }
}

void figure_text(FILE *stream, double x, double y, const char *more, const char *text)
{
    fprintf(stream, "<text x=\"%.1f\" y=\"%.1f\"%s>", x, y, more);
    figure_escape(stream, text);
    fputs("</text>\n", stream);
}

double figure_pixel(const struct figure_axis *axis, double number)
{
    const double at = !axis->is_log ? number : number > 0.0 ? log10(number) : (double)NAN;
    return axis->from + (axis->to - axis->from) * (at - axis->low) / (axis->high - axis->low);
}

double figure_half_cell(const double *number, size_t count)
{
    double least = (double)INFINITY;
    for (size_t i = 1; i < count; i++) {
        const double apart = fabs(number[i] - number[i - 1]);
        least = apart > 0.0 && apart < least ? apart : least;
    }
    return isfinite(least) ? 0.5 * least : 0.5;
}
