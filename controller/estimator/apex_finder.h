/* From the legs' angles to the apex: when the stance leg passes the vertical, and the walker's
 * state there.
 *
 * The apex is the same for every body: the stance leg's angle falls through 0. Its state comes
 * from two sides. The model observer knows the whole stance. Least-squares cubics through the
 * samples within a window of the crossing know nothing of the walker. apex_fusion.h decides
 * between them.
 *
 * The apex is reported a window (apex_window_s) and some ticks after it happened. The law has
 * hundreds of milliseconds (on a person about 170) until the spring must be ready, and samples
 * from both sides smooth without lag. The ticks after the window spread the work: one fit or one
 * step back in time each.
 */
#ifndef CONTROLLER_ESTIMATOR_APEX_FINDER_H
#define CONTROLLER_ESTIMATOR_APEX_FINDER_H

#include "controller/control_params.h"
#include "controller/estimator/angle_history.h"
#include "controller/estimator/apex_fit.h"
#include "controller/estimator/apex_fusion.h"
#include "controller/estimator/model_observer.h"
#include "controller/signals.h"

#define apex_finder_init REAL_SYMBOL(apex_finder_init)
#define apex_finder_watch REAL_SYMBOL(apex_finder_watch)
#define apex_finder_begin REAL_SYMBOL(apex_finder_begin)
#define apex_finder_work REAL_SYMBOL(apex_finder_work)

/* An apex whose window is full, on its way to the report. */
struct apex_work {
    bool busy;
    uint32_t stage;
    enum side side;
    uint32_t centre_tick; /* first sample at or below zero */
    struct apex_fit fit;
    struct angle_fit swing_fit;
    bool modelled;                     /* the model observer was in this stance's single support */
    real state[SINGLE_SUPPORT_STATES]; /* its state on the way back to the apex */
    real back_step_s;
    real model_before_s; /* its apex lies this long before the centre tick */
};

struct apex_finder {
    uint32_t window_ticks; /* half width of the apex fit */
    uint32_t apex_tick[SIDE_COUNT];
    bool apex_pending[SIDE_COUNT];                /* crossed, the fit's second half still to come */
    struct apex_sums fit[SIDE_COUNT][SIDE_COUNT]; /* of both legs around an apex of [side] */
    bool foot_ahead[SIDE_COUNT];                  /* was ahead since the last falling crossing */
    struct apex_fusion fusion;
    struct apex_work work;
};

/* Starts with no crossing. *params must be valid. */
void apex_finder_init(struct apex_finder *finder, const struct control_params *params);

enum apex_sign {
    APEX_NONE = 0,
    APEX_CROSSED = 1,  /* the leg's angle has fallen through 0 */
    APEX_COLLECTED = 2 /* the window around the last crossing is full */
};

/* One tick, of both legs: sign[side]. A leg must have been more than ahead_rad ahead for its fall
 * through 0 to count. samples: how many ticks the history holds; with less than a window of them
 * before, a crossing makes no apex. Constant cost. */
void apex_finder_watch(struct apex_finder *finder, const struct angle_history *history,
                       uint32_t samples, real ahead_rad, uint32_t tick,
                       enum apex_sign sign[SIDE_COUNT]);

/* Begins the work on that crossing: the fit, and the model's way back. */
void apex_finder_begin(struct apex_finder *finder, const struct model_observer *model,
                       enum side side, uint32_t tick);

/* Once a tick: the next piece of that work. True in the tick in which gait->apex and the GAIT_APEX
 * event were written. Cost: one fit, or one step of the model. */
bool apex_finder_work(struct apex_finder *finder, const struct control_params *params,
                      const struct model_observer *model, struct gait_state *gait, uint32_t tick);

#endif
