/* Are these verified, steady steps? Engaging waits for them, and irregular ones end a walk.
 *
 * A step goes from apex to apex. It is steady when the sides alternate, the other foot landed in
 * it exactly once, and it lasted as long as the two steps before it, within a third. Recorded
 * people vary by 2 to 4 %, and limp by 10 to 20 %. Two legs that disagree are not steady either.
 * Nor is a step that is not shown to be forward walking (walk_proof.h). What contradicts forward
 * walking ends the assistance at once.
 */
#ifndef CONTROLLER_SUPERVISOR_STEP_MONITOR_H
#define CONTROLLER_SUPERVISOR_STEP_MONITOR_H

#include "controller/signals.h"

#define step_monitor_init REAL_SYMBOL(step_monitor_init)
#define step_monitor_update REAL_SYMBOL(step_monitor_update)

enum { STEP_MONITOR_IRREGULAR = 2 }; /* unsteady steps in a row that end the assistance */

struct step_monitor {
    uint32_t apex_tick;     /* of the newest apex, as it happened */
    uint32_t known_tick;    /* when it became known */
    uint32_t step_ticks[2]; /* the newest steps, newest first; 0 = none */
    uint32_t steady;        /* steady steps in a row, saturating */
    uint32_t unsteady;      /* unsteady ones in a row, saturating */
    enum side side;         /* of the newest apex */
    uint8_t strikes;        /* heel strikes of the other foot since it */
    bool seen;              /* there has been an apex */
    bool same_side;         /* the newest apex was the same leg's as the one before */
};

/* No step seen. */
void step_monitor_init(struct step_monitor *monitor);

/* Once a tick, with the observer's events of this tick. Returns true in the tick in which
 * a step ends (an apex). Constant cost. */
bool step_monitor_update(struct step_monitor *monitor, const struct gait_state *gait,
                         uint32_t tick);

#endif
