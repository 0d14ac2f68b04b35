/* Compares what the controller reported about the gait with the plant's truth, event by event.
 *
 * Times are in seconds of the plant, or of the recording when a recorded person walks. The
 * controller's times are those of its own events: the estimated moment, and the tick in which it
 * reported the event.
 */
#ifndef SIM_HOST_LOOP_GAIT_RECORD_H
#define SIM_HOST_LOOP_GAIT_RECORD_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "sim_host/loop/loop.h"

struct gait_moment {
    double event_s; /* when it happened, as estimated */
    double known_s; /* when the controller reported it */
    double value;   /* a release: the motor's position in metres of spring; else 0 */
};

/* A list that grows; count entries are valid. */
struct gait_moments {
    struct gait_moment *at;
    size_t count, capacity;
};

enum { GAIT_PHASE_TICKS = 4096 }; /* longest stride whose phase is measured */

struct gait_record {
    struct gait_moments seen[SIDE_COUNT][GAIT_EVENT_KINDS];
    struct gait_moments release[SIDE_COUNT]; /* of the latch, by the plant */
    struct gait_moments
        true_strike[SIDE_COUNT]; /* by the plant or the recording; known_s = event_s */
    struct gait_moments true_toe_off[SIDE_COUNT];
    struct gait_moments
        switch_closed[SIDE_COUNT]; /* by the foot switches, as the controller heard */
    struct gait_moments switch_opened[SIDE_COUNT];
    uint32_t switch_closed_tick[SIDE_COUNT], switch_opened_tick[SIDE_COUNT]; /* the newest */
    float phase[SIDE_COUNT][GAIT_PHASE_TICKS]; /* the controller's, since the last true strike */
    uint32_t phase_count[SIDE_COUNT];
    double phase_squares[SIDE_COUNT]; /* sum of squared errors, share of the stride */
    uint64_t phase_measured[SIDE_COUNT];
    double origin_s;    /* subtracted from the plant's time */
    bool out_of_memory; /* something was not recorded */
};

/* Empty; times will count from origin_s of the plant. */
void gait_record_init(struct gait_record *record, double origin_s);
void gait_record_free(struct gait_record *record);

/* One event of the plant. */
void gait_record_truth(struct gait_record *record, const struct walk_event *event);

/* After each loop_tick: the controller's events and gait phase of that tick. */
void gait_record_take(struct gait_record *record, const struct loop *loop);

/* RMS error of the leg's gait phase against the true heel strikes, share of a stride;
 * NaN when nothing was measured. */
double gait_record_phase_error(const struct gait_record *record, enum side side);

#endif
