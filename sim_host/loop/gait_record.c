#include "sim_host/loop/gait_record.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The controller numbers its SYNCs from 1, and its input of a tick was sampled one
 * SYNC before. */
#define SAMPLED_BEFORE_TICKS 2.0

void gait_record_init(struct gait_record *record, double origin_s)
{
    memset(record, 0, sizeof *record);
    record->origin_s = origin_s;
}

void gait_record_free(struct gait_record *record)
{
    for (int side = 0; side < SIDE_COUNT; side++) {
        for (int kind = 0; kind < GAIT_EVENT_KINDS; kind++) {
            free(record->seen[side][kind].at);
        }
        free(record->release[side].at);
        free(record->true_strike[side].at);
        free(record->true_toe_off[side].at);
        free(record->switch_closed[side].at);
        free(record->switch_opened[side].at);
    }
    memset(record, 0, sizeof *record);
}

static void append(struct gait_record *record, struct gait_moments *list, double event_s,
                   double known_s, double value)
{
    if (list->count == list->capacity) {
        const size_t capacity = list->capacity == 0 ? 256 : 2 * list->capacity;
        struct gait_moment *at =
            (struct gait_moment *)realloc(list->at, capacity * sizeof *list->at);
        if (at == NULL) {
            record->out_of_memory = true;
            return;
        }
        list->at = at;
        list->capacity = capacity;
    }
    list->at[list->count++] =
        (struct gait_moment){event_s - record->origin_s, known_s - record->origin_s, value};
}

/* The stride from the last true strike to this one is over: now its true phase at
 * each tick is known. */
static void measure_phase(struct gait_record *record, enum side side)
{
    const uint32_t count = record->phase_count[side];
    record->phase_count[side] = 0;
    if (record->true_strike[side].count < 2 || count == 0 || count >= GAIT_PHASE_TICKS) {
        return;
    }
    for (uint32_t i = 0; i < count; i++) {
        const double said = (double)record->phase[side][i];
        if (said >= 0.0) {
            const double off = said - (double)i / (double)count;
            const double error = off - floor(off + 0.5); /* 0.99 and 0.01 are close */
            record->phase_squares[side] += error * error;
            record->phase_measured[side]++;
        }
    }
}

void gait_record_truth(struct gait_record *record, const struct walk_event *event)
{
    const enum side side = event->side;
    switch (event->kind) {
    case WALK_EVENT_HEEL_STRIKE:
        append(record, &record->true_strike[side], event->time_s, event->time_s, 0.0);
        measure_phase(record, side);
        break;
    case WALK_EVENT_TOE_OFF:
        append(record, &record->true_toe_off[side], event->time_s, event->time_s, 0.0);
        break;
    case WALK_EVENT_RELEASE:
        append(record, &record->release[side], event->time_s, event->time_s, event->value);
        break;
    default:
        break;
    }
}

/* Edges of the switches, as the controller takes them for a foot's. */
static void take_switches(struct gait_record *record, const struct loop *loop, double period_s)
{
    const struct walk_proof *proof = &loop->rig.task.controller.observer.body.proof;
    for (int side = 0; side < SIDE_COUNT; side++) {
        const struct foot_history *foot = &proof->foot[side];
        if (foot->raw_edge_tick != record->switch_closed_tick[side] && foot->raw_edge_tick != 0) {
            const double edge_s = ((double)foot->raw_edge_tick - SAMPLED_BEFORE_TICKS) * period_s;
            append(record, &record->switch_closed[side], edge_s, edge_s, 0.0);
        }
        if (foot->contact == FOOT_UP && foot->raw_up_tick != record->switch_opened_tick[side]) {
            const double edge_s = ((double)foot->raw_up_tick - SAMPLED_BEFORE_TICKS) * period_s;
            append(record, &record->switch_opened[side], edge_s, edge_s, 0.0);
            record->switch_opened_tick[side] = foot->raw_up_tick;
        }
        record->switch_closed_tick[side] = foot->raw_edge_tick;
    }
}

void gait_record_take(struct gait_record *record, const struct loop *loop)
{
    const struct controller *controller = &loop->rig.task.controller;
    const struct gait_state *gait = &controller->observer.state;
    const double period_s = loop->nodes.plant.config.tick_s;
    const double now_s = (double)(loop->tick - 1) * period_s;
    for (int kind = 0; kind < GAIT_EVENT_KINDS; kind++) {
        const struct gait_event *event = &gait->event[kind];
        if (event->happened) {
            append(record, &record->seen[event->side][kind],
                   ((double)event->tick - SAMPLED_BEFORE_TICKS) * period_s -
                       (double)event->before_tick_s,
                   now_s, 0.0);
        }
    }
    take_switches(record, loop, period_s);
    for (int side = 0; side < SIDE_COUNT; side++) {
        if (record->phase_count[side] < GAIT_PHASE_TICKS) {
            record->phase[side][record->phase_count[side]++] = gait->stride_share[side];
        }
    }
}

double gait_record_phase_error(const struct gait_record *record, enum side side)
{
    const uint64_t measured = record->phase_measured[side];
    return measured > 0 ? sqrt(record->phase_squares[side] / (double)measured) : (double)NAN;
}
