/* The bus budget against the in-process bus: traffic at the limits of the frame table,
 * with blocking SDOs and a bus error every 10 ms, never takes longer than computed; and
 * the computation is not idly large. */
#include <check.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/bus/frame_table.h"
#include "sim_host/bus/bus_budget.h"
#include "sim_host/bus/sim_bus.h"
#include "tests/support/assert_close.h"

enum { TICKS = 20000, ERROR_EVERY_US = 10000 };

struct row {
    const char *name;
    uint32_t id;
    unsigned bytes;
    uint64_t period_us;
    unsigned node;
    char kind;
    bool apart;
    double budget_us;
    uint64_t next_us; /* earliest next release */
    double worst_us;  /* measured, from the SYNC's queueing or its own */
};

#define ROW(name, id, bytes, period_us, deadline_us, node, kind) \
    {#name, id, bytes, period_us, node, #kind[0], false, 0.0, 0, 0.0},
static struct row rows[] = {FRAME_TABLE(ROW)};
#undef ROW
enum { ROWS = sizeof rows / sizeof rows[0] };

static struct sim_bus bus;
static struct can_bus port[ROWS]; /* of the sender of each frame */
static struct can_bus nodes;
static uint64_t queued_ns[2048];
static uint64_t last_error_ns;
static unsigned seed;

static unsigned next_random(void)
{
    seed = seed * 1664525U + 1013904223U;
    return seed >> 8;
}

static void read_budget(const char *options)
{
    char command[128];
    char line[128];
    snprintf(command, sizeof command, "scripts/bus-budget --csv %s", options);
    FILE *pipe = popen(command, "r");
    ck_assert_ptr_nonnull(pipe);
    unsigned found = 0;
    while (fgets(line, sizeof line, pipe) != NULL) {
        char name[64];
        unsigned id;
        unsigned bits;
        double response_us;
        if (sscanf(line, "%63[^,],%x,%u,%lf", name, &id, &bits, &response_us) != 4) {
            continue;
        }
        for (unsigned i = 0; i < ROWS; i++) {
            if (rows[i].id == id) {
                ck_assert_str_eq(rows[i].name, name);
                rows[i].budget_us = response_us;
                found++;
            }
        }
    }
    ck_assert_int_eq(pclose(pipe), 0);
    ck_assert_uint_eq(found, ROWS);
}

static void note(void *context, const struct sim_bus_event *event)
{
    (void)context;
    if (event->kind != SIM_BUS_FRAME) {
        return;
    }
    for (unsigned i = 0; i < ROWS; i++) {
        if (rows[i].id == event->message.id) {
            const double took_us = (double)(event->time_ns - queued_ns[event->message.id]) / 1e3;
            rows[i].worst_us = took_us > rows[i].worst_us ? took_us : rows[i].worst_us;
        }
    }
}

/* One error in ten milliseconds, at the last bit where it costs most. */
static struct sim_bus_fault strike(void *context, const struct can_msg *message, unsigned sender,
                                   uint64_t time_ns)
{
    struct sim_bus_fault fault = {.kind = SIM_BUS_FAULT_NONE};
    (void)context;
    (void)sender;
    if (message->length >= 5 && time_ns - last_error_ns >= ERROR_EVERY_US * UINT64_C(1000)) {
        last_error_ns = time_ns;
        fault.kind = SIM_BUS_FAULT_DESTROY;
        fault.bit = 200;
    }
    return fault;
}

static void queue(unsigned i, uint64_t counted_from_ns)
{
    struct can_msg message = {.id = rows[i].id, .length = (uint8_t)rows[i].bytes};
    const unsigned r = next_random();
    for (unsigned b = 0; b < message.length; b++) {
        /* Bit patterns with the most stuff bits, and any others. */
        message.data[b] = (uint8_t)(r % 3 == 0 ? 0x78U : r % 3 == 1 ? 0x87U : next_random());
    }
    queued_ns[rows[i].id] = counted_from_ns;
    ck_assert_int_eq(can_bus_send(&port[i], &message), CAN_OK);
}

/* Nodes answer when the SYNC is through. */
static void answer(void *context, uint64_t now_ns)
{
    struct can_msg message;
    (void)context;
    while (can_bus_receive(&nodes, &message, NULL) == CAN_OK) {
        if (message.id != FRAME_SYNC || (message.flags & CAN_FRAME_ERROR) != 0) {
            continue;
        }
        for (unsigned i = 0; i < ROWS; i++) {
            const bool slow_now = rows[i].kind == 'N' && now_ns / 1000 >= rows[i].next_us;
            if ((rows[i].kind == 'S' && rows[i].id != FRAME_SYNC) || slow_now) {
                rows[i].next_us = now_ns / 1000 + rows[i].period_us - 200;
                queue(i, queued_ns[FRAME_SYNC]);
            }
        }
    }
}

static void walk_the_bus(void)
{
    sim_bus_init(&bus, BUS_BITRATE);
    /* One port per sending node is enough: queues are ordered by identifier. */
    const int controller = sim_bus_attach(&bus, "controller", NULL, NULL);
    const int others = sim_bus_attach(&bus, "nodes", answer, NULL);
    for (unsigned i = 0; i < ROWS; i++) {
        port[i] = sim_bus_port(&bus, rows[i].node == NODE_CONTROLLER ? controller : others);
        rows[i].apart =
            rows[i].id == FRAME_NMT || strncmp(rows[i].name, "EMCY", 4) == 0 || rows[i].kind == 'O';
    }
    nodes = sim_bus_port(&bus, others);
    sim_bus_set_tap(&bus, note, NULL);
    sim_bus_set_fault_hook(&bus, strike, NULL);
    seed = 1;
    for (uint64_t tick = 1; tick <= TICKS; tick++) {
        /* What is less urgent comes at any moment, often just before the SYNC. */
        const uint64_t sync_ns = tick * 1000000;
        const uint64_t early_ns = sync_ns - 1 - next_random() % (tick % 2 == 0 ? 5000 : 900000);
        sim_bus_run_until(&bus, early_ns);
        for (unsigned i = 0; i < ROWS; i++) {
            const bool sporadic = rows[i].kind == 'A' || rows[i].kind == 'E';
            if (sporadic && !rows[i].apart && early_ns / 1000 >= rows[i].next_us &&
                (tick % 97 == 0 || next_random() % 4 == 0)) {
                rows[i].next_us = early_ns / 1000 + rows[i].period_us;
                queue(i, early_ns);
            }
        }
        sim_bus_run_until(&bus, sync_ns);
        for (unsigned i = 0; i < ROWS; i++) {
            if (rows[i].id == FRAME_SYNC) {
                queue(i, sync_ns);
            }
        }
    }
    sim_bus_run_until(&bus, (TICKS + 100) * UINT64_C(1000000));
}

START_TEST(no_frame_takes_longer_than_the_budget_says)
{
    read_budget("--bitrate 1000000");
    walk_the_bus();
    ck_assert_uint_gt(bus.stats.error_frames, TICKS / 20);
    for (unsigned i = 0; i < ROWS; i++) {
        if (!rows[i].apart) {
            ck_assert_msg(rows[i].worst_us <= rows[i].budget_us,
                          "%s took %.1f us, the budget says %.1f us", rows[i].name,
                          rows[i].worst_us, rows[i].budget_us);
        }
        if (rows[i].kind == 'S') {
            ck_assert_msg(rows[i].worst_us >= 0.6 * rows[i].budget_us,
                          "%s took at most %.1f us, the budget says %.1f us: too cautious?",
                          rows[i].name, rows[i].worst_us, rows[i].budget_us);
        }
    }
}
END_TEST

START_TEST(the_last_sensor_frame_by_hand)
{
    /* SYNC 55, drives 2 x 115, targets 135, sensors 2 x 105 bits, one blocking SDO of 135
     * and one error of 31 + 135: 931 of the 1000 (architecture's lengths). */
    read_budget("--bitrate 1000000");
    for (unsigned i = 0; i < ROWS; i++) {
        if (rows[i].id == FRAME_LEG_STATE_RIGHT) {
            assert_close(rows[i].budget_us, 55 + 2 * 115 + 135 + 2 * 105 + 135 + 166, 1e-9, 0);
        }
    }
}
END_TEST

/* A device with foot switches has a table of its own. */
START_TEST(the_frames_of_foot_switches_fit_too)
{
    ck_assert_int_eq(system("scripts/bus-budget --bitrate 1000000 --optional >/dev/null"), 0);
    ck_assert_int_ne(system("scripts/bus-budget --bitrate 800000 --optional >/dev/null"), 0);
}
END_TEST

START_TEST(it_says_when_a_rate_does_not_fit_and_which_does)
{
    ck_assert_int_ne(system("scripts/bus-budget --bitrate 500000 >/dev/null"), 0);
    ck_assert_int_eq(system("scripts/bus-budget --bitrate 500000 | grep -q 'they hold with'"), 0);
    ck_assert_int_eq(system("scripts/bus-budget --bitrate 500000 --tick-us 2000 >/dev/null"), 0);
    ck_assert_int_ne(system("scripts/bus-budget --bitrate 5 >/dev/null 2>&1"), 0);
}
END_TEST

/* The programs' own computation against the script's, frame by frame. */
START_TEST(the_computation_in_c_is_the_script_s)
{
    static const unsigned pairs[][2] = {
        {1000000, 1000}, {500000, 2000}, {500000, 1900}, {250000, 4000}, {800000, 1300}};
    for (size_t p = 0; p < sizeof pairs / sizeof pairs[0]; p++) {
        char options[64];
        snprintf(options, sizeof options, "--bitrate %u --tick-us %u", pairs[p][0], pairs[p][1]);
        read_budget(options);
        ck_assert(bus_budget_holds(pairs[p][0], pairs[p][1]));
        for (unsigned i = 0; i < ROWS; i++) {
            const double bits = bus_budget_response_bits(pairs[p][0], pairs[p][1], rows[i].id);
            /* Whole bit times in C; the script prints thousandths of a microsecond. */
            ck_assert_msg(fabs(bits * 1e6 / pairs[p][0] - rows[i].budget_us) <= 1e6 / pairs[p][0],
                          "%s at %s: %g bits in C, %g us by the script", rows[i].name, options,
                          bits, rows[i].budget_us);
        }
    }
}
END_TEST

START_TEST(the_tick_that_fits_is_the_script_s)
{
    static const unsigned rates[] = {1000000, 800000, 500000, 250000, 125000};
    for (size_t i = 0; i < sizeof rates / sizeof rates[0]; i++) {
        const unsigned fits = bus_budget_fastest_tick_us(rates[i]);
        char command[128];
        ck_assert_uint_gt(fits, 0);
        snprintf(command, sizeof command, "scripts/bus-budget --bitrate %u --tick-us %u >/dev/null",
                 rates[i], fits);
        ck_assert_int_eq(system(command), 0);
        snprintf(command, sizeof command, "scripts/bus-budget --bitrate %u --tick-us %u >/dev/null",
                 rates[i], fits - 50);
        ck_assert_int_ne(system(command), 0);
    }
}
END_TEST

START_TEST(a_rate_that_does_not_fit_is_refused_with_one_that_does)
{
    char message[BUS_BUDGET_MESSAGE_MAX];
    ck_assert_int_eq(bus_budget_check_build(message, sizeof message), 0);
    ck_assert_int_eq(bus_budget_check(500000, 2000, message, sizeof message), 0);
    ck_assert_int_eq(bus_budget_check(500000, 1000, message, sizeof message), -1);
    ck_assert_ptr_nonnull(strstr(message, "TICK_US=1900 BITRATE=500000"));
    ck_assert_int_eq(bus_budget_check(10000, 1000, message, sizeof message), -1);
    ck_assert_ptr_nonnull(strstr(message, "at no tick"));
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("bus_budget");
    TCase *tcase = tcase_create("all");
    tcase_set_timeout(tcase, 60);
    tcase_add_test(tcase, no_frame_takes_longer_than_the_budget_says);
    tcase_add_test(tcase, the_last_sensor_frame_by_hand);
    tcase_add_test(tcase, the_computation_in_c_is_the_script_s);
    tcase_add_test(tcase, the_tick_that_fits_is_the_script_s);
    tcase_add_test(tcase, a_rate_that_does_not_fit_is_refused_with_one_that_does);
    tcase_add_test(tcase, the_frames_of_foot_switches_fit_too);
    tcase_add_test(tcase, it_says_when_a_rate_does_not_fit_and_which_does);
    suite_add_tcase(suite, tcase);
    return run_suite(suite);
}
