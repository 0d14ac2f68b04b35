/* Computes what the laws beyond eq. (16) must know of a walker (controller/laws/gait_branch.h), from the model.
 *
 * The gaits are those of the long-period branch at equally spaced speeds (Newton on the map at given speed, with
 * the map's derivative). Each has two gains. One comes from the Riccati equation of the map linearised there,
 * iterated until it does not change. The other puts all eigenvalues at zero (Ackermann's formula). Weights are
 * given for the paper's walker and scaled: times with sqrt(l/g), r0 with the length at which the spring stores
 * the same share of M g l.
 *
 * Computed in double whatever the caller is compiled for; plain doubles. The same bits everywhere.
 */
#ifndef SIM_HOST_GAIT_LAWS_TABLE_H
#define SIM_HOST_GAIT_LAWS_TABLE_H

#include "sim_host/gait/gait_curve.h"

enum { LAWS_TABLE_POINTS = 40 };

struct laws_weights {
    double speed, swing_angle, swing_rate; /* of squared departures, paper's units */
    double r0;                             /* per m^2 */
    double travel;                         /* per rad/s along the branch */
};

struct laws_point {
    double speed_rad_s, r0_m, swing_angle_rad, swing_rate_rad_s;
    double map[3][3], input[3]; /* derivative of the next apex by this one, and by r0 */
    double cost[6];             /* 11, 22, 33, 12+21, 13+31, 23+32 */
    double lqr_gain[3], deadbeat_gain[3];
};

struct laws_table {
    int count;
    double speed_min_rad_s, speed_step_rad_s, r0_weight, travel_weight;
    struct laws_point point[LAWS_TABLE_POINTS];
};

enum laws_table_error {
    LAWS_TABLE_OK = 0,
    LAWS_TABLE_NO_CURVE = -1, /* gait_curve() does not reach this walker's range */
    LAWS_TABLE_LOST = -2,     /* Newton lost the gait between two speeds */
    /* The gaits and their derivatives are there, costs and gains are not. */
    LAWS_TABLE_NO_RICCATI = -3, /* the iteration did not come to rest */
    LAWS_TABLE_UNCONTROLLABLE = -4
};

struct laws_weights laws_weights_default(void);

/* Fills the table for a walker whose r0 scales by length_scale (1 for the paper's walker). The speeds are those of
 * the gaits from r0 = 0.005 to 0.262 times it, where the clamp of the collision begins. delay_s: the latch opens so
 * long after heel strike (late_gait.h). About 0.1 s; 1 s with a delay. */
enum laws_table_error laws_table_make(const struct gait_walker *walker, double length_scale,
                                      double delay_s, const struct laws_weights *weights,
                                      struct laws_table *table);

/* The gain of eq. (16) for this walker. It is `wanted` when no gait of the table from r0_low_m on has an
 * eigenvalue beyond LAWS_TABLE_CALM with it. Else it is the gain whose largest eigenvalue is smallest. *largest
 * receives that eigenvalue. unit: the gain's scale, 1 for the paper's walker. */
#define LAWS_TABLE_CALM 0.9
double laws_table_gain(const struct laws_table *table, double r0_low_m, double wanted, double unit,
                       double *largest);

/* The gains of eq. (16) around `gain` with which no gait of the table from r0_low_m on has an eigenvalue of
 * LAWS_TABLE_BORNE or more: *low to *high, found in steps of 0.0005 `unit`. Both are `gain` where it has one itself. */
#define LAWS_TABLE_BORNE 0.95
void laws_table_gain_range(const struct laws_table *table, double r0_low_m, double gain,
                           double unit, double *low, double *high);

/* In words; a static string, never NULL. */
const char *laws_table_error_name(enum laws_table_error error);

#endif
