/* What befalls a recorded person: the person stops, hurries, trips, is pushed, slips or falls.
 *
 * The recording goes on as the person's own time does; what is added to its angles ends by itself or
 * stays, as said at each field. All zeros but rate = 1: the recording as it is.
 * No heap, no globals; plain data, a copy is a snapshot; O(1).
 */
#ifndef SIM_HOST_PLANT_PERSON_MOTION_H
#define SIM_HOST_PLANT_PERSON_MOTION_H

#include <stdbool.h>

#include "model/side.h"
#include "sim_host/plant/recorded_person.h"

struct person_motion {
    double rate;             /* of the person's time: 1; 0: stands still; below 0: backwards */
    double shift_s;          /* by which the recording is ahead of the plant's time so far */
    bool held[SIDE_COUNT];   /* the leg stays where it is; let go, it is back within 150 ms */
    double away[SIDE_COUNT]; /* share of the held angle that is still there */
    double held_rad[SIDE_COUNT];
    double
        bump_rad[SIDE_COUNT]; /* added to the leg's angle; decays with a time constant of 200 ms */
    double tilt_to_rad;       /* not 0: falls, the whole body turns at 2.5 rad/s until here */
    double tilt_rad;
    bool contact_forced[SIDE_COUNT]; /* the foot's contact is `contact`, whatever was recorded */
    bool contact[SIDE_COUNT];
};

/* As recorded. */
void person_motion_init(struct person_motion *motion);

/* Takes hold of a leg where *now has it. */
void person_motion_hold(struct person_motion *motion, enum side side,
                        const struct recorded_person_state *now);

/* One tick: changes the person's next state; *now is the state before. A tilted body beyond 0.5 rad has
 * no foot on the ground. */
void person_motion_apply(struct person_motion *motion, double tick_s,
                         const struct recorded_person_state *now,
                         struct recorded_person_state *next);

/* Beyond 0.5 rad: the person has fallen. */
bool person_motion_is_down(const struct person_motion *motion);

#endif
