/* One stride of a block of walkers with vectors of BATCH_LANES: flight, push-off, flight.
 *
 * Included by kernel_*.c, once per instruction set; it defines the functions BATCH_STRIDE and BATCH_PEAK.
 */
#ifndef SIM_HOST_BATCH_KERNEL_H
#define SIM_HOST_BATCH_KERNEL_H

#include <string.h>

#include "sim_host/batch/flight.h"
#include "sim_host/batch/push_off.h"
#include "sim_host/batch/push_time.h"

/* The walkers in the lanes of a vector, and where in the block they belong. */
struct crew {
    double state[COLUMN_COUNT][BATCH_LANES];
    double slope[BATCH_DIRECTIONS][COLUMN_COUNT][BATCH_LANES];
    double mass_ratio[BATCH_LANES];
    double time[BATCH_LANES];
    double slope_rad[BATCH_LANES], rise[BATCH_LANES]; /* of the ground */
    int slot[BATCH_LANES]; /* -1: nobody; the lane computes on with what is left in it */
    int steps[BATCH_LANES];
    int waiting; /* next slot of the block to look at */
    int flying;  /* lanes with somebody in them */
};

/* Puts the block's next walker that has no fault into a lane. */
static void crew_enlist(struct crew *crew, const struct block *block, int lane, int directions)
{
    crew->slot[lane] = -1;
    while (crew->waiting < block->count && block->fault[crew->waiting] != STRIDE_OK) {
        crew->waiting++;
    }
    if (crew->waiting == block->count) {
        return;
    }
    const int slot = crew->waiting++;
    crew->slot[lane] = slot;
    crew->flying++;
    crew->steps[lane] = 0;
    crew->time[lane] = 0.0;
    crew->mass_ratio[lane] = block->mass_ratio[slot];
    crew->slope_rad[lane] = block->slope_rad[slot];
    crew->rise[lane] = block->rise[slot];
    for (int c = 0; c < COLUMN_COUNT; c++) {
        crew->state[c][lane] = block->state[c][slot];
        for (int d = 0; d < directions; d++) {
            crew->slope[d][c][lane] = block->slope[d][c][slot];
        }
    }
}

static void crew_discharge(struct crew *crew, struct block *block, int lane, int64_t fault,
                           double *time, int directions)
{
    const int slot = crew->slot[lane];
    crew->flying--;
    time[slot] = crew->time[lane];
    block->fault[slot] = fault;
    block->series[slot] += crew->steps[lane];
    for (int c = 0; c < COLUMN_COUNT; c++) {
        block->state[c][slot] = crew->state[c][lane];
        for (int d = 0; d < directions; d++) {
            block->slope[d][c][slot] = crew->slope[d][c][lane];
        }
    }
}

LANE_INLINE struct flight_state crew_variation(const struct crew *crew, int direction)
{
    const struct flight_state dx = {
        vd_load(crew->slope[direction][COLUMN_TS]), vd_load(crew->slope[direction][COLUMN_TN]),
        vd_load(crew->slope[direction][COLUMN_WS]), vd_load(crew->slope[direction][COLUMN_WN])};
    return dx;
}

/* Carries the variations through a step, and where it ended at the event, onto the event: a change of the
 * start changes the time of the event, too (saltation). */
LANE_INLINE void crew_move_slopes(struct crew *crew, const struct taylor *t,
                                  const struct flight_walker *walker, enum flight_goal goal,
                                  const struct flight_end *end, int directions)
{
    struct flight_state rates = {end->x.ws, end->x.wn, vd_all(0.0), vd_all(0.0)};
    for (int k = t->order - 1; k >= 1; k--) {
        rates.ws = rates.ws * end->length + (double)k * t->ws[k];
        rates.wn = rates.wn * end->length + (double)k * t->wn[k];
    }
    const vd per_rate = 1.0 / event_of(goal, rates.ts, rates.tn);
    for (int d = 0; d < directions; d++) {
        struct flight_state dx = crew_variation(crew, d);
        variation_move(t, walker, end->length, &dx);
        const vd later = -event_of(goal, dx.ts, dx.tn) * per_rate;
        const vd shift = vd_pick(end->arrived, later, vd_all(0.0));
        vd_store(crew->slope[d][COLUMN_TS], dx.ts + shift * rates.ts);
        vd_store(crew->slope[d][COLUMN_TN], dx.tn + shift * rates.tn);
        vd_store(crew->slope[d][COLUMN_WS], dx.ws + shift * rates.ws);
        vd_store(crew->slope[d][COLUMN_WN], dx.wn + shift * rates.wn);
    }
}

LANE_INLINE struct flight_end crew_step(struct crew *crew, const struct block_precision *precision,
                                        enum flight_goal goal, int directions, int has_ground)
{
    struct taylor t;
    const struct flight_ground ground = {vd_load(crew->slope_rad), vd_load(crew->rise)};
    const struct flight_walker walker = flight_walker_of(vd_load(crew->mass_ratio));
    const struct flight_state x = {vd_load(crew->state[COLUMN_TS]), vd_load(crew->state[COLUMN_TN]),
                                   vd_load(crew->state[COLUMN_WS]),
                                   vd_load(crew->state[COLUMN_WN])};
    taylor_expand(&t, &walker, &x, precision->order);
    const struct flight_end end = flight_land(&t, goal, has_ground ? &ground : NULL,
                                              taylor_step(&t, precision->log2_tolerance));
    if (directions > 0) {
        crew_move_slopes(crew, &t, &walker, goal, &end, directions);
    }
    vd_store(crew->state[COLUMN_TS], end.x.ts);
    vd_store(crew->state[COLUMN_TN], end.x.tn);
    vd_store(crew->state[COLUMN_WS], end.x.ws);
    vd_store(crew->state[COLUMN_WN], end.x.wn);
    vd_store(crew->time, vd_load(crew->time) + end.length);
    return end;
}

/* Flies all walkers of the block that have no fault to the goal. */
LANE_INLINE void fly(struct block *block, const struct block_precision *precision,
                     enum flight_goal goal, double *time, int directions, int has_ground)
{
    const int64_t overdue = goal == GOAL_STRIKE ? STRIDE_NO_HEEL_STRIKE : STRIDE_NO_APEX;
    struct crew crew;
    memset(&crew, 0, sizeof crew);
    for (int lane = 0; lane < BATCH_LANES; lane++) {
        crew_enlist(&crew, block, lane, directions);
    }
    while (crew.flying > 0) {
        const struct flight_end end = crew_step(&crew, precision, goal, directions, has_ground);
        for (int lane = 0; lane < BATCH_LANES; lane++) {
            if (crew.slot[lane] < 0) {
                continue;
            }
            int64_t fault = end.fault[lane];
            crew.steps[lane]++;
            if (fault == STRIDE_OK && !end.arrived[lane]) {
                if (crew.time[lane] < BATCH_PHASE_LIMIT && crew.steps[lane] < BATCH_MAX_STEPS) {
                    continue;
                }
                fault = overdue;
            }
            crew_discharge(&crew, block, lane, fault, time, directions);
            crew_enlist(&crew, block, lane, directions);
        }
    }
}

/* Up to BATCH_LANES slots of the block, gathered: those without a fault from *from on. */
static int gather(const struct block *block, int *from, int slots[BATCH_LANES])
{
    int count = 0;
    for (; *from < block->count && count < BATCH_LANES; ++*from) {
        if (block->fault[*from] == STRIDE_OK) {
            slots[count++] = *from;
        }
    }
    for (int lane = count; lane < BATCH_LANES; lane++) {
        slots[lane] = count > 0 ? slots[0] : 0; /* the same again; not stored */
    }
    return count;
}

LANE_INLINE vd gathered(const double *column, const int *slots)
{
    vd x = vd_all(0.0);
    for (int lane = 0; lane < BATCH_LANES; lane++) {
        x[lane] = column[slots[lane]];
    }
    return x;
}

LANE_INLINE void scatter(double *column, const int *slots, int count, vd x)
{
    for (int lane = 0; lane < count; lane++) {
        column[slots[lane]] = x[lane];
    }
}

LANE_INLINE struct dual gathered_dual(const struct block *block, int column, const int *slots,
                                      int directions)
{
    struct dual x;
    x.v = gathered(block->state[column], slots);
    for (int d = 0; d < directions; d++) {
        x.d[d] = gathered(block->slope[d][column], slots);
    }
    return x;
}

LANE_INLINE void scatter_dual(struct block *block, int column, const int *slots, int count,
                              struct dual x, int directions)
{
    scatter(block->state[column], slots, count, x.v);
    for (int d = 0; d < directions; d++) {
        scatter(block->slope[d][column], slots, count, x.d[d]);
    }
}

/* Collision, clamp and double support of all walkers of the block that have no fault. */
LANE_INLINE void push_all(struct block *block, const struct block_precision *precision,
                          int directions, int has_ground)
{
    int from = 0, slots[BATCH_LANES] = {0};
    for (int count = gather(block, &from, slots); count > 0; count = gather(block, &from, slots)) {
        struct dual x[COLUMN_COUNT];
        for (int c = 0; c < COLUMN_COUNT; c++) {
            x[c] = gathered_dual(block, c, slots, directions);
        }
        struct dual rest = dual_all(gathered(block->push, slots), directions);
        if (directions > 0) {
            rest.d[directions - 1] = vd_all(1.0); /* the last direction is r0 */
        }
        const struct flight_ground ground = {gathered(block->slope_rad, slots),
                                             gathered(block->rise, slots)};
        /* The strike is where ts + tn is twice the incline; on level ground to rounding, hence exactly. */
        const vd incline =
            vd_pick(ground_is_level(&ground), vd_all(0.0), 0.5 * (x[COLUMN_TS].v + x[COLUMN_TN].v));
        const struct push_result out =
            push_off(gathered(block->mass_ratio, slots), gathered(block->stiffness, slots), rest, x,
                     has_ground ? &incline : NULL, vi_all(-1), directions);
        scatter(block->opening, slots, count, vd_abs(x[COLUMN_TN].v - x[COLUMN_TS].v));
        struct flight_state after = {out.ts.v, out.tn.v, out.ws.v, out.wn.v};
        const vi fault = vi_pick(out.fault == vi_all(STRIDE_OK), flight_fault(&after), out.fault);
        scatter_dual(block, COLUMN_TS, slots, count, out.ts, directions);
        scatter_dual(block, COLUMN_TN, slots, count, out.tn, directions);
        scatter_dual(block, COLUMN_WS, slots, count, out.ws, directions);
        scatter_dual(block, COLUMN_WN, slots, count, out.wn, directions);
        scatter(block->step, slots, count, out.push.step);
        scatter(block->ankle_rate, slots, count, out.ankle_rate);
        if (precision->want_times) {
            scatter(block->time[1], slots, count, push_time(&out.push, fault == vi_all(STRIDE_OK)));
        }
        for (int lane = 0; lane < count; lane++) {
            block->clamped[slots[lane]] = out.clamped[lane] & 1;
            block->fault[slots[lane]] = fault[lane];
        }
    }
}

static void stride_plain(struct block *block, const struct block_precision *precision)
{
    fly(block, precision, GOAL_STRIKE, block->time[0], 0, 0);
    push_all(block, precision, 0, 0);
    fly(block, precision, GOAL_APEX, block->time[2], 0, 0);
}

static void stride_rough(struct block *block, const struct block_precision *precision)
{
    fly(block, precision, GOAL_STRIKE, block->time[0], 0, 1);
    push_all(block, precision, 0, 1);
    fly(block, precision, GOAL_APEX, block->time[2], 0, 0);
}

static void stride_with_slopes(struct block *block, const struct block_precision *precision)
{
    fly(block, precision, GOAL_STRIKE, block->time[0], BATCH_DIRECTIONS - 1, 0);
    push_all(block, precision, BATCH_DIRECTIONS, 0);
    fly(block, precision, GOAL_APEX, block->time[2], BATCH_DIRECTIONS, 0);
}

static void stride_from_strike(struct block *block, const struct block_precision *precision)
{
    push_all(block, precision, 0, 0);
    fly(block, precision, GOAL_APEX, block->time[2], 0, 0);
    fly(block, precision, GOAL_STRIKE, block->time[0], 0, 0);
}

double BATCH_PEAK(long rounds)
{
    /* Seven chains each: enough for a latency of three and two units of each kind, and all sixteen registers. */
    vd p0 = vd_all(1.0), p1 = 2.0 * p0, p2 = 3.0 * p0, p3 = 4.0 * p0, p4 = 5.0 * p0, p5 = 6.0 * p0;
    vd s0 = p0, s1 = p1, s2 = p2, s3 = p3, s4 = p4, s5 = p5, p6 = 7.0 * p0, s6 = p6;
    const vd factor = vd_all(1.0 - 1e-9), term = vd_all(1e-9);
    for (long round = 0; round < rounds; round++) {
        p0 = p0 * factor;
        s0 = s0 + term;
        p1 = p1 * factor;
        s1 = s1 + term;
        p2 = p2 * factor;
        s2 = s2 + term;
        p3 = p3 * factor;
        s3 = s3 + term;
        p4 = p4 * factor;
        s4 = s4 + term;
        p5 = p5 * factor;
        s5 = s5 + term;
        p6 = p6 * factor;
        s6 = s6 + term;
    }
    const vd all = p0 + p1 + p2 + p3 + p4 + p5 + p6 + s0 + s1 + s2 + s3 + s4 + s5 + s6;
    return all[0];
}

void BATCH_STRIDE(struct block *block, const struct block_precision *precision)
{
    if (precision->from_strike) {
        stride_from_strike(block, precision);
    } else if (precision->want_slopes) {
        stride_with_slopes(block, precision);
    } else if (precision->has_ground) {
        stride_rough(block, precision);
    } else {
        stride_plain(block, precision);
    }
}

#endif
