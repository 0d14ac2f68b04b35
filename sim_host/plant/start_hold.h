/* Holds the walker in its start pose until it may walk, and again after a fall.
 *
 * The start pose is that just after lift-off of the start gait. The hold ends at a SYNC, with the
 * start gait's rates. Both drives must be in position mode, and the stance SEA must have stood
 * loaded at its target for settle_ticks. Only certain ticks count: release_tick, and every
 * release_grid_ticks after it. So runs over different buses can be compared.
 * Pure: no heap, no globals; O(1); plain data.
 */
#ifndef SIM_HOST_PLANT_START_HOLD_H
#define SIM_HOST_PLANT_START_HOLD_H

#include <stdbool.h>
#include <stdint.h>

struct start_hold_params {
    uint64_t release_tick;       /* earliest tick at which the hold ends; default 1000 */
    uint32_t release_grid_ticks; /* >= 1; default 100 */
    uint32_t settle_ticks;       /* loaded and still for so long; default 20 */
    double position_tolerance_m; /* |motor - target| counts as loaded; default 0.0005 l */
    double least_load_m;         /* a target below this is not a load; default 0.001 l */
    bool hold_after_fall;        /* default false: a fall is the end */
    uint32_t fall_ticks;         /* from the fall to the next hold; default 500 */
};

struct start_hold {
    struct start_hold_params params;
    bool holding;
    uint32_t settled_ticks;
    uint64_t grid_origin_tick;
    uint64_t fallen_since_tick;
    bool fallen;
};

/* What decides, once per SYNC. */
struct start_hold_view {
    bool drives_enabled;      /* both in position mode */
    double stance_position_m; /* reported */
    double stance_target_m;
    double stance_speed_m_s;
    bool fault; /* the walker has fallen or is otherwise lost */
};

enum start_hold_action { START_HOLD_NONE = 0, START_HOLD_LET_GO = 1, START_HOLD_TAKE_HOLD = 2 };

/* The defaults named above, for this leg. */
void start_hold_params_default(double leg_length_m, struct start_hold_params *params);
/* NULL if every field is in range, else the name of the first that is not. */
const char *start_hold_params_check(const struct start_hold_params *params);
/* Starts holding. */
void start_hold_init(struct start_hold *start_hold, const struct start_hold_params *params);
/* Call once per SYNC. Returns LET_GO and TAKE_HOLD once each, when they happen. */
enum start_hold_action start_hold_tick(struct start_hold *start_hold, uint64_t tick,
                                       const struct start_hold_view *view);

#endif
