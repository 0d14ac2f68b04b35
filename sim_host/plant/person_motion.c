#include "sim_host/plant/person_motion.h"

static const double BACK_S = 0.150;
static const double BUMP_S = 0.200;
static const double FALL_RAD_S = 2.5;
static const double DOWN_RAD = 0.5;

void person_motion_init(struct person_motion *motion)
{
    *motion = (struct person_motion){.rate = 1.0};
}

void person_motion_hold(struct person_motion *motion, enum side side,
                        const struct recorded_person_state *now)
{
    motion->held[side] = true;
    motion->held_rad[side] = now->leg_angle_rad[side];
}

bool person_motion_is_down(const struct person_motion *motion)
{
    return motion->tilt_rad > DOWN_RAD || motion->tilt_rad < -DOWN_RAD;
}

static void fall(struct person_motion *motion, double tick_s)
{
    const double step_rad = FALL_RAD_S * tick_s;
    const double left_rad = motion->tilt_to_rad - motion->tilt_rad;
    motion->tilt_rad += left_rad > step_rad    ? step_rad
                        : left_rad < -step_rad ? -step_rad
                                               : left_rad;
}

void person_motion_apply(struct person_motion *motion, double tick_s,
                         const struct recorded_person_state *now,
                         struct recorded_person_state *next)
{
    bool changed = motion->tilt_to_rad != 0.0;
    if (changed) {
        fall(motion, tick_s);
    }
    for (int i = 0; i < SIDE_COUNT; i++) {
        if (motion->rate != 1.0) {
            next->leg_rate_rad_s[i] *= motion->rate;
            next->ankle_rate_m_s[i] *= motion->rate;
        }
        const double step = tick_s / BACK_S;
        motion->away[i] = motion->held[i]          ? 1.0
                          : motion->away[i] > step ? motion->away[i] - step
                                                   : 0.0;
        const double added_rad = motion->away[i] * (motion->held_rad[i] - next->leg_angle_rad[i]) +
                                 motion->bump_rad[i] + motion->tilt_rad;
        changed = changed || added_rad != 0.0;
        next->leg_angle_rad[i] += added_rad;
        motion->bump_rad[i] -= motion->bump_rad[i] * tick_s / BUMP_S;
        if (changed) {
            next->leg_rate_rad_s[i] = (next->leg_angle_rad[i] - now->leg_angle_rad[i]) / tick_s;
        }
        if (motion->contact_forced[i]) {
            next->contact[i] = motion->contact[i];
        }
        next->contact[i] = next->contact[i] && !person_motion_is_down(motion);
    }
}
