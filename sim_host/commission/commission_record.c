/* Results as a file that a later run goes on from. */
#include <string.h>
#include <unistd.h>

#include "hal/storage/crc.h"
#include "sim_host/commission/commission.h"
#include "sim_host/devices/device_text.h"
#include "sim_host/text/ini.h"
#include "sim_host/text/number_text.h"

/* What the steps find for the device file. */
static const enum device_leg_key found_keys[] = {DEVICE_LEG_leg_zero_rad, DEVICE_LEG_ankle_zero_m,
                                                 DEVICE_LEG_unload};
enum { FOUND_KEYS = sizeof found_keys / sizeof found_keys[0], FOUND_NAME_MAX = 64 };

struct reading {
    struct commission *commission;
    bool is_other, is_changed;
};

/* Of all that is declared, but for what the steps find. */
static uint32_t fingerprint(const struct device_file *device)
{
    uint32_t crc = crc32_update(0, &device->description.common, sizeof device->description.common);
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        for (unsigned key = 0; key < DEVICE_LEG_COUNT; key++) {
            bool is_found = false;
            for (unsigned i = 0; i < FOUND_KEYS; i++) {
                is_found = is_found || found_keys[i] == key;
            }
            if (!is_found && device_key_applies(&device->description.leg[leg], key)) {
                const double number = device->number[leg][key];
                crc = crc32_update(crc, &number, sizeof number);
            }
        }
    }
    return crc;
}

static void found_name(int leg, enum device_leg_key key, char name[FOUND_NAME_MAX])
{
    (void)snprintf(name, FOUND_NAME_MAX, "%s.%s", leg == SIDE_LEFT ? "left" : "right",
                   device_leg_keys[key].name);
}

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
    fprintf(stream, "\n[device]\n");
    print_line(stream, "name", commission->declared.name);
    fprintf(stream, "fingerprint = %08x\n", fingerprint(&commission->declared));
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        for (unsigned i = 0; i < FOUND_KEYS; i++) {
            char name[FOUND_NAME_MAX], text[DEVICE_VALUE_TEXT_MAX];
            const double number = commission->device.number[leg][found_keys[i]];
            if (number != commission->declared.number[leg][found_keys[i]]) {
                found_name(leg, found_keys[i], name);
                device_value_text(&device_leg_keys[found_keys[i]], number, text, sizeof text);
                print_line(stream, name, text);
            }
        }
    }
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

/* Whose record it is, and what was found for its file. */
static int take_device(struct reading *reading, const char *key, const char *value, char *message,
                       size_t size)
{
    struct commission *commission = reading->commission;
    char text[COMMISSION_LINE];
    if (strcmp(key, "name") == 0) {
        (void)snprintf(text, sizeof text, "%s", commission->declared.name);
        for (char *c = text; *c != '\0'; c++) {
            *c = *c == ';' || *c == '#' ? ',' : *c; /* as it was written */
        }
        reading->is_other = strcmp(value, text) != 0;
        return 0;
    }
    if (strcmp(key, "fingerprint") == 0) {
        (void)snprintf(text, sizeof text, "%08x", fingerprint(&commission->declared));
        reading->is_changed = strcmp(value, text) != 0;
        return 0;
    }
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        for (unsigned i = 0; i < FOUND_KEYS; i++) {
            double number;
            found_name(leg, found_keys[i], text);
            if (strcmp(key, text) != 0) {
                continue;
            }
            if (device_value_read(&device_leg_keys[found_keys[i]], value, &number, text,
                                  sizeof text) != 0) {
                (void)snprintf(message, size, "%.200s", text);
                return -1;
            }
            const int declared = commission->declared.description.leg[leg].unload;
            const bool is_settled =
                found_keys[i] == DEVICE_LEG_unload &&
                (declared == DEVICE_UNLOAD_LATCH || declared == DEVICE_UNLOAD_HARDWARE);
            if (!is_settled) {
                device_file_set(&commission->device, (enum side)leg, found_keys[i], number);
            }
            return 0;
        }
    }
    (void)snprintf(message, size, "no key \"%.60s\" of a device's record", key);
    return -1;
}

static int take_key(void *context, const char *section, const char *key, const char *value,
                    int line, char *message, size_t size)
{
    struct reading *reading = (struct reading *)context;
    struct commission *commission = reading->commission;
    (void)line;
    char why[OBJECT_MESSAGE_MAX];
    if (strcmp(section, "device") == 0) {
        return take_device(reading, key, value, message, size);
    }
    const int step = commission_step_named(section, why);
    if (step < 0) {
        (void)snprintf(message, size, "no record of afo commission: step %s", why);
        return -1;
    }
    struct commission_result *result = &commission->result[step];
    if (strcmp(key, "verdict") == 0) {
        const int verdict = verdict_named(value);
        if (verdict < 0) {
            (void)snprintf(message, size, "\"%.60s\" is no verdict", value);
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
    /* A record without a [device] is of no device that is known. */
    struct reading reading = {.commission = commission, .is_other = true, .is_changed = true};
    message[0] = '\0';
    memset(commission->result, 0, sizeof commission->result);
    if (access(path, F_OK) != 0) {
        return 0;
    }
    if (ini_read(path, take_key, &reading, message, OBJECT_MESSAGE_MAX) != 0) {
        return -1;
    }
    if (reading.is_other) {
        (void)snprintf(message, OBJECT_MESSAGE_MAX,
                       "%.200s is the record of another device than \"%.60s\": move it away, or "
                       "name another one with --record",
                       path, commission->declared.name);
        return -1;
    }
    if (reading.is_changed) {
        (void)snprintf(message, OBJECT_MESSAGE_MAX,
                       "the device file was changed since %.200s was written: all steps are open "
                       "again",
                       path);
        commission->device = commission->declared;
        memset(commission->result, 0, sizeof commission->result);
    }
    return 0;
}
