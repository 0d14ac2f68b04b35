/* What the picture of each study shows. */
#ifndef SIM_HOST_STUDY_PICTURES_H
#define SIM_HOST_STUDY_PICTURES_H

#include "sim_host/cli/figure.h"

enum { PICTURE_PANELS = 6, PICTURE_CURVES = 4 };

/* Columns are named as in the table; "a/b" is the quotient of two. */
struct picture_panel {
    enum figure_mark mark;
    const char *title;
    const char *x, *y[PICTURE_CURVES];
    const char *value;                 /* of cells */
    const char *where;                 /* "column=text,column=text": rows that count; NULL: all */
    const char *by;                    /* a column: a line for each of its texts */
    const char *per;                   /* a column: a panel for each of its texts */
    const char *y_title, *value_title; /* NULL: the columns' own */
    bool log_x, log_y;
    bool in_runs; /* a line of `by` breaks where another one's rows lie between */
    double level[FIGURE_LEVELS_MOST];
    size_t levels;
};

struct picture {
    const char *study;
    struct picture_panel panel[PICTURE_PANELS];
};

/* NULL: no study has that name. */
const struct picture *picture_of(const char *study);

#endif
