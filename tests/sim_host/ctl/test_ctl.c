/* afo ctl's verbs against the real controller's node, which walks on the in-process bus. */
#include "sim_host/ctl/ctl.h"

#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "hal/bus/frame_table.h"
#include "sim_host/loop/loop.h"
#include "tests/support/assert_close.h"

enum { WAITS_MAX = 50, WORDS_MAX = 8 };

static struct loop loop;
static struct ctl ctl;
static char *out_text, *complaint_text;
static size_t out_size, complaint_size;
static unsigned requests;          /* SDO requests of the tool that were on the bus */
static unsigned pauses_before_end; /* 0: nobody wants to end */

static void count_requests(void *context, const struct sim_bus_event *event)
{
    (void)context;
    requests +=
        event->kind == SIM_BUS_FRAME && event->message.id >= 0x601 && event->message.id <= 0x67F
            ? 1
            : 0;
}

static bool wait(void *context, unsigned waits)
{
    (void)context;
    loop_tick(&loop);
    return waits < WAITS_MAX;
}

static bool pause_for(void *context, unsigned milliseconds)
{
    (void)context;
    for (unsigned i = 0; i < milliseconds; i++) {
        loop_tick(&loop);
    }
    return pauses_before_end == 0 || --pauses_before_end > 0;
}

static void open_streams(void)
{
    ctl.out = open_memstream(&out_text, &out_size);
    ctl.complaints = open_memstream(&complaint_text, &complaint_size);
}

static void close_streams(void)
{
    fclose(ctl.out);
    fclose(ctl.complaints);
    free(out_text);
    free(complaint_text);
}

static void setup(void)
{
    static struct loop_config config;
    struct subject subject;
    struct control_params params;
    char message[LOOP_MESSAGE_MAX];
    subject_default(&subject);
    ck_assert_int_eq(subject_control_params(&subject, &params, message), 0);
    ck_assert_int_eq(loop_configure(&config, &subject, &params, 0.41, SENSORS_17BIT, 1, message),
                     0);
    ck_assert_int_eq(loop_init(&loop, &config, NULL, message), 0);
    const int port = sim_bus_attach(&loop.bus, "tool", NULL, NULL);
    memset(&ctl, 0, sizeof ctl);
    ctl.link = (struct ctl_link){.bus = sim_bus_port(&loop.bus, port),
                                 .wait = wait,
                                 .pause = pause_for,
                                 .node = NODE_CONTROLLER};
    ctl.period_ms = 100;
    ctl.patience_ms = 10000;
    pauses_before_end = 0;
    open_streams();
    ctl_open(&ctl);
    sim_bus_set_tap(&loop.bus, count_requests, NULL);
    requests = 0;
}

static void teardown(void)
{
    close_streams();
    loop_free(&loop);
}

/* One command line; what it printed is in out_text and complaint_text. */
static enum exit_status run(const char *first, ...)
{
    static char room[WORDS_MAX][160];
    char *words[WORDS_MAX];
    int count = 0;
    va_list rest;
    close_streams();
    open_streams();
    va_start(rest, first);
    for (const char *word = first; word != NULL; word = va_arg(rest, const char *)) {
        (void)snprintf(room[count], sizeof room[0], "%s", word);
        words[count] = room[count];
        count++;
    }
    va_end(rest);
    const enum exit_status status = ctl_run(&ctl, count, words);
    fflush(ctl.out);
    fflush(ctl.complaints);
    return status;
}

static void says(const char *text, const char *part)
{
    ck_assert_msg(strstr(text, part) != NULL, "\"%s\" lacks \"%s\"", text, part);
}

static const char *last_of(const char *text, const char *part)
{
    const char *last = NULL;
    for (const char *at = text; (at = strstr(at, part)) != NULL; at++) {
        last = at;
    }
    return last;
}

static void ticks(unsigned count)
{
    for (unsigned i = 0; i < count; i++) {
        loop_tick(&loop);
    }
}

static enum supervisor_state state(void)
{
    return loop.rig.task.output.state;
}

/* ---- names ------------------------------------------------------------------------- */

START_TEST(every_entry_has_one_name_and_is_found_by_it)
{
    const struct object_list *list = &ctl.objects;
    char message[OBJECT_MESSAGE_MAX], address[16];
    size_t entries = 0;
    for (size_t i = 0; i < controller_object_count; i++) {
        entries += controller_object_table[i].sub != 0 ? 1 : 0;
    }
    ck_assert_uint_gt(list->count, entries);
    ck_assert_uint_lt(list->count, OBJECT_LIST_MAX);
    for (size_t i = 0; i < list->count; i++) {
        const struct named_object *object = &list->object[i];
        ck_assert_ptr_eq(object_list_find(list, object->name, false, message), object);
        (void)snprintf(address, sizeof address, "0x%04x:%02x", object->entry->index,
                       object->entry->sub);
        ck_assert_ptr_eq(object_list_find(list, address, false, message), object);
        ck_assert_uint_eq(strspn(object->name, "abcdefghijklmnopqrstuvwxyz0123456789_."),
                          strlen(object->name));
    }
}
END_TEST

START_TEST(parameters_have_the_ranges_and_units_of_their_table)
{
    char message[OBJECT_MESSAGE_MAX], name[OBJECT_NAME_MAX];
    for (int i = 0; i < CONTROL_PARAM_COUNT; i++) {
        const struct control_param_descriptor *row = &control_param_descriptors[i];
        (void)snprintf(name, sizeof name, "parameters.%s", row->name);
        const struct named_object *object = object_list_find(&ctl.objects, name, false, message);
        ck_assert_ptr_nonnull(object);
        ck_assert(object->has_range);
        ck_assert((float)object->low == row->minimum && (float)object->high == row->maximum);
        ck_assert_str_eq(object->unit, strcmp(row->unit, "-") == 0 ? "" : row->unit);
        ck_assert_str_eq(object->meaning, row->meaning);
    }
}
END_TEST

START_TEST(a_mistyped_name_is_answered_with_the_nearest)
{
    ck_assert_int_eq(run("get", "kp_m_s_rat", NULL), EXIT_USAGE);
    says(complaint_text, "nearest: kp_m_s_rad");
    ck_assert_int_eq(run("get", "precompression", NULL), EXIT_USAGE); /* two have it */
    says(complaint_text, "last_step.precompression, last_step_in_full.precompression");
    ck_assert_int_eq(run("set", "kp_m=0.04", NULL),
                     EXIT_USAGE); /* a beginning is for reading only */
    says(complaint_text, "nearest: parameters.kp_m_s_rad");
    ck_assert_int_eq(run("gte", "kp", NULL), EXIT_USAGE);
    says(complaint_text, "nearest: get");
    ck_assert_int_eq(run("set", "kp_m_s_rad", NULL), EXIT_USAGE);
    says(complaint_text, "write NAME=VALUE");
    ck_assert_int_eq(run("get", "0x2010:zz", NULL), EXIT_USAGE);
    ck_assert_uint_eq(requests, 0);
}
END_TEST

/* ---- get and set --------------------------------------------------------------------- */

START_TEST(values_are_shown_in_si_units_with_their_names)
{
    ticks(3000);
    ck_assert_int_eq(state(), SUPERVISOR_WALKING);
    ck_assert_int_eq(run("get", "supervisor_state", NULL), EXIT_GOOD);
    ck_assert_str_eq(out_text, "state.supervisor_state_and_emergency_stop = 4 (walking)\n");
    ck_assert_int_eq(run("get", "law", "latched_fault", NULL), EXIT_GOOD);
    says(out_text, "parameters.law = 0 (proportional)\n");
    says(out_text, "state.latched_fault = 0 (none)\n");
    ck_assert_int_eq(run("get", "last_step", NULL), EXIT_GOOD);
    char expected[128];
    (void)snprintf(expected, sizeof expected, "last_step.precompression = %.12g m\n",
                   loop.rig.task.node.objects.step_r0 * 1e-5);
    says(out_text, expected);
    ck_assert_int_eq(run("get", "left_drive_temperature", NULL), EXIT_GOOD);
    says(out_text, " degC");
    ck_assert_int_eq(run("get", "0x1008", NULL), EXIT_GOOD);
    ck_assert_str_eq(out_text, "manufacturer_device_name = AFO controller\n");
    ck_assert_int_eq(run("get", "0x2099:01", NULL), EXIT_BAD);
    says(complaint_text, "no such object (0x06020000)");
}
END_TEST

START_TEST(a_setting_is_written_and_read_back)
{
    ck_assert_int_eq(run("set", "kp_m_s_rad=0.045", "law=dlqr", NULL), EXIT_GOOD);
    says(out_text, "parameters.kp_m_s_rad = 0.045 m/(rad/s)\n");
    says(out_text, "parameters.law = 2 (dlqr)\n");
    ck_assert(loop.rig.task.node.objects.params.kp_m_s_rad == 0.045f);
    ck_assert(loop.rig.task.node.objects.params.law == 2.0f);
}
END_TEST

START_TEST(a_value_that_comes_by_a_ramp_is_told_as_accepted)
{
    ticks(3000);
    ck_assert_int_eq(state(), SUPERVISOR_WALKING);
    ck_assert_int_eq(run("set", "kp_m_s_rad=0.046875", NULL), EXIT_GOOD);
    says(out_text, "parameters.kp_m_s_rad = 0.046875 m/(rad/s) accepted, there within 5 s (now ");
    ck_assert(loop.rig.task.node.objects.params.kp_m_s_rad != 0.046875f);
    ticks(5001);
    ck_assert(loop.rig.task.node.objects.params.kp_m_s_rad == 0.046875f);
    ck_assert_int_eq(run("set", "kp_m_s_rad=0.046875", NULL), EXIT_GOOD);
    ck_assert_msg(strstr(out_text, "accepted") == NULL, "%s", out_text);
    ctl.json = true;
    ck_assert_int_eq(run("set", "kp_m_s_rad=0.0439453125", NULL), EXIT_GOOD);
    says(out_text, "\"accepted\": 0.043945312");
    says(out_text, "\"there_within_s\": 5");
    ctl.json = false;
}
END_TEST

START_TEST(an_index_alone_is_its_whole_group)
{
    static char by_name[4096];
    ck_assert_int_eq(run("get", "refused_node", NULL), EXIT_GOOD);
    (void)snprintf(by_name, sizeof by_name, "%s", out_text);
    says(by_name, "refused_node.node = 0 (for none)\n");
    says(by_name, "refused_node.verdict = ");
    char message[OBJECT_MESSAGE_MAX], index[8], first[16];
    const struct named_object *object =
        object_list_find(&ctl.objects, "refused_node.node", false, message);
    (void)snprintf(index, sizeof index, "0x%04X", object->entry->index);
    (void)snprintf(first, sizeof first, "%s:01", index);
    ck_assert_int_eq(run("get", index, NULL), EXIT_GOOD);
    ck_assert_str_eq(out_text, by_name);
    ck_assert_int_eq(run("get", first, NULL), EXIT_GOOD);
    ck_assert_str_eq(out_text, "refused_node.node = 0 (for none)\n");
    ck_assert_int_eq(run("get", "0x2099", NULL), EXIT_BAD);
    says(complaint_text, "no such object (0x06020000)");
}
END_TEST

START_TEST(a_refusal_is_told_in_words_with_what_is_allowed)
{
    ck_assert_int_eq(run("set", "kp_m_s_rad=2", NULL), EXIT_BAD);
    says(complaint_text, "the value is too high (0x06090031)");
    says(complaint_text, "allowed is 0 .. 1 m/(rad/s)");
    ck_assert_int_eq(run("set", "desired_apex_speed=99", NULL), EXIT_BAD);
    says(complaint_text, "too high");
    ck_assert_int_eq(run("set", "walk_requested=7", NULL), EXIT_BAD);
    says(complaint_text, "allowed is 0 .. 1");
    ticks(3000);
    ck_assert_int_eq(run("set", "leg_length_m=1.1", NULL), EXIT_BAD);
    says(complaint_text, "stop first");
    ck_assert_int_eq(run("save", NULL), EXIT_BAD);
    says(complaint_text, "a controller on a PC keeps no settings");
}
END_TEST

START_TEST(what_makes_no_sense_is_not_sent)
{
    ck_assert_int_eq(run("set", "kp_m_s_rad=0.045", "kp_m_s_rad=two", NULL), EXIT_USAGE);
    says(complaint_text, "is no number");
    ck_assert_int_eq(run("set", "kp_m_s_rad=0.045x", NULL), EXIT_USAGE);
    ck_assert_int_eq(run("set", "kp_m_s_rad=nan", NULL), EXIT_USAGE);
    ck_assert_int_eq(run("set", "walk_requested=300", NULL), EXIT_USAGE);
    says(complaint_text, "holds 0 .. 255");
    ck_assert_int_eq(run("set", "walk_requested=0.5", NULL), EXIT_USAGE);
    ck_assert_int_eq(run("set", "latched_fault=0", NULL), EXIT_USAGE);
    says(complaint_text, "only shown");
    ck_assert_int_eq(run("set", "law=walk", NULL), EXIT_USAGE);
    says(complaint_text, "0 proportional");
    ck_assert_uint_eq(requests, 0);
}
END_TEST

START_TEST(a_drive_is_not_written_to_while_it_has_torque)
{
    ticks(3000);
    ctl.link.node = NODE_DRIVE_LEFT;
    ctl_open(&ctl);
    ck_assert_int_eq(run("get", "latch_closed", NULL), EXIT_GOOD);
    ck_assert_int_eq(run("set", "abort_connection_option_code=0", NULL), EXIT_BAD);
    says(complaint_text, "afo ctl stop");
    ck_assert_int_eq(loop.nodes.drive[0].objects.abort_connection_option, 1);
}
END_TEST

START_TEST(a_silent_node_is_named)
{
    ctl.link.node = 77;
    ctl_open(&ctl);
    ck_assert_int_eq(run("get", "device_type", NULL), EXIT_BAD);
    says(complaint_text, "node 77 does not answer");
    /* and asked once only, however much is to be read */
    ck_assert_int_eq(run("get", "0x1018:01", "0x1018:02", "identity_object", "0x6041", NULL),
                     EXIT_BAD);
    ck_assert_ptr_eq(strstr(complaint_text, "does not answer"),
                     last_of(complaint_text, "does not answer"));
    ck_assert_int_eq(run("set", "producer_heartbeat_time=100", NULL), EXIT_BAD);
    ck_assert_ptr_eq(strstr(complaint_text, "does not answer"),
                     last_of(complaint_text, "does not answer"));
}
END_TEST

/* ---- the device ----------------------------------------------------------------------- */

START_TEST(stop_waits_for_unloaded_springs_and_walk_asks_anew)
{
    ticks(3000);
    ck_assert_int_eq(state(), SUPERVISOR_WALKING);
    ck_assert_int_eq(run("stop", NULL), EXIT_GOOD);
    ck_assert_str_eq(out_text, "standby\n");
    ck_assert_int_eq(state(), SUPERVISOR_STANDBY);
    ck_assert_uint_eq(loop.rig.task.node.objects.walk_requested, 0);
    ck_assert_int_eq(run("walk", NULL), EXIT_GOOD);
    ck_assert_str_eq(out_text, "engaging\n");
    ck_assert_int_eq(run("walk", NULL), EXIT_GOOD); /* it does already */
}
END_TEST

START_TEST(a_spent_request_is_taken_back_and_made_anew)
{
    ticks(3000);
    plant_push(&loop.nodes.plant, -1.0, 0.0); /* it falls */
    for (int i = 0; i < 6000 && state() != SUPERVISOR_FAULT && state() != SUPERVISOR_STANDBY; i++) {
        ticks(1);
    }
    ticks(1000);
    ck_assert(state() == SUPERVISOR_FAULT || state() == SUPERVISOR_STANDBY);
    ck_assert_uint_eq(loop.rig.task.node.objects.walk_requested, 1);
    if (state() == SUPERVISOR_FAULT) {
        ck_assert_int_eq(run("walk", NULL), EXIT_BAD);
        says(complaint_text, "afo ctl reset");
        return;
    }
    ck_assert_int_eq(run("walk", NULL), EXIT_GOOD);
    ck_assert_int_eq(state(), SUPERVISOR_ENGAGING);
}
END_TEST

START_TEST(the_emergency_stop_is_told_and_reset_waits_for_its_release)
{
    ticks(3000);
    loop.rig.stop_pressed = true;
    ticks(1500);
    ck_assert_int_eq(state(), SUPERVISOR_FAULT);
    ck_assert_int_eq(run("walk", NULL), EXIT_BAD);
    says(out_text, "FAULT: emergency stop, emergency stop pressed");
    says(complaint_text, "release the emergency stop");
    ctl.patience_ms = 500;
    ck_assert_int_eq(run("reset", NULL), EXIT_BAD);
    says(complaint_text, "still there");
    loop.rig.stop_pressed = false;
    ctl.patience_ms = 10000;
    ticks(1000);
    ck_assert_int_eq(run("reset", NULL), EXIT_GOOD);
    ck_assert_str_eq(out_text, "standby\n");
    ck_assert_int_eq(run("reset", NULL), EXIT_GOOD); /* nothing to clear */
}
END_TEST

/* Whatever one line of the list finds, the others are told, too. */
START_TEST(a_board_is_checked_line_by_line)
{
    struct controller_board *board = &loop.rig.task.node.objects.board;
    struct controller_counters *counters = &loop.rig.task.node.objects.counters;
    const struct controller_board good = {.clock_Hz = 170000000,
                                          .watchdog_clock_Hz = 32100,
                                          .option_bytes = 0xFEEFFBAA,
                                          .wanted_option_bytes = 0xFEEFFBAA,
                                          .reset_flags = 1u << 27,
                                          .bits =
                                              BOARD_BOOST | BOARD_STOP_CLOSED | BOARD_PERMIT_MOVES};
    static const char *const lines[] = {"clock ", "boost", "watchdog", "option",   "supply",
                                        "supply", "stop",  "permit",   "cut line", "program"};

    ck_assert_int_eq(run("board", NULL), EXIT_BAD);
    says(complaint_text, "no board");
    *board = good;
    ck_assert_int_eq(run("board", NULL), EXIT_GOOD);
    says(out_text, "power-on");
    for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++) {
        *board = good;
        board->clock_Hz -= i == 0;
        board->bits ^= (uint8_t)(i == 1 ? BOARD_BOOST : 0);
        board->watchdog_clock_Hz = i == 2 ? 27000 : board->watchdog_clock_Hz;
        board->option_bytes ^= i == 3 ? 1u << 24 : 0;
        board->supply_dips = i == 4;
        board->bits ^= (uint8_t)(i == 5 ? BOARD_SUPPLY_LOW : 0);
        board->bits ^= (uint8_t)(i == 6 ? BOARD_STOP_CLOSED : 0);
        board->bits ^= (uint8_t)(i == 7 ? BOARD_PERMIT_MOVES : 0);
        board->bits ^= (uint8_t)(i == 8 ? BOARD_POWER_CUT : 0);
        counters->flash_corrected = i == 9;
        ck_assert_int_eq(run("board", NULL), EXIT_BAD);
        const char *line = strstr(out_text, lines[i]);
        ck_assert_ptr_nonnull(line);
        ck_assert(strstr(line, "NOT SO") < strchr(line, '\n'));
    }
}
END_TEST

START_TEST(zero_tells_how_it_ended)
{
    ticks(3000);
    ck_assert_int_eq(run("zero", NULL), EXIT_BAD);
    says(complaint_text, "afo ctl stop");
    ck_assert_int_eq(run("stop", NULL), EXIT_GOOD);
    ck_assert_int_eq(run("zero", NULL),
                     EXIT_BAD); /* it does not stand with its legs side by side */
    says(complaint_text, "refused");
}
END_TEST

START_TEST(a_tool_that_is_interrupted_says_what_stays)
{
    ticks(10);
    ck_assert_int_eq(run("stop", NULL), EXIT_GOOD);
    pauses_before_end = 20; /* within the wait for the nodes */
    ck_assert_int_eq(run("walk", NULL), EXIT_BAD);
    says(complaint_text, "interrupted");
}
END_TEST

/* ---- watch, dump, diff ------------------------------------------------------------------- */

START_TEST(watch_prints_what_changes)
{
    ctl.looks = 40;
    ck_assert_int_eq(run("watch", "supervisor_state", "law", NULL), EXIT_GOOD);
    says(out_text, "state.supervisor_state_and_emergency_stop = 4 (walking)\n");
    const char *law = strstr(out_text, "parameters.law");
    ck_assert_ptr_nonnull(law);
    ck_assert_ptr_null(strstr(law + 1, "parameters.law")); /* once: it does not change */
    ctl.looks = 0;
    pauses_before_end = 3;
    ck_assert_int_eq(run("watch", "ticks", NULL), EXIT_GOOD); /* Ctrl-C is its end */
}
END_TEST

static void write_dump(char *path)
{
    const int file = mkstemp(path);
    ck_assert_int_ge(file, 0);
    ck_assert_int_eq(run("dump", NULL), EXIT_GOOD);
    ck_assert_int_eq(write(file, out_text, out_size), (int)out_size);
    close(file);
}

START_TEST(a_dump_equals_the_node_and_diff_names_what_was_changed)
{
    char path[] = "/tmp/afo-ctl-XXXXXX";
    ck_assert_int_eq(run("set", "kp_m_s_rad=0.04", NULL), EXIT_GOOD);
    write_dump(path);
    says(out_text, "[controller]\n");
    says(out_text, "kp_m_s_rad = 0.04 ; m/(rad/s)\n");
    ck_assert_int_eq(run("diff", path, NULL), EXIT_GOOD);
    char compared[64];
    (void)snprintf(compared, sizeof compared, "%d compared, 0 different, 0 unknown\n",
                   CONTROL_PARAM_COUNT - CONTROL_PARAMS_LOCKED + 1);
    says(out_text, compared);
    ck_assert_int_eq(run("set", "kp_m_s_rad=0.045", NULL), EXIT_GOOD);
    ck_assert_int_eq(run("diff", path, NULL), EXIT_BAD);
    says(out_text, "parameters.kp_m_s_rad: file 0.04, node 0.045 m/(rad/s)\n");
    says(out_text, "1 different");
    ck_assert_int_eq(run("diff", "/nowhere/file", NULL), EXIT_USAGE);
    unlink(path);
}
END_TEST

/* This program's client number is 100 (README.md). Of the virtual device the left gear is 1, and 2 is allowed. */
START_TEST(changes_are_told_with_who_when_and_from_what_to_what)
{
    ck_assert_int_eq(run("changes", NULL), EXIT_GOOD);
    says(out_text, "0 changes since the start");
    ck_assert_int_eq(run("set", "kp_m_s_rad=0.04", NULL), EXIT_GOOD);
    ck_assert_int_eq(run("stop", NULL), EXIT_GOOD);
    for (int i = 0; i < 3000; i++) {
        loop_tick(&loop);
    }
    ck_assert_int_eq(run("set", "kp_m_s_rad=0.045", "0x2051:12=2", NULL), EXIT_GOOD);
    ck_assert_int_eq(run("set", "kp_m_s_rad=2", NULL), EXIT_BAD); /* refused: no change */
    ck_assert_int_eq(run("changes", NULL), EXIT_GOOD);
    says(out_text, "3 changes since the start, the last 3 of them:\n");
    says(out_text, "client 100 parameters.kp_m_s_rad: ");
    says(out_text, " to 0.04\n");
    says(out_text, "parameters.kp_m_s_rad: 0.04 to 0.045\n");
    says(out_text, "left_leg_s_device.left_gear: 1 to 2\n");
    ctl.json = true;
    ck_assert_int_eq(run("changes", NULL), EXIT_GOOD);
    says(out_text, "\"since_start\": 3");
    says(out_text, "\"client\": 100");
    says(out_text, "\"address\": \"0x2051:12\"");
    ctl.json = false;
}
END_TEST

/* The ring keeps the last 32, oldest first. */
START_TEST(the_last_changes_are_kept)
{
    char word[40];
    for (int i = 0; i < 40; i++) {
        (void)snprintf(word, sizeof word, "0x2052:12=%d", i % 2 + 2);
        ck_assert_int_eq(run("set", word, NULL), EXIT_GOOD);
    }
    ck_assert_int_eq(run("changes", NULL), EXIT_GOOD);
    says(out_text, "40 changes since the start, the last 32 of them:\n   9  ");
    const char *line = strchr(out_text, '\n') + 1;
    for (int number = 9; number <= 40; number++) {
        ck_assert_int_eq((int)strtol(line, NULL, 10), number);
        line = strchr(line, '\n') + 1;
    }
    ck_assert_str_eq(line, "");
}
END_TEST

/* Why the drives are spared is told by a name. */
START_TEST(the_drives_state_is_told_in_words)
{
    struct control_task *task = &loop.rig.task;
    task->config.limits[SIDE_LEFT] = (struct derate_limits){1.0f, 2.0f, 0.0f, 0.0f};
    task->config.limits[SIDE_RIGHT] = (struct derate_limits){0.0f, 0.0f, 900.0f, 0.0f};
    task->node.objects.loaded_without_link = 2;
    ck_assert_int_eq(run("stop", NULL), EXIT_GOOD);
    for (int i = 0; i < 12000; i++) {
        loop_tick(&loop);
    }
    ck_assert_int_eq(run("get", "drives", NULL), EXIT_GOOD);
    says(out_text, "drives.left_spared_for = 1 (temperature)\n");
    says(out_text, "drives.last_withdrawn_for = 1 (temperature)\n");
    says(out_text, "drives.right_spared_for = 2 (supply too low)\n");
    says(out_text, "drives.withdrawn = 1");
    says(out_text, "drives.share_of_the_push = 0 %");
    says(out_text, "drives.loaded_without_link = 2\n");
    ctl.patience_ms = 300;
    ck_assert_int_eq(run("walk", NULL), EXIT_BAD);
    says(complaint_text, "the drives are spared");
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("ctl");
    TCase *tcase = tcase_create("verbs");
    tcase_set_timeout(tcase, 60);
    tcase_add_checked_fixture(tcase, setup, teardown);
    tcase_add_test(tcase, every_entry_has_one_name_and_is_found_by_it);
    tcase_add_test(tcase, parameters_have_the_ranges_and_units_of_their_table);
    tcase_add_test(tcase, a_mistyped_name_is_answered_with_the_nearest);
    tcase_add_test(tcase, values_are_shown_in_si_units_with_their_names);
    tcase_add_test(tcase, a_setting_is_written_and_read_back);
    tcase_add_test(tcase, a_value_that_comes_by_a_ramp_is_told_as_accepted);
    tcase_add_test(tcase, an_index_alone_is_its_whole_group);
    tcase_add_test(tcase, a_refusal_is_told_in_words_with_what_is_allowed);
    tcase_add_test(tcase, what_makes_no_sense_is_not_sent);
    tcase_add_test(tcase, a_drive_is_not_written_to_while_it_has_torque);
    tcase_add_test(tcase, a_silent_node_is_named);
    tcase_add_test(tcase, stop_waits_for_unloaded_springs_and_walk_asks_anew);
    tcase_add_test(tcase, a_spent_request_is_taken_back_and_made_anew);
    tcase_add_test(tcase, the_emergency_stop_is_told_and_reset_waits_for_its_release);
    tcase_add_test(tcase, a_board_is_checked_line_by_line);
    tcase_add_test(tcase, zero_tells_how_it_ended);
    tcase_add_test(tcase, a_tool_that_is_interrupted_says_what_stays);
    tcase_add_test(tcase, watch_prints_what_changes);
    tcase_add_test(tcase, changes_are_told_with_who_when_and_from_what_to_what);
    tcase_add_test(tcase, the_last_changes_are_kept);
    tcase_add_test(tcase, the_drives_state_is_told_in_words);
    tcase_add_test(tcase, a_dump_equals_the_node_and_diff_names_what_was_changed);
    suite_add_tcase(suite, tcase);
    return run_suite(suite);
}
