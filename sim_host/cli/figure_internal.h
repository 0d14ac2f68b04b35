/* Among figure.c, which lays out, figure_marks.c, which draws the numbers, and figure_axis.c, where they lie. */
#ifndef SIM_HOST_CLI_FIGURE_INTERNAL_H
#define SIM_HOST_CLI_FIGURE_INTERNAL_H

#include "sim_host/cli/figure.h"

struct figure_axis {
    double low, high; /* of the numbers, or of their decimal logarithms */
    bool is_log;
    double from, to; /* pixels of low and high */
};

/* Where a panel's numbers go. */
struct figure_place {
    struct figure_axis x, y;
    double legend_left, top;
};

/* Pixels; NaN for a number that the axis does not have. */
double figure_pixel(const struct figure_axis *axis, double number);

/* The text as a document may hold it. */
void figure_escape(FILE *stream, const char *text);
void figure_text(FILE *stream, double x, double y, const char *more, const char *text);
void figure_draw(FILE *stream, const struct figure_panel *panel, const struct figure_place *place);

/* Half a grid's spacing along x or y, in numbers. */
double figure_half_cell(const double *number, size_t count);

#endif
