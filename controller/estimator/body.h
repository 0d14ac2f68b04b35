/* What the rows of body_table.h work on: the tick they look at, and what they remember. */
#ifndef CONTROLLER_ESTIMATOR_BODY_H
#define CONTROLLER_ESTIMATOR_BODY_H

#include "controller/control_params.h"
#include "controller/estimator/angle_history.h"
#include "controller/estimator/arm_window.h"
#include "controller/estimator/compass_events.h"
#include "controller/estimator/model_observer.h"
#include "controller/estimator/person_events.h"
#include "controller/estimator/placement.h"
#include "controller/estimator/stride_clock.h"
#include "controller/estimator/walk_proof.h"
#include "controller/estimator/walking_speed.h"
#include "controller/signals.h"

/* What a body's rules remember; all zeros to begin with. */
struct body_state {
    struct compass_events compass;
    struct person_events leg[SIDE_COUNT];
    struct walk_proof proof;
    struct placement placement;
    struct arm_window window[SIDE_COUNT]; /* by the foot that is to land */
};

/* One tick as a body's rules see it, and what they write. */
struct body_tick {
    const struct control_params *params;
    const struct controller_input *input;
    const struct angle_history *history; /* this tick's angles are in it */
    uint32_t samples;                    /* how many of them there are so far */
    const struct walking_speed *speed;
    struct gait_state *gait;      /* written: events and phase */
    struct stride_clock *clock;   /* written: strides */
    struct model_observer *model; /* written by the compass' rules: it follows their events */
};

#endif
