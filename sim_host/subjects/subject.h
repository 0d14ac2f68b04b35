/* Whom the device walks: body, spring, actuator limits, transmission, law.
 *
 * One INI file per subject (sim_host/subjects has two). From it come both the
 * controller's parameters and the plant's, separately: the plant never sees the
 * controller's structs.
 */
#ifndef SIM_HOST_SUBJECTS_SUBJECT_H
#define SIM_HOST_SUBJECTS_SUBJECT_H

#include <stdbool.h>
#include <stddef.h>

#include "controller/control_params.h"
#include "sim_host/gait/gait_curve.h"
#include "sim_host/nodes/walker_nodes.h"
#include "sim_host/subjects/actuator_file.h"

enum { SUBJECT_NAME_MAX = 64, SUBJECT_MESSAGE_MAX = 768 };

enum ankle_kind { ANKLE_LINEAR = 0, ANKLE_LEVER = 1 };

/* SI units. The keys of the file are in subject_keys (subject.c), with ranges. */
struct subject {
    char name[SUBJECT_NAME_MAX];
    double torso_mass_kg, leg_mass_kg, leg_length_m, spring_N_per_m, gravity_m_s2;
    double stroke_max_m, speed_max_m_s, force_max_N; /* of the SEA; 0 = by the body's scale */
    double counts_per_m;                             /* motor counts per metre of spring */
    enum ankle_kind ankle;
    double ankle_lever_m, ankle_neutral_rad;
    enum drive_protocol protocol;
    double rated_force_N;          /* CiA 402: at the motor's rated torque; 0 = by the scale */
    double zero_counts, direction; /* CiA 402: count at the unloaded spring; +1 or -1 */
    double turns_per_m;            /* CANSimple: motor turns per metre of spring */
    double rad_per_m, zero_rad;    /* MIT mode: motor angle per metre, at the unloaded spring */
    double position_range_rad, velocity_range_rad_s, torque_range_Nm; /* MIT mode: of the fields */
    double kp_Nm_rad, kd_Nms_rad; /* MIT mode: the drive's position loop */
    bool is_person;               /* a person walks; the compass' gaits need not suit the spring */
    bool as_built;                /* the actuators are these, and not idealised ones */
    struct actuators actuators;   /* as_built; the fields of the SEA above follow from them */
    double control_override[CONTROL_PARAM_COUNT]; /* [controller] section, by parameter */
    bool control_overridden[CONTROL_PARAM_COUNT];
};

/* The paper's walker: the same as sim_host/subjects/paper.ini. */
void subject_default(struct subject *subject);

/* Reads a subject file. M, m, l and k must be given; the SEA's limits that are not
 * follow from the body's scale, the rest from the default. Returns 0, or -1 with file, line, key
 * and what is allowed in message (SUBJECT_MESSAGE_MAX bytes); *subject is then
 * not to be used. */
int subject_read(struct subject *subject, const char *path, char *message);

/* The subject wears these actuators: spring, stroke, speed, force, counts, rated force and lever become
 * theirs (of unlike legs the weaker one's). Returns 0, or -1 with the reason in message: springs that
 * differ by more than 2 %. */
int subject_take_actuators(struct subject *subject, const struct actuators *actuators,
                           char *message);

/* Time there is to load a spring at the highest cadence that is provided for, 130 steps a minute: from
 * the own heel strike to shortly before the other's, s. */
#define SUBJECT_LOAD_S (0.8 * 60.0 / 130.0)

/* Stroke limit of the SEA, m: the file's, or by the body's scale. */
double subject_stroke_m(const struct subject *subject);

/* Force of the spring at the drive's rated torque, N: the file's, or that of the spring
 * at 0.35 leg lengths. */
double subject_rated_force_N(const struct subject *subject);

/* The drives as the virtual nodes are to play them. */
struct walker_drives subject_drives(const struct subject *subject);

/* The subject's body as the study tools know it. */
struct gait_walker subject_gait_walker(const struct subject *subject);

/* The controller's parameters for this subject: gains and limits scaled from the
 * paper's walker (kp with l sqrt(l/g), speeds with sqrt(g/l), lengths with l and
 * the spring's energy), finv computed from the model for this very walker, then
 * the file's overrides. Returns 0, or -1 with the reason in message. */
int subject_control_params(const struct subject *subject, struct control_params *params,
                           char *message);

#endif
