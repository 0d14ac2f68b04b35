/* Results as a file that a later run goes on from. */
#include <string.h>
#include <unistd.h>

#include "sim_host/commission/commission.h"
#include "sim_host/text/ini.h"

/* A remark's sign and a line end would be read as such. */
static void print_line(FILE *stream, const char *key, const char *text)
{
    fprintf(stream, "%s = ", key);
    for (const char *c = text; *c != '\0'; c++) {
        const bool is_sign = *c == ';' || *c == '#';
        fputc(is_sign ? ',' : *c == '\n' || *c == '\r' ? ' ' : *c, stream);
    }
    fputc('\n', stream);
}

void commission_record_write(const struct commission *commission, FILE *stream)
{
    fprintf(stream, "; what afo commission has done and found\n");
    for (int step = 0; step < COMMISSION_STEPS; step++) {
        const struct commission_result *result = &commission->result[step];
        if (result->verdict == COMMISSION_NOT_DONE) {
            continue;
        }
        fprintf(stream, "\n[%s]\n", commission_step_name((enum commission_step)step));
        print_line(stream, "verdict", commission_verdict_name(result->verdict));
        print_line(stream, "when", result->when);
        if (result->reason[0] != '\0') {
            print_line(stream, "reason", result->reason);
        }
        /* A line of the file holds about 400 letters. */
        for (size_t at = 0; at < strlen(result->done); at += COMMISSION_LINE - 1) {
            char part[COMMISSION_LINE];
            (void)snprintf(part, sizeof part, "%s", result->done + at);
            fprintf(stream, "done = |");
            for (const char *c = part; *c != '\0'; c++) {
                fputc(*c == ';' || *c == '#' ? ',' : *c, stream);
            }
            fprintf(stream, "|\n");
        }
        for (unsigned i = 0; i < result->finding_count; i++) {
            print_line(stream, "found", result->finding[i]);
        }
    }
}

static int verdict_named(const char *text)
{
    for (int verdict = COMMISSION_NOT_DONE; verdict <= COMMISSION_NO_PART; verdict++) {
        if (strcmp(commission_verdict_name((enum commission_verdict)verdict), text) == 0) {
            return verdict;
        }
    }
    return -1;
}

/* "|text|", which keeps the blanks at the ends of a part. */
static void append_done(struct commission_result *result, const char *value)
{
    const size_t length = strlen(value), used = strlen(result->done);
    if (length >= 2 && used + length < sizeof result->done) {
        (void)snprintf(result->done + used, sizeof result->done - used, "%.*s", (int)length - 2,
                       value + 1);
    }
}

static int take_key(void *context, const char *section, const char *key, const char *value,
                    int line, char *message, size_t size)
{
    struct commission *commission = (struct commission *)context;
    char why[OBJECT_MESSAGE_MAX];
    const int step = commission_step_named(section, why);
    if (step < 0) {
        (void)snprintf(message, size, "line %d: no step: %s", line, why);
        return -1;
    }
    struct commission_result *result = &commission->result[step];
    if (strcmp(key, "verdict") == 0) {
        const int verdict = verdict_named(value);
        if (verdict < 0) {
            (void)snprintf(message, size, "line %d: \"%s\" is no verdict", line, value);
            return -1;
        }
        result->verdict = (enum commission_verdict)verdict;
    } else if (strcmp(key, "when") == 0) {
        (void)snprintf(result->when, sizeof result->when, "%s", value);
    } else if (strcmp(key, "reason") == 0) {
        (void)snprintf(result->reason, sizeof result->reason, "%s", value);
    } else if (strcmp(key, "done") == 0) {
        append_done(result, value);
    } else if (strcmp(key, "found") == 0 && result->finding_count < COMMISSION_FINDINGS) {
        (void)snprintf(result->finding[result->finding_count++], COMMISSION_LINE, "%s", value);
    }
    return 0;
}

int commission_record_read(struct commission *commission, const char *path, char *message)
{
    memset(commission->result, 0, sizeof commission->result);
    if (access(path, F_OK) != 0) {
        return 0;
    }
    return ini_read(path, take_key, commission, message, OBJECT_MESSAGE_MAX);
}
