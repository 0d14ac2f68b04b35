/* board: what a board must show before anyone walks with it, asked over SDO, line by line. */
#include <stdarg.h>
#include <string.h>

#include "firmware/controller_objects.h"
#include "model/tick.h"
#include "sim_host/ctl/ctl.h"
#include "sim_host/ctl/ctl_internal.h"

enum { ROWS_MAX = 16, TEXT_MAX = 160 };
/* The NUCLEO-G474RE's (hal/port_stm32g474/clock_tree.h, lsi_meter.h), and bits of RCC_CSR. */
enum { CLOCK_HZ = 170000000, WATCHDOG_CLOCK_LOWEST_HZ = 28000, WATCHDOG_CLOCK_HIGHEST_HZ = 35700 };

struct row {
    const char *name;
    char value[TEXT_MAX];
    bool good;
    const char *remedy; /* when it is not */
};

struct list {
    const struct ctl *ctl;
    struct row rows[ROWS_MAX];
    unsigned count;
    bool silent; /* a read failed, which was told */
};

static uint32_t ask(struct list *list, const char *name)
{
    uint32_t number = 0;

    list->silent = list->silent || ctl_read_named(list->ctl, name, &number) != 0;
    return number;
}

static void add(struct list *list, const char *name, bool good, const char *remedy,
                const char *format, ...) __attribute__((format(printf, 5, 6)));
static void add(struct list *list, const char *name, bool good, const char *remedy,
                const char *format, ...)
{
    struct row *row = &list->rows[list->count++];
    va_list arguments;

    *row = (struct row){.name = name, .good = good, .remedy = remedy};
    va_start(arguments, format);
    (void)vsnprintf(row->value, sizeof row->value, format, arguments);
    va_end(arguments);
}

/* RM0440, RCC_CSR. */
static void name_reset(uint32_t flags, char text[TEXT_MAX])
{
    static const char *const names[] = {"option bytes", "pin",      "power-on or brown-out",
                                        "software",     "watchdog", "window watchdog",
                                        "low power"};
    text[0] = '\0';
    for (unsigned i = 0; i < sizeof names / sizeof names[0]; i++) {
        if ((flags >> (25 + i) & 1u) != 0) {
            const size_t used = strlen(text);
            (void)snprintf(text + used, TEXT_MAX - used, "%s%s", used > 0 ? ", " : "", names[i]);
        }
    }
}

static void check_clocks(struct list *list, uint32_t bits)
{
    const uint32_t clock = ask(list, "board.clock");
    const uint32_t watchdog = ask(list, "board.watchdog_clock");

    add(list, "clock", clock == (uint32_t)CLOCK_HZ, "is the crystal X3 fitted?", "%u Hz", clock);
    add(list, "boost mode", (bits & (uint32_t)BOARD_BOOST) != 0,
        "the core must not run so fast without it", "%s",
        (bits & (uint32_t)BOARD_BOOST) != 0 ? "on" : "off");
    add(list, "watchdog's oscillator",
        watchdog >= (uint32_t)WATCHDOG_CLOCK_LOWEST_HZ &&
            watchdog <= (uint32_t)WATCHDOG_CLOCK_HIGHEST_HZ,
        watchdog == 0 ? "ask again two seconds later" : "it or the crystal is off", "%u Hz",
        watchdog);
}

static void check_supply(struct list *list, uint32_t bits)
{
    const uint32_t now = ask(list, "board.option_bytes");
    const uint32_t wanted = ask(list, "board.wanted_option_bytes");
    const uint32_t dips = ask(list, "board.supply_dips");
    const bool low = (bits & (uint32_t)BOARD_SUPPLY_LOW) != 0;

    add(list, "option bytes", now == wanted,
        "flash the board by cable (make flash); with read protection, erase it first",
        "%08X, wanted %08X", now, wanted);
    add(list, "supply", !low && dips == 0, "measure 3.3 V under load", "%s 2.9 V, %u dips",
        low ? "below" : "above", dips);
}

static void check_lines(struct list *list, uint32_t bits)
{
    const bool closed = (bits & (uint32_t)BOARD_STOP_CLOSED) != 0;
    const bool moves = (bits & (uint32_t)BOARD_PERMIT_MOVES) != 0;
    const bool cut = (bits & (uint32_t)BOARD_POWER_CUT) != 0;

    add(list, "stop input", closed, "release the button; is PC0 wired?", "%s",
        closed ? "closed" : "open: pressed, or not wired");
    add(list, "permit line", moves, "it moves once the bus works and no drive is stuck", "%s",
        moves ? "toggles" : "stands still");
    add(list, "cut line", !cut, "a drive kept its torque; if none did, is PC5 shorted?", "%s",
        cut ? "high: the drives' torque is taken" : "low");
}

static void check_bus(struct list *list)
{
    const uint32_t errors = ask(list, "counters.error_frames");
    const uint32_t lost = ask(list, "counters.frames_lost_on_receive");
    const uint32_t off = ask(list, "counters.times_bus_off");
    const uint32_t refused = ask(list, "counters.frames_refused_by_the_queue");
    const uint32_t missed = ask(list, "counters.missed_ticks");
    const uint32_t cycles = ask(list, "counters.worst_tick_cycles");

    add(list, "bus", errors == 0 && lost == 0 && off == 0 && refused == 0,
        "check terminators, ground and bit rate",
        "%u error frames, %u lost, %u not sent, %u times off", errors, lost, refused, off);
    add(list, "ticks", missed == 0, "something keeps the loop for too long",
        "%u missed, %u cycles at worst of %u", missed, cycles,
        (unsigned)(CLOCK_HZ / 1000000 * TICK_PERIOD_US));
}

static void check_memory(struct list *list)
{
    const uint32_t crc = ask(list, "program_software_identification.crc_32_of_the_program");
    const uint32_t rounds = ask(list, "board.program_tests");
    const uint32_t corrected = ask(list, "counters.flash_errors_corrected");
    const uint32_t ram = ask(list, "board.ram_tests");
    const uint32_t cause = ask(list, "last_crash.cause");
    char reset[TEXT_MAX];

    name_reset(ask(list, "board.reset_flags"), reset);
    add(list, "program", corrected == 0, "the flash ages: replace the board",
        "CRC-32 %08X, tested %u times, %u errors corrected", crc, rounds, corrected);
    add(list, "RAM", true, "", "tested %u times", ram);
    add(list, "reset", cause == 0, "afo blackbox tells more", "by %s; crash cause %u", reset,
        cause);
}

static void print_list(const struct list *list)
{
    for (unsigned i = 0; i < list->count; i++) {
        const struct row *row = &list->rows[i];
        fprintf(list->ctl->out, "%-21s  %-6s  %s%s%s\n", row->name, row->good ? "good" : "NOT SO",
                row->value, row->good ? "" : " - ", row->good ? "" : row->remedy);
    }
}

static void list_json(const struct list *list)
{
    struct json_writer json;

    json_begin(&json, list->ctl->out);
    json_open_object(&json, NULL);
    for (unsigned i = 0; i < list->count; i++) {
        json_open_object(&json, list->rows[i].name);
        json_bool(&json, "good", list->rows[i].good);
        json_text(&json, "value", list->rows[i].value);
        json_close_object(&json);
    }
    json_close_object(&json);
    json_end(&json);
}

enum exit_status ctl_board(struct ctl *ctl, int count, char **words)
{
    struct list list = {.ctl = ctl};
    const uint32_t bits = ask(&list, "board.state_bits");
    bool good = true;

    (void)count;
    (void)words;
    if (!list.silent && ask(&list, "board.clock") == 0 && !list.silent) {
        ctl_complain(ctl, "this controller runs on no board: its program tells of none");
        return EXIT_BAD;
    }
    check_clocks(&list, bits);
    check_supply(&list, bits);
    check_lines(&list, bits);
    check_bus(&list);
    check_memory(&list);
    if (list.silent) {
        return EXIT_BAD;
    }
    for (unsigned i = 0; i < list.count; i++) {
        good = good && list.rows[i].good;
    }
    if (ctl->json) {
        list_json(&list);
    } else {
        print_list(&list);
    }
    return good ? EXIT_GOOD : EXIT_BAD;
}
