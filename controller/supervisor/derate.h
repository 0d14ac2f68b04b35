/* What the drives can still bear: a share, 0 to 1, of the prescribed precompression.
 *
 * Each leg's drive is judged by the limits of its data sheet. Between the temperature from which it is
 * spared and the one at which it stops, the share falls evenly from 1 to 0; so it does over the last
 * DERATE_SUPPLY_MARGIN before a limit of its supply. A maker's warning that lasts halves the push. A
 * value that is no number, and one that stays away, count as beyond the limit.
 *
 * Both legs get the share of the one that bears less: nobody limps. The share moves slowly, and upwards
 * only when there is something to gain, so that one reading changes no push. Beyond a limit for
 * DERATE_WITHDRAW_S the assistance is withdrawn: the springs are unloaded, and the drives rest until every
 * reading is back where nothing is spared. That is no fault; a new walk takes a new request.
 */
#ifndef CONTROLLER_SUPERVISOR_DERATE_H
#define CONTROLLER_SUPERVISOR_DERATE_H

#include <stdbool.h>
#include <stdint.h>

#include "model/real.h"
#include "model/side.h"

#define derate_init REAL_SYMBOL(derate_init)
#define derate_update REAL_SYMBOL(derate_update)
#define derate_cause_name REAL_SYMBOL(derate_cause_name)

/* Of the limit: from here to the limit the share falls from 1 to 0. */
#define DERATE_SUPPLY_MARGIN REAL(0.05)
#define DERATE_WARNING_S REAL(5.0) /* a warning that lasts so long */
#define DERATE_WARNING_SHARE REAL(0.5)
#define DERATE_WITHDRAW_S REAL(2.0)
#define DERATE_SILENT_S REAL(0.5) /* what is not told for so long counts as beyond its limit */
/* The share's way: down and up, per second; and how much more must be possible before it rises. */
#define DERATE_FALL_1_S REAL(0.2)
#define DERATE_RISE_1_S REAL(0.05)
#define DERATE_HYSTERESIS REAL(0.1)
/* A time between two updates counts as no longer than this. */
#define DERATE_PERIOD_MAX_S REAL(1.0)

/* Why a leg bears less. The values appear on the bus and in reports. */
enum derate_cause {
    DERATE_NONE = 0,
    DERATE_TEMPERATURE = 1,
    DERATE_SUPPLY_LOW = 2,
    DERATE_SUPPLY_HIGH = 3,
    DERATE_WARNING = 4, /* of the drive's maker */
    DERATE_SILENT = 5,  /* there is a limit, and the drive no longer tells */
    DERATE_CAUSES = 6
};

/* One drive's limits; 0 = not told. A temperature to stop at has one to warn at below it, and the
 * supply's two limits lie further apart than their margins (device_check.h). */
struct derate_limits {
    real temperature_warn_degC, temperature_stop_degC;
    real supply_min_V, supply_max_V;
};

/* What one drive tells of itself. Any value, NaN included. */
struct derate_reading {
    bool heard; /* the drive itself is: else nothing is concluded */
    bool has_temperature, has_supply;
    bool warning;
    real temperature_degC, supply_V;
};

struct derate_leg {
    real share;    /* what it bears, by the last reading */
    real beyond_s; /* it has been beyond a limit for so long */
    real warned_s; /* it has warned for so long */
    real silent_s; /* it has not told what has a limit for so long */
    uint8_t cause; /* enum derate_cause */
};

struct derate {
    struct derate_leg leg[SIDE_COUNT];
    real share;       /* of the prescription, both legs': 0..1 */
    real least_share; /* since the start */
    uint32_t tick;    /* of the last update */
    bool begun;
    bool rising;
    bool withdrawn;         /* no assistance now */
    uint8_t withdrew_cause; /* enum derate_cause of the last time it was withdrawn; 0 = never */
    uint8_t withdrew_leg;   /* enum side */
};

/* Everything can be borne. */
void derate_init(struct derate *derate);

/* Judges both drives; limit and reading: SIDE_COUNT. Called now and then, at least once in
 * DERATE_PERIOD_MAX_S, with the tick of the call. Returns true when something of it is new that is told:
 * a leg's cause, or that the assistance is withdrawn or may be given again. Pure but for *derate; O(1). */
bool derate_update(struct derate *derate, const struct derate_limits *limit,
                   const struct derate_reading *reading, uint32_t tick);

/* "temperature" and so on; a static string for any value. */
const char *derate_cause_name(enum derate_cause cause);

#endif
