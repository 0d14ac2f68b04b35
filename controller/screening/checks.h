/* The fault rules: what the sensors and drives say, against each other and against what a body
 * and a spring can do.
 *
 * Three kinds:
 *   - a sample that no motion explains is replaced (samples.h); one that lasts is a fault;
 *   - a value that lasts where the others say it cannot (stuck, spring, following error, drive
 *     state) is a fault after a count of ticks;
 *   - a value that is wrong at once (range, not finite, fall, emergency stop) is a fault at once.
 * checks.c says beside each limit what it follows from.
 */
#ifndef CONTROLLER_SCREENING_CHECKS_H
#define CONTROLLER_SCREENING_CHECKS_H

#include "controller/control_params.h"
#include "controller/screening/samples.h"
#include "controller/signals.h"
#include "controller/supervisor/supervisor.h"

#define checks_init REAL_SYMBOL(checks_init)
#define checks_update REAL_SYMBOL(checks_update)
#define checks_find REAL_SYMBOL(checks_find)
#define checks_standstill REAL_SYMBOL(checks_standstill)
#define checks_springs_slack REAL_SYMBOL(checks_springs_slack)
#define checks_upright REAL_SYMBOL(checks_upright)

/* What is remembered of one leg. */
struct leg_checks {
    uint16_t still_ticks; /* the angle has had one and the same value for so long, */
    real other_angle_rad; /* and the other leg was here when that began */
    real motor_before_m;  /* the tick before */
    uint16_t motor_still_ticks;
    uint8_t force_contradiction_count; /* force samples in a row that the spring does not explain */
    uint16_t latch_ticks;              /* since the latch last changed */
    uint16_t unarmed_ticks;            /* since the latch was last told that it may open */
    uint16_t unlatched_ticks; /* an empty spring's latch has been open for so long (a person's) */
    bool opened_unarmed;      /* the latch opened although it was not armed */
    enum latch_state latch;
    real motor_at_release_m;
    uint16_t ankle_contradiction_count;  /* ticks in a row in which ankle and latch contradict */
    uint16_t follow_contradiction_count; /* ticks in a row beyond the following error */
    uint16_t off_contradiction_count;    /* ticks in a row beyond what may last for a moment only */
    real command_m[4];                   /* the last commands, newest first */
    real standstill_ref_rad;             /* standstill: the angle has stayed near this */
};

struct checks {
    struct leg_checks leg[SIDE_COUNT];
    uint16_t standstill_ticks;
    uint16_t tilted_ticks; /* both legs of a person have leant to one side for so long, */
    uint16_t lifted_ticks; /* and no foot was on the ground */
    uint16_t state_contradiction_count; /* ticks in which a drive is not where it was sent */
    bool was_enabled;                   /* both drives have followed since enabling, */
    bool has_left;                      /* and one of them has left that state by itself */
};

/* What the rules look at in one tick. */
struct checks_view {
    const struct controller_input *input; /* after samples_screen */
    const struct samples *samples;        /* after samples_screen */
    enum supervisor_state state;
    const struct sea_request *command; /* SIDE_COUNT: of the last tick */
};

/* Nothing remembered. */
void checks_init(struct checks *checks);

/* Once a tick, after samples_screen: counts what contradicts. Constant cost. */
void checks_update(struct checks *checks, const struct control_params *params,
                   const struct checks_view *view);

/* The first thing that is wrong now, most serious first; SUPERVISOR_FAULT_NONE without. *view is
 * that of the last checks_update. Pure, constant cost. */
enum supervisor_fault checks_find(const struct checks *checks, const struct control_params *params,
                                  const struct checks_view *view);

/* Both legs have kept their angles for half a second. */
bool checks_standstill(const struct checks *checks);

/* A person is on their feet: legs and switches do not say that they sit, lie or hang. True of a compass. */
bool checks_upright(const struct checks *checks);

/* Both motors freshly known to be at zero spring. */
bool checks_springs_slack(const struct control_params *params,
                          const struct controller_input *input);

#endif
