/* Heel strike and toe-off of a person's leg, from the pitch of both legs alone.
 *
 * A planted foot stays where it is while the hip goes on. So its leg, from hip to ankle, turns
 * backwards at about the walking speed over the leg's length. That rate, as measured at the
 * last apexes, is walking_speed here. No threshold is in absolute units: the rules scale with
 * person and speed.
 *   heel strike  The leg is ahead and comes from its swing. It has slowed down until it turns
 *                backwards at most of that rate: the foot is planted.
 *   toe-off      The leg is behind. It has stopped turning backwards and turns forwards (Zeni
 *                et al., Gait & Posture 27:710, 2008: the foot's rearmost point relative to
 *                the pelvis), and its ankle's push is over (ankle_push.h). The turn decides
 *                that there is an event. Its time is the mean of turn and end of push: people
 *                differ in both, but seldom in both alike. Without a push it is the turn's.
 * "Ahead" and "behind" compare one leg with the other, so an offset of both sensors does not
 * matter. Legs side by side, or legs that sway without a step, make no events. The rates are
 * slopes smoothed over +-16 ms: events are reported that much later.
 */
#ifndef CONTROLLER_ESTIMATOR_PERSON_EVENTS_H
#define CONTROLLER_ESTIMATOR_PERSON_EVENTS_H

#include <stdint.h>

#include "controller/estimator/angle_history.h"
#include "controller/estimator/ankle_push.h"
#include "controller/signals.h"

#define person_events_update REAL_SYMBOL(person_events_update)
#define person_events_rate REAL_SYMBOL(person_events_rate)

enum { LEG_RATE_HALF_WINDOW = TICKS_OF_MS(16) }; /* ticks */

enum leg_contact {
    LEG_UNKNOWN = 0, /* standing still, or just started */
    LEG_STANCE = 1,
    LEG_SWING = 2
};

enum leg_event_kind { LEG_EVENT_NONE = 0, LEG_EVENT_STRIKE = 1, LEG_EVENT_TOE_OFF = 2 };

struct leg_event {
    enum leg_event_kind kind;
    real age_s; /* the event lies this long before the tick of the call, >= 0 */
};

struct person_events { /* all zeros to begin with */
    enum leg_contact contact;
    real rate_before_rad_s;   /* smoothed rate one tick ago */
    uint32_t first_tick;      /* at which the rate went through the coming event's first level */
    real first_before_ticks;  /* that crossing lies this long before first_tick */
    struct leg_event waiting; /* placed ahead of now; reported when its time has come */
    struct ankle_push push;
    bool turned;         /* the leg has turned forwards, its toe-off is still to be placed */
    bool swung;          /* the swing was fast enough to be a step */
    bool landing;        /* and is being slowed, with the foot ahead: about to land */
    uint32_t since_tick; /* of the contact state */
    uint32_t moved_tick; /* when the leg last moved */
};

/* Both legs as they were LEG_RATE_HALF_WINDOW ticks ago, and this ankle as it is. */
struct leg_view {
    real rate_rad_s;          /* of this leg, smoothed */
    real ahead_rad;           /* this leg's angle minus the other's */
    real walking_speed_rad_s; /* forward speed at the last apexes, > 0 */
    real extension;           /* of the ankle, over the leg's length */
    bool fresh;               /* the sensor's sample of this tick has come */
    real strike_bias_s;       /* fitted: this leg's strikes are found so late, */
    real toe_off_bias_s;      /* and its toe-offs; negative: early */
};

/* Slope of the line through the samples within LEG_RATE_HALF_WINDOW of `centre`, rad/s;
 * angle_rad[tick % GAIT_HISTORY]. About 200 operations. */
real person_events_rate(const real angle_rad[GAIT_HISTORY], uint32_t centre_tick);

/* One tick of one leg, every tick in order. Constant cost, tens of operations. */
struct leg_event person_events_update(struct person_events *leg, const struct leg_view *view,
                                      uint32_t tick);

#endif
