/* The motions of commissioning: one leg's spring is loaded a little, slowly, and unloaded again, so
 * that a tool can see what the drive, its sensors and its latch do.
 *
 * The tool only asks (struct motion_request). How far, how fast, and whether at all is decided here:
 *
 *   - A request must be renewed within MOTION_RENEWAL_TICKS. A tool that is lost ends in UNLOADING. After
 *     a fault it takes a new request.
 *   - Loads are shares of the largest one, spring_stiffness_n_m times r0_max_m. Up to 5 % is allowed
 *     until both legs have moved so; then up to 20 % until both have moved beyond 10 %; then all. A
 *     fault begins anew at 5 %, but not the one that a cut of the link makes by intent.
 *   - Beyond the force of the stage, or with the motor far from its reference, a motion returns to zero.
 *
 *   WAITS --both drives enabled, at zero--> LOADS --reference there--> HOLDS --time--> RETURNS --at zero--> IDLE
 *
 * The reference is half a cosine each way, so that it begins and ends at rest.
 */
#ifndef CONTROLLER_COMMISSIONING_MOTION_H
#define CONTROLLER_COMMISSIONING_MOTION_H

#include "controller/control_params.h"
#include "controller/signals.h"

#define motion_init REAL_SYMBOL(motion_init)
#define motion_watch REAL_SYMBOL(motion_watch)
#define motion_enter REAL_SYMBOL(motion_enter)
#define motion_forget REAL_SYMBOL(motion_forget)
#define motion_update REAL_SYMBOL(motion_update)
#define motion_share_allowed REAL_SYMBOL(motion_share_allowed)

enum { MOTION_RENEWAL_TICKS = TICKS_OF_MS(500) };
/* A cut of the link lasts at most so long; then the controller unloads by its own targets. */
enum { MOTION_CUT_TICKS = TICKS_OF_MS(500) };

/* The values appear on the bus. */
enum motion_phase {
    MOTION_IDLE = 0,
    MOTION_WAITS = 1, /* for both drives to be enabled */
    MOTION_LOADS = 2,
    MOTION_HOLDS = 3, /* also: oscillates, is armed, is cut off */
    MOTION_RETURNS = 4
};

/* How the last motion ended; the values appear on the bus. */
enum motion_outcome {
    MOTION_NONE_YET = 0,
    MOTION_DONE = 1,
    MOTION_REFUSED = 2, /* not begun: a larger load than the stage allows, or no such motion */
    MOTION_BEYOND = 3,  /* more force than the stage allows, or the motor beyond its reference */
    MOTION_NOT_REACHED = 4, /* the motor did not come to where it was sent */
    MOTION_INTERRUPTED = 5  /* a fault, a stop, or the tool was lost */
};

/* The motor's force as the drive told it, with the motor's position at that SYNC. */
struct motion_sample {
    real force_N;
    real position_m;
    uint8_t number; /* of samples so far, modulo 256 */
};

struct motion {
    uint8_t renewal;        /* the last one seen */
    uint16_t renewal_ticks; /* since it changed; saturates */
    uint8_t order;          /* of the motion under way, or the last one */
    enum motion_kind kind;
    enum side side;
    enum motion_phase phase;
    enum motion_outcome outcome; /* of `order`; it may still change until the phase is IDLE */
    uint32_t phase_ticks;        /* since the phase began */
    uint32_t hold_ticks;
    real size_m; /* the reference's largest value */
    real from_m; /* where RETURNS begins */
    real reference_m[SIDE_COUNT];
    uint8_t heavy_samples;      /* forces in a row beyond what the stage allows */
    bool spent;                 /* a fault ended the request: it takes MOTION_KIND_NONE first */
    bool armed;                 /* the latch of `side` may be opened by the node */
    bool cut;                   /* nothing may be sent to the drives */
    uint8_t proven[SIDE_COUNT]; /* 1: moved within 5 %, 2: beyond 10 % of the largest load */
    struct motion_sample sample[SIDE_COUNT];
    /* Oscillation: phase of the cycle, what the motor did in it, and what was found. */
    real cycle_rad, frequency_Hz, last_frequency_Hz, least_m, greatest_m;
    uint16_t cycles;
    real bandwidth_Hz;      /* the first cycle with less than 0.707 of the reference; 0 = none */
    uint16_t release_ticks; /* from arming to the latch's opening; UINT16_MAX = it did not */
    uint16_t unload_ticks;  /* from the cut to an unloaded spring; UINT16_MAX = it did not */
};

/* Nothing asked for, nothing proven. */
void motion_init(struct motion *motion);

/* Once a tick, in every state: is a motion asked for, and by a tool that is still there? Also keeps the
 * newest force samples. O(1). */
bool motion_watch(struct motion *motion, const struct controller_input *input);

/* COMMISSIONING begins: both references where the motors are, and from there slowly to zero. */
void motion_enter(struct motion *motion, const struct control_params *params,
                  const struct controller_input *input);

/* COMMISSIONING has ended: a motion under way is interrupted. by_fault: loads begin small again. */
void motion_forget(struct motion *motion, bool by_fault);

/* Once a tick in COMMISSIONING: begins, goes on with or ends the motion that input->motion asks for.
 * reference_m, armed and cut are the tick's command. Every reference lies in 0..r0_max_m. O(1). */
void motion_update(struct motion *motion, const struct control_params *params,
                   const struct controller_input *input);

/* The largest share of the largest load that a motion may have now: 0.05, 0.2 or 1. */
real motion_share_allowed(const struct motion *motion);

#endif
