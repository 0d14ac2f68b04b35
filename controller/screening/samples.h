/* Screening of the samples: what replaces a sample that is lost or that no motion explains.
 *
 * A sample is accepted when a leg, an ankle or a motor can have come there from the last accepted
 * one in the time between. Otherwise the last accepted value stands in for it (a leg's angle goes
 * on at its last rate), as for a sample that was lost. So one corrupted frame ends nothing. Of a motor
 * only ticks without an answer widen what is accepted, and three answers in a row that no motion explains
 * are a jump of its encoder (lost ones between do not count): then 120 ms are rejected. How long this lasts is
 * counted, and checks.h makes a lasting one a fault: a motor's wherever its drive may have torque. Cycles that
 * the controller missed are not known here, so a motor that moved on meanwhile may look like a jump.
 */
#ifndef CONTROLLER_SCREENING_SAMPLES_H
#define CONTROLLER_SCREENING_SAMPLES_H

#include "controller/control_params.h"
#include "controller/signals.h"

#define samples_init REAL_SYMBOL(samples_init)
#define samples_screen REAL_SYMBOL(samples_screen)

/* The last accepted samples of one leg, and what was received in this tick. */
struct leg_samples {
    real angle_rad;
    real rate_rad; /* the angle's change per tick */
    real extension_m;
    real motor_m;
    uint16_t angle_rejected_ticks; /* ticks in a row without an accepted sample */
    uint16_t extension_rejected_ticks;
    uint16_t motor_rejected_ticks;
    uint16_t motor_missing_ticks; /* of these, those in which none came */
    bool received_finite;         /* angle, extension and motor position as received are numbers */
    real received_rad;            /* the angle as received */
};

struct samples {
    struct leg_samples leg[SIDE_COUNT];
};

/* Nothing remembered: any finite first sample is accepted. */
void samples_init(struct samples *samples);

/* First in a tick, once a tick: replaces in *input the leg angles, ankle extensions and motor
 * positions that are lost, not finite or not explained by a motion. Their ages stay as received.
 * Constant cost. */
void samples_screen(struct samples *samples, const struct control_params *params,
                    struct controller_input *input);

#endif
