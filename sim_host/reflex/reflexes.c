#include "sim_host/reflex/reflexes.h"

enum { HIP_MS = 5, KNEE_MS = 10, ANKLE_MS = 20 };
#define REST 0.01       /* stimulation of a muscle that does nothing */
#define LOAD_LEAST 0.02 /* of body weight: what a foot that stands carries */

void reflex_gains_published(struct reflex_gains *gains)
{
#define REFLEX_GAIN_VALUE(name, published, unit, meaning) .name = (published),
    *gains = (struct reflex_gains){REFLEX_GAINS(REFLEX_GAIN_VALUE)};
#undef REFLEX_GAIN_VALUE
}

void reflex_gains_healthy(struct reflex_gains *gains)
{
    *gains = (struct reflex_gains){
        .sol_force = 1.274,
        .ta_length = 1.033,
        .ta_length_off = 0.3596,
        .ta_sol_force = 0.3199,
        .gas_force = 1.028,
        .vas_force = 0.9423,
        .vas_knee = 2.693,
        .vas_knee_off = 2.816,
        .vas_stance = 0.08952,
        .hip_stance = 0.05032,
        .lean_gain = 1.654,
        .lean_rate_gain = 0.2298,
        .lean_wanted = 0.1087,
        .glu_share = 0.8929,
        .load = 1.018,
        .late_stance = 0.2366,
        .swing_lean = 2.551,
        .hfl_length = 0.3676,
        .hfl_length_off = 0.4881,
        .hfl_ham_length = 2.913,
        .hfl_ham_length_off = 0.9248,
        .ham_force = 0.5772,
        .glu_force = 0.5143,
    };
}

void reflexes_init(struct reflexes *reflexes, const struct reflex_moment *moment)
{
    *reflexes = (struct reflexes){0};
    for (int i = 0; i < REFLEX_RING; i++) {
        reflexes->ring[i] = *moment;
    }
    for (int side = 0; side < SIDE_COUNT; side++) {
        reflexes->stands[side] = moment->leg[side].load > LOAD_LEAST;
        reflexes->lift_off_lean_rad[side] = moment->lean_rad;
    }
}

static const struct reflex_moment *past(const struct reflexes *reflexes, int delay_ms)
{
    return &reflexes->ring[(reflexes->newest + REFLEX_RING - delay_ms) % REFLEX_RING];
}

void reflexes_sense(struct reflexes *reflexes, const struct reflex_moment *moment)
{
    reflexes->newest = (reflexes->newest + 1) % REFLEX_RING;
    reflexes->ring[reflexes->newest] = *moment;
    const struct reflex_moment *late = past(reflexes, HIP_MS);
    for (int side = 0; side < SIDE_COUNT; side++) {
        const bool stands = late->leg[side].load > LOAD_LEAST;
        if (stands && !reflexes->stands[side]) {
            reflexes->is_trailing[side] = false;
            reflexes->is_trailing[SIDE_COUNT - 1 - side] = true;
        }
        if (!stands && reflexes->stands[side]) {
            reflexes->lift_off_lean_rad[side] = late->lean_rad;
            reflexes->is_trailing[side] = false;
        }
        reflexes->stands[side] = stands;
    }
}

static double above(double value)
{
    return value > 0.0 ? value : 0.0;
}

static double tibialis_length(const struct reflex_sense *ankle, const struct reflex_gains *gains)
{
    return gains->ta_length * above(ankle->length[MUSCLE_TA] - gains->ta_length_off);
}

static void stance(const struct reflexes *reflexes, const struct reflex_gains *gains,
                   enum side side, double stimulation[MUSCLE_COUNT])
{
    const enum side other = (enum side)(SIDE_COUNT - 1 - (int)side);
    const struct reflex_sense *ankle = &past(reflexes, ANKLE_MS)->leg[side];
    const struct reflex_sense *knee = &past(reflexes, KNEE_MS)->leg[side];
    const struct reflex_moment *hip = past(reflexes, HIP_MS);
    const bool late = reflexes->stands[other] && reflexes->is_trailing[side];
    stimulation[MUSCLE_SOL] = REST + gains->sol_force * ankle->force[MUSCLE_SOL];
    stimulation[MUSCLE_TA] =
        REST + tibialis_length(ankle, gains) - gains->ta_sol_force * ankle->force[MUSCLE_SOL];
    stimulation[MUSCLE_GAS] = REST + gains->gas_force * ankle->force[MUSCLE_GAS];
    stimulation[MUSCLE_VAS] = gains->vas_stance + gains->vas_force * knee->force[MUSCLE_VAS];
    if (knee->knee_rate_rad_s > 0.0) {
        stimulation[MUSCLE_VAS] -= gains->vas_knee * above(knee->knee_rad - gains->vas_knee_off);
    }
    const double load = gains->load * hip->leg[side].load;
    const double lean = load * (gains->lean_gain * (hip->lean_rad - gains->lean_wanted) +
                                gains->lean_rate_gain * hip->lean_rate_rad_s);
    stimulation[MUSCLE_HAM] = gains->hip_stance + above(lean);
    stimulation[MUSCLE_GLU] = gains->hip_stance + gains->glu_share * above(lean);
    stimulation[MUSCLE_HFL] = gains->hip_stance + above(-lean);
    if (late) {
        stimulation[MUSCLE_VAS] -= gains->load * hip->leg[other].load;
        stimulation[MUSCLE_GLU] -= gains->late_stance;
        stimulation[MUSCLE_HFL] += gains->late_stance;
    }
}

static void swing(const struct reflexes *reflexes, const struct reflex_gains *gains, enum side side,
                  double stimulation[MUSCLE_COUNT])
{
    const struct reflex_sense *ankle = &past(reflexes, ANKLE_MS)->leg[side];
    const struct reflex_sense *hip = &past(reflexes, HIP_MS)->leg[side];
    stimulation[MUSCLE_SOL] = stimulation[MUSCLE_GAS] = stimulation[MUSCLE_VAS] = REST;
    stimulation[MUSCLE_TA] = REST + tibialis_length(ankle, gains);
    stimulation[MUSCLE_HAM] = REST + gains->ham_force * hip->force[MUSCLE_HAM];
    stimulation[MUSCLE_GLU] = REST + gains->glu_force * hip->force[MUSCLE_GLU];
    stimulation[MUSCLE_HFL] =
        REST + gains->swing_lean * (reflexes->lift_off_lean_rad[side] - gains->lean_wanted) +
        gains->hfl_length * above(hip->length[MUSCLE_HFL] - gains->hfl_length_off) -
        gains->hfl_ham_length * above(hip->length[MUSCLE_HAM] - gains->hfl_ham_length_off);
}

void reflexes_stimulate(const struct reflexes *reflexes, const struct reflex_gains *gains,
                        enum side side, double stimulation[MUSCLE_COUNT])
{
    if (reflexes->stands[side]) {
        stance(reflexes, gains, side, stimulation);
    } else {
        swing(reflexes, gains, side, stimulation);
    }
    for (int i = 0; i < MUSCLE_COUNT; i++) {
        stimulation[i] = stimulation[i] < REST ? REST : stimulation[i] > 1.0 ? 1.0 : stimulation[i];
    }
}
