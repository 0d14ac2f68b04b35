#include "sim_host/study/report.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "sim_host/cli/experiment.h"
#include "sim_host/cli/program.h"
#include "sim_host/study/plot.h"

enum { PATH_BYTES = 4096 };
enum { DIGITS = 17 }; /* all of a double */

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
        fputs(cell.text, file);
    } else if (cell.kind == CELL_TRUTH) {
        fprintf(file, "%s", cell.integer ? "true" : "false");
    } else if (cell.kind == CELL_INTEGER) {
        fprintf(file, "%ld", cell.integer);
    } else if (format == FORMAT_TEXT) {
        fprintf(file, "%.10g", cell.number);
    } else if (real_is_finite(cell.number)) {
        fprintf(file, "%.17g", cell.number);
    } else {
        fputs("nan", file);
    }
}

static void put_cell(struct json_writer *json, const char *name, struct cell cell)
{
    if (cell.kind == CELL_TEXT) {
        json_text(json, name, cell.text);
    } else if (cell.kind == CELL_TRUTH) {
        json_bool(json, name, cell.integer != 0);
    } else if (cell.kind == CELL_INTEGER) {
        json_integer(json, name, cell.integer);
    } else {
        json_number(json, name, cell.number, DIGITS);
    }
}

/* What a run is, in one line: a run may only resume a file of the same. */
static void identity_text(const struct common *common, const char *command, const char *settings,
                          char *text, size_t size)
{
    const struct walker_params *p = &common->params;
    snprintf(text, size, "afo study %s M=%.17g m=%.17g l=%.17g k=%.17g g=%.17g %s", command,
             p->hip_mass_kg, p->leg_mass_kg, p->leg_length_m, p->ankle_stiffness_N_m,
             p->gravity_m_s2, settings);
}

/* FILE.json beside the table. 0 where that is longer than a path can be. */
static int path_beside(const char *table, char *path, size_t size)
{
    return (size_t)snprintf(path, size, "%s.json", table) < size;
}

/* Whether the file beside the table tells of the same run. */
static int is_of(const char *table, const char *identity)
{
    char path[PATH_BYTES], line[4096];
    int same = 0;
    FILE *file = path_beside(table, path, sizeof path) ? fopen(path, "r") : NULL;
    while (file != NULL && !same && fgets(line, sizeof line, file) != NULL) {
        const char *at = strstr(line, identity);
        same = at != NULL && at[strlen(identity)] == '"';
    }
    if (file != NULL) {
        fclose(file);
    }
    return same;
}

static void begin_json(struct report *report, const char *command)
{
    const struct walker_params *p = &report->common->params;
    struct json_writer *json = &report->json;
    json_open_object(json, NULL);
    json_text(json, "command", command);
    json_open_object(json, "walker");
    json_number(json, "M", p->hip_mass_kg, DIGITS);
    json_number(json, "m", p->leg_mass_kg, DIGITS);
    json_number(json, "l", p->leg_length_m, DIGITS);
    json_number(json, "k", p->ankle_stiffness_N_m, DIGITS);
    json_number(json, "g", p->gravity_m_s2, DIGITS);
    json_close_object(json);
}

/* Puts what is known of the run beside its table. 0 behind a complaint. */
static int write_beside(const struct report *report)
{
    char path[PATH_BYTES];
    FILE *file = path_beside(report->common->out_path, path, sizeof path) ? fopen(path, "w") : NULL;
    int good = file != NULL && fflush(report->beside) == 0 &&
               fwrite(report->beside_text, 1, report->beside_bytes, file) == report->beside_bytes;
    good = file != NULL && fclose(file) == 0 && good;
    if (!good) {
        fprintf(stderr, "afo study: cannot write %s.json: %s\n", report->common->out_path,
                strerror(errno));
    }
    return good;
}

static int is_regular(FILE *file)
{
    struct stat status;
    return fstat(fileno(file), &status) == 0 && S_ISREG(status.st_mode);
}

/* Begins FILE.json, and writes it for the first time, so that a run that is broken off can be resumed. */
static int begin_beside(struct report *report, const char *command, const char *identity)
{
    if (report->common->out_path == NULL || !is_regular(report->file)) {
        return 1;
    }
    report->beside = open_memstream(&report->beside_text, &report->beside_bytes);
    if (report->beside == NULL) {
        fprintf(stderr, "afo study: out of memory\n");
        return 0;
    }
    json_begin(&report->json, report->beside);
    begin_json(report, command);
    json_text(&report->json, "run", identity);
    experiment_identity(&report->json, 0, NULL);
    const long open = ftell(report->beside);
    fputs("}\n", report->beside);
    const int good = write_beside(report);
    fseek(report->beside, open, SEEK_SET);
    return good;
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

/* Counts complete rows of the file and cuts off an unfinished one. 0: not a file of this run, by the file beside it. */
static int find_resume_point(struct report *report, const char *identity)
{
    char line[4096];
    long keep = 0;
    int number = 0, rows = 0;
    while (fgets(line, sizeof line, report->file) != NULL) {
        const size_t length = strlen(line);
        if (length == 0 || line[length - 1] != '\n') {
            break;
        }
        if (number == 0 && !is_of(report->common->out_path, identity)) {
            return 0;
        }
        if (number >= 1) {
            add_to_totals(line, report->resumed_totals);
            if (report->plot != NULL) {
                fputs(line, report->plot);
            }
            rows++;
        }
        number++;
        keep = ftell(report->file);
    }
    report->rows_resumed = rows;
    return fflush(report->file) == 0 && ftruncate(fileno(report->file), keep) == 0 &&
           fseek(report->file, keep, SEEK_SET) == 0;
}

static int open_file(struct report *report, const char *identity)
{
    const struct common *common = report->common;
    report->file = stdout;
    if (common->resume && (common->out_path == NULL || common->format != FORMAT_CSV)) {
        fprintf(stderr, "afo study: --resume needs --csv and --out FILE\n");
        return 0;
    }
    if (common->out_path == NULL) {
        return 1;
    }
    report->file = common->resume ? fopen(common->out_path, "r+") : NULL;
    if (report->file == NULL) {
        report->file = fopen(common->out_path, "w");
    } else if (!find_resume_point(report, identity)) {
        fprintf(stderr, "afo study: %s holds another run, cannot resume it\n", common->out_path);
        fclose(report->file);
        return 0;
    }
    if (report->file == NULL) {
        fprintf(stderr, "afo study: cannot write %s: %s\n", common->out_path, strerror(errno));
        return 0;
    }
    return 1;
}

static void put_columns(const struct report *report, FILE *file)
{
    for (int i = 0; i < report->column_count; i++) {
        fprintf(file, "%s%s", report->columns[i], i + 1 < report->column_count ? "," : "\n");
    }
}

static void begin_plot(struct report *report, const char *command)
{
    report->plot = plot_table(command);
    if (report->plot != NULL) {
        put_columns(report, report->plot);
    }
}

void report_plot_own(struct report *report, const char *study, const char *columns)
{
    report->plot = plot_table(study);
    report->plot_is_own = 1;
    if (report->plot != NULL) {
        fputs(columns, report->plot);
    }
}

int report_open(struct report *report, const struct common *common, const char *command,
                const char *settings, const char *const *columns)
{
    char identity[1024];
    *report = (struct report){.common = common, .columns = columns};
    identity_text(common, command, settings, identity, sizeof identity);
    for (report->column_count = 0; columns[report->column_count] != NULL; report->column_count++) {
    }
    begin_plot(report, command);
    if (!open_file(report, identity)) {
        return 0;
    }
    if (common->format == FORMAT_JSON) {
        json_begin(&report->json, report->file);
        begin_json(report, command);
        return 1;
    }
    if (common->format == FORMAT_CSV && !begin_beside(report, command, identity)) {
        return 0;
    }
    if (common->format == FORMAT_CSV && (common->out_path == NULL || ftell(report->file) <= 0)) {
        put_columns(report, report->file);
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
        json_break(&report->json, "\n");
        json_open_list(&report->json, "rows");
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
        json_break(&report->json, "\n");
        json_close_list(&report->json);
    }
    report->rows_open = 0;
}

static void plot_row(const struct report *report, const struct cell *cells)
{
    for (int i = 0; i < report->column_count; i++) {
        fputs(i > 0 ? "," : "", report->plot);
        print_cell(report->plot, FORMAT_CSV, cells[i]);
    }
    fputc('\n', report->plot);
}

void report_row(struct report *report, const struct cell *cells)
{
    const enum report_format format = report->common->format;
    open_rows(report);
    if (report->plot != NULL && !report->plot_is_own) {
        plot_row(report, cells);
    }
    if (format == FORMAT_JSON) {
        json_break(&report->json, "\n ");
        json_open_object(&report->json, NULL);
    }
    for (int i = 0; i < report->column_count; i++) {
        if (format == FORMAT_JSON) {
            put_cell(&report->json, report->columns[i], cells[i]);
            continue;
        }
        if (i > 0) {
            fputc(format == FORMAT_CSV ? ',' : '\t', report->file);
        }
        print_cell(report->file, format, cells[i]);
    }
    if (format == FORMAT_JSON) {
        json_close_object(&report->json);
    } else {
        fputc('\n', report->file);
    }
    report->rows_written++;
    fflush(report->file); /* a long run writes as it goes */
}

/* A named field: a line `"name": ...` in JSON, `name: ...` for people. Beside a CSV file it stands in FILE.json, beside
 * one on standard output on standard error: a table is nothing but a table. True where the value is to be
 * written as JSON. */
static int open_field(struct report *report, const char *name)
{
    close_rows(report);
    if (report->common->format == FORMAT_JSON || report->beside != NULL) {
        json_break(&report->json, "\n");
        return 1;
    }
    report->text = report->common->format == FORMAT_CSV ? stderr : report->file;
    fprintf(report->text, "%s: ", name);
    return 0;
}

void report_value(struct report *report, const char *name, struct cell value)
{
    if (open_field(report, name)) {
        put_cell(&report->json, name, value);
        return;
    }
    print_cell(report->text, report->common->format, value);
    fputc('\n', report->text);
}

void report_list(struct report *report, const char *name, const double *values, int count)
{
    if (open_field(report, name)) {
        json_open_list(&report->json, name);
        for (int i = 0; i < count; i++) {
            json_number(&report->json, NULL, values[i], DIGITS);
        }
        json_close_list(&report->json);
        return;
    }
    for (int i = 0; i < count; i++) {
        fputs(i > 0 ? ", " : "", report->text);
        print_cell(report->text, report->common->format, cell_number(values[i]));
    }
    fputc('\n', report->text);
}

void report_pairs(struct report *report, const char *name, const double *values, int pairs)
{
    const enum report_format format = report->common->format;
    if (open_field(report, name)) {
        json_open_list(&report->json, name);
        for (int i = 0; i < pairs; i++) {
            json_open_list(&report->json, NULL);
            json_number(&report->json, NULL, values[2 * i], DIGITS);
            json_number(&report->json, NULL, values[2 * i + 1], DIGITS);
            json_close_list(&report->json);
        }
        json_close_list(&report->json);
        return;
    }
    for (int i = 0; i < pairs; i++) {
        fprintf(report->text, "%s[", i > 0 ? ", " : "");
        print_cell(report->text, format, cell_number(values[2 * i]));
        fputs(", ", report->text);
        print_cell(report->text, format, cell_number(values[2 * i + 1]));
        fputs("]", report->text);
    }
    fputc('\n', report->text);
}

void report_progress(struct report *report, int done, int of)
{
    if (of <= 0) {
        return;
    }
    if (!report->progress_begun) {
        progress_begin(&report->progress, "done", (uint64_t)of, report->common->quiet != 0);
        report->progress_begun = 1;
    }
    progress_tell(&report->progress, (uint64_t)done);
}

int report_close(struct report *report)
{
    close_rows(report);
    if (report->common->format == FORMAT_JSON || report->beside != NULL) {
        json_close_object(&report->json);
        json_end(&report->json);
    }
    const int beside = report->beside == NULL || write_beside(report);
    if (report->beside != NULL) {
        fclose(report->beside);
        free(report->beside_text);
    }
    if (report->progress_begun) {
        progress_end(&report->progress);
    }
    if (report->file == stdout) {
        return program_output_done() == 0;
    }
    int good = fflush(report->file) == 0 && !ferror(report->file);
    good = fclose(report->file) == 0 && good;
    if (!good) {
        fprintf(stderr, "afo study: cannot write %s: %s\n", report->common->out_path,
                strerror(errno));
    }
    return good && beside;
}
