#include "sim_host/nodes/power_relay.h"

#include "model/tick.h"

enum {
    K2_TICKS = TICKS_OF_MS(POWER_RELAY_PUMP_MS + POWER_RELAY_K2_MS + POWER_RELAY_STO_MS),
    K3_TICKS = TICKS_OF_MS(POWER_RELAY_K3_MS + POWER_RELAY_STO_MS)
};

static void toggle(void *context)
{
    ((struct power_relay *)context)->moved = true;
}

static void cut(void *context, bool on)
{
    ((struct power_relay *)context)->is_cut = on;
}

static const struct drive_power_enable_ops line_ops = {toggle, cut};

void power_relay_init(struct power_relay *relay)
{
    *relay = (struct power_relay){.lines = {&line_ops, relay}};
}

void power_relay_let_go(struct power_relay *relay)
{
    relay->is_cut = false;
}

/* Ticks in a row, up to `most`. */
static uint32_t counted(uint32_t ticks, bool on, uint32_t most)
{
    return !on ? 0 : ticks < most ? ticks + 1 : most;
}

bool power_relay_advance(struct power_relay *relay)
{
    relay->still_ticks = counted(relay->still_ticks, !relay->moved, K2_TICKS);
    relay->cut_ticks = counted(relay->cut_ticks, relay->is_cut, K3_TICKS);
    relay->moved = false;
    return relay->still_ticks < K2_TICKS && relay->cut_ticks < K3_TICKS;
}
