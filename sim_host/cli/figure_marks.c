#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sim_host/cli/figure_internal.h"

enum {
    COLOURS = 8,
    DOTTED_MOST = 60, /* a line of more points has no dots of its own */
    RASTER = 2,       /* dots nearer than half a pixel are one */
    SHADES = 6,
    SHADES_SHOWN = 6,
    LEGEND_LETTERS = 22
};

/* Distinct without red beside green, too (Okabe and Ito 2008). */
static const char *const colours[COLOURS] = {"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                             "#e69f00", "#56b4e9", "#000000", "#999999"};

static const char *figure_colour(size_t series)
{
    return colours[series % COLOURS];
}

/* ---- lines and dots ------------------------------------------------------------------ */

static void draw_line(FILE *stream, const struct figure_series *series, const char *colour,
                      const struct figure_place *place)
{
    bool is_down = false;
    fprintf(stream, "<path class=\"line\" fill=\"none\" stroke=\"%s\" stroke-width=\"1.6\" d=\"",
            colour);
    for (size_t i = 0; i < series->count; i++) {
        const double x = figure_pixel(&place->x, series->x[i]);
        const double y = figure_pixel(&place->y, series->y[i]);
        const bool is_there = isfinite(x) && isfinite(y);
        if (is_there) {
            fprintf(stream, "%c%.1f %.1f", is_down ? 'L' : 'M', x, y);
        }
        is_down = is_there;
    }
    fputs("\"/>\n", stream);
}

/* A path of points, each where none is yet; without memory for that, all of them. */
static void draw_dots(FILE *stream, const struct figure_series *series, const char *colour,
                      const struct figure_place *place, double width)
{
    const size_t columns = (size_t)(RASTER * fabs(place->x.to - place->x.from)) + 2;
    const size_t rows = (size_t)(RASTER * fabs(place->y.to - place->y.from)) + 2;
    unsigned char *taken = calloc(columns, rows);
    fprintf(
        stream,
        "<path class=\"dots\" fill=\"none\" stroke=\"%s\" stroke-width=\"%.1f\" stroke-linecap=\"round\" d=\"",
        colour, width);
    for (size_t i = 0; i < series->count; i++) {
        const double x = figure_pixel(&place->x, series->x[i]);
        const double y = figure_pixel(&place->y, series->y[i]);
        if (!isfinite(x) || !isfinite(y)) {
            continue;
        }
        const size_t at = (size_t)(RASTER * fabs(y - place->y.to)) % rows * columns +
                          (size_t)(RASTER * fabs(x - place->x.from)) % columns;
        if (taken == NULL || taken[at] == 0) {
            fprintf(stream, "M%.1f %.1fh0", x, y);
        }
        if (taken != NULL) {
            taken[at] = 1;
        }
    }
    fputs("\"/>\n", stream);
    free(taken);
}

/* ---- cells --------------------------------------------------------------------------- */

/* From dark to bright also in grey (after Smith and van der Walt's viridis, 2015). */
static void shade(double part, char *text, size_t size)
{
    static const double stops[SHADES][3] = {{68, 1, 84},    {65, 68, 135},  {42, 120, 142},
                                            {34, 168, 132}, {122, 209, 81}, {253, 231, 37}};
    const double at = fmin(fmax(part, 0.0), 1.0) * (SHADES - 1);
    const int from = (int)fmin(floor(at), SHADES - 2);
    int mixed[3];
    for (int k = 0; k < 3; k++) {
        mixed[k] = (int)(stops[from][k] + (at - from) * (stops[from + 1][k] - stops[from][k]));
    }
    (void)snprintf(text, size, "#%02x%02x%02x", (unsigned)mixed[0], (unsigned)mixed[1],
                   (unsigned)mixed[2]);
}

static void value_range(const struct figure_series *series, double *low, double *high)
{
    *low = (double)INFINITY;
    *high = -(double)INFINITY;
    for (size_t i = 0; i < series->count; i++) {
        if (isfinite(series->value[i])) {
            *low = fmin(*low, series->value[i]);
            *high = fmax(*high, series->value[i]);
        }
    }
    if (!(*high > *low)) {
        *low = isfinite(*low) ? *low : 0.0;
        *high = *low + 1.0;
    }
}

static void draw_shades(FILE *stream, const struct figure_panel *panel,
                        const struct figure_place *place, double low, double high)
{
    char colour[8], text[32];
    if (panel->value_title != NULL) {
        figure_text(stream, place->legend_left, place->top + 10.0, "", panel->value_title);
    }
    const bool whole = high - low < SHADES_SHOWN && floor(low) == low && floor(high) == high;
    const int shown = whole ? (int)(high - low) + 1 : SHADES_SHOWN;
    for (int i = 0; i < shown; i++) {
        const double part = (double)i / (shown > 1 ? shown - 1 : 1);
        const double y = place->top + 20.0 + 18.0 * i;
        shade(part, colour, sizeof colour);
        fprintf(stream, "<rect x=\"%.1f\" y=\"%.1f\" width=\"16\" height=\"14\" fill=\"%s\"/>",
                place->legend_left, y, colour);
        (void)snprintf(text, sizeof text, "%.4g", low + part * (high - low));
        figure_text(stream, place->legend_left + 22.0, y + 11.0, "", text);
    }
}

static void draw_cells(FILE *stream, const struct figure_panel *panel,
                       const struct figure_place *place)
{
    const struct figure_series *series = &panel->series[0];
    const double half_x = figure_half_cell(series->x, series->count);
    const double half_y = figure_half_cell(series->y, series->count);
    double low, high;
    char colour[8];
    value_range(series, &low, &high);
    fputs("<g shape-rendering=\"crispEdges\">\n", stream);
    for (size_t i = 0; i < series->count; i++) {
        const double x = series->x[i], y = series->y[i];
        if (!isfinite(series->value[i]) || !isfinite(x) || !isfinite(y)) {
            continue;
        }
        const double left = figure_pixel(&place->x, x - half_x);
        const double top = figure_pixel(&place->y, y + half_y);
        shade((series->value[i] - low) / (high - low), colour, sizeof colour);
        fprintf(stream, "<path class=\"cell\" fill=\"%s\" d=\"M%.1f %.1fH%.1fV%.1fH%.1fZ\"/>\n",
                colour, left, top, figure_pixel(&place->x, x + half_x),
                figure_pixel(&place->y, y - half_y), left);
    }
    fputs("</g>\n", stream);
    draw_shades(stream, panel, place, low, high);
}

/* ---- bars ---------------------------------------------------------------------------- */

static void draw_bars(FILE *stream, const struct figure_panel *panel,
                      const struct figure_place *place)
{
    const double least = panel->log_x ? place->x.from : figure_pixel(&place->x, 0.0);
    const double band = (place->y.from - place->y.to) / fmax(place->y.low, 1.0);
    const double bar = band / ((double)panel->series_count + 1.0);
    for (size_t k = 0; panel->series_count > 0 && k < panel->series[0].count; k++) {
        const double top = place->y.to + band * (double)k + 0.5 * bar;
        figure_text(stream, place->x.from - 6.0, top + 0.5 * (band - bar) + 4.0,
                    " text-anchor=\"end\"", panel->labels[k]);
        for (size_t i = 0; i < panel->series_count; i++) {
            const double end = k < panel->series[i].count
                                   ? figure_pixel(&place->x, panel->series[i].y[k])
                                   : (double)NAN;
            if (isfinite(end)) {
                fprintf(
                    stream,
                    "<rect class=\"bar\" x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\" fill=\"%s\"/>\n",
                    fmin(least, end), top + bar * (double)i, fabs(end - least), bar,
                    figure_colour(i));
            }
        }
    }
}

/* ---- a panel ------------------------------------------------------------------------- */

static void draw_legend(FILE *stream, const struct figure_panel *panel,
                        const struct figure_place *place)
{
    double y = place->top + 12.0;
    for (size_t i = 0; i < panel->series_count; i++) {
        const char *name = panel->series[i].name;
        if (name == NULL || name[0] == '\0') {
            continue;
        }
        fprintf(stream, "<path d=\"M%.1f %.1fh16\" stroke=\"%s\" stroke-width=\"3\"/>",
                place->legend_left, y - 4.0, figure_colour(i));
        figure_text(stream, place->legend_left + 22.0, y,
                    strlen(name) > LEGEND_LETTERS ? " font-size=\"9\"" : "", name);
        y += 17.0;
    }
}

void figure_draw(FILE *stream, const struct figure_panel *panel, const struct figure_place *place)
{
    if (panel->mark == FIGURE_BARS) {
        draw_bars(stream, panel, place);
    } else if (panel->mark == FIGURE_CELLS && panel->series_count > 0) {
        draw_cells(stream, panel, place);
        return;
    }
    for (size_t i = 0; i < panel->series_count && panel->mark != FIGURE_BARS; i++) {
        const struct figure_series *series = &panel->series[i];
        if (panel->mark == FIGURE_LINE) {
            draw_line(stream, series, figure_colour(i), place);
        }
        if (panel->mark == FIGURE_DOTS || series->count <= DOTTED_MOST) {
            draw_dots(stream, series, figure_colour(i), place,
                      panel->mark == FIGURE_DOTS && series->count > DOTTED_MOST ? 1.4 : 5.0);
        }
    }
    draw_legend(stream, panel, place);
}
