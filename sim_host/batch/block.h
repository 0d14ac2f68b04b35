/* What the engine's vector code works on: a block of walkers side by side, one column per quantity.
 *
 * In units of each walker: hip mass M, leg length l, time sqrt(l/g). Private to sim_host/batch.
 */
#ifndef SIM_HOST_BATCH_BLOCK_H
#define SIM_HOST_BATCH_BLOCK_H

#include <stdint.h>

#define BATCH_BLOCK \
    128 /* walkers in a block: little is lost in half-filled vectors, and L1 holds it */
#define BATCH_MAX_ORDER 28     /* of the power series */
#define BATCH_MAX_STEP 1.5     /* longest step, in sqrt(l/g) */
#define BATCH_PHASE_LIMIT 60.0 /* longest phase, in sqrt(l/g), as model/stride_settings.c has it */
#define BATCH_MAX_STEPS 4000   /* of one phase; 60 units at the smallest step that occurs are 600 */
#define BATCH_DIRECTIONS 4     /* derivatives by the apex's three numbers and by r0 */

enum batch_column { COLUMN_TS, COLUMN_TN, COLUMN_WS, COLUMN_WN, COLUMN_COUNT };

struct block {
    double mass_ratio[BATCH_BLOCK];          /* m / M */
    double stiffness[BATCH_BLOCK];           /* k l / (M g) */
    double push[BATCH_BLOCK];                /* r0 / l */
    double slope_rad[BATCH_BLOCK];           /* of the ground */
    double rise[BATCH_BLOCK];                /* height_rise cos(slope): across the slope, l */
    double state[COLUMN_COUNT][BATCH_BLOCK]; /* angles, rates; in: apex, out: next apex */
    double slope[BATCH_DIRECTIONS][COLUMN_COUNT][BATCH_BLOCK]; /* d state / d direction */
    double time[3][BATCH_BLOCK];    /* apex to strike, double support, lift-off to apex */
    double step[BATCH_BLOCK];       /* toe to toe, l */
    double opening[BATCH_BLOCK];    /* angle between the legs at the strike */
    double ankle_rate[BATCH_BLOCK]; /* after collision and clamp */
    int64_t series[BATCH_BLOCK];    /* power series expanded on the way */
    int64_t clamped[BATCH_BLOCK];
    int64_t fault[BATCH_BLOCK]; /* enum stride_fault */
    int count;
};

/* How exactly to compute. */
struct block_precision {
    int order;             /* of the power series, 4..BATCH_MAX_ORDER */
    double log2_tolerance; /* of a step's last term */
    int want_times; /* the double support's duration too, a quadrature the map itself does not need */
    int want_slopes; /* the derivatives */
    int from_strike; /* strides begin and end just before heel strike */
    int has_ground;  /* some walker of the block walks on ground that is not level */
};

/* One stride of a block's walkers. Bounded; no state kept. */
typedef void block_stride_fn(struct block *block, const struct block_precision *precision);

/* Multiplies and adds in registers, rounds * BATCH_PEAK_OPERATIONS of them per lane: the processor's peak without fused
 * operations. Returns a sum, that nothing may be left out. */
typedef double block_peak_fn(long rounds);
#define BATCH_PEAK_OPERATIONS 14

block_stride_fn batch_stride_lanes2;
block_peak_fn batch_peak_lanes2;
#ifdef __x86_64__
block_stride_fn batch_stride_lanes4, batch_stride_lanes8;
block_peak_fn batch_peak_lanes4, batch_peak_lanes8;
#endif

#endif
