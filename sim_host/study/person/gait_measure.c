#include "sim_host/study/person/gait_measure.h"

#include <math.h>
#include <string.h>

#define DEGREES (180.0 / 3.14159265358979323846)
#define SAMPLE_S 0.005
#define STANDS_WEIGHTS 0.05
#define LIFTED_WEIGHTS 0.02
#define STRIDE_LEAST_S 0.4

void gait_measure_init(struct gait_measure *measure, double from_s)
{
    memset(measure, 0, sizeof *measure);
    measure->from_s = from_s;
    measure->last_strike_s = -1.0;
    for (int side = 0; side < SIDE_COUNT; side++) {
        measure->leg[side].strike_s = -1.0;
        measure->leg[side].stands = true;
    }
}

/* ---- curves --------------------------------------------------------------------------------------------------- */

static void look(const struct reflex_person *person, enum side side, double value[GAIT_CURVES])
{
    static const double straight_deg[JOINT_COUNT] = {180.0, 180.0, 90.0};
    const double mass_kg = person->params.mass_kg;
    double torque_Nm[JOINT_COUNT];
    struct joint_angles joints;
    muscles_joint_angles(&person->body, side, &joints);
    memcpy(torque_Nm, person->torque_Nm[side], sizeof torque_Nm);
    muscles_add_joint_ends(&joints, mass_kg, torque_Nm);
    for (int i = 0; i < JOINT_COUNT; i++) {
        value[CURVE_ANGLE + i] = straight_deg[i] - DEGREES * joints.angle_rad[i];
        value[CURVE_MOMENT + i] = torque_Nm[i] / mass_kg;
    }
    value[CURVE_LOAD] = person->ground_N[side].y / (mass_kg * person->params.gravity_m_s2);
}

/* The stride's samples as a curve of GAIT_POINTS, added to the sum. */
static void close_stride(struct gait_leg *leg)
{
    for (int c = 0; c < GAIT_CURVES; c++) {
        for (int i = 0; i < GAIT_POINTS; i++) {
            const double at = (double)i / (GAIT_POINTS - 1) * (leg->samples - 1);
            const int below = (int)at < leg->samples - 1 ? (int)at : leg->samples - 2;
            const double part = at - below;
            leg->sum[c][i] +=
                (1.0 - part) * leg->sample[c][below] + part * leg->sample[c][below + 1];
        }
    }
    leg->strides++;
}

static void sample(struct gait_leg *leg, const double value[GAIT_CURVES], double now_s)
{
    const bool due = now_s - leg->strike_s >= leg->samples * SAMPLE_S - 1e-9;
    if (leg->strike_s >= 0.0 && due && leg->samples < GAIT_SAMPLES) {
        for (int c = 0; c < GAIT_CURVES; c++) {
            leg->sample[c][leg->samples] = value[c];
        }
        leg->samples++;
    }
}

/* ---- steps ---------------------------------------------------------------------------------------------------- */

static void strike(struct gait_measure *measure, struct gait_leg *leg)
{
    const double now_s = measure->now_s;
    if (leg->strike_s >= 0.0 && now_s - leg->strike_s < STRIDE_LEAST_S) {
        return; /* the same foot once more */
    }
    if (leg->strike_s >= measure->from_s && leg->samples > 1 && leg->samples < GAIT_SAMPLES) {
        close_stride(leg);
    }
    leg->strike_s = now_s;
    leg->samples = 0;
    if (measure->last_strike_s >= measure->from_s) {
        const double step_s = now_s - measure->last_strike_s;
        measure->steps++;
        measure->step_sum_s += step_s;
        measure->step_squares_s2 += step_s * step_s;
    }
    measure->last_strike_s = now_s;
}

static void take_leg(struct gait_measure *measure, const struct reflex_person *person,
                     enum side side)
{
    struct gait_leg *leg = &measure->leg[side];
    double value[GAIT_CURVES];
    look(person, side, value);
    const double load = value[CURVE_LOAD];
    if (!leg->stands && load > STANDS_WEIGHTS) {
        strike(measure, leg);
    }
    leg->stands = leg->stands ? load > LIFTED_WEIGHTS : load > STANDS_WEIGHTS;
    sample(leg, value, measure->now_s);
    if (measure->now_s >= measure->from_s) {
        measure->peak_weights = fmax(measure->peak_weights, load);
    }
}

/* What is asked of smoothness and effort. */
static void take_effort(struct gait_measure *measure, const struct reflex_person *person,
                        double passed_s)
{
    for (int side = 0; side < SIDE_COUNT; side++) {
        for (int i = 0; i < JOINT_COUNT; i++) {
            const double rate = (person->torque_Nm[side][i] - measure->torque_before_Nm[side][i]) /
                                (passed_s * person->params.mass_kg);
            measure->torque_before_Nm[side][i] = person->torque_Nm[side][i];
            measure->torque_rate_squares += rate * rate / (SIDE_COUNT * JOINT_COUNT);
        }
        for (int i = 0; i < MUSCLE_COUNT; i++) {
            const double activation = person->muscle[side][i].activation;
            measure->activation_squares += activation * activation / (SIDE_COUNT * MUSCLE_COUNT);
        }
    }
    measure->trunk_rate_squares +=
        person->body.dq[MULTIBODY_TRUNK] * person->body.dq[MULTIBODY_TRUNK];
    measure->ticks++;
}

void gait_measure_take(struct gait_measure *measure, const struct reflex_person *person,
                       double now_s)
{
    const double passed_s = now_s - measure->now_s;
    measure->now_s = now_s;
    measure->fell = reflex_person_fell(person);
    if (measure->fell || !(passed_s > 0.0)) {
        return;
    }
    for (int side = 0; side < SIDE_COUNT; side++) {
        take_leg(measure, person, (enum side)side);
    }
    if (now_s < measure->from_s) {
        measure->start_m = person->body.q[MULTIBODY_X];
        measure->start_s = now_s;
        memcpy(measure->torque_before_Nm, person->torque_Nm, sizeof measure->torque_before_Nm);
        return;
    }
    take_effort(measure, person, passed_s);
    measure->distance_m = person->body.q[MULTIBODY_X] - measure->start_m;
    measure->walked_s = now_s - measure->start_s;
}

void gait_measure_summary(const struct gait_measure *measure, struct gait_summary *summary)
{
    const double ticks = measure->ticks > 0 ? (double)measure->ticks : 1.0;
    const double steps = measure->steps > 0 ? (double)measure->steps : 1.0;
    memset(summary, 0, sizeof *summary);
    summary->fell = measure->fell;
    summary->walked_s = measure->now_s;
    summary->steps = measure->steps;
    summary->speed_m_s = measure->walked_s > 0.0 ? measure->distance_m / measure->walked_s : 0.0;
    summary->step_time_s = measure->step_sum_s / steps;
    summary->step_time_sd_s = sqrt(
        fmax(0.0, measure->step_squares_s2 / steps - summary->step_time_s * summary->step_time_s));
    summary->peak_weights = measure->peak_weights;
    summary->torque_rate_Nm_kg_s = sqrt(measure->torque_rate_squares / ticks);
    summary->activation = measure->activation_squares / ticks;
    summary->trunk_rate_rad_s = sqrt(measure->trunk_rate_squares / ticks);
    for (int side = 0; side < SIDE_COUNT; side++) {
        const struct gait_leg *leg = &measure->leg[side];
        summary->has_curve[side] = leg->strides > 0;
        for (int c = 0; leg->strides > 0 && c < GAIT_CURVES; c++) {
            for (int i = 0; i < GAIT_POINTS; i++) {
                summary->curve[side][c][i] = leg->sum[c][i] / leg->strides;
            }
        }
    }
}
