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

struct support_params {
    uint64_t release_tick;       /* earliest tick to let go at; default 1000 */
    uint32_t release_grid_ticks; /* >= 1; default 100 */
    uint32_t settle_ticks;       /* loaded and still for so long; default 20 */
    double position_tolerance_m; /* |motor - target| counts as loaded; default 0.0005 l */
    double least_load_m;         /* a target below this is not a load; default 0.001 l */
    bool hold_after_fall;        /* default false: a fall is the end */
    uint32_t fall_ticks;         /* lies so long before the hand lifts it; default 500 */
};

struct support {
    struct support_params params;
    bool holding;
    uint32_t settled_ticks;
    uint64_t grid_origin_tick;
    uint64_t fallen_since_tick;
    bool fallen;
};

/* What the hand looks at, once per SYNC. */
struct support_view {
    bool drives_enabled;      /* both in position mode */
    double stance_position_m; /* reported */
    double stance_target_m;
    double stance_speed_m_s;
    bool fault; /* the walker has fallen or is otherwise lost */
};

enum support_action { SUPPORT_NONE = 0, SUPPORT_LET_GO = 1, SUPPORT_TAKE_HOLD = 2 };

void support_params_default(double leg_length_m, struct support_params *params);
const char *support_params_check(const struct support_params *params);
/* Begins holding. */
void support_init(struct support *support, const struct support_params *params);
/* One SYNC. LET_GO and TAKE_HOLD are told once each. */
enum support_action support_tick(struct support *support, uint64_t tick,
                                 const struct support_view *view);

#endif
