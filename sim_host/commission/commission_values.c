/* Findings, and values of the controller by name. */
#include <math.h>
#include <stdarg.h>
#include <string.h>

#include "hal/bus/bytes.h"
#include "hal/bus/frame_table.h"
#include "sim_host/cli/host_report.h"
#include "sim_host/commission/commission_internal.h"

enum { LOOK_MS = 50, STANDBY_MS = 8000, RESET_EACH = 4 };

void commission_find(struct commission_result *result, const char *format, ...)
{
    va_list arguments;
    if (result->finding_count == COMMISSION_FINDINGS) {
        return;
    }
    va_start(arguments, format);
    (void)vsnprintf(result->finding[result->finding_count++], COMMISSION_LINE, format, arguments);
    va_end(arguments);
}

void commission_note(struct commission_result *result, const char *format, ...)
{
    const size_t used = strlen(result->done);
    va_list arguments;
    va_start(arguments, format);
    if (used > 0) {
        (void)snprintf(result->done + used, sizeof result->done - used, " ");
    }
    (void)vsnprintf(result->done + strlen(result->done), sizeof result->done - strlen(result->done),
                    format, arguments);
    va_end(arguments);
}

int commission_break(struct commission_result *result, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(result->reason, sizeof result->reason, format, arguments);
    va_end(arguments);
    return -1;
}

/* Who wants to end waits for no answer: that is no node's fault. */
static int give_up(struct commission *commission, struct commission_result *result,
                   const char *message)
{
    return commission_wait(commission, 0)
               ? commission_break(result, "%s", message)
               : commission_break(result, "interrupted; the controller unloads");
}

int commission_get(struct commission *commission, struct commission_result *result,
                   const char *name, double *number)
{
    static struct object_value value;
    char message[OBJECT_MESSAGE_MAX];
    const struct named_object *object =
        object_list_find(&commission->ctl.objects, name, false, message);
    if (object == NULL || ctl_link_read(&commission->ctl.link, object, &value, message) != 0) {
        return give_up(commission, result, message);
    }
    return object_number(object, &value, number)
               ? 0
               : commission_break(result, "%s is no number", name);
}

int commission_get_leg(struct commission *commission, struct commission_result *result,
                       const char *group, enum side leg, const char *name, double *number)
{
    char whole[OBJECT_NAME_MAX];
    (void)snprintf(whole, sizeof whole, "%s.%s_%s", group, commission_leg((int)leg), name);
    return commission_get(commission, result, whole, number);
}

int commission_set(struct commission *commission, struct commission_result *result,
                   const char *name, double number)
{
    struct object_value value;
    char message[OBJECT_MESSAGE_MAX], text[OBJECT_TEXT_MAX];
    const struct named_object *object =
        object_list_find(&commission->ctl.objects, name, false, message);
    (void)snprintf(text, sizeof text, "%.9g", number);
    if (object == NULL || object_value_from_text(object, text, &value, message) != 0 ||
        ctl_link_write(&commission->ctl.link, object, &value, message) != 0) {
        return give_up(commission, result, message);
    }
    return 0;
}

int commission_peek(struct commission *commission, unsigned node, uint16_t index, uint8_t sub,
                    uint32_t *number, char *message)
{
    static struct object_value value;
    struct ctl_link link = commission->ctl.link;
    struct named_object object;
    struct co_entry entry;
    link.node = (uint8_t)node;
    ctl_link_any_object(index, sub, &object, &entry);
    if (ctl_link_read(&link, &object, &value, message) != 0) {
        return -1;
    }
    for (size_t i = value.length; i < 4; i++) {
        value.bytes[i] = 0;
    }
    *number = bytes_get_u32(value.bytes);
    return 0;
}

bool commission_wait(struct commission *commission, unsigned milliseconds)
{
    return commission->ctl.link.pause(commission->ctl.link.context, milliseconds);
}

int commission_confirm(struct commission *commission, struct commission_result *result,
                       enum side leg, const char *question, int *answer)
{
    *answer = commission->person.confirm(commission->person.context, leg, question);
    return *answer >= 0 || commission_wait(commission, 0) ? 0
                                                          : commission_break(result, "interrupted");
}

/* Who keeps the controller in its self test: a spring that is not slack. */
static void tell_loaded(struct commission *commission, struct commission_result *result)
{
    struct commission_result other = {.verdict = COMMISSION_NOT_DONE};
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        const size_t used = strlen(result->reason);
        double motor_m;
        if (commission_is_driven(commission, leg) &&
            commission_get_leg(commission, &other, "measured", (enum side)leg, "motor", &motor_m) ==
                0 &&
            !(fabs(motor_m) <= commission->tolerance_m)) {
            (void)snprintf(result->reason + used, sizeof result->reason - used,
                           "; the %s motor stands at %.1f mm: turn it back by hand until its "
                           "spring is slack",
                           commission_leg(leg), 1000.0 * motor_m);
        }
    }
}

int commission_reach_standby(struct commission *commission, struct commission_result *result)
{
    double state = 0.0, fault = 0.0;
    for (unsigned n = 0; n * LOOK_MS < STANDBY_MS; n++) {
        if (commission_get(commission, result, "state.supervisor_state_and_emergency_stop",
                           &state) != 0) {
            return -1;
        }
        if ((unsigned)state == SUPERVISOR_STANDBY) {
            return 0;
        }
        /* A drive in fault takes its reset first; then the controller's is obeyed. */
        if ((unsigned)state == SUPERVISOR_FAULT && n % RESET_EACH == 0 &&
            commission_set(commission, result, "commands.reset_fault", 1.0) != 0) {
            return -1;
        }
        if (!commission_wait(commission, LOOK_MS)) {
            return commission_break(result, "interrupted");
        }
    }
    if (commission_get(commission, result, "state.latched_fault", &fault) != 0) {
        return -1;
    }
    (void)commission_break(
        result, "the controller does not come to standby: %s%s%s",
        host_report_state_name((enum supervisor_state)((unsigned)state & 0x3Fu)),
        fault != 0.0 ? ", " : "",
        fault != 0.0 ? supervisor_fault_name((enum supervisor_fault)(unsigned)fault) : "");
    tell_loaded(commission, result);
    return -1;
}
