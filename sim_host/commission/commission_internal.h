/* What the steps share: values by name, motions, findings. */
#ifndef SIM_HOST_COMMISSION_COMMISSION_INTERNAL_H
#define SIM_HOST_COMMISSION_COMMISSION_INTERNAL_H

#include "controller/commissioning/motion.h"
#include "controller/supervisor/supervisor.h"
#include "sim_host/commission/commission.h"

/* A step. Returns 0 when it came to its end, whatever it found; -1 when it was broken off: the reason is
 * in its result. */
typedef int (*commission_run_step)(struct commission *commission, struct commission_result *result);
int commission_identify(struct commission *commission, struct commission_result *result);
int commission_rest(struct commission *commission, struct commission_result *result);
int commission_moves(struct commission *commission, struct commission_result *result);
int commission_zero(struct commission *commission, struct commission_result *result);
int commission_sensors(struct commission *commission, struct commission_result *result);
int commission_latch(struct commission *commission, struct commission_result *result);
int commission_spring(struct commission *commission, struct commission_result *result);
int commission_bandwidth(struct commission *commission, struct commission_result *result);
int commission_link(struct commission *commission, struct commission_result *result);
int commission_stop(struct commission *commission, struct commission_result *result);
int commission_switches(struct commission *commission, struct commission_result *result);

/* Something is not as it should be: found, expected, what to look at. */
void commission_find(struct commission_result *result, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
/* Something was measured; sentences are put behind each other. */
void commission_note(struct commission_result *result, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
/* The step cannot go on. Returns -1. */
int commission_break(struct commission_result *result, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

static inline const char *commission_leg(int leg)
{
    return leg == SIDE_LEFT ? "left" : "right";
}

/* A device may have one drive alone: the other leg has sensors only. */
static inline bool commission_is_driven(const struct commission *commission, int leg)
{
    return device_leg_is_driven(&commission->device.description.leg[leg]);
}

/* A value of the controller by name, in the unit shown. Returns 0, or -1 with the reason in the result. */
int commission_get(struct commission *commission, struct commission_result *result,
                   const char *name, double *number);
int commission_get_leg(struct commission *commission, struct commission_result *result,
                       const char *group, enum side leg, const char *name, double *number);
int commission_set(struct commission *commission, struct commission_result *result,
                   const char *name, double number);

/* A number at an address of any node. Returns 0, or the SDO's reason in message and -1. */
int commission_peek(struct commission *commission, unsigned node, uint16_t index, uint8_t sub,
                    uint32_t *number, char *message);

/* Lets time pass; false when the person wants to end. */
bool commission_wait(struct commission *commission, unsigned milliseconds);

/* Asks the person: *answer is 1 yes, 0 no, -1 nobody answers. Returns 0, or -1 when they want to end. */
int commission_confirm(struct commission *commission, struct commission_result *result,
                       enum side leg, const char *question, int *answer);

/* Waits until the supervisor is in STANDBY; a fault that is left from before is reset first. Returns 0, or
 * -1 with the reason in the result. */
int commission_reach_standby(struct commission *commission, struct commission_result *result);

/* One motion, from its order to its end; afterwards nothing is asked for any more and the controller is
 * on its way to STANDBY. */
struct commission_motion {
    enum motion_kind kind;
    enum side leg;
    double share, seconds, frequency_Hz;
};

struct commission_motion_report {
    enum motion_outcome outcome;
    enum supervisor_fault fault; /* that ended it; NONE without */
    /* While it was held: motors, ankles. */
    double motor_m[SIDE_COUNT], ankle_m[SIDE_COUNT];
    double least_ankle_m[SIDE_COUNT], greatest_ankle_m[SIDE_COUNT];
    double largest_other_m; /* of the other motor, at any time, from where it began */
    bool held;
    /* Force against position: F = stiffness x + friction (loading) or - friction (unloading). */
    unsigned samples;
    double stiffness_N_m, friction_N;
    double bandwidth_Hz, last_frequency_Hz;
    unsigned release_ms, unload_ms; /* 65535: it did not */
    bool latch_closed_before, latch_opened;
};

/* Returns 0 when it ended, well or not; -1 when the tool was to end or the controller fell silent, with
 * the reason in the result. */
int commission_perform(struct commission *commission, struct commission_result *result,
                       const struct commission_motion *motion,
                       struct commission_motion_report *report);

/* Finds what a motion's end says by itself: beyond, not reached, refused, a fault. True: it was done. */
bool commission_was_done(struct commission_result *result, const struct commission_motion *motion,
                         const struct commission_motion_report *report);

#endif
