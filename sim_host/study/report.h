/* Prints the results of a study command: the same rows as a table for people, as CSV or as one JSON object. */
#ifndef SIM_HOST_STUDY_REPORT_H
#define SIM_HOST_STUDY_REPORT_H

#include <stdio.h>

#include "sim_host/cli/json_writer.h"
#include "sim_host/cli/progress.h"
#include "sim_host/gait/orbit.h"

enum report_format { FORMAT_TEXT, FORMAT_CSV, FORMAT_JSON };

/* Options that every command has. */
struct common {
    struct walker_params params;
    enum report_format format;
    int threads;
    int quiet;
    int resume;
    const char *out_path; /* NULL: standard output */
};

enum cell_kind { CELL_NUMBER, CELL_INTEGER, CELL_TEXT, CELL_TRUTH };

struct cell {
    enum cell_kind kind;
    double number;
    long integer;
    const char *text;
};

#define REPORT_TOTALS 8
#define NO_NUMBER __builtin_nan("") /* an empty cell: nan in CSV, null in JSON */

struct report {
    const struct common *common;
    FILE *file, *text; /* the table; where a named result goes as text */
    FILE *plot;        /* the table of --plot, or NULL; plot_is_own: the rows do not go there */
    int plot_is_own;
    FILE *beside; /* in memory: FILE.json of a CSV file */
    char *beside_text;
    size_t beside_bytes;
    const char *const *columns; /* NULL-terminated */
    int column_count;
    int rows_open, rows_written, fields_written;
    int rows_resumed;                     /* complete rows found in the file to be resumed */
    double resumed_totals[REPORT_TOTALS]; /* of their first columns */
    struct json_writer json;              /* FORMAT_JSON */
    struct progress progress;
    int progress_begun;
};

struct cell cell_number(double number);
struct cell cell_integer(long integer);
struct cell cell_text(const char *text);
struct cell cell_truth(int is_true);

/* Opens the output. `settings` describes everything that the rows depend on beside the walker; with
 * --resume the file's own must be the same. Prints a message and returns 0 when that fails. */
int report_open(struct report *report, const struct common *common, const char *command,
                const char *settings, const char *const *columns);

/* The picture (--plot) is of another table than the report's: of `study` in pictures.c. Its rows go to report->plot, where
 * that is not NULL. */
void report_plot_own(struct report *report, const char *study, const char *columns);

/* A line of the table; `cells` has one per column. */
void report_row(struct report *report, const struct cell *cells);

/* A named result beside the table; of a CSV file it is put into FILE.json. */
void report_value(struct report *report, const char *name, struct cell value);
/* The same for a list, and for a list of pairs (values alternate). */
void report_list(struct report *report, const char *name, const double *values, int count);
void report_pairs(struct report *report, const char *name, const double *values, int pairs);

/* Shows how far the work is (sim_host/cli/progress.h), unless --quiet. */
void report_progress(struct report *report, int done, int of);

/* Ends the output. 0 (and a message) when not all could be written. */
int report_close(struct report *report);

#endif
