/* The whole controller: measurements of one tick in, SEA commands out.
 *
 * controller_update() calls one function a stage, in this order:
 *
 *   sense      screening/zeroing     takes the sensors' offsets off, finds new ones at standstill
 *   screen     screening/            replaces lost and impossible samples, counts contradictions
 *   supervise  supervisor/           may it move? It judges by the gait as of the tick before:
 *                                    the observer runs behind it
 *   estimate   estimator/            the gait's phase and events, the apex state; steady steps?
 *   decide     laws/                 the step's precompression
 *   actuate    actuation/springs     references of both motors, latches
 *              commissioning/motion  the same for the motions that a tool asks for
 *   guard      actuation/command_guard   the last gate
 *
 * Pure: all state is in struct controller, time is the tick number of the input.
 * The same object code runs on the orthosis, on the emulated target, on a laptop
 * against the simulated walker, and on a replayed log.
 */
#ifndef CONTROLLER_CONTROLLER_H
#define CONTROLLER_CONTROLLER_H

#include "controller/actuation/command_guard.h"
#include "controller/actuation/springs.h"
#include "controller/commissioning/motion.h"
#include "controller/control_params.h"
#include "controller/estimator/gait_observer.h"
#include "controller/laws/step_plan.h"
#include "controller/screening/checks.h"
#include "controller/screening/samples.h"
#include "controller/screening/zeroing.h"
#include "controller/signals.h"
#include "controller/supervisor/derate.h"
#include "controller/supervisor/step_monitor.h"
#include "controller/supervisor/supervisor.h"
#include "controller/supervisor/wearer.h"

#define controller_init REAL_SYMBOL(controller_init)
#define controller_update REAL_SYMBOL(controller_update)
#define controller_bear REAL_SYMBOL(controller_bear)
#define controller_cue REAL_SYMBOL(controller_cue)

struct controller {
    const struct control_params *params; /* the caller's; constant while walking */
    struct gait_observer observer;
    struct step_plan plan;
    struct springs springs;
    struct command_guard guard;
    struct supervisor supervisor;
    struct step_record last_step; /* the last one decided */
    struct samples samples;
    struct checks checks;
    struct step_monitor step_monitor;
    struct zeroing zeroing;
    struct wearer wearer;
    struct motion motion;
    struct derate derate;
    bool
        request_spent; /* it has ended by a fault, a withdrawal, or in test mode: it takes a new one */
    bool observing;    /* the observer has been started */
};

struct controller_output {
    struct sea_request sea[SIDE_COUNT];
    enum supervisor_state state;
    enum supervisor_fault fault; /* latched */
    bool new_step;               /* last_step was written in this tick */
    enum zeroing_state zeroing;
    bool cut_off;  /* nothing may be sent to the drives, nor a heartbeat: commissioning/motion.h */
    bool new_zero; /* controller->zeroing.mean was found in this tick: the caller is to put
                      it into the parameters */
};

/* Prepares a controller that waits in SUPERVISOR_INIT. *params stays the
 * caller's and must outlive the controller. Returns CONTROL_PARAMS_OK or what
 * control_params_validate says; then the controller must not be used. */
int controller_init(struct controller *controller, const struct control_params *params);

/* One tick, called once per SYNC in order of ticks. Every command field is
 * finite and within its limits whatever the input holds. Cost: see the budget
 * test; the worst tick is that of an apex fit. Loop only, not ISR. */
void controller_update(struct controller *controller, const struct controller_input *input,
                       struct controller_output *output);

/* What the drives tell of temperature, supply and warnings, now and then (derate.h); limit and reading:
 * SIDE_COUNT. It acts from the next controller_update on. Returns what derate_update() returns. Loop
 * only; O(1), in a tick that has little else to do. */
bool controller_bear(struct controller *controller, const struct derate_limits *limit,
                     const struct derate_reading *reading, uint32_t tick);

/* What the wearer is told now. Pure; O(1). */
enum wearer_cue controller_cue(const struct controller *controller);

#endif
