/* A study's table, read back from its text, and the lines of a picture out of it. */
#ifndef SIM_HOST_STUDY_PLOT_TABLE_H
#define SIM_HOST_STUDY_PLOT_TABLE_H

#include <stdbool.h>

#include "sim_host/study/pictures.h"

enum { PLOT_COLUMNS_MOST = 24 };

struct plot_columns {
    char *text; /* cut into fields; owned */
    const char *name[PLOT_COLUMNS_MOST];
    const char **field; /* owned; row by row */
    size_t columns, rows;
    void **kept; /* what the panels point to; owned */
    size_t kept_count;
    bool is_cut; /* a panel would have had more series than a figure takes */
};

/* Reads "a,b\n1,2\n". NULL: an empty table. 0, or -1 without memory. */
int plot_columns_read(struct plot_columns *table, const char *text);
void plot_columns_free(struct plot_columns *table);

/* The column's different texts in their order; at most `most`. */
size_t plot_texts(const struct plot_columns *table, const char *column, const char **texts,
                  size_t most);

/* The series of a panel: rows that `where` names, and where `only` is there, those whose column `per` is it. Series
 * without a number are left out. They live as long as the table. 0, or -1 without memory. */
int plot_fill(struct plot_columns *table, const struct picture_panel *asked, const char *only,
              struct figure_panel *panel);

/* What a legend says of a column's text: "stable" or "not stable", "kp 0.042", or the text itself. */
void plot_group_title(const char *column, const char *group, char *text, size_t size);

/* "stance_rate_rad_s" is "stance rate (rad/s)". */
void plot_axis_title(const char *column, char *text, size_t size);

#endif
