#include "sim_host/study/report.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

struct cell cell_number(double number)
{
    return (struct cell){.kind = CELL_NUMBER, .number = number};
}

struct cell cell_integer(long integer)
{
    return (struct cell){.kind = CELL_INTEGER, .integer = integer};
}

struct cell cell_text(const char *text)
{
    return (struct cell){.kind = CELL_TEXT, .text = text};
}

struct cell cell_truth(int is_true)
{
    return (struct cell){.kind = CELL_TRUTH, .integer = is_true};
}

static void print_cell(FILE *file, enum report_format format, struct cell cell)
{
    if (cell.kind == CELL_TEXT) {
        fprintf(file, format == FORMAT_JSON ? "\"%s\"" : "%s", cell.text);
    } else if (cell.kind == CELL_TRUTH) {
        fprintf(file, "%s", cell.integer ? "true" : "false");
    } else if (cell.kind == CELL_INTEGER) {
        fprintf(file, "%ld", cell.integer);
    } else if (format == FORMAT_TEXT) {
        fprintf(file, "%.10g", cell.number);
    } else if (real_is_finite(cell.number)) {
        fprintf(file, "%.17g", cell.number);
    } else {
        fprintf(file, format == FORMAT_JSON ? "null" : "nan");
    }
}

/* The first two lines of a CSV file say what it holds; a run may only resume its own. */
static void header_text(const struct common *common, const char *command, const char *settings,
                        char *text, size_t size)
{
    const struct walker_params *p = &common->params;
    snprintf(text, size, "# afo-study %s M=%.17g m=%.17g l=%.17g k=%.17g g=%.17g %s", command,
             p->hip_mass_kg, p->leg_mass_kg, p->leg_length_m, p->ankle_stiffness_N_m,
             p->gravity_m_s2, settings);
}

static void add_to_totals(const char *line, double totals[REPORT_TOTALS])
{
    const char *at = line;
    for (int i = 0; i < REPORT_TOTALS && *at != '\0'; i++) {
        char *end;
        totals[i] += strtod(at, &end);
        at = *end == ',' ? end + 1 : "";
    }
}

/* Counts complete rows of the file and cuts off an unfinished one, and the comments behind the last.
 * 0: not a file of this run. */
static int find_resume_point(struct report *report, const char *header)
{
    char line[4096];
    long keep = 0;
    int number = 0, rows = 0;
    while (fgets(line, sizeof line, report->file) != NULL) {
        const size_t length = strlen(line);
        if (length == 0 || line[length - 1] != '\n') {
            break;
        }
        if (number == 0 &&
            (strncmp(line, header, strlen(header)) != 0 || line[strlen(header)] != '\n')) {
            return 0;
        }
        if (number >= 2 && line[0] == '#') {
            break;
        }
        if (number >= 2) {
            add_to_totals(line, report->resumed_totals);
            rows++;
        }
        number++;
        keep = ftell(report->file);
    }
    if (number == 1) { /* the line of the column names is missing: begin again behind the first */
        keep = 0;
    }
    report->rows_resumed = rows;
    return fflush(report->file) == 0 && ftruncate(fileno(report->file), keep) == 0 &&
           fseek(report->file, keep, SEEK_SET) == 0;
}

static int open_file(struct report *report, const char *header)
{
    const struct common *common = report->common;
    report->file = stdout;
    if (common->resume && (common->out_path == NULL || common->format != FORMAT_CSV)) {
        fprintf(stderr, "afo-study: --resume needs --csv and --out FILE\n");
        return 0;
    }
    if (common->out_path == NULL) {
        return 1;
    }
    report->file = common->resume ? fopen(common->out_path, "r+") : NULL;
    if (report->file == NULL) {
        report->file = fopen(common->out_path, "w");
    } else if (!find_resume_point(report, header)) {
        fprintf(stderr, "afo-study: %s holds another run, cannot resume it\n", common->out_path);
        fclose(report->file);
        return 0;
    }
    if (report->file == NULL) {
        fprintf(stderr, "afo-study: cannot write %s: %s\n", common->out_path, strerror(errno));
        return 0;
    }
    return 1;
}

int report_open(struct report *report, const struct common *common, const char *command,
                const char *settings, const char *const *columns)
{
    char header[1024];
    *report = (struct report){.common = common, .columns = columns};
    header_text(common, command, settings, header, sizeof header);
    if (!open_file(report, header)) {
        return 0;
    }
    for (report->column_count = 0; columns[report->column_count] != NULL; report->column_count++) {
    }
    clock_gettime(CLOCK_MONOTONIC, &report->started);
    const struct walker_params *p = &common->params;
    if (common->format == FORMAT_JSON) {
        fprintf(report->file,
                "{\"command\": \"%s\", \"walker\": {\"M\": %.17g, \"m\": %.17g, \"l\": %.17g, "
                "\"k\": %.17g, \"g\": %.17g}",
                command, p->hip_mass_kg, p->leg_mass_kg, p->leg_length_m, p->ankle_stiffness_N_m,
                p->gravity_m_s2);
    } else if (common->format == FORMAT_CSV && ftell(report->file) <= 0) {
        fprintf(report->file, "%s\n", header);
        for (int i = 0; i < report->column_count; i++) {
            fprintf(report->file, "%s%s", columns[i], i + 1 < report->column_count ? "," : "\n");
        }
    }
    return 1;
}

static void open_rows(struct report *report)
{
    if (report->rows_open) {
        return;
    }
    report->rows_open = 1;
    if (report->common->format == FORMAT_JSON) {
        fprintf(report->file, ",\n\"rows\": [");
    } else if (report->common->format == FORMAT_TEXT) {
        for (int i = 0; i < report->column_count; i++) {
            fprintf(report->file, "%s%s", report->columns[i],
                    i + 1 < report->column_count ? "\t" : "\n");
        }
    }
}

static void close_rows(struct report *report)
{
    if (report->rows_open && report->common->format == FORMAT_JSON) {
        fprintf(report->file, "\n]");
    }
    report->rows_open = 0;
}

void report_row(struct report *report, const struct cell *cells)
{
    const enum report_format format = report->common->format;
    open_rows(report);
    if (format == FORMAT_JSON) {
        fprintf(report->file, "%s\n {", report->rows_written > 0 ? "," : "");
    }
    for (int i = 0; i < report->column_count; i++) {
        if (format == FORMAT_JSON) {
            fprintf(report->file, "%s\"%s\": ", i > 0 ? ", " : "", report->columns[i]);
        } else if (i > 0) {
            fprintf(report->file, format == FORMAT_CSV ? "," : "\t");
        }
        print_cell(report->file, format, cells[i]);
    }
    fprintf(report->file, format == FORMAT_JSON ? "}" : "\n");
    report->rows_written++;
    fflush(report->file); /* a long run writes as it goes */
}

/* Opens a named field: `"name": ` in JSON, `name: ` for people, a comment in CSV. */
static void open_field(struct report *report, const char *name)
{
    close_rows(report);
    if (report->common->format == FORMAT_JSON) {
        fprintf(report->file, ",\n\"%s\": ", name);
    } else {
        fprintf(report->file, "%s%s: ", report->common->format == FORMAT_CSV ? "# " : "", name);
    }
}

static void close_field(struct report *report)
{
    if (report->common->format != FORMAT_JSON) {
        fputc('\n', report->file);
    }
}

void report_value(struct report *report, const char *name, struct cell value)
{
    open_field(report, name);
    print_cell(report->file, report->common->format, value);
    close_field(report);
}

void report_list(struct report *report, const char *name, const double *values, int count)
{
    const int json = report->common->format == FORMAT_JSON;
    open_field(report, name);
    fprintf(report->file, json ? "[" : "");
    for (int i = 0; i < count; i++) {
        fprintf(report->file, i > 0 ? ", " : "");
        print_cell(report->file, report->common->format, cell_number(values[i]));
    }
    fprintf(report->file, json ? "]" : "");
    close_field(report);
}

void report_pairs(struct report *report, const char *name, const double *values, int pairs)
{
    open_field(report, name);
    const enum report_format format = report->common->format;
    fprintf(report->file, format == FORMAT_JSON ? "[" : "");
    for (int i = 0; i < pairs; i++) {
        fprintf(report->file, "%s[", i > 0 ? ", " : "");
        print_cell(report->file, format, cell_number(values[2 * i]));
        fprintf(report->file, ", ");
        print_cell(report->file, format, cell_number(values[2 * i + 1]));
        fprintf(report->file, "]");
    }
    fprintf(report->file, format == FORMAT_JSON ? "]" : "");
    close_field(report);
}

void report_progress(struct report *report, int done, int of)
{
    struct timespec now;
    if (report->common->quiet || !isatty(STDERR_FILENO) || of <= 0) {
        return;
    }
    clock_gettime(CLOCK_MONOTONIC, &now);
    const double spent = (double)(now.tv_sec - report->started.tv_sec) +
                         1e-9 * (double)(now.tv_nsec - report->started.tv_nsec);
    const double left = done > 0 ? spent * (of - done) / done : 0.0;
    fprintf(stderr, "\r%3d %%  %d of %d, %.0f s gone, about %.0f s left   ", 100 * done / of, done,
            of, spent, left);
    report->progress_shown = 1;
}

int report_close(struct report *report)
{
    close_rows(report);
    if (report->common->format == FORMAT_JSON) {
        fprintf(report->file, "}\n");
    }
    if (report->progress_shown) {
        fprintf(stderr, "\r%60s\r", "");
    }
    int good = fflush(report->file) == 0 && !ferror(report->file);
    if (report->file != stdout) {
        good = fclose(report->file) == 0 && good;
    }
    if (!good) {
        if (report->common->out_path != NULL) { /* of standard output main() tells */
            fprintf(stderr, "afo-study: cannot write %s: %s\n", report->common->out_path,
                    strerror(errno));
        }
    }
    return good;
}
