/* The person of a recording at a moment: what a recorded person does in the walker's place.
 *
 * Between samples the angles follow a cubic (Catmull-Rom); contact is held.
 */
#ifndef SIM_HOST_PLANT_RECORDED_PERSON_H
#define SIM_HOST_PLANT_RECORDED_PERSON_H

#include <stdbool.h>
#include <stddef.h>

#include "model/side.h"
#include "sim_host/plant/recording.h"

/* The person now. Rates are the interpolation's. */
struct recorded_person_state {
    double leg_angle_rad[SIDE_COUNT];
    double leg_rate_rad_s[SIDE_COUNT];
    double ankle_m[SIDE_COUNT];
    double ankle_rate_m_s[SIDE_COUNT];
    bool contact[SIDE_COUNT];
    bool finished; /* time is past the last sample, which is held */
};

/* Fills *state for time_s after the first sample; before it, the first sample is held. *cursor remembers
 * the place in the recording: start it at 0 and pass it back. A recording has at least two samples.
 * O(1) per tick on average while time goes on. */
void recorded_person_at(const struct recording *recording, double time_s, size_t *cursor,
                        struct recorded_person_state *state);

#endif
