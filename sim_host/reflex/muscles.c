#include "sim_host/reflex/muscles.h"

#include <assert.h>
#include <stdbool.h>

#include "model/trig.h"

#define PI 3.14159265358979323846
#define RAD(degrees) ((degrees)*PI / 180.0)
#define REFERENCE_MASS_KG 80.0

/* Table I of Geyer & Herr (2010): N, lo/s, m, m. */
static const struct muscle published[MUSCLE_COUNT] = {
    [MUSCLE_SOL] = {4000.0, 6.0, 0.04, 0.26},  [MUSCLE_TA] = {800.0, 12.0, 0.06, 0.24},
    [MUSCLE_GAS] = {1500.0, 12.0, 0.05, 0.40}, [MUSCLE_VAS] = {6000.0, 12.0, 0.08, 0.23},
    [MUSCLE_HAM] = {3000.0, 12.0, 0.10, 0.31}, [MUSCLE_GLU] = {1500.0, 12.0, 0.11, 0.13},
    [MUSCLE_HFL] = {2000.0, 12.0, 0.11, 0.10},
};

/* Where a muscle passes a joint. Its arm is r cos(angle - greatest), or r where it is constant; its length there
 * changes by pennation times that. */
struct attachment {
    enum muscle_id muscle;
    enum joint joint;
    bool extends, is_constant;
    double arm_m, greatest_rad, reference_rad, pennation;
    double reference_sine; /* of reference - greatest: trig_sincos_f64's bits */
};

static const struct attachment attachments[] = {
    {MUSCLE_SOL, JOINT_ANKLE, true, false, 0.05, RAD(110.0), RAD(80.0), 0.5, -0.5},
    {MUSCLE_TA, JOINT_ANKLE, false, false, 0.04, RAD(80.0), RAD(110.0), 0.7, 0.5},
    {MUSCLE_GAS, JOINT_ANKLE, true, false, 0.05, RAD(110.0), RAD(80.0), 0.7, -0.5},
    {MUSCLE_GAS, JOINT_KNEE, false, false, 0.05, RAD(140.0), RAD(165.0), 0.7, 0.42261826174069939},
    {MUSCLE_VAS, JOINT_KNEE, true, false, 0.06, RAD(165.0), RAD(125.0), 0.7, -0.64278760968653936},
    {MUSCLE_HAM, JOINT_KNEE, false, false, 0.05, RAD(180.0), RAD(180.0), 0.7, 0.0},
    {MUSCLE_HAM, JOINT_HIP, true, true, 0.08, 0.0, RAD(155.0), 0.7, 0.0},
    {MUSCLE_GLU, JOINT_HIP, true, true, 0.10, 0.0, RAD(150.0), 0.5, 0.0},
    {MUSCLE_HFL, JOINT_HIP, false, true, 0.10, 0.0, RAD(180.0), 0.5, 0.0},
};
static_assert(sizeof attachments / sizeof attachments[0] == MUSCLE_PASSES, "one of each");

void muscles_default(double mass_kg, double leg_m, struct muscle muscle[MUSCLE_COUNT])
{
    for (int i = 0; i < MUSCLE_COUNT; i++) {
        muscle[i] = published[i];
        muscle[i].force_max_N *= mass_kg / REFERENCE_MASS_KG;
        muscle[i].optimal_m *= leg_m;
        muscle[i].slack_m *= leg_m;
    }
}

void muscles_joint_angles(const struct multibody_state *state, enum side side,
                          struct joint_angles *joints)
{
    const double *angle = state->q + multibody_leg(side), *rate = state->dq + multibody_leg(side);
    joints->angle_rad[JOINT_HIP] = PI - angle[PART_THIGH] + state->q[MULTIBODY_TRUNK];
    joints->angle_rad[JOINT_KNEE] = PI - angle[PART_THIGH] + angle[PART_SHANK];
    joints->angle_rad[JOINT_ANKLE] = 0.5 * PI + angle[PART_SHANK] - angle[PART_FOOT];
    joints->rate_rad_s[JOINT_HIP] = state->dq[MULTIBODY_TRUNK] - rate[PART_THIGH];
    joints->rate_rad_s[JOINT_KNEE] = rate[PART_SHANK] - rate[PART_THIGH];
    joints->rate_rad_s[JOINT_ANKLE] = rate[PART_SHANK] - rate[PART_FOOT];
}

void muscles_pass(const struct joint_angles *joints, struct muscle_passes *passes)
{
    for (int i = 0; i < MUSCLE_PASSES; i++) {
        const struct attachment *at = &attachments[i];
        const double angle = joints->angle_rad[at->joint];
        if (at->is_constant) {
            passes->way[i] = angle - at->reference_rad;
            passes->arm[i] = 1.0;
        } else {
            double sine;
            trig_sincos_f64(angle - at->greatest_rad, &sine, &passes->arm[i]);
            passes->way[i] = sine - at->reference_sine;
        }
    }
}

double muscles_total_m(const struct muscle *muscle, enum muscle_id id, double leg_scale,
                       const struct muscle_passes *passes)
{
    double total_m = muscle[id].optimal_m + muscle[id].slack_m;
    for (int i = 0; i < MUSCLE_PASSES; i++) {
        const struct attachment *at = &attachments[i];
        if (at->muscle == id) {
            total_m +=
                (at->extends ? -1.0 : 1.0) * at->pennation * at->arm_m * leg_scale * passes->way[i];
        }
    }
    return total_m;
}

void muscles_add_torque(enum muscle_id id, double leg_scale, const struct muscle_passes *passes,
                        double force_N, double torque_Nm[JOINT_COUNT])
{
    for (int i = 0; i < MUSCLE_PASSES; i++) {
        const struct attachment *at = &attachments[i];
        if (at->muscle == id) {
            torque_Nm[at->joint] +=
                (at->extends ? 1.0 : -1.0) * at->arm_m * leg_scale * passes->arm[i] * force_N;
        }
    }
}

/* How far beyond its end an angle is, times a stiffness, with a damping that never pulls inward. */
static double end_torque(double beyond_rad, double rate_rad_s, double mass_kg)
{
    const double stiffness_Nm_rad = 0.3 / RAD(1.0) * mass_kg / REFERENCE_MASS_KG;
    const double full_rate_rad_s = RAD(1.0);
    const double damping = 1.0 + rate_rad_s / full_rate_rad_s;
    return beyond_rad > 0.0 && damping > 0.0 ? stiffness_Nm_rad * beyond_rad * damping : 0.0;
}

void muscles_add_joint_ends(const struct joint_angles *joints, double mass_kg,
                            double torque_Nm[JOINT_COUNT])
{
    static const double lowest[JOINT_COUNT] = {0.0, 0.0, RAD(70.0)};
    static const double highest[JOINT_COUNT] = {RAD(230.0), RAD(175.0), RAD(130.0)};
    for (int i = 0; i < JOINT_COUNT; i++) {
        const double angle = joints->angle_rad[i], rate = joints->rate_rad_s[i];
        torque_Nm[i] += end_torque(lowest[i] - angle, -rate, mass_kg);
        torque_Nm[i] -= end_torque(angle - highest[i], rate, mass_kg);
    }
}

void muscles_add_to_body(const double torque_Nm[JOINT_COUNT], enum side side,
                         double force[MULTIBODY_DOF])
{
    double *leg = force + multibody_leg(side);
    force[MULTIBODY_TRUNK] += torque_Nm[JOINT_HIP];
    leg[PART_THIGH] -= torque_Nm[JOINT_HIP] + torque_Nm[JOINT_KNEE];
    leg[PART_SHANK] += torque_Nm[JOINT_KNEE] + torque_Nm[JOINT_ANKLE];
    leg[PART_FOOT] -= torque_Nm[JOINT_ANKLE];
}
