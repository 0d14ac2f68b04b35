/* A picture of several walks over each other, as SVG: panels below each other, a line for each walk, one legend. */
#ifndef SIM_HOST_CLI_OVERLAY_H
#define SIM_HOST_CLI_OVERLAY_H

#include <stdio.h>

enum { OVERLAY_LINES_MOST = 8 };

struct overlay_line {
    const char *name; /* in the legend */
    const double *value;
    size_t count; /* value[i] stands at i + 1; NaN: a gap */
};

struct overlay_panel {
    const char *title; /* with the unit */
    struct overlay_line line[OVERLAY_LINES_MOST];
    size_t lines;
};

/* Writes the whole file. The panels share their axis, which counts from 1 to the longest line's end; x_title is its
 * name. Values of a panel span at least 1e-9. The stream keeps its error, and who opened it asks for it. */
void overlay_write(FILE *stream, const char *title, const char *x_title,
                   const struct overlay_panel *panels, size_t count);

#endif
