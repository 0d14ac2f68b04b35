/* What each leg's device did, in the figures that people use: torque, work and power of the pushes, when in
 * the gait cycle, how freely the ankle moves besides, and what the motor bore.
 *
 * Heel strikes and toe-offs are the truth's (the recording's contacts), so this judges and never helps. The
 * pushes count from the first one on; a stance is one that began while the controller walked.
 */
#ifndef SIM_HOST_LOOP_PUSH_RECORD_H
#define SIM_HOST_LOOP_PUSH_RECORD_H

#include <stdbool.h>
#include <stdint.h>

#include "sim_host/loop/loop.h"

/* Swing is free from so long after toe-off on. */
#define PUSH_RECORD_FREE_S 0.05

/* A mean that knows how many it is of. */
struct push_mean {
    double sum;
    uint32_t count;
};

struct push_leg_record {
    uint32_t stances, pushes;                    /* that ended; given in them */
    struct push_mean torque_Nm, work_J, power_W; /* peak torque, work, peak power of a push */
    struct push_mean load_share, release_share, end_share; /* of the gait cycle, 0..1 */
    double most_torque_Nm;
    double swing_Nm;  /* largest from PUSH_RECORD_FREE_S after toe-off to heel strike */
    double stance_Nm; /* largest from heel strike to the other foot's */
    double ankle_least_m, ankle_most_m; /* extension */
    double track_squares_Nm2;           /* torque less that of a motor at its target, open latch */
    uint64_t track_ticks;
    double current_squares_A2, peak_A; /* as built */
    double hottest_degC, lowest_V;
    uint64_t limited_ticks, ticks; /* force, current or voltage at its limit; of all */
    double last_work_J;            /* the device's on the ankle, as of the last tick */
    /* the stride that runs; times are the plant's, < 0: not yet */
    struct {
        bool counts;
        double strike_s, toe_off_s, other_s, loaded_s, release_s, end_s;
        double torque_Nm, power_W, work_from_J;
    } now;
};

struct push_record {
    struct push_leg_record leg[SIDE_COUNT];
    bool has_lever; /* else torques are forces, N: a compass */
};

void push_record_init(struct push_record *record, const struct loop *loop);

/* One event of the plant, and after each loop_tick() the plant as it is. */
void push_record_event(struct push_record *record, const struct walk_event *event);
void push_record_take(struct push_record *record, const struct loop *loop);

/* Mean, or NaN of none. */
double push_mean_of(const struct push_mean *mean);

/* Work of the weaker leg in shares of the stronger one's, 0..1; NaN without pushes of both. */
double push_record_symmetry(const struct push_record *record);

/* RMS of torque tracking, N m; RMS current, A; NaN when nothing was measured. */
double push_record_track_Nm(const struct push_leg_record *leg);
double push_record_rms_A(const struct push_leg_record *leg);

#endif
