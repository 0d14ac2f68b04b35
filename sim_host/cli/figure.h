/* A picture of numbers, as SVG: panels beside and below each other, of lines, dots, cells or bars, each with its legend. */
#ifndef SIM_HOST_CLI_FIGURE_H
#define SIM_HOST_CLI_FIGURE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

enum { FIGURE_SERIES_MOST = 24, FIGURE_LEVELS_MOST = 2 };

enum figure_mark {
    FIGURE_LINE, /* through the points in their order, a dot at each where there are few */
    FIGURE_DOTS, /* the points alone */
    FIGURE_CELLS, /* a rectangle around each point of a grid, coloured by its value; one series a panel */
    FIGURE_BARS /* y[i] is the length of the bar at labels[i], one for each value of the first series */
};

struct figure_series {
    const char *name;    /* in the legend; NULL or "": none */
    const double *x, *y; /* not finite: a gap in the line, no mark */
    const double *value; /* of cells */
    size_t count;
};

struct figure_panel {
    enum figure_mark mark;
    const char *title, *x_title, *y_title, *value_title; /* with units; NULL: none */
    bool log_x, log_y;                                   /* numbers above 0 alone are drawn */
    const char *const *labels;                           /* of bars */
    double level[FIGURE_LEVELS_MOST];                    /* dashed lines across, at y */
    size_t levels;
    struct figure_series series[FIGURE_SERIES_MOST];
    size_t series_count;
};

/* Writes the whole file. title is escaped here, and so are all other texts. The stream keeps its error, and who opened
 * it asks for it. Cost: linear in the points; dots that lie upon each other are written once. */
void figure_write(FILE *stream, const char *title, const struct figure_panel *panels, size_t count);

#endif
