#include "sim_host/bus/bus_budget.h"

#include <stdio.h>

#include "hal/bus/frame_table.h"

enum {
    ERROR_BITS = 31, /* error flags, delimiter and intermission, Davis 2007 section 3.3 */
    ERRORS_EVERY_US = 10000,
    TICK_STEP_US = 50,
    NEVER_DEADLINES = 50 /* a response so many deadlines long has no bound */
};

struct row {
    uint32_t id;
    uint32_t bits; /* with the most stuff bits */
    uint32_t period_us, deadline_us;
    bool apart; /* not part of a walk's cycle: delays nobody */
};

struct bus {
    struct row row[64];
    unsigned count;
    uint32_t bitrate, tick_us;
};

#define ROW(name, id, bytes, period_us, deadline_us, node, kind)                   \
    {id, 34 + 8 * (bytes) + 13 + (34 + 8 * (bytes)-1) / 4, period_us, deadline_us, \
     (id) == FRAME_NMT || ((id) > FRAME_SYNC && (id) < 0x100) || #kind[0] == 'O'},

static void read_table(struct bus *bus, uint32_t bitrate, uint32_t tick_us)
{
/* The table's times in ticks, of this tick and not of the build's. */
#undef FRAME_TICKS
#define FRAME_TICKS(n) ((n)*tick_us)
    const struct row rows[] = {FRAME_TABLE(ROW)};
    bus->count = sizeof rows / sizeof rows[0];
    _Static_assert(sizeof rows <= sizeof bus->row, "the table fits");
    for (unsigned i = 0; i < bus->count; i++) {
        bus->row[i] = rows[i];
    }
    bus->bitrate = bitrate;
    bus->tick_us = tick_us;
}

static double bits_of_us(const struct bus *bus, uint32_t us)
{
    return (double)us * (double)bus->bitrate / 1e6;
}

static uint32_t whole_up(double x)
{
    const uint32_t whole = (uint32_t)x;
    return (double)whole < x ? whole + 1 : whole;
}

static uint32_t errors_bits(const struct bus *bus, double window, const struct row *frame)
{
    uint32_t longest = 0;
    for (unsigned i = 0; i < bus->count; i++) {
        const struct row *row = &bus->row[i];
        const bool counts = row == frame || (!row->apart && row->id < frame->id);
        longest = counts && row->bits > longest ? row->bits : longest;
    }
    return (1 + (uint32_t)(window / bits_of_us(bus, ERRORS_EVERY_US))) * (ERROR_BITS + longest);
}

static uint32_t blocking_bits(const struct bus *bus, const struct row *frame)
{
    uint32_t longest = 0;
    for (unsigned i = 0; i < bus->count; i++) {
        const struct row *row = &bus->row[i];
        longest = !row->apart && row->id > frame->id && row->bits > longest ? row->bits : longest;
    }
    return longest;
}

/* What more urgent frames take in a window. */
static uint32_t demand_bits(const struct bus *bus, double window, const struct row *frame)
{
    uint32_t sum = 0;
    for (unsigned i = 0; i < bus->count; i++) {
        const struct row *row = &bus->row[i];
        if (!row->apart && row->id < frame->id) {
            sum += whole_up((window + 1.0) / bits_of_us(bus, row->period_us)) * row->bits;
        }
    }
    return sum;
}

/* Least fixed points of the two equations; each grows to its value or beyond the limit. */
static uint32_t busy_bits(const struct bus *bus, const struct row *frame, double limit)
{
    const double period = bits_of_us(bus, frame->period_us);
    uint32_t value = frame->bits, previous = 0;
    while (value != previous && (double)value <= limit) {
        previous = value;
        value = blocking_bits(bus, frame) + errors_bits(bus, previous, frame) +
                demand_bits(bus, previous, frame) + whole_up(previous / period) * frame->bits;
    }
    return value;
}

static uint32_t waiting_bits(const struct bus *bus, const struct row *frame, uint32_t instance,
                             double limit)
{
    const uint32_t before = blocking_bits(bus, frame) + instance * frame->bits;
    uint32_t value = before, previous = UINT32_MAX;
    while (value != previous && (double)value <= limit) {
        previous = value;
        value = before + errors_bits(bus, previous + frame->bits, frame) +
                demand_bits(bus, previous, frame);
    }
    return value;
}

static double response_bits(const struct bus *bus, const struct row *frame)
{
    const double period = bits_of_us(bus, frame->period_us);
    const uint32_t longer = frame->deadline_us > bus->tick_us ? frame->deadline_us : bus->tick_us;
    const double limit = NEVER_DEADLINES * bits_of_us(bus, longer);
    const uint32_t busy = busy_bits(bus, frame, limit);
    double worst = 0.0;
    if (busy > limit) {
        return (double)UINT32_MAX;
    }
    for (uint32_t i = 0; i < whole_up(busy / period); i++) {
        const uint32_t waiting = waiting_bits(bus, frame, i, limit);
        if (waiting > limit) {
            return (double)UINT32_MAX;
        }
        const double response = waiting + frame->bits - i * period;
        worst = response > worst ? response : worst;
    }
    return worst;
}

uint32_t bus_budget_response_bits(uint32_t bitrate, uint32_t tick_us, uint32_t frame_id)
{
    struct bus bus;
    read_table(&bus, bitrate, tick_us);
    for (unsigned i = 0; i < bus.count; i++) {
        if (bus.row[i].id == frame_id) {
            return (uint32_t)response_bits(&bus, &bus.row[i]);
        }
    }
    return UINT32_MAX;
}

bool bus_budget_holds(uint32_t bitrate, uint32_t tick_us)
{
    struct bus bus;
    read_table(&bus, bitrate, tick_us);
    for (unsigned i = 0; i < bus.count; i++) {
        if (response_bits(&bus, &bus.row[i]) > bits_of_us(&bus, bus.row[i].deadline_us)) {
            return false;
        }
    }
    return true;
}

uint32_t bus_budget_fastest_tick_us(uint32_t bitrate)
{
    uint32_t low = 1, high = BUS_BUDGET_SLOWEST_TICK_US / TICK_STEP_US;
    if (!bus_budget_holds(bitrate, high * TICK_STEP_US)) {
        return 0;
    }
    while (low < high) {
        const uint32_t middle = (low + high) / 2;
        if (bus_budget_holds(bitrate, middle * TICK_STEP_US)) {
            high = middle;
        } else {
            low = middle + 1;
        }
    }
    return low * TICK_STEP_US;
}

int bus_budget_check(uint32_t bitrate, uint32_t tick_us, char *message, size_t size)
{
    if (bus_budget_holds(bitrate, tick_us)) {
        return 0;
    }
    const uint32_t fits = bus_budget_fastest_tick_us(bitrate);
    if (fits == 0) {
        snprintf(message, size,
                 "%g kbit/s carries the bus's frames at no tick; take a faster bit rate",
                 bitrate / 1e3);
    } else {
        snprintf(message, size,
                 "%g kbit/s does not carry a tick of %u us; it carries one of %u us: build with "
                 "TICK_US=%u BITRATE=%u",
                 bitrate / 1e3, tick_us, fits, (fits + 99) / 100 * 100, bitrate);
    }
    return -1;
}

int bus_budget_check_build(char *message, size_t size)
{
    return bus_budget_check(BUS_BITRATE, TICK_PERIOD_US, message, size);
}
