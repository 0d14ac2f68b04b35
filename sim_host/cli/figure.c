#include "sim_host/cli/figure_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    PANEL_WIDTH = 400, /* of the numbers' field */
    PANEL_HEIGHT = 250,
    LEFT = 80,
    LEFT_OF_BARS = 230, /* room for their labels */
    LEGEND = 150,
    TOP = 44, /* of the picture: its title */
    PANEL_TOP = 30,
    PANEL_BOTTOM = 52,
    BAR_HEIGHT = 9,
    TICKS = 5,
    COLUMNS_MOST = 2,
    TITLE_MOST = 150
};
#define MARGIN_PART 0.05  /* of the numbers' span, around them */
#define LEVEL_PART 1e-6   /* of their size: a smaller span is none */
#define LEVEL_MARGIN 0.02 /* of their size, around them then */

/* ---- axes ---------------------------------------------------------------------------- */

static void widen(struct figure_axis *axis, double number)
{
    const double at = !axis->is_log ? number : number > 0.0 ? log10(number) : (double)NAN;
    if (isfinite(at)) {
        axis->low = fmin(axis->low, at);
        axis->high = fmax(axis->high, at);
    }
}

static void close_axis(struct figure_axis *axis, double part)
{
    if (!(axis->high >= axis->low)) {
        axis->low = 0.0;
        axis->high = 1.0;
    }
    /* Numbers that differ by their rounding alone make a level line, not noise. */
    const double size = fmax(fabs(axis->low), fabs(axis->high)), wide = axis->high - axis->low;
    const double margin = wide > LEVEL_PART * size ? part * wide : LEVEL_MARGIN * size + 1e-9;
    axis->low -= margin;
    axis->high += margin;
}

static void span(const struct figure_panel *panel, struct figure_place *place)
{
    struct figure_axis *x = &place->x, *y = &place->y;
    for (size_t i = 0; i < panel->series_count; i++) {
        const struct figure_series *series = &panel->series[i];
        const bool is_grid = panel->mark == FIGURE_CELLS;
        const double half_x = is_grid ? figure_half_cell(series->x, series->count) : 0.0;
        const double half_y = is_grid ? figure_half_cell(series->y, series->count) : 0.0;
        for (size_t k = 0; k < series->count; k++) {
            if (isfinite(series->x[k]) && isfinite(series->y[k])) {
                widen(x, series->x[k] - half_x);
                widen(x, series->x[k] + half_x);
                widen(y, series->y[k] - half_y);
                widen(y, series->y[k] + half_y);
            }
        }
    }
    for (size_t i = 0; i < panel->levels; i++) {
        widen(y, panel->level[i]);
    }
}

static size_t bars_in(const struct figure_panel *panel)
{
    return panel->series_count > 0 ? panel->series[0].count : 0;
}

/* Bars lie: their lengths go along x, their places down y. */
static void span_bars(const struct figure_panel *panel, struct figure_place *place)
{
    widen(&place->x, panel->log_x ? (double)NAN : 0.0);
    for (size_t i = 0; i < panel->series_count; i++) {
        for (size_t k = 0; k < panel->series[i].count; k++) {
            widen(&place->x, panel->series[i].y[k]);
        }
    }
    close_axis(&place->x, MARGIN_PART);
    place->y.high = 0.0;
    place->y.low = (double)bars_in(panel);
}

static double height_of(const struct figure_panel *panel)
{
    const double bars =
        panel->mark == FIGURE_BARS
            ? (double)(bars_in(panel) * (panel->series_count * BAR_HEIGHT + BAR_HEIGHT))
            : 0.0;
    return fmax(bars, PANEL_HEIGHT);
}

static double left_of(const struct figure_panel *panel)
{
    return panel->mark == FIGURE_BARS ? LEFT_OF_BARS : LEFT;
}

static struct figure_place place_of(const struct figure_panel *panel, double left, double top)
{
    const struct figure_axis none = {(double)INFINITY, -(double)INFINITY, false, 0.0, 0.0};
    struct figure_place place = {none, none, left + left_of(panel) + PANEL_WIDTH + 14.0,
                                 top + PANEL_TOP};
    const double part = panel->mark == FIGURE_CELLS ? 0.0 : MARGIN_PART;
    place.x.is_log = panel->log_x;
    place.y.is_log = panel->log_y;
    if (panel->mark == FIGURE_BARS) {
        span_bars(panel, &place);
    } else {
        span(panel, &place);
        close_axis(&place.x, part);
        close_axis(&place.y, part);
    }
    place.x.from = left + left_of(panel);
    place.x.to = place.x.from + PANEL_WIDTH;
    place.y.from = place.top + height_of(panel);
    place.y.to = place.top;
    return place;
}

/* ---- frames -------------------------------------------------------------------------- */

/* 1, 2 or 5 times a power of ten, for about TICKS lines over a span. */
static double tick_step(double span)
{
    const double power = pow(10.0, floor(log10(span / TICKS))), part = span / TICKS / power;
    return (part < 1.5 ? 1.0 : part < 3.5 ? 2.0 : part < 7.5 ? 5.0 : 10.0) * power;
}

/* digits: behind the point; below 0: as many as the number needs. */
static void draw_tick(FILE *stream, const struct figure_place *place, double at, double number,
                      int digits, bool is_x)
{
    char text[32];
    const struct figure_axis *axis = is_x ? &place->x : &place->y;
    const double pixel =
        axis->from + (axis->to - axis->from) * (at - axis->low) / (axis->high - axis->low);
    (void)snprintf(text, sizeof text, digits < 0 ? "%.*g" : "%.*f", digits < 0 ? 6 : digits,
                   number);
    if (is_x) {
        fprintf(stream, "<path d=\"M%.1f %.1fV%.1f\" stroke=\"#e4e4e4\"/>", pixel, place->y.from,
                place->y.to);
        figure_text(stream, pixel, fmax(place->y.from, place->y.to) + 16.0,
                    " text-anchor=\"middle\"", text);
    } else {
        fprintf(stream, "<path d=\"M%.1f %.1fH%.1f\" stroke=\"#e4e4e4\"/>", place->x.from, pixel,
                place->x.to);
        figure_text(stream, place->x.from - 6.0, pixel + 4.0, " text-anchor=\"end\"", text);
    }
}

static void draw_log_ticks(FILE *stream, const struct figure_place *place, bool is_x)
{
    static const double parts[] = {1.0, 2.0, 5.0};
    const struct figure_axis *axis = is_x ? &place->x : &place->y;
    const bool wide = axis->high - axis->low > 2.5;
    const int every = (int)fmax(1.0, ceil((axis->high - axis->low) / (2 * TICKS)));
    for (int power = (int)floor(axis->low); power <= (int)ceil(axis->high); power++) {
        for (int i = 0; i < (wide ? 1 : 3); i++) {
            const double at = power + log10(parts[i]);
            if (at >= axis->low && at <= axis->high && power % every == 0) {
                draw_tick(stream, place, at, pow(10.0, at), -1, is_x);
            }
        }
    }
}

static void draw_ticks(FILE *stream, const struct figure_place *place, bool is_x, bool is_whole)
{
    const struct figure_axis *axis = is_x ? &place->x : &place->y;
    if (axis->is_log) {
        draw_log_ticks(stream, place, is_x);
        return;
    }
    const double step = fmax(tick_step(axis->high - axis->low), is_whole ? 1.0 : 0.0);
    const int digits = step > 1e5 || step < 1e-6 ? -1 : (int)fmax(0.0, -floor(log10(step)));
    for (double i = ceil(axis->low / step); i * step <= axis->high; i += 1.0) {
        const double number = i * step + 0.0; /* no -0 */
        draw_tick(stream, place, number, number, digits, is_x);
    }
}

/* Whether x is a count: no tick lies between two of them. */
static bool is_counted(const struct figure_panel *panel)
{
    for (size_t i = 0; i < panel->series_count; i++) {
        for (size_t k = 0; k < panel->series[i].count; k++) {
            if (isfinite(panel->series[i].x[k]) &&
                panel->series[i].x[k] != floor(panel->series[i].x[k])) {
                return false;
            }
        }
    }
    return panel->mark != FIGURE_BARS;
}

static void draw_titles(FILE *stream, const struct figure_panel *panel,
                        const struct figure_place *place)
{
    char turned[96];
    const double middle = 0.5 * (place->x.from + place->x.to);
    if (panel->title != NULL) {
        figure_text(stream, place->x.from, place->top - 8.0, " font-weight=\"bold\"", panel->title);
    }
    if (panel->x_title != NULL) {
        figure_text(stream, middle, place->y.from + 34.0, " text-anchor=\"middle\"",
                    panel->x_title);
    }
    if (panel->y_title != NULL && panel->mark != FIGURE_BARS) {
        const double x = place->x.from - LEFT + 16.0, y = 0.5 * (place->y.from + place->y.to);
        (void)snprintf(turned, sizeof turned,
                       " text-anchor=\"middle\" transform=\"rotate(-90 %.1f %.1f)\"", x, y);
        figure_text(stream, x, y, turned, panel->y_title);
    }
}

static void draw_panel(FILE *stream, const struct figure_panel *panel, double left, double top)
{
    const struct figure_place place = place_of(panel, left, top);
    draw_titles(stream, panel, &place);
    draw_ticks(stream, &place, true, is_counted(panel));
    if (panel->mark != FIGURE_BARS) {
        draw_ticks(stream, &place, false, false);
    }
    for (size_t i = 0; i < panel->levels; i++) {
        fprintf(stream, "<path d=\"M%.1f %.1fH%.1f\" stroke=\"#555\" stroke-dasharray=\"6 4\"/>\n",
                place.x.from, figure_pixel(&place.y, panel->level[i]), place.x.to);
    }
    figure_draw(stream, panel, &place);
    fprintf(
        stream,
        "<path class=\"frame\" fill=\"none\" stroke=\"#888\" d=\"M%.1f %.1fH%.1fV%.1fH%.1fZ\"/>\n",
        place.x.from, place.y.from, place.x.to, place.y.to, place.x.from);
}

void figure_write(FILE *stream, const char *title, const struct figure_panel *panels, size_t count)
{
    const size_t columns = count < COLUMNS_MOST ? (count > 0 ? count : 1) : COLUMNS_MOST;
    double tallest = 0.0, left = LEFT;
    for (size_t p = 0; p < count; p++) {
        tallest = fmax(tallest, height_of(&panels[p]));
        left = fmax(left, left_of(&panels[p]));
    }
    const double panel_width = left + PANEL_WIDTH + LEGEND;
    const double panel_height = PANEL_TOP + tallest + PANEL_BOTTOM;
    const double width = (double)columns * panel_width;
    const double height = TOP + (double)((count + columns - 1) / columns) * panel_height;
    char shown[TITLE_MOST + 8];
    (void)snprintf(shown, sizeof shown, "%.*s%s", TITLE_MOST, title,
                   strlen(title) > TITLE_MOST ? " ..." : "");
    fprintf(stream,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %.0f %.0f\" width=\"%.0f\" "
            "height=\"%.0f\" font-family=\"sans-serif\" font-size=\"12\">\n<title>",
            width, height, width, height);
    figure_escape(stream, title);
    fputs("</title>\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n", stream);
    figure_text(stream, 16.0, 22.0, " font-size=\"14\"", shown);
    for (size_t p = 0; p < count; p++) {
        draw_panel(stream, &panels[p], (double)(p % columns) * panel_width,
                   TOP + (double)(p / columns) * panel_height);
    }
    fputs("</svg>\n", stream);
}
