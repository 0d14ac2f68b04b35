/* finv of eq. (16): which precompression walks at which apex speed.
 *
 * The fixed-point curve r0 -> v of the long-period branch, sampled at equally
 * spaced r0 by a program from the model (build/afo study table), and its inverse.
 * Source: paper eq. (15); the curve is made by sim_host/gait/gait_curve.
 */
#ifndef CONTROLLER_LAWS_SPEED_TABLE_H
#define CONTROLLER_LAWS_SPEED_TABLE_H

#include <stdint.h>

#include "model/real.h"

#define speed_table_check REAL_SYMBOL(speed_table_check)
#define speed_table_inverse REAL_SYMBOL(speed_table_inverse)
#define speed_table_speed REAL_SYMBOL(speed_table_speed)

enum { SPEED_TABLE_MAX = 64 };

struct speed_table {
    uint32_t count;                    /* 4..SPEED_TABLE_MAX used entries; 32 bits: no padding */
    real r0_min_m;                     /* r0 of entry 0, > 0 */
    real r0_step_m;                    /* > 0 */
    real speed_rad_s[SPEED_TABLE_MAX]; /* forward apex speed, strictly rising */
};

enum speed_table_result {
    SPEED_TABLE_OK = 0,
    SPEED_TABLE_BAD_COUNT = -1,
    SPEED_TABLE_BAD_GRID = -2,  /* r0_min_m or r0_step_m not positive and finite */
    SPEED_TABLE_NOT_RISING = -3 /* an entry not finite, not positive or not above its neighbour */
};

/* Says whether *table may be used by the other functions. Call once, at
 * initialisation; at most SPEED_TABLE_MAX comparisons. */
enum speed_table_result speed_table_check(const struct speed_table *table);

/* The r0 in metres whose fixed point has forward apex speed speed_rad_s.
 * Beyond either end of the table: that end's r0. A cubic through the four
 * nearest entries, solved for r0 by a fixed number of Newton steps.
 * Cost: a binary search over 64 entries and 4 Newton steps. Pure. */
real speed_table_inverse(const struct speed_table *table, real speed_rad_s);

/* The fixed point's speed at r0_m (clamped to the table), same interpolation. */
real speed_table_speed(const struct speed_table *table, real r0_m);

#endif
