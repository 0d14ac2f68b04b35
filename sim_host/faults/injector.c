#include "sim_host/faults/injector.h"

#include "hal/bus/frame_table.h"
#include "sim_host/faults/foreign_node.h"
#include "sim_host/faults/injector_internal.h"

enum { TICK_NS = TICK_PERIOD_US * 1000 };

bool injector_prepare(struct loop *loop)
{
    return sim_bus_attach(&loop->bus, "foreign node", NULL, NULL) == INJECTOR_PORT_FOREIGN;
}

static struct sim_bus_fault on_frame(void *context, const struct can_msg *message, unsigned sender,
                                     uint64_t time_ns)
{
    struct injector *injector = (struct injector *)context;
    struct sim_bus_fault fault = {.kind = SIM_BUS_FAULT_NONE};
    (void)time_ns;
    for (unsigned i = 0; i < injector->count && fault.kind == SIM_BUS_FAULT_NONE; i++) {
        if (injector->shot[i].active) {
            fault = injector_on_frame(&injector->shot[i], message, sender);
            injector->shot[i].changed += fault.kind != SIM_BUS_FAULT_NONE ? 1 : 0;
        }
    }
    return fault;
}

static uint32_t foreign_node_frames(const struct loop *loop)
{
    return loop->bus.ports[INJECTOR_PORT_FOREIGN].status.tx_frames;
}

uint32_t injector_foreign_frames(const struct injector *injector)
{
    return foreign_node_frames(injector->loop) - injector->foreign_node_frames;
}

void injector_begin(struct injector *injector, struct loop *loop, const struct fault_shot *shots,
                    unsigned count)
{
    *injector = (struct injector){.loop = loop, .count = count};
    for (unsigned i = 0; i < count; i++) {
        injector->shot[i].shot = shots[i];
        injector->shot[i].rng = shots[i].seed;
        injector->shot[i].next_ns = UINT64_MAX;
    }
    injector->foreign_node_frames = foreign_node_frames(loop);
    sim_bus_set_fault_hook(&loop->bus, on_frame, injector);
}

static void begin_and_end(struct injector *injector)
{
    for (unsigned i = 0; i < injector->count; i++) {
        struct shot_state *state = &injector->shot[i];
        const struct fault_shot *shot = &state->shot;
        if (!state->active && !state->done && injector->tick >= shot->start_tick) {
            state->active = true;
            injector_start(state, injector->loop);
            foreign_node_begin(state, injector->loop->tick * (uint64_t)TICK_NS);
        }
        if (state->active && injector->tick >= shot->start_tick + shot->duration_ticks) {
            state->active = false;
            state->done = true;
            state->next_ns = UINT64_MAX;
            injector_stop(state, injector->loop);
        }
        if (state->active) {
            injector_hold(state, injector->loop);
        }
    }
}

static bool misses_tick(const struct injector *injector)
{
    for (unsigned i = 0; i < injector->count; i++) {
        if (injector->shot[i].active && injector->shot[i].shot.kind == FAULT_TICKS_MISSED) {
            return true;
        }
    }
    return false;
}

static uint64_t jitter_ns(struct injector *injector)
{
    for (unsigned i = 0; i < injector->count; i++) {
        struct shot_state *state = &injector->shot[i];
        if (state->active && state->shot.kind == FAULT_TICK_JITTER) {
            return (uint64_t)(injector_random(&state->rng) * state->shot.magnitude * 1e6);
        }
    }
    return 0;
}

/* The bus up to until_ns, with what foreign nodes send by their own clocks meanwhile. */
static void run_bus(struct injector *injector, uint64_t until_ns)
{
    struct loop *loop = injector->loop;
    for (;;) {
        struct shot_state *next = NULL;
        for (unsigned i = 0; i < injector->count; i++) {
            struct shot_state *state = &injector->shot[i];
            if (state->next_ns <= until_ns && (next == NULL || state->next_ns < next->next_ns)) {
                next = state;
            }
        }
        if (next == NULL) {
            break;
        }
        sim_bus_run_until(&loop->bus, next->next_ns);
        foreign_node_send(next, loop);
    }
    sim_bus_run_until(&loop->bus, until_ns);
}

void injector_tick(struct injector *injector)
{
    struct loop *loop = injector->loop;
    const uint64_t sync_ns = loop->tick * (uint64_t)TICK_NS;
    begin_and_end(injector);
    run_bus(injector, sync_ns + jitter_ns(injector));
    if (!misses_tick(injector)) {
        /* As the flashed controller does it (firmware/orthosis.c). */
        bus_recovery_update(&injector->recovery, control_task_start_cycle(&loop->rig.task),
                            &loop->rig.task.config.bus);
    }
    run_bus(injector, sync_ns + TICK_NS - 1);
    loop_end_period(loop, sync_ns + TICK_NS - 1);
    injector->tick++;
}
