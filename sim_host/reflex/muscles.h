/* The seven muscles of a leg, where they pull, and the joints' soft ends; after Geyer & Herr (2010).
 *
 * Joint angles are theirs: a straight knee is pi, a hip with the thigh in line with the trunk is pi, an ankle with the
 * foot square to the shank is pi / 2; flexion (at the ankle: dorsiflexion) makes each smaller.
 */
#ifndef SIM_HOST_REFLEX_MUSCLES_H
#define SIM_HOST_REFLEX_MUSCLES_H

#include "sim_host/reflex/multibody.h"
#include "sim_host/reflex/muscle.h"

enum joint { JOINT_HIP = 0, JOINT_KNEE = 1, JOINT_ANKLE = 2, JOINT_COUNT = 3 };

enum muscle_id {
    MUSCLE_SOL = 0, /* soleus */
    MUSCLE_TA = 1,  /* tibialis anterior */
    MUSCLE_GAS = 2, /* gastrocnemius */
    MUSCLE_VAS = 3, /* vasti */
    MUSCLE_HAM = 4, /* hamstrings */
    MUSCLE_GLU = 5, /* glutei */
    MUSCLE_HFL = 6, /* hip flexors */
    MUSCLE_COUNT = 7
};

struct joint_angles {
    double angle_rad[JOINT_COUNT], rate_rad_s[JOINT_COUNT];
};

/* Their muscles at full strength, for a person of 80 kg: forces grow with the mass, lengths with the leg. */
void muscles_default(double mass_kg, double leg_m, struct muscle muscle[MUSCLE_COUNT]);

void muscles_joint_angles(const struct multibody_state *state, enum side side,
                          struct joint_angles *joints);

/* Where a leg's muscles pass its joints, at these angles: worked out once, for all that is asked of them. */
enum { MUSCLE_PASSES = 9 };
struct muscle_passes {
    double way[MUSCLE_PASSES]; /* how far round the joint from the reference, by its arm */
    double arm[MUSCLE_PASSES]; /* a share of the largest */
};
void muscles_pass(const struct joint_angles *joints, struct muscle_passes *passes);

/* Length of muscle and tendon together, m. leg_scale: the leg's length by theirs (1 m). */
double muscles_total_m(const struct muscle *muscle, enum muscle_id id, double leg_scale,
                       const struct muscle_passes *passes);

/* Adds the torque (N m, positive extends) that a muscle pulling with force_N makes at every joint. */
void muscles_add_torque(enum muscle_id id, double leg_scale, const struct muscle_passes *passes,
                        double force_N, double torque_Nm[JOINT_COUNT]);

/* Adds the soft ends of the joints' ranges: ankle 70 to 130 degrees, knee to 175, hip to 230. mass_kg: the body's. */
void muscles_add_joint_ends(const struct joint_angles *joints, double mass_kg,
                            double torque_Nm[JOINT_COUNT]);

/* What joint torques do to the body's coordinates. */
void muscles_add_to_body(const double torque_Nm[JOINT_COUNT], enum side side,
                         double force[MULTIBODY_DOF]);

#endif
