#include "controller/screening/samples.h"

#include "controller/screening/tick_count.h"

/* Fastest a leg swings, in sqrt(g/l), and an ankle extends, in sqrt(g l). Both are several
 * times what the walker does at its fastest gait (1.1 and 0.57) or a person (about 2). A foot
 * that its spring no longer holds drops back within some ticks. */
#define LEG_RATE_RATIO REAL(6.0)
#define ANKLE_RATE_RATIO REAL(6.0)
/* A motor, in limits of its own reference. */
#define MOTOR_RATE_RATIO REAL(2.0)
/* Noise of a sample: rad, and in leg lengths. A motor's is its encoder's, and what it goes on between SYNC and sample. */
#define ANGLE_NOISE_RAD REAL(0.02)
#define LENGTH_NOISE_RATIO REAL(0.005)
#define MOTOR_NOISE_RATIO REAL(0.002)

static real speed_unit(const struct control_params *params)
{
    return real_sqrt(params->gravity_m_s2 / params->leg_length_m);
}

void samples_init(struct samples *samples)
{
    *samples = (struct samples){0};
    for (int side = 0; side < SIDE_COUNT; side++) {
        /* From so long ago any first sample is possible. */
        samples->leg[side].angle_rejected_ticks = UINT16_MAX - 1;
        samples->leg[side].extension_rejected_ticks = UINT16_MAX - 1;
        samples->leg[side].motor_rejected_ticks = UINT16_MAX - 1;
    }
}

/* Whether a value can have come from the last accepted one within `ticks`. */
static bool is_possible(real value, real before, real rate_per_tick, real noise, uint16_t ticks)
{
    const real change_max = rate_per_tick * (real)ticks + noise;
    return real_abs(value - before) <= change_max; /* false when it is not finite */
}

/* For so long a missing angle goes on at its last rate: a lost frame then does not look like a
 * leg that stopped. After that it stays where it is, so that it does not run away. */
enum { BRIDGE_TICKS = TICKS_OF_MS(50) };

static void screen_angle(struct leg_samples *leg, struct leg_measurement *sample,
                         real rate_per_tick)
{
    const uint16_t ticks = count_up(leg->angle_rejected_ticks);
    const real angle = sample->leg_angle_rad;
    if (sample->age_ticks == 0 &&
        is_possible(angle, leg->angle_rad, rate_per_tick, ANGLE_NOISE_RAD, ticks)) {
        const real change = angle - leg->angle_rad;
        leg->rate_rad = (change + (real)(ticks - 1) * leg->rate_rad) / (real)ticks;
        leg->angle_rad = angle;
        leg->angle_rejected_ticks = 0;
        return;
    }
    leg->angle_rejected_ticks = ticks;
    leg->rate_rad = ticks > BRIDGE_TICKS ? REAL(0.0) : leg->rate_rad;
    leg->angle_rad += leg->rate_rad;
    sample->leg_angle_rad = leg->angle_rad;
}

static void screen_length(real *accepted, uint16_t *rejected_ticks, real *value, bool fresh,
                          real rate_per_tick, real noise)
{
    const uint16_t ticks = count_up(*rejected_ticks);
    if (fresh && is_possible(*value, *accepted, rate_per_tick, noise, ticks)) {
        *accepted = *value;
        *rejected_ticks = 0;
        return;
    }
    *rejected_ticks = ticks;
    *value = *accepted;
}

/* Longer than sensor_age_max_s may be, so that a jump becomes a fault; from then on it counts as silent for so long. */
enum { JUMP_TICKS = TICKS_OF_MS(120) };
/* Wrong answers in a row that are no corrupted frames any more, but an encoder that has jumped. */
enum { JUMP_ANSWERS = 3 };

/* A drive answers in every tick, and its motor cannot move further in one than its limit of speed lets it. So the
 * time that counts is that without an answer: else a jump of some centimetres would pass after some ticks.
 * After a jump the drive leads its reading back to the target, and its motor away from it: within some ticks the
 * reading would pass for a motion again. So it stays rejected. */
static void screen_motor(struct leg_samples *leg, struct sea_measurement *sea, real rate_per_tick,
                         real noise)
{
    const bool fresh = sea->age_ticks == 0, over = leg->motor_rejected_ticks > JUMP_TICKS;
    const bool jumped =
        !over && leg->motor_rejected_ticks - leg->motor_missing_ticks >= JUMP_ANSWERS;
    const uint16_t ticks = count_up(over ? leg->motor_rejected_ticks : leg->motor_missing_ticks);
    if (fresh && !jumped &&
        is_possible(sea->precompression_m, leg->motor_m, rate_per_tick, noise, ticks)) {
        leg->motor_m = sea->precompression_m;
        leg->motor_rejected_ticks = leg->motor_missing_ticks = 0;
        return;
    }
    leg->motor_rejected_ticks = count_up(leg->motor_rejected_ticks);
    leg->motor_missing_ticks =
        fresh ? leg->motor_missing_ticks : count_up(leg->motor_missing_ticks);
    sea->precompression_m = leg->motor_m;
}

void samples_screen(struct samples *samples, const struct control_params *params,
                    struct controller_input *input)
{
    const real length = params->leg_length_m;
    const real unit = speed_unit(params) * CONTROL_PERIOD_S;
    const real noise = LENGTH_NOISE_RATIO * length;
    for (int side = 0; side < SIDE_COUNT; side++) {
        struct leg_samples *leg = &samples->leg[side];
        struct leg_measurement *sample = &input->leg[side];
        struct sea_measurement *sea = &input->sea[side];
        leg->received_rad = sample->leg_angle_rad;
        leg->received_finite = real_is_finite(sample->leg_angle_rad) &&
                               real_is_finite(sample->ankle_extension_m) &&
                               real_is_finite(sea->precompression_m);
        screen_angle(leg, sample, LEG_RATE_RATIO * unit);
        screen_length(&leg->extension_m, &leg->extension_rejected_ticks, &sample->ankle_extension_m,
                      sample->age_ticks == 0, ANKLE_RATE_RATIO * unit * length, noise);
        screen_motor(leg, sea, MOTOR_RATE_RATIO * params->sea_speed_max_m_s * CONTROL_PERIOD_S,
                     MOTOR_NOISE_RATIO * length);
    }
}
