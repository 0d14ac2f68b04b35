/* The page to sign: one HTML file without anything from outside. */
#include <stdlib.h>

#include "sim_host/commission/commission.h"

static void put_text(FILE *stream, const char *text)
{
    for (const char *c = text; *c != '\0'; c++) {
        switch (*c) {
        case '&':
            fputs("&amp;", stream);
            break;
        case '<':
            fputs("&lt;", stream);
            break;
        case '>':
            fputs("&gt;", stream);
            break;
        case '"':
            fputs("&quot;", stream);
            break;
        default:
            fputc(*c, stream);
            break;
        }
    }
}

static void put_head(FILE *stream, const struct commission *commission)
{
    fputs(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n<title>Commissioning: ",
        stream);
    put_text(stream, commission->device.name);
    fputs("</title>\n<style>body{font-family:sans-serif;max-width:60em;margin:2em auto}"
          "table{border-collapse:collapse;width:100%}td,th{border:1px solid #888;padding:.3em;"
          "text-align:left;vertical-align:top}.failed,.interrupted{background:#fdd}"
          ".passed{background:#dfd}.skipped{background:#ffd}.line{border-bottom:1px solid #000;"
          "height:3em}</style></head>\n<body>\n<h1>Commissioning of ",
          stream);
    put_text(stream, commission->device.name);
    fputs("</h1>\n<p>Made by afo commission", stream);
    if (commission->now[0] != '\0') {
        fputs(", ", stream);
        put_text(stream, commission->now);
    }
    fputs(".</p>\n", stream);
}

/* The class of a row is its verdict's first word. */
static const char *class_of(enum commission_verdict verdict)
{
    switch (verdict) {
    case COMMISSION_PASSED:
        return "passed";
    case COMMISSION_SKIPPED:
    case COMMISSION_NO_PART:
        return "skipped";
    case COMMISSION_FAILED:
        return "failed";
    default:
        return "interrupted";
    }
}

static void put_step(FILE *stream, const struct commission *commission, enum commission_step step)
{
    const struct commission_result *result = &commission->result[step];
    fprintf(stream, "<tr class=\"%s\"><td>%s</td><td>%s</td><td>%s</td><td>",
            class_of(result->verdict), commission_step_name(step), commission_step_shows(step),
            commission_verdict_name(result->verdict));
    put_text(stream, result->when);
    fputs("</td><td>", stream);
    put_text(stream, result->done);
    for (unsigned i = 0; i < result->finding_count; i++) {
        fputs("<br><b>Found:</b> ", stream);
        put_text(stream, result->finding[i]);
    }
    if (result->reason[0] != '\0') {
        fputs("<br><i>", stream);
        put_text(stream, result->reason);
        fputs("</i>", stream);
    }
    fputs("</td></tr>\n", stream);
}

/* What is open, what was found, and what this device cannot do. */
static unsigned put_hazards(FILE *stream, const struct commission *commission)
{
    unsigned count = 0;
    for (int step = 0; step < COMMISSION_STEPS; step++) {
        const struct commission_result *result = &commission->result[step];
        const bool passed =
            result->verdict == COMMISSION_PASSED || result->verdict == COMMISSION_NO_PART;
        if (!passed) {
            fprintf(stream, "<li>Not shown (%s): %s.</li>\n",
                    commission_verdict_name(result->verdict),
                    commission_step_shows((enum commission_step)step));
            count++;
        }
    }
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        const struct device_leg *declared = &commission->device.description.leg[leg];
        const char *name = leg == SIDE_LEFT ? "Left" : "Right";
        if (device_leg_is_driven(declared) && !device_leg_reports_latch(declared)) {
            fprintf(stream,
                    "<li>%s leg: no latch that reports CLOSED. For the bench only, not for "
                    "a person.</li>\n",
                    name);
            count++;
        }
        if (device_leg_is_driven(declared) && declared->unload == DEVICE_UNLOAD_NONE) {
            fprintf(stream,
                    "<li>%s leg: nothing unloads a loaded spring when the link is lost.</li>\n",
                    name);
            count++;
        }
    }
    return count;
}

void commission_page_write(const struct commission *commission, FILE *stream)
{
    put_head(stream, commission);
    fputs("<h2>Done and found</h2>\n<table><tr><th>step</th><th>shows</th><th>verdict</th>"
          "<th>when</th><th>measured, found</th></tr>\n",
          stream);
    for (int step = 0; step < COMMISSION_STEPS; step++) {
        put_step(stream, commission, (enum commission_step)step);
    }
    fputs("</table>\n<h2>Hazards that remain</h2>\n<ul>\n", stream);
    if (put_hazards(stream, commission) == 0) {
        fputs("<li>None was found by these steps.</li>\n", stream);
    }
    fprintf(stream,
            "</ul>\n<h2>Accepted</h2>\n<p>%s</p>\n"
            "<table><tr><th>name</th><th>date</th><th>signature</th></tr>\n"
            "<tr><td class=\"line\"></td><td class=\"line\"></td><td class=\"line\"></td></tr>\n"
            "<tr><td class=\"line\"></td><td class=\"line\"></td><td class=\"line\"></td></tr>\n"
            "</table>\n<h2>Device</h2>\n<pre>\n",
            commission_is_complete(commission)
                ? "Every step has passed, or was skipped with the reason above."
                : "NOT COMPLETE: steps are open, failed or interrupted. Not to be accepted.");
    char *text = NULL;
    size_t size = 0;
    FILE *memory = open_memstream(&text, &size);
    if (memory != NULL) {
        device_file_write(memory, &commission->device);
        fclose(memory);
        put_text(stream, text);
        free(text);
    }
    fputs("</pre>\n</body></html>\n", stream);
}
