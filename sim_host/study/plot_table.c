#include "sim_host/study/plot_table.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { NAME_BYTES = 96 };

/* ---- reading ------------------------------------------------------------------------- */

static size_t count_of(const char *text, char letter)
{
    size_t count = 0;
    for (; *text != '\0'; text++) {
        count += *text == letter;
    }
    return count;
}

/* Cuts a line into fields, at most `most`; those that are missing are empty. */
static size_t cut(char *line, const char **field, size_t most)
{
    size_t count = 0;
    for (char *at = line; count < most; count++) {
        char *comma = strchr(at, ',');
        field[count] = at;
        if (comma == NULL) {
            return count + 1;
        }
        *comma = '\0';
        at = comma + 1;
    }
    return count;
}

int plot_columns_read(struct plot_columns *table, const char *text)
{
    char *rest = NULL;
    *table = (struct plot_columns){.text = strdup(text != NULL ? text : "")};
    if (table->text == NULL) {
        return -1;
    }
    const size_t lines = count_of(table->text, '\n');
    char *line = strtok_r(table->text, "\n", &rest);
    if (line == NULL) {
        return 0;
    }
    table->columns = cut(line, table->name, PLOT_COLUMNS_MOST);
    table->field = calloc(lines * table->columns + 1, sizeof *table->field);
    if (table->field == NULL) {
        return -1;
    }
    while ((line = strtok_r(NULL, "\n", &rest)) != NULL && table->rows < lines) {
        const char **field = &table->field[table->rows * table->columns];
        for (size_t i = cut(line, field, table->columns); i < table->columns; i++) {
            field[i] = "";
        }
        table->rows++;
    }
    return 0;
}

void plot_columns_free(struct plot_columns *table)
{
    for (size_t i = 0; i < table->kept_count; i++) {
        free(table->kept[i]);
    }
    free(table->kept);
    free(table->field);
    free(table->text);
    *table = (struct plot_columns){.text = NULL};
}

/* Memory that is freed with the table; NULL: none is left. */
static void *keep(struct plot_columns *table, size_t count, size_t size)
{
    void **more = realloc(table->kept, (table->kept_count + 1) * sizeof *more);
    if (more == NULL) {
        return NULL;
    }
    table->kept = more;
    more[table->kept_count] = calloc(count + 1, size);
    return more[table->kept_count] != NULL ? more[table->kept_count++] : NULL;
}

/* ---- fields -------------------------------------------------------------------------- */

static const char *text_at(const struct plot_columns *table, size_t row, const char *column,
                           size_t length)
{
    for (size_t i = 0; i < table->columns; i++) {
        if (strlen(table->name[i]) == length && strncmp(table->name[i], column, length) == 0) {
            return table->field[row * table->columns + i];
        }
    }
    return "";
}

static double number_of(const char *text)
{
    char *end;
    const double number = strtod(text, &end);
    return end != text && *end == '\0'  ? number
           : strcmp(text, "true") == 0  ? 1.0
           : strcmp(text, "false") == 0 ? 0.0
                                        : (double)NAN;
}

/* Of a column, or of the quotient of two. */
static double number_at(const struct plot_columns *table, size_t row, const char *column)
{
    const size_t length = strcspn(column, "/");
    const double number = number_of(text_at(table, row, column, length));
    return column[length] == '\0' ? number
                                  : number / number_of(text_at(table, row, column + length + 1,
                                                               strlen(column + length + 1)));
}

/* Whether a row is one of "column=text,column=text". */
static bool counts(const struct plot_columns *table, size_t row, const char *where)
{
    while (where != NULL && *where != '\0') {
        const size_t name = strcspn(where, "="), all = strcspn(where, ",");
        const char *text = text_at(table, row, where, name);
        if (strlen(text) != all - name - 1 ||
            strncmp(text, where + name + 1, all - name - 1) != 0) {
            return false;
        }
        where += all + (where[all] == ',');
    }
    return true;
}

static bool is_in(const struct plot_columns *table, size_t row, const char *column,
                  const char *text)
{
    return column == NULL || text == NULL ||
           strcmp(text_at(table, row, column, strlen(column)), text) == 0;
}

size_t plot_texts(const struct plot_columns *table, const char *column, const char **texts,
                  size_t most)
{
    size_t count = 0;
    for (size_t row = 0; row < table->rows && count < most; row++) {
        const char *text = text_at(table, row, column, strlen(column));
        size_t i = 0;
        while (i < count && strcmp(texts[i], text) != 0) {
            i++;
        }
        if (i == count) {
            texts[count++] = text;
        }
    }
    return count;
}

/* ---- series -------------------------------------------------------------------------- */

struct curve {
    const struct picture_panel *asked;
    const char *only, *group, *y;
};

/* What the legend calls a curve: its group, its column, or both. */
static const char *name_of(struct plot_columns *table, const struct curve *curve)
{
    char *name = keep(table, NAME_BYTES, 1);
    char column[NAME_BYTES] = "";
    const struct picture_panel *asked = curve->asked;
    if (asked->y[1] != NULL) {
        plot_axis_title(curve->y, column, sizeof column);
    }
    if (name != NULL) {
        if (curve->group != NULL) {
            plot_group_title(asked->by, curve->group, name, NAME_BYTES);
        }
        const size_t used = strlen(name);
        (void)snprintf(name + used, NAME_BYTES - used, "%s%s",
                       used > 0 && column[0] != '\0' ? ", " : "", column);
    }
    return name;
}

static void take_row(const struct plot_columns *table, size_t row, const struct curve *curve,
                     double *x, double *y, double *value, const char **label, size_t at)
{
    const bool is_bar = curve->asked->mark == FIGURE_BARS;
    x[at] = is_bar ? (double)at : number_at(table, row, curve->asked->x);
    y[at] = number_at(table, row, curve->y);
    value[at] = curve->asked->value != NULL ? number_at(table, row, curve->asked->value) : 0.0;
    label[at] = is_bar ? text_at(table, row, curve->asked->x, strlen(curve->asked->x)) : NULL;
}

/* Adds the curve's series to the panel, if it has a number. 0, or -1 without memory. */
static int add_series(struct plot_columns *table, const struct curve *curve,
                      struct figure_panel *panel)
{
    const size_t room = 2 * table->rows;
    double *x = keep(table, room, sizeof *x), *y = keep(table, room, sizeof *y);
    double *value = keep(table, room, sizeof *value);
    const char **label = keep(table, room, sizeof *label), *name = name_of(table, curve);
    size_t count = 0, found = 0;
    const bool is_bar = curve->asked->mark == FIGURE_BARS;
    bool was_in = false;
    if (x == NULL || y == NULL || value == NULL || label == NULL || name == NULL) {
        return -1;
    }
    for (size_t row = 0; row < table->rows; row++) {
        const bool is_asked = counts(table, row, curve->asked->where);
        if (!is_in(table, row, curve->asked->per, curve->only) || (!is_asked && !is_bar)) {
            continue;
        }
        const bool is_its = is_in(table, row, curve->asked->by, curve->group);
        /* The first point of the next run ends this one, so that the lines meet. */
        if (is_its || (curve->asked->in_runs && was_in)) {
            take_row(table, row, curve, x, y, value, label, count);
            y[count] =
                is_asked ? y[count] : (double)NAN; /* a bar that is missing keeps its place */
            found += isfinite(y[count]) != 0;
            count++;
        }
        if (!is_its && was_in && curve->asked->in_runs) {
            x[count] = y[count] = (double)NAN;
            count++;
        }
        was_in = is_its;
    }
    const bool is_drawn = found > 0 || (is_bar && count > 0);
    table->is_cut = table->is_cut || (is_drawn && panel->series_count == FIGURE_SERIES_MOST);
    if (is_drawn && panel->series_count < FIGURE_SERIES_MOST) {
        if (panel->series_count == 0) {
            panel->labels = (const char *const *)label;
        }
        panel->series[panel->series_count++] = (struct figure_series){name, x, y, value, count};
    }
    return 0;
}

int plot_fill(struct plot_columns *table, const struct picture_panel *asked, const char *only,
              struct figure_panel *panel)
{
    const char *groups[FIGURE_SERIES_MOST + 1] = {NULL};
    size_t count = 1;
    if (asked->by != NULL) {
        count = plot_texts(table, asked->by, groups, FIGURE_SERIES_MOST + 1);
    }
    for (size_t g = 0; g < count; g++) {
        for (int c = 0; c < PICTURE_CURVES && asked->y[c] != NULL; c++) {
            const struct curve curve = {asked, only, groups[g], asked->y[c]};
            if (add_series(table, &curve, panel) != 0) {
                return -1;
            }
        }
    }
    return 0;
}

/* ---- words --------------------------------------------------------------------------- */

void plot_group_title(const char *column, const char *group, char *text, size_t size)
{
    char title[NAME_BYTES], *end;
    plot_axis_title(column, title, sizeof title);
    const double number = strtod(group, &end);
    if (strcmp(group, "true") == 0 || strcmp(group, "false") == 0) {
        (void)snprintf(text, size, "%s%s", group[0] == 't' ? "" : "not ", title);
    } else if (end != group && *end == '\0') {
        (void)snprintf(text, size, "%s %.4g", title, number);
    } else {
        (void)snprintf(text, size, "%s", group);
    }
}

void plot_axis_title(const char *column, char *text, size_t size)
{
    static const struct {
        const char *end, *unit;
    } units[] = {{"_rad_s", "rad/s"},   {"_m_s", "m/s"},  {"_J_per_m", "J/m"}, {"_J_m", "J/m"},
                 {"_per_min", "1/min"}, {"_N", "N"},      {"_rad", "rad"},     {"_mm", "mm"},
                 {"_ms", "ms"},         {"_Ns", "N s"},   {"_N_m", "N/m"},     {"_m", "m"},
                 {"_s", "s"},           {"_percent", "%"}};
    const size_t length = strlen(column);
    size_t used = length;
    const char *unit = NULL;
    for (size_t i = 0; i < sizeof units / sizeof units[0] && unit == NULL; i++) {
        const size_t end = strlen(units[i].end);
        if (length > end && strcmp(column + length - end, units[i].end) == 0) {
            unit = units[i].unit;
            used = length - end;
        }
    }
    (void)snprintf(text, size, "%.*s%s%s%s", (int)used, column, unit != NULL ? " (" : "",
                   unit != NULL ? unit : "", unit != NULL ? ")" : "");
    for (char *at = text; *at != '\0' && at < text + used; at++) {
        *at = *at == '_' ? ' ' : *at;
    }
}
