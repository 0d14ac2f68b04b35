#include "sim_host/study/plot.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sim_host/cli/exit_status.h"
#include "sim_host/cli/option.h"
#include "sim_host/cli/program.h"
#include "sim_host/cli/program_output.h"
#include "sim_host/study/pictures.h"
#include "sim_host/study/plot_table.h"

enum { KEY_PLOT = 0x7100, CHILDREN_MOST = 4, NAMES_MOST = 4, TITLE_BYTES = 512, PANELS_MOST = 16 };

/* Of the running study; a process runs one. */
static struct {
    struct output_file file;
    char title[TITLE_BYTES]; /* the command */
    const char *study;
    FILE *stream; /* into text */
    char *text;
    size_t bytes;
    struct {
        const char *column, *title;
    } names[NAMES_MOST];
    size_t name_count;
} plot;

/* ---- the option ---------------------------------------------------------------------- */

static const struct argp_option option_list[] = {
    {0, 0, 0, 0, "Picture:", 110},
    {"plot", KEY_PLOT, "FILE.svg", 0, "draw what was found", 110},
    {0}};

static error_t take(int key, char *text, struct argp_state *state)
{
    if (key != KEY_PLOT) {
        return ARGP_ERR_UNKNOWN;
    }
    const size_t length = strlen(text);
    if (length < 5 || strcmp(text + length - 4, ".svg") != 0) {
        argp_error(state, "--plot %s: the picture is an SVG; give it a name that ends in .svg",
                   text);
    }
    output_file_discard(&plot.file);
    if (program_open_output(&plot.file, text) != 0) {
        exit(EXIT_USAGE);
    }
    return 0;
}

static void discard_at_exit(void)
{
    output_file_discard(&plot.file);
}

void plot_option_parse(const struct argp *parser, int argc, char **argv, void *input)
{
    static const struct argp own = {option_list, take, 0, 0, 0, 0, 0};
    struct argp_child children[CHILDREN_MOST + 2] = {{0}};
    struct argp whole = *parser;
    size_t count = 0;
    for (; parser->children != NULL && parser->children[count].argp != NULL; count++) {
        if (count == CHILDREN_MOST) {
            abort(); /* more room is needed here */
        }
        children[count] = parser->children[count];
    }
    children[count] = (struct argp_child){&own, 0, 0, 0};
    whole.children = children;
    program_command_text(argc, argv, plot.title, sizeof plot.title);
    (void)atexit(discard_at_exit);
    option_parse(&whole, argc, argv, input);
}

/* ---- the table ----------------------------------------------------------------------- */

static void forget_table(void)
{
    if (plot.stream != NULL) {
        (void)fclose(plot.stream);
    }
    free(plot.text);
    plot.stream = NULL;
    plot.text = NULL;
    plot.bytes = 0;
}

int plot_is_asked(void)
{
    return plot.file.stream != NULL;
}

void plot_copy_table(FILE *to)
{
    if (plot.stream != NULL && fflush(plot.stream) == 0) {
        (void)fwrite(plot.text, 1, plot.bytes,
                     to); /* errors are found when the file is committed */
    }
}

FILE *plot_table(const char *study)
{
    if (plot.file.stream == NULL) {
        return NULL;
    }
    forget_table();
    plot.study = study;
    plot.stream = open_memstream(&plot.text, &plot.bytes);
    if (plot.stream == NULL) {
        program_complain("out of memory for the picture");
    }
    return plot.stream;
}

void plot_name(const char *column, const char *title)
{
    if (plot.name_count < NAMES_MOST) {
        plot.names[plot.name_count].column = column;
        plot.names[plot.name_count++].title = title;
    }
}

/* ---- the picture --------------------------------------------------------------------- */

struct drawing {
    struct plot_columns table;
    struct figure_panel panels[PANELS_MOST];
    char title[PANELS_MOST][128], x_title[PANELS_MOST][64], y_title[PANELS_MOST][64],
        value_title[PANELS_MOST][64];
    size_t count;
};

static void name_axis(const char *column, char *text, size_t size)
{
    for (size_t i = 0; i < plot.name_count; i++) {
        if (strcmp(plot.names[i].column, column) == 0) {
            (void)snprintf(text, size, "%s", plot.names[i].title);
            return;
        }
    }
    plot_axis_title(column, text, size);
}

static void begin_panel(struct drawing *drawing, const struct picture_panel *asked,
                        const char *only)
{
    struct figure_panel *panel = &drawing->panels[drawing->count];
    const size_t i = drawing->count;
    const bool more = asked->y[1] != NULL;
    panel->mark = asked->mark;
    panel->log_x = asked->log_x;
    panel->log_y = asked->log_y;
    panel->levels = asked->levels;
    memcpy(panel->level, asked->level, sizeof panel->level);
    char group[64] = "";
    if (only != NULL) {
        plot_group_title(asked->per, only, group, sizeof group);
    }
    (void)snprintf(drawing->title[i], sizeof drawing->title[i], "%s%s%s",
                   asked->title != NULL ? asked->title : "",
                   asked->title != NULL && only != NULL ? ": " : "", group);
    name_axis(asked->mark == FIGURE_BARS ? asked->y[0] : asked->x, drawing->x_title[i],
              sizeof drawing->x_title[i]);
    if (asked->y_title == NULL && !more) {
        name_axis(asked->y[0], drawing->y_title[i], sizeof drawing->y_title[i]);
    }
    if (asked->value != NULL) {
        name_axis(asked->value, drawing->value_title[i], sizeof drawing->value_title[i]);
    }
    panel->title = drawing->title[i];
    panel->x_title = drawing->x_title[i];
    panel->y_title = asked->y_title != NULL ? asked->y_title : drawing->y_title[i];
    panel->value_title = asked->value_title != NULL ? asked->value_title : drawing->value_title[i];
}

/* One panel of the picture, or one for each text of its column `per`. 0, or -1 without memory. */
static int add_panels(struct drawing *drawing, const struct picture_panel *asked)
{
    const char *texts[PANELS_MOST + 1] = {NULL};
    size_t count = 1;
    if (asked->per != NULL) {
        count = plot_texts(&drawing->table, asked->per, texts, PANELS_MOST + 1);
    }
    drawing->table.is_cut = drawing->table.is_cut || drawing->count + count > PANELS_MOST;
    for (size_t i = 0; i < count && drawing->count < PANELS_MOST; i++) {
        begin_panel(drawing, asked, texts[i]);
        struct figure_panel *panel = &drawing->panels[drawing->count];
        if (plot_fill(&drawing->table, asked, texts[i], panel) != 0) {
            return -1;
        }
        drawing->count += panel->series_count > 0;
        if (panel->series_count == 0) {
            *panel = (struct figure_panel){.mark = FIGURE_LINE};
        }
    }
    return 0;
}

static int draw(const struct picture *picture)
{
    struct drawing *drawing = calloc(1, sizeof *drawing);
    int done = drawing != NULL ? plot_columns_read(&drawing->table, plot.text) : -1;
    for (int i = 0; i < PICTURE_PANELS && done == 0 && picture->panel[i].y[0] != NULL; i++) {
        done = add_panels(drawing, &picture->panel[i]);
    }
    if (done != 0) {
        program_complain("out of memory for the picture");
    } else if (drawing->count == 0) {
        program_complain("nothing was found that could be drawn: %s was not written",
                         plot.file.path);
        output_file_discard(&plot.file);
    } else {
        if (drawing->table.is_cut) {
            program_complain("%s takes %d panels of %d lines each: more was found than is drawn",
                             plot.file.path, (int)PANELS_MOST, (int)FIGURE_SERIES_MOST);
        }
        figure_write(plot.file.stream, plot.title, drawing->panels, drawing->count);
        done = program_commit_output(&plot.file);
    }
    if (drawing != NULL) {
        plot_columns_free(&drawing->table);
        free(drawing);
    }
    return done;
}

int plot_finish(int status)
{
    if (plot.file.stream == NULL) {
        return status;
    }
    const bool is_whole = plot.stream != NULL && fclose(plot.stream) == 0;
    plot.stream = NULL;
    if (is_whole && status != EXIT_USAGE && draw(picture_of(plot.study)) != 0) {
        status = EXIT_USAGE;
    } else if (!is_whole && status == EXIT_GOOD) {
        program_complain("%s was not written", plot.file.path);
        status = EXIT_USAGE;
    }
    forget_table();
    output_file_discard(&plot.file);
    return status;
}
