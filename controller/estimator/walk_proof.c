#include "controller/estimator/walk_proof.h"

enum {
    /* A switch that says something else for so long means it; bounce is over by then. */
    BOUNCE_TICKS = TICKS_OF_MS(12),
    /* A closing counts as a foot's after so long in the air: shorter is bounce or chatter. */
    OPEN_LEAST_TICKS = TICKS_OF_MS(50),
    SWING_LEAST_TICKS = TICKS_OF_MS(150),
    SWING_MOST_TICKS = TICKS_OF_MS(1500),
    /* Double support of walking lasts 60 ms and more; the switches' biases take up to 40 of it. */
    DOUBLE_LEAST_TICKS = TICKS_OF_MS(20)
};

/* The standing leg turns back by so much at least while it stands alone: 6 cm on a 0.9 m leg. */
#define PROGRESS_LEAST_RAD REAL(0.07)
/* The foot that lands is ahead of the other by so much: 5 cm. */
#define AHEAD_LEAST_RAD REAL(0.06)

static void count_up(uint16_t *ticks)
{
    if (*ticks < UINT16_MAX) {
        (*ticks)++;
    }
}

static void watch_raw(struct foot_history *foot, enum foot_contact now, uint32_t tick)
{
    const bool down = now != FOOT_UP;
    if (!down && !foot->raw_up) {
        foot->raw_up_tick = tick;
    } else if (foot->raw_up && now == FOOT_DOWN && tick - foot->raw_up_tick >= OPEN_LEAST_TICKS) {
        foot->raw_edge_tick = tick;
    }
    foot->raw_up = !down;
}

/* True in the tick in which the foot itself has changed. */
static bool changes(struct foot_history *foot, enum foot_contact now, uint32_t tick)
{
    watch_raw(foot, now, tick);
    if (now == foot->contact) {
        foot->other_ticks = 0;
        return false;
    }
    count_up(&foot->other_ticks);
    if (foot->other_ticks < BOUNCE_TICKS) {
        return false;
    }
    foot->contact = now;
    foot->since_tick = tick;
    foot->other_ticks = 0;
    return true;
}

static enum walk_sign deny(struct walk_proof *proof)
{
    proof->steps = 0;
    proof->single[SIDE_LEFT] = proof->single[SIDE_RIGHT] = false;
    return WALK_STEP_DENIED;
}

static enum walk_sign leaves(struct walk_proof *proof, int side, const real angle_rad[SIDE_COUNT],
                             uint32_t tick)
{
    const struct foot_history *other = &proof->foot[1 - side];
    if (other->contact != FOOT_DOWN || tick - other->since_tick < DOUBLE_LEAST_TICKS) {
        return deny(proof);
    }
    proof->single[side] = false;
    proof->single[1 - side] = true;
    proof->single_from_rad[1 - side] = angle_rad[1 - side];
    return WALK_FOOT_CHANGED;
}

static enum walk_sign lands(struct walk_proof *proof, int side, uint32_t swing_ticks,
                            const real angle_rad[SIDE_COUNT])
{
    const int standing = 1 - side;
    const real progress_rad = proof->single_from_rad[standing] - angle_rad[standing];
    if (proof->foot[standing].contact != FOOT_DOWN) {
        return deny(proof);
    }
    if (!proof->single[standing]) {
        proof->steps = 0; /* its beginning was not seen */
        return WALK_NOTHING_NEW;
    }
    proof->single[standing] = false;
    if (swing_ticks < SWING_LEAST_TICKS || swing_ticks > SWING_MOST_TICKS ||
        progress_rad < PROGRESS_LEAST_RAD ||
        angle_rad[side] - angle_rad[standing] < AHEAD_LEAST_RAD) {
        return deny(proof);
    }
    if (proof->steps < UINT32_MAX) {
        proof->steps++;
    }
    return WALK_STEP_SHOWN;
}

enum walk_sign walk_proof_update(struct walk_proof *proof, const enum foot_contact foot[SIDE_COUNT],
                                 const real angle_rad[SIDE_COUNT], uint32_t tick)
{
    enum walk_sign sign = WALK_NOTHING_NEW;
    for (int side = 0; side < SIDE_COUNT; side++) {
        const uint32_t before_tick = proof->foot[side].since_tick;
        const bool was_up = proof->foot[side].contact == FOOT_UP;
        if (!changes(&proof->foot[side], foot[side], tick)) {
            continue;
        }
        if (foot[side] == FOOT_UP) {
            sign = leaves(proof, side, angle_rad, tick);
        } else if (foot[side] == FOOT_DOWN && was_up) {
            sign = lands(proof, side, tick - before_tick, angle_rad);
        } else {
            proof->steps = 0; /* a switch that is not heard shows nothing */
        }
    }
    return sign;
}
