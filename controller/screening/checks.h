/* Plausibility of what the sensors and drives say, against each other and against
 * what a body and a spring can do.
 *
 * Three kinds:
 *   - a sample that no motion explains (a jump) is not used: it ages as if it were
 *     lost, and a lasting one is a fault, so one corrupted frame ends nothing;
 *   - a value that lasts where the others say it cannot (stuck, spring, following
 *     error, drive state) is a fault after a count of ticks;
 *   - a value that is wrong at once (range, not finite, fall, emergency stop) is a
 *     fault at once.
 * What a limit follows from stands beside it in checks.c.
 */
#ifndef CONTROLLER_SCREENING_CHECKS_H
#define CONTROLLER_SCREENING_CHECKS_H

#include "controller/control_params.h"
#include "controller/signals.h"
#include "controller/supervisor/supervisor.h"

#define checks_init REAL_SYMBOL(checks_init)
#define checks_screen REAL_SYMBOL(checks_screen)
#define checks_find REAL_SYMBOL(checks_find)
#define checks_standstill REAL_SYMBOL(checks_standstill)
#define checks_springs_slack REAL_SYMBOL(checks_springs_slack)

/* What is remembered of one leg. */
struct leg_checks {
    real angle_rad; /* newest believed sample */
    real rate_rad;  /* its change per tick */
    real extension_m;
    real motor_m;
    real motor_before_m;           /* the tick before */
    uint16_t angle_rejected_ticks; /* ticks without a believed sample */
    uint16_t extension_rejected_ticks;
    uint16_t motor_rejected_ticks;
    uint16_t still_ticks; /* the angle has had one and the same value for so long, */
    real other_angle_rad; /* and the other leg was here when that began */
    uint16_t motor_still_ticks;
    uint8_t force_contradiction_count; /* force samples in a row that the spring does not explain */
    uint16_t latch_ticks;              /* since the latch last changed */
    enum latch_state latch;
    real motor_at_release_m;
    uint16_t ankle_contradiction_count;  /* ticks in a row in which ankle and latch contradict */
    uint16_t follow_contradiction_count; /* ticks in a row beyond the following error */
    uint16_t off_contradiction_count;    /* ... beyond what may last for a moment only */
    real command_m[4];                   /* the last commands, newest first */
    real standstill_ref_rad;             /* standstill: the angle has stayed near this */
};

struct checks {
    struct leg_checks leg[SIDE_COUNT];
    uint16_t standstill_ticks;
    uint16_t state_contradiction_count; /* ticks in which a drive is not where it was sent */
    bool was_enabled;                   /* both drives have followed since enabling */
};

/* What the checks need to know of the rest of the controller. */
struct checks_context {
    enum supervisor_state state;
    const struct sea_request *command; /* SIDE_COUNT: of the last tick */
};

/* Nothing remembered: any first sample is believed. */
void checks_init(struct checks *checks);

/* First in a tick: replaces samples that are lost, not finite or beyond belief by the
 * held value (the leg angle goes on at its last rate). Their ages stay as received; how long
 * one has not been believed is counted in *checks. Constant cost. */
void checks_screen(struct checks *checks, const struct control_params *params,
                   struct controller_input *input);

/* The first thing that is wrong now, most serious first. raw: as received; input: after
 * checks_screen. Constant cost. */
enum supervisor_fault checks_find(struct checks *checks, const struct control_params *params,
                                  const struct controller_input *raw,
                                  const struct controller_input *input,
                                  const struct checks_context *context);

/* Both legs have kept their angles for half a second. */
bool checks_standstill(const struct checks *checks);

/* Both motors freshly known to be at zero spring. */
bool checks_springs_slack(const struct control_params *params,
                          const struct controller_input *input);

#endif
