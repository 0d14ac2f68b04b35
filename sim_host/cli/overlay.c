#include "sim_host/cli/overlay.h"

#include <math.h>

enum {
    WIDTH = 860,
    PANEL_HEIGHT = 250,
    LEFT = 70,
    RIGHT = 180, /* of it the legend */
    TOP = 50,
    GAP = 40,
    BOTTOM = 50,
    DOTS_MOST = 60,
    TICKS = 5
};

/* Distinct without red beside green, too (Okabe and Ito 2008). */
static const char *const colours[OVERLAY_LINES_MOST] = {"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                                        "#e69f00", "#56b4e9", "#000000", "#999999"};

struct scale {
    double low, high;
};

static double longest(const struct overlay_panel *panels, size_t count)
{
    size_t most = 2;
    for (size_t p = 0; p < count; p++) {
        for (size_t i = 0; i < panels[p].lines; i++) {
            most = panels[p].line[i].count > most ? panels[p].line[i].count : most;
        }
    }
    return (double)most;
}

static struct scale scale_of(const struct overlay_panel *panel)
{
    struct scale scale = {(double)INFINITY, -(double)INFINITY};
    for (size_t i = 0; i < panel->lines; i++) {
        for (size_t k = 0; k < panel->line[i].count; k++) {
            scale.low = fmin(scale.low, panel->line[i].value[k]);
            scale.high = fmax(scale.high, panel->line[i].value[k]);
        }
    }
    if (!(scale.high >= scale.low)) {
        return (struct scale){0.0, 1.0};
    }
    const double margin = fmax(0.06 * (scale.high - scale.low), 1e-9);
    return (struct scale){scale.low - margin, scale.high + margin};
}

static double across(double x, double most)
{
    return LEFT + (x - 1.0) / (most - 1.0) * (WIDTH - LEFT - RIGHT);
}

static double down(double value, const struct scale *scale, double top)
{
    return top + PANEL_HEIGHT * (scale->high - value) / (scale->high - scale->low);
}

/* 1, 2 or 5 times a power of ten, for about TICKS lines over a span. */
static double tick_step(double span)
{
    const double power = pow(10.0, floor(log10(span / TICKS))), part = span / TICKS / power;
    return (part < 1.5 ? 1.0 : part < 3.5 ? 2.0 : part < 7.5 ? 5.0 : 10.0) * power;
}

static void draw_frame(FILE *stream, const struct overlay_panel *panel, const struct scale *scale,
                       double top, double most)
{
    const double step = tick_step(scale->high - scale->low), x_step = fmax(tick_step(most), 1.0);
    fprintf(stream, "<text x=\"%d\" y=\"%.1f\" font-weight=\"bold\">%s</text>\n", LEFT, top - 8.0,
            panel->title);
    for (int i = (int)ceil(scale->low / step); i * step <= scale->high; i++) {
        const double y = down(i * step, scale, top);
        fprintf(
            stream,
            "<path d=\"M%d %.1fH%d\" stroke=\"#ddd\"/><text x=\"%d\" y=\"%.1f\" text-anchor=\"end\">%.6g</text>\n",
            LEFT, y, WIDTH - RIGHT, LEFT - 6, y + 4.0, i * step);
    }
    for (int i = 1; i * x_step <= most; i++) {
        fprintf(stream, "<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"middle\">%.6g</text>\n",
                across(i * x_step, most), top + PANEL_HEIGHT + 16.0, i * x_step);
    }
    fprintf(
        stream,
        "<rect x=\"%d\" y=\"%.1f\" width=\"%d\" height=\"%d\" fill=\"none\" stroke=\"#888\"/>\n",
        LEFT, top, WIDTH - LEFT - RIGHT, PANEL_HEIGHT);
}

static void draw_line(FILE *stream, const struct overlay_line *line, const char *colour,
                      const struct scale *scale, double top, double most)
{
    int is_down = 0;
    fprintf(stream, "<path fill=\"none\" stroke=\"%s\" stroke-width=\"1.6\" d=\"", colour);
    for (size_t k = 0; k < line->count; k++) {
        const int is_there = isfinite(line->value[k]);
        if (is_there) {
            fprintf(stream, "%c%.1f %.1f", is_down ? 'L' : 'M', across((double)k + 1.0, most),
                    down(line->value[k], scale, top));
        }
        is_down = is_there;
    }
    fputs("\"/>\n", stream);
    for (size_t k = 0; k < line->count && most <= DOTS_MOST; k++) {
        if (isfinite(line->value[k])) {
            fprintf(stream, "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"2.4\" fill=\"%s\"/>\n",
                    across((double)k + 1.0, most), down(line->value[k], scale, top), colour);
        }
    }
}

void overlay_write(FILE *stream, const char *title, const char *x_title,
                   const struct overlay_panel *panels, size_t count)
{
    const double most = longest(panels, count);
    const int height = TOP + (int)count * (PANEL_HEIGHT + GAP) - GAP + BOTTOM;
    fprintf(
        stream,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %d %d\" width=\"%d\" height=\"%d\" "
        "font-family=\"sans-serif\" font-size=\"12\">\n<title>%s</title>\n"
        "<rect width=\"100%%\" height=\"100%%\" fill=\"white\"/>\n<text x=\"%d\" y=\"18\" font-size=\"15\">%s</text>\n",
        WIDTH, height, WIDTH, height, title, LEFT, title);
    for (size_t p = 0; p < count; p++) {
        const double top = TOP + (double)p * (PANEL_HEIGHT + GAP);
        const struct scale scale = scale_of(&panels[p]);
        draw_frame(stream, &panels[p], &scale, top, most);
        for (size_t i = 0; i < panels[p].lines; i++) {
            draw_line(stream, &panels[p].line[i], colours[i], &scale, top, most);
        }
    }
    for (size_t i = 0; count > 0 && i < panels[0].lines; i++) {
        const int y = TOP + 16 + 20 * (int)i, x = WIDTH - RIGHT + 14;
        fprintf(
            stream,
            "<path d=\"M%d %dh18\" stroke=\"%s\" stroke-width=\"3\"/><text x=\"%d\" y=\"%d\">%s</text>\n",
            x, y - 4, colours[i], x + 24, y, panels[0].line[i].name);
    }
    fprintf(stream, "<text x=\"%d\" y=\"%d\" text-anchor=\"middle\">%s</text>\n</svg>\n",
            LEFT + (WIDTH - LEFT - RIGHT) / 2, height - 12, x_title);
}
