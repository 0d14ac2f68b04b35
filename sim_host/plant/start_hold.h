/* The hand that holds the walker until it may walk, and again after a fall.
 *
 * It holds the start pose (just after lift-off of the start gait). It lets go at a
 * SYNC, with the start gait's rates, when both drives are in position mode and
 * the stance SEA has stood loaded at its target for settle_ticks. So that runs
 * over different buses are comparable, only certain ticks count: release_tick,
 * and every release_grid_ticks after it.
 * Pure: no heap, no globals; O(1); plain data.
 */
#ifndef SIM_HOST_PLANT_START_HOLD_H
#define SIM_HOST_PLANT_START_HOLD_H

#include <stdbool.h>
#include <stdint.h>

struct start_hold_params {
    uint64_t release_tick;       /* earliest tick to let go at; default 1000 */
    uint32_t release_grid_ticks; /* >= 1; default 100 */
    uint32_t settle_ticks;       /* loaded and still for so long; default 20 */
    double position_tolerance_m; /* |motor - target| counts as loaded; default 0.0005 l */
    double least_load_m;         /* a target below this is not a load; default 0.001 l */
    bool hold_after_fall;        /* default false: a fall is the end */
    uint32_t fall_ticks;         /* lies so long before the hand lifts it; default 500 */
};

struct start_hold {
    struct start_hold_params params;
    bool holding;
    uint32_t settled_ticks;
    uint64_t grid_origin_tick;
    uint64_t fallen_since_tick;
    bool fallen;
};

/* What the hand looks at, once per SYNC. */
struct start_hold_view {
    bool drives_enabled;      /* both in position mode */
    double stance_position_m; /* reported */
    double stance_target_m;
    double stance_speed_m_s;
    bool fault; /* the walker has fallen or is otherwise lost */
};

enum start_hold_action { START_HOLD_NONE = 0, START_HOLD_LET_GO = 1, START_HOLD_TAKE_HOLD = 2 };

void start_hold_params_default(double leg_length_m, struct start_hold_params *params);
const char *start_hold_params_check(const struct start_hold_params *params);
/* Begins holding. */
void start_hold_init(struct start_hold *support, const struct start_hold_params *params);
/* One SYNC. LET_GO and TAKE_HOLD are told once each. */
enum start_hold_action start_hold_tick(struct start_hold *support, uint64_t tick,
                                       const struct start_hold_view *view);

#endif
