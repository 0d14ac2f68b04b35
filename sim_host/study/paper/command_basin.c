/* afo study basin: from which states the walker finds its gait; cross-sections, and the whole volume. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "sim_host/study/paper/basin_walks.h"
#include "sim_host/study/paper/command.h"
#include "sim_host/study/plot.h"
#include "sim_host/study/pool.h"

enum axis { AXIS_STANCE_RATE, AXIS_SWING_ANGLE, AXIS_SWING_RATE, AXIS_R0, AXIS_COUNT };
enum { POINTS_MAX = 5000, PORTION = 4096 /* starts of a slice side by side */ };

static const char *const axis_names[AXIS_COUNT] = {"stance-rate", "swing-angle", "swing-rate",
                                                   "r0"};
static const char *const axis_titles[AXIS_COUNT] = {"stance rate (rad/s)", "swing angle (rad)",
                                                    "swing rate (rad/s)", "r0 (m)"};
static const double default_ranges[AXIS_COUNT][2] = {
    {-1.2, 0.0}, {-1.0, 0.6}, {-3.0, 6.0}, {0.005, 0.07}};

struct options {
    struct common common;
    double r0, kp, ranges[AXIS_COUNT][2];
    enum axis first, second;
    int points, strides, volume;
};

static const struct argp_option table[] = {
    {"r0", 'r', "M", 0, "push-off (0.05)", 0},
    {"kp", 'K', "GAIN", 0, "gain of the step law (0)", 0},
    {"plane", 'p', "A,B", 0,
     "two of stance-rate, swing-angle, swing-rate, r0; the others stay at the gait", 0},
    {"a-range", 'A', "LOW,HIGH", 0, "of the first axis", 0},
    {"b-range", 'B', "LOW,HIGH", 0, "of the second axis", 0},
    {"box", 'X', "6 NUMBERS", 0, "with --volume: low,high of stance rate, swing angle, swing rate",
     0},
    {"points", 'n', "N", 0, "points along each axis (100)", 0},
    {"strides", 's', "N", 0, "at most so many steps from each state (200)", 0},
    {"volume", 'V', 0, 0, "the whole three-dimensional basin, slice by slice of stance rate", 0},
    {0},
};

static enum axis axis_of(const char *name, size_t length, const struct argp_state *state)
{
    for (int i = 0; i < AXIS_COUNT; i++) {
        if (strlen(axis_names[i]) == length && strncmp(name, axis_names[i], length) == 0) {
            return (enum axis)i;
        }
    }
    argp_error(state, "--plane: \"%.*s\" is none of stance-rate, swing-angle, swing-rate, r0",
               (int)length, name);
    return AXIS_STANCE_RATE;
}

static void parse_plane(struct options *options, const char *text, const struct argp_state *state)
{
    const char *comma = strchr(text, ',');
    if (comma == NULL) {
        argp_error(state, "--plane: two axes separated by a comma");
        return;
    }
    options->first = axis_of(text, (size_t)(comma - text), state);
    options->second = axis_of(comma + 1, strlen(comma + 1), state);
    if (options->first == options->second) {
        argp_error(state, "--plane: the two axes must differ");
    }
}

static double pending[2][2];
static int has_pending[2];

static error_t parse(int key, char *argument, struct argp_state *state)
{
    struct options *options = state->input;
    double box[6];
    switch (key) {
    case 'p':
        parse_plane(options, argument, state);
        return 0;
    case 'A':
    case 'B':
        command_numbers(argument, key == 'A' ? "a-range" : "b-range", 2, pending[key - 'A'], state);
        has_pending[key - 'A'] = 1;
        return 0;
    case 'X':
        command_numbers(argument, "box", 6, box, state);
        memcpy(options->ranges, box, sizeof box);
        return 0;
    case 'n':
        options->points = command_integer(argument, "points", 2, POINTS_MAX, state);
        return 0;
    case 's':
        options->strides = command_integer(argument, "strides", 1, 1000000, state);
        return 0;
    case 'V':
        options->volume = 1;
        return 0;
    case ARGP_KEY_END:
        for (int i = 0; i < 2 && !options->volume; i++) {
            if (has_pending[i]) {
                memcpy(options->ranges[i == 0 ? options->first : options->second], pending[i],
                       sizeof pending[i]);
            }
        }
        for (int i = 0; i < AXIS_COUNT; i++) {
            if (!(options->ranges[i][1] > options->ranges[i][0])) {
                argp_error(state, "the range of %s must rise", axis_names[i]);
            }
        }
        return 0;
    default:
        return command_law(key, argument, &options->r0, &options->kp, state);
    }
}

struct line {
    struct basin_end *cells;     /* of a plane's line */
    long counts[BASIN_OUTCOMES]; /* of a slice, by outcome */
    int has_failed;              /* no memory */
};

/* A gait to stand still at, per value of r0. */
struct base {
    struct problem problem;
    double x[3];
    int good;
};

struct study {
    struct options options;
    struct base *bases; /* one, or one per value of the axis that is r0 */
    struct line *lines;
    struct report report;
    int skip;
};

static double axis_value(const struct options *options, enum axis axis, int i)
{
    const double *range = options->ranges[axis];
    return range[0] + (range[1] - range[0]) * i / (options->points - 1);
}

static void compute_line(void *context, int i)
{
    const struct study *study = context;
    const struct options *options = &study->options;
    struct line *line = &study->lines[i];
    struct basin_start *starts = calloc((size_t)options->points, sizeof *starts);
    struct basin_end *ends = calloc((size_t)options->points, sizeof *ends);
    int *cell = calloc((size_t)options->points, sizeof *cell);
    size_t count = 0;
    line->has_failed = starts == NULL || ends == NULL || cell == NULL;
    for (int j = 0; j < options->points && !line->has_failed; j++) {
        const int r0_index = options->first == AXIS_R0 ? i : options->second == AXIS_R0 ? j : 0;
        const struct base *base = &study->bases[r0_index];
        double values[AXIS_COUNT] = {base->x[0], base->x[1], base->x[2], 0.0};
        values[options->first] = axis_value(options, options->first, i);
        values[options->second] = axis_value(options, options->second, j);
        if (base->good) {
            starts[count] =
                (struct basin_start){&base->problem, base->x, {values[0], values[1], values[2]}};
            cell[count++] = j;
        }
    }
    if (count > 0) {
        line->has_failed = basin_walks(starts, count, options->strides, ends) != 0;
        for (size_t n = 0; n < count; n++) {
            line->cells[cell[n]] = ends[n];
        }
    }
    free(starts);
    free(ends);
    free(cell);
}

static int is_computed(const struct line *line)
{
    if (line->has_failed) {
        fprintf(stderr, "afo study: out of memory; take fewer --points\n");
    }
    return !line->has_failed;
}

static int report_line(void *context, int i)
{
    struct study *study = context;
    const struct options *options = &study->options;
    if (!is_computed(&study->lines[i])) {
        return 0;
    }
    for (int j = study->skip; j < options->points; j++) {
        const struct basin_end *cell = &study->lines[i].cells[j];
        const struct cell row[] = {cell_number(axis_value(options, options->first, i)),
                                   cell_number(axis_value(options, options->second, j)),
                                   cell_integer((long)cell->outcome), cell_integer(cell->strides),
                                   cell_integer((long)cell->fault)};
        report_row(&study->report, row);
    }
    study->skip = 0;
    report_progress(&study->report, i + 1, options->points);
    return !ferror(study->report.file);
}

/* Starts first .. first + count - 1 of a slice. */
static void compute_portion(const struct study *study, int i, size_t first, size_t count,
                            struct basin_start *starts, struct basin_end *ends)
{
    const struct options *options = &study->options;
    const struct base *base = &study->bases[0];
    struct line *line = &study->lines[i];
    for (size_t n = 0; n < count; n++) {
        const int j = (int)((first + n) / (size_t)options->points);
        const int k = (int)((first + n) % (size_t)options->points);
        starts[n] = (struct basin_start){&base->problem,
                                         base->x,
                                         {axis_value(options, AXIS_STANCE_RATE, i),
                                          axis_value(options, AXIS_SWING_ANGLE, j),
                                          axis_value(options, AXIS_SWING_RATE, k)}};
    }
    line->has_failed |= basin_walks(starts, count, options->strides, ends) != 0;
    for (size_t n = 0; n < count; n++) {
        line->counts[ends[n].outcome]++;
    }
}

static void compute_slice(void *context, int i)
{
    const struct study *study = context;
    const size_t all = (size_t)study->options.points * (size_t)study->options.points;
    struct basin_start *starts = calloc(PORTION, sizeof *starts);
    struct basin_end *ends = calloc(PORTION, sizeof *ends);
    const int has_room = starts != NULL && ends != NULL;
    study->lines[i].has_failed = !has_room;
    for (size_t first = 0; has_room && first < all && !study->lines[i].has_failed;
         first += PORTION) {
        compute_portion(study, i, first, all - first < PORTION ? all - first : PORTION, starts,
                        ends);
    }
    free(starts);
    free(ends);
}

static int report_slice(void *context, int i)
{
    struct study *study = context;
    const struct line *line = &study->lines[i];
    if (!is_computed(line)) {
        return 0;
    }
    const struct cell row[] = {cell_number(axis_value(&study->options, AXIS_STANCE_RATE, i)),
                               cell_integer(line->counts[BASIN_CONVERGES]),
                               cell_integer(line->counts[BASIN_WALKS_ON]),
                               cell_integer(line->counts[BASIN_FALLS])};
    report_row(&study->report, row);
    report_progress(&study->report, i + 1, study->options.points);
    return !ferror(study->report.file);
}

/* The gait at each r0 that is looked at. 0 when there is none at all. */
static int find_bases(struct study *study, int count, int *status)
{
    const struct options *options = &study->options;
    int good = 0;
    *status = EXIT_NOT_FOUND;
    for (int i = 0; i < count; i++) {
        const double r0 = count == 1 ? options->r0 : axis_value(options, AXIS_R0, i);
        struct base *base = &study->bases[i];
        base->good = command_gait(&options->common, BRANCH_LONG, r0, options->kp, &base->problem,
                                  base->x, status);
        good += base->good;
        if (!base->good && *status == EXIT_USAGE) {
            return 0;
        }
    }
    return good > 0;
}

static void print_volume(struct study *study)
{
    const struct options *options = &study->options;
    const double *resumed = study->report.resumed_totals;
    double converging = resumed[1], all = resumed[1] + resumed[2] + resumed[3], cell = 1.0;
    for (int i = 0; i < options->points; i++) {
        const long *counts = study->lines[i].counts;
        converging += (double)counts[BASIN_CONVERGES];
        all += (double)(counts[0] + counts[1] + counts[2]);
    }
    for (int k = 0; k < 3; k++) {
        cell *= (options->ranges[k][1] - options->ranges[k][0]) / (options->points - 1);
    }
    report_value(&study->report, "share", cell_number(converging / all));
    report_value(&study->report, "volume_rad3_s2", cell_number(converging * cell));
}

static int run_study(struct study *study)
{
    static const char *const plane_columns[] = {"a", "b", "outcome", "strides", "fault", NULL};
    static const char *const volume_columns[] = {"stance_rate_rad_s", "converges", "walks_on",
                                                 "falls", NULL};
    const struct options *options = &study->options;
    char settings[512];
    snprintf(
        settings, sizeof settings,
        "r0=%.17g kp=%.17g %s a=%s:%.17g:%.17g b=%s:%.17g:%.17g c=%.17g:%.17g points=%d strides=%d",
        options->r0, options->kp, options->volume ? "volume" : "plane", axis_names[options->first],
        options->ranges[options->first][0], options->ranges[options->first][1],
        axis_names[options->second], options->ranges[options->second][0],
        options->ranges[options->second][1], options->ranges[AXIS_SWING_RATE][0],
        options->ranges[AXIS_SWING_RATE][1], options->points, options->strides);
    if (!report_open(&study->report, &options->common, options->volume ? "basin-volume" : "basin",
                     settings, options->volume ? volume_columns : plane_columns)) {
        return EXIT_USAGE;
    }
    plot_name("a", axis_titles[options->first]);
    plot_name("b", axis_titles[options->second]);
    const int per_job = options->volume ? 1 : options->points;
    study->skip = study->report.rows_resumed % per_job;
    const struct pool_jobs jobs = {study->report.rows_resumed / per_job,
                                   options->points,
                                   options->common.threads,
                                   study,
                                   options->volume ? compute_slice : compute_line,
                                   options->volume ? report_slice : report_line};
    const int complete = pool_run(&jobs);
    if (options->volume && complete) {
        print_volume(study);
    } else if (!options->volume) {
        report_value(&study->report, "plane_a", cell_text(axis_names[options->first]));
        report_value(&study->report, "plane_b", cell_text(axis_names[options->second]));
    }
    return report_close(&study->report) && complete ? EXIT_FOUND : EXIT_USAGE;
}

int command_basin(int argc, char **argv)
{
    struct study study = {.options = {.common = command_defaults(),
                                      .r0 = 0.05,
                                      .first = AXIS_SWING_ANGLE,
                                      .second = AXIS_STANCE_RATE,
                                      .points = 100,
                                      .strides = 200}};
    struct options *options = &study.options;
    memcpy(options->ranges, default_ranges, sizeof default_ranges);
    command_parse(
        table, parse,
        "Tries states around the long branch's gait: outcome 1 finds the gait, 2 walks on "
        "without it, 0 falls.",
        argc, argv, options);
    const int has_r0_axis =
        !options->volume && (options->first == AXIS_R0 || options->second == AXIS_R0);
    const int base_count = has_r0_axis ? options->points : 1;
    int status = EXIT_NOT_FOUND;
    struct basin_end *cells =
        calloc((size_t)options->points * (size_t)options->points, sizeof *cells);
    study.lines = calloc((size_t)options->points, sizeof *study.lines);
    study.bases = calloc((size_t)base_count, sizeof *study.bases);
    if (cells == NULL || study.lines == NULL || study.bases == NULL) {
        fprintf(stderr, "afo study: out of memory; take fewer --points\n");
    } else if (find_bases(&study, base_count, &status)) {
        for (int i = 0; i < options->points; i++) {
            study.lines[i].cells = cells + (size_t)i * (size_t)options->points;
        }
        status = run_study(&study);
    }
    free(cells);
    free(study.lines);
    free(study.bases);
    return status;
}
