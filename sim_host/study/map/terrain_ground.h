/* What the best of all laws can do on uneven ground: dynamic programming on the return map.
 *
 * A law knows the apex and chooses the push-off. Then the height of the next foothold is drawn against the one
 * before, evenly from equally likely rises (Byl, Tedrake 2009: Metastable walking machines). The most steps that
 * can be expected from an apex x are found by iteration on a grid:
 *
 *     V(x) = 1 + max over r0 of mean over rises of V(next(x, r0, rise)),    0 when the stride ends in a fault.
 *
 * The heel strike parts the stride in two. Apex and rise make an angle between the legs and a rate of the ankle.
 * These, the rise and r0 make the next apex. So two tables of three and four dimensions replace one of five.
 * Values between nodes are interpolated (MIDDLE), or are those of the best corner of the cell (OUTER). MIDDLE is an
 * estimate; the law made from it can be walked, which gives a bound from below. OUTER is a bound from above, as far as
 * a corner is better than all of its cell.
 *
 * Without a limit on speed the best law changes to the speed that bears the ground best, and then need not
 * fall at all. Two other questions have finite answers. The chance to be still up after n steps: V_0 = 1,
 * V_n = max mean V_(n-1). And the most steps among laws whose mean speed stays below a limit. For every price p >= 0
 *
 *     V_p(x) = 1 + max mean [ V_p(next) - p (v_next / limit - 1) ]
 *
 * is at least that (weak duality of Lagrange). The least over p is the bound.
 *
 * Plain doubles, SI units. The same bits for any number of threads.
 */
#ifndef SIM_HOST_STUDY_MAP_TERRAIN_GROUND_H
#define SIM_HOST_STUDY_MAP_TERRAIN_GROUND_H

#include <stdbool.h>

#include "sim_host/gait/gait_curve.h"

enum { TERRAIN_PUSHES_MAX = 256, TERRAIN_PUSHES_BLOCK = 8, TERRAIN_RISES_MAX = 64 };

/* An axis of a grid: nodes from low to high, closer together near low by the power of their number. */
struct terrain_axis {
    double low, high, power; /* value = low + (high - low) (i / (count - 1))^power */
    int count;               /* at least 2 */
};

struct terrain_range {
    struct terrain_axis speed, angle, swing; /* forward rad/s, rad, rad/s: of the apex */
    struct terrain_axis legs,
        ankle; /* after the strike: rad, and ankle rate over (that times sqrt(g l)) */
    struct terrain_axis push; /* r0, m; a whole number of blocks of nodes */
    int rises;                /* equally likely, at the middles of as many parts of the range */
    double rise_most;         /* the range is +- this, leg lengths */
};

/* Positions on the grids, in cells from its first node; what lies beyond is put on its edge. */
struct terrain_strike {
    float legs, ankle; /* legs NEGATIVE: no heel strike */
};
struct terrain_apex {
    float speed, angle, swing; /* speed NEGATIVE: the stride ends in a fault */
};

struct terrain_table {
    struct gait_walker walker;
    struct terrain_range range;
    struct terrain_strike *
        strike; /* [(apex node) * rises + rise]; node = (speed * angles + angle) * swings + swing */
    struct terrain_apex *apex; /* [((rise * legs + leg) * ankles + ankle) * pushes + push] */
};

enum terrain_side { TERRAIN_MIDDLE, TERRAIN_OUTER };

enum terrain_question {
    TERRAIN_STEPS, /* most steps to be expected, at a price on speed */
    TERRAIN_CHANCE /* greatest chance to be still up after so many rounds */
};

struct terrain_goal {
    enum terrain_question question;
    double price;       /* 0: any speed will do; of TERRAIN_STEPS alone */
    double limit_rad_s; /* above 0: of the mean forward apex speed */
};

/* The value of being at a node, and of having pushed off there: what terrain_solve() makes. */
struct terrain_value {
    enum terrain_side side;
    struct terrain_goal goal;
    float *apex; /* by apex node */
    float *push; /* as the table's apex */
    int rounds;
    bool
        settled; /* steps: what all rounds to come would change at the start is below a thousandth, by the ratio of the
                     last changes; chance: the last round changed none by 1e-5 */
};

/* Computes the tables on `threads` cores: about 8 us an entry that can be reached at all. Returns 0, or -1 without
 * memory or with a range out of bounds. Release with terrain_free(). */
int terrain_make(struct terrain_table *table, const struct gait_walker *walker,
                 const struct terrain_range *range, int threads);
void terrain_free(struct terrain_table *table);

/* Iterates until the value at `start` (stance rate, swing angle, swing rate) is settled, at most rounds_max rounds.
 * Steps begin at 0 and are extrapolated where changes shrink by a steady ratio. Values of a chance fall from
 * round to round; each is a bound of all that follow. Returns 0, or -1 without memory.
 * Release with terrain_value_free(). */
int terrain_solve(const struct terrain_table *table, enum terrain_side side,
                  const struct terrain_goal *goal, const double start[3], int rounds_max,
                  int threads, struct terrain_value *value);
void terrain_value_free(struct terrain_value *value);

/* The law made from a value: the push-off within low_m..high_m with the greatest value from an apex. The apex's
 * strikes are computed, not read from the grid. *worth receives the value. */
double terrain_law(const struct terrain_table *table, const struct terrain_value *value,
                   const double apex[3], double low_m, double high_m, double *worth);

#endif
