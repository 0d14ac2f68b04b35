/* walk, stop, reset, zero, save: what is asked of the device, and whether it came to pass. */
#include <stdlib.h>
#include <string.h>

#include "controller/screening/zeroing.h"
#include "hal/bus/bytes.h"
#include "hal/bus/frame_table.h"
#include "sim_host/cli/host_report.h"
#include "sim_host/ctl/ctl.h"
#include "sim_host/ctl/ctl_internal.h"

enum { RESET_AGAIN_MS = 200, LOOK_MS = 20, TICK_WAIT_MS = 2, TICKS_APART = 3 };
enum { STOP_BIT = 0x80, STATE_BITS = 0x3F, SIGNATURE_BYTES = 4 };

static const struct named_object *object_at(const struct ctl *ctl, const char *name)
{
    char message[OBJECT_MESSAGE_MAX];
    const struct named_object *object = object_list_find(&ctl->objects, name, false, message);
    if (object == NULL) {
        ctl_complain(ctl, "%s", message);
    }
    return object;
}

int ctl_read_named(const struct ctl *ctl, const char *name, uint32_t *number)
{
    static struct object_value value;
    char message[OBJECT_MESSAGE_MAX];
    const struct named_object *object = object_at(ctl, name);
    if (object == NULL) {
        return -1;
    }
    if (ctl_link_read(&ctl->link, object, &value, message) != 0) {
        ctl_complain(ctl, "%s", message);
        return -1;
    }
    *number = (uint32_t)co_od_number(object->entry, value.bytes);
    return 0;
}

static int write_named(const struct ctl *ctl, const char *name, uint32_t number)
{
    struct object_value value;
    char message[OBJECT_MESSAGE_MAX];
    const struct named_object *object = object_at(ctl, name);
    if (object == NULL) {
        return -1;
    }
    value.length = object->entry->size;
    bytes_put_u32(value.bytes, number);
    if (ctl_link_write(&ctl->link, object, &value, message) != 0) {
        ctl_complain(ctl, "%s", message);
        return -1;
    }
    return 0;
}

#define WALK_REQUESTED "commands.walk_requested"
#define STATE "state.supervisor_state_and_emergency_stop"
#define FAULT "state.latched_fault"
#define BUTTON "commands.wearer_button_pressed"
#define ZEROING "state.zeroing"

/* ---- the device's state ----------------------------------------------------------- */

struct condition {
    enum supervisor_state state;
    bool emergency_stop;
    enum supervisor_fault fault;
};

static int read_condition(const struct ctl *ctl, struct condition *condition)
{
    uint32_t state, fault;
    if (ctl_read_named(ctl, STATE, &state) != 0 || ctl_read_named(ctl, FAULT, &fault) != 0) {
        return -1;
    }
    condition->state = (enum supervisor_state)(state & (uint32_t)STATE_BITS);
    condition->emergency_stop = (state & STOP_BIT) != 0;
    condition->fault = (enum supervisor_fault)fault;
    return 0;
}

static void tell(const struct ctl *ctl, const struct condition *condition)
{
    const char *state = host_report_state_name(condition->state);
    const bool faulty = condition->fault != SUPERVISOR_FAULT_NONE;
    struct json_writer json;
    if (!ctl->json) {
        fprintf(ctl->out, "%s%s%s%s\n", state, faulty ? ": " : "",
                faulty ? supervisor_fault_name(condition->fault) : "",
                condition->emergency_stop ? ", emergency stop pressed" : "");
        return;
    }
    json_begin(&json, ctl->out);
    json_open_object(&json, NULL);
    json_text(&json, "state", state);
    json_text(&json, "fault", faulty ? supervisor_fault_name(condition->fault) : NULL);
    json_bool(&json, "emergency_stop", condition->emergency_stop);
    json_close_object(&json);
    json_end(&json);
}

/* Waits until the state is one of `wanted` (bits of 1 << state), or one of `lost`. Returns 1, or 0 for
 * a lost one or when the patience is over, -1 after a complaint. */
static int wait_for(const struct ctl *ctl, unsigned wanted, unsigned lost, unsigned patience_ms,
                    struct condition *condition)
{
    for (unsigned waited = 0;; waited += LOOK_MS) {
        if (read_condition(ctl, condition) != 0) {
            return -1;
        }
        if ((wanted & (1u << condition->state)) != 0) {
            return 1;
        }
        if ((lost & (1u << condition->state)) != 0 || waited >= patience_ms) {
            return 0;
        }
        if (!ctl->link.pause(ctl->link.context, LOOK_MS)) {
            ctl_complain(ctl, "interrupted: what was asked for stays asked for");
            return -1;
        }
    }
}

static enum exit_status give_up(const struct ctl *ctl, const struct condition *condition,
                                const char *what, const char *remedy)
{
    tell(ctl, condition);
    ctl_complain(ctl, "%s; %s", what, remedy);
    return EXIT_BAD;
}

/* Two writes of one object must not fall into one tick: the controller would see the last one only. */
static int let_ticks_pass(const struct ctl *ctl)
{
    uint32_t first, now;
    if (ctl_read_named(ctl, "counters.ticks", &first) != 0) {
        return -1;
    }
    for (unsigned waited = 0; waited < ctl->patience_ms; waited += TICK_WAIT_MS) {
        if (ctl_read_named(ctl, "counters.ticks", &now) != 0) {
            return -1;
        }
        if (now - first >= TICKS_APART) {
            return 0;
        }
        if (!ctl->link.pause(ctl->link.context, TICK_WAIT_MS)) {
            return -1;
        }
    }
    ctl_complain(ctl, "the controller's ticks stand still: its bus has no SYNC");
    return -1;
}

#define IN(state) (1u << SUPERVISOR_##state)

/* ---- walk and stop ------------------------------------------------------------------ */

enum exit_status ctl_walk(struct ctl *ctl, int count, char **words)
{
    struct condition condition;
    (void)count;
    (void)words;
    if (read_condition(ctl, &condition) != 0) {
        return EXIT_BAD;
    }
    if (supervisor_may_assist(condition.state)) {
        tell(ctl, &condition);
        return EXIT_GOOD;
    }
    if (condition.state == SUPERVISOR_FAULT) {
        return give_up(ctl, &condition, "a fault is latched",
                       condition.emergency_stop
                           ? "release the emergency stop, stand still, then `afo ctl reset'"
                           : "mend its cause, stand still, then `afo ctl reset'");
    }
    /* A request that ended in a stop is spent: it is taken back and made anew. */
    if (write_named(ctl, WALK_REQUESTED, 0) != 0 || let_ticks_pass(ctl) != 0 ||
        write_named(ctl, WALK_REQUESTED, 1) != 0) {
        return EXIT_BAD;
    }
    const int came =
        wait_for(ctl, IN(ENGAGING) | IN(WALKING), IN(FAULT), ctl->patience_ms, &condition);
    if (came < 0) {
        return EXIT_BAD;
    }
    uint32_t withdrawn = 0;
    if (came == 0 && ctl_read_named(ctl, "drives.withdrawn", &withdrawn) == 0 && withdrawn != 0) {
        return give_up(ctl, &condition, "the drives are spared",
                       "wait until they have recovered: `afo ctl get drives'");
    }
    if (came == 0) {
        return give_up(ctl, &condition, "it did not engage",
                       condition.state == SUPERVISOR_INIT
                           ? "nodes are missing: `afo ctl get refused_node'"
                           : "are both springs slack and all values fresh? A person has to "
                             "be on their feet and to set off");
    }
    tell(ctl, &condition);
    return EXIT_GOOD;
}

enum exit_status ctl_stop(struct ctl *ctl, int count, char **words)
{
    struct condition condition;
    (void)count;
    (void)words;
    if (write_named(ctl, WALK_REQUESTED, 0) != 0) {
        return EXIT_BAD;
    }
    const unsigned stopped = IN(INIT) | IN(SELF_TEST) | IN(STANDBY) | IN(FAULT);
    if (let_ticks_pass(ctl) != 0) {
        return EXIT_BAD;
    }
    const int came = wait_for(ctl, stopped, 0, ctl->patience_ms, &condition);
    if (came < 0) {
        return EXIT_BAD;
    }
    if (came == 0) {
        return give_up(ctl, &condition, "it has not unloaded",
                       "press the emergency stop, and keep the feet on the ground");
    }
    tell(ctl, &condition);
    return condition.state == SUPERVISOR_FAULT ? EXIT_BAD : EXIT_GOOD;
}

/* ---- the wearer's button -------------------------------------------------------------- */

static const double PRESS_S = 0.2, LONGEST_PRESS_S = 60.0;

/* The virtual one. Whatever happens, it is let go. */
enum exit_status ctl_press(struct ctl *ctl, int count, char **words)
{
    struct condition condition;
    char *end = NULL;
    const double press_s = count > 0 ? strtod(words[0], &end) : PRESS_S;
    if (count > 0 && (*end != '\0' || !(press_s >= PRESS_S && press_s <= LONGEST_PRESS_S))) {
        ctl_complain(ctl, "press takes %g to %g seconds, not \"%s\"", PRESS_S, LONGEST_PRESS_S,
                     words[0]);
        return EXIT_USAGE;
    }
    if (write_named(ctl, BUTTON, 1) != 0) {
        return EXIT_BAD;
    }
    (void)ctl->link.pause(ctl->link.context, (unsigned)(press_s * 1e3));
    if (write_named(ctl, BUTTON, 0) != 0 || read_condition(ctl, &condition) != 0) {
        return EXIT_BAD;
    }
    tell(ctl, &condition);
    return EXIT_GOOD;
}

/* ---- reset, zero, save ---------------------------------------------------------------- */

enum exit_status ctl_reset(struct ctl *ctl, int count, char **words)
{
    struct condition condition;
    (void)count;
    (void)words;
    if (read_condition(ctl, &condition) != 0) {
        return EXIT_BAD;
    }
    if (condition.state != SUPERVISOR_FAULT) {
        tell(ctl, &condition);
        return EXIT_GOOD; /* there is nothing to clear */
    }
    int came = 0;
    for (unsigned waited = 0; came == 0 && waited <= ctl->patience_ms; waited += RESET_AGAIN_MS) {
        if (write_named(ctl, "commands.reset_fault", 1) != 0 || let_ticks_pass(ctl) != 0) {
            return EXIT_BAD;
        }
        /* A drive in fault takes its reset first; then the controller's is obeyed. */
        came = wait_for(ctl, IN(STANDBY), 0, RESET_AGAIN_MS, &condition);
    }
    if (came < 0) {
        return EXIT_BAD;
    }
    if (came == 0) {
        return give_up(ctl, &condition, "the fault is still there",
                       "a reset is obeyed when its cause is gone and both legs stand still");
    }
    tell(ctl, &condition);
    return EXIT_GOOD;
}

static const char *zeroing_words(uint32_t state)
{
    switch (state) {
    case ZEROING_DONE:
        return "found; `afo ctl save' keeps them";
    case ZEROING_MOVED:
        return "refused: the legs moved, or the drives were switched on; stand still and try again";
    case ZEROING_TOO_FAR:
        return "refused: a sensor is further off than it can be mounted; stand upright, feet side by "
               "side, or mount it anew";
    case ZEROING_NO_SAMPLE:
        return "refused: a sensor was silent; see `afo ctl get counters'";
    default:
        return "not begun: the controller did not take the request";
    }
}

enum exit_status ctl_zero(struct ctl *ctl, int count, char **words)
{
    static char angle_left[] = "angle_zero_left_rad", angle_right[] = "angle_zero_right_rad";
    static char ankle_left[] = "ankle_zero_left_m", ankle_right[] = "ankle_zero_right_m";
    char *offsets[] = {angle_left, angle_right, ankle_left, ankle_right};
    struct condition condition;
    uint32_t zeroing = ZEROING_RUNNING;
    (void)count;
    (void)words;
    if (read_condition(ctl, &condition) != 0) {
        return EXIT_BAD;
    }
    if (supervisor_may_enable(condition.state)) {
        return give_up(ctl, &condition, "the drives are under torque", "`afo ctl stop' first");
    }
    if (write_named(ctl, "commands.zero_the_leg_sensors", 1) != 0 || let_ticks_pass(ctl) != 0) {
        return EXIT_BAD;
    }
    for (unsigned waited = 0; zeroing == ZEROING_RUNNING; waited += LOOK_MS) {
        if (ctl_read_named(ctl, ZEROING, &zeroing) != 0) {
            return EXIT_BAD;
        }
        if (zeroing != ZEROING_RUNNING) {
            break;
        }
        if (waited >= ctl->patience_ms || !ctl->link.pause(ctl->link.context, LOOK_MS)) {
            ctl_complain(ctl, "it still runs; `afo ctl get zeroing' tells how it ends");
            return EXIT_BAD;
        }
    }
    if (zeroing != ZEROING_DONE) {
        ctl_complain(ctl, "%s", zeroing_words(zeroing));
        return EXIT_BAD;
    }
    if (!ctl->json) {
        fprintf(ctl->out, "%s\n", zeroing_words(zeroing));
    }
    return ctl_get(ctl, sizeof offsets / sizeof offsets[0], offsets);
}

enum exit_status ctl_save(struct ctl *ctl, int count, char **words)
{
    static const uint8_t signature[SIGNATURE_BYTES] = {'s', 'a', 'v', 'e'};
    (void)count;
    (void)words;
    struct object_value value = {.length = sizeof signature};
    char message[OBJECT_MESSAGE_MAX];
    const struct named_object *object =
        object_list_find(&ctl->objects, "0x1010:01", false, message);
    struct ctl_address_object room;
    if (object == NULL) {
        object = ctl_address("0x1010:01", &room);
    }
    memcpy(value.bytes, signature, sizeof signature);
    if (ctl_link_write(&ctl->link, object, &value, message) != 0) {
        ctl_complain(ctl, "%s", message);
        return EXIT_BAD;
    }
    if (ctl->json) {
        struct json_writer json;
        json_begin(&json, ctl->out);
        json_open_object(&json, NULL);
        json_unsigned(&json, "node", ctl->link.node);
        json_bool(&json, "saved", true);
        json_close_object(&json);
        json_end(&json);
    } else {
        fprintf(ctl->out, "node %u keeps its settings\n", ctl->link.node);
    }
    return EXIT_GOOD;
}
