/* Subject files as they were: one file with body, spring, actuator and prescription. `afo device convert`
 * parts one into a person and a device.
 */
#ifndef SIM_HOST_SUBJECTS_OLD_SUBJECT_H
#define SIM_HOST_SUBJECTS_OLD_SUBJECT_H

#include "sim_host/devices/device_file.h"
#include "sim_host/persons/person.h"

enum { OLD_SUBJECT_MESSAGE_MAX = 768 };

/* SI units. The keys of the file are in old_keys (old_subject.c), with ranges. */
struct old_subject {
    char name[PERSON_NAME_MAX];
    double torso_mass_kg, leg_mass_kg, leg_length_m, spring_N_per_m, gravity_m_s2;
    double stroke_max_m, speed_max_m_s, force_max_N; /* of the actuator; 0 = by the body's scale */
    double counts_per_m;                             /* motor counts per metre of spring */
    enum device_ankle ankle;
    double ankle_lever_m, ankle_neutral_rad;
    enum device_protocol protocol;
    double rated_force_N; /* at the motor's rated torque; 0 = by the scale */
    double zero_counts, direction;
    double turns_per_m;
    double rad_per_m, zero_rad;
    double position_range_rad, velocity_range_rad_s, torque_range_Nm;
    double kp_Nm_rad, kd_Nms_rad;
    struct person prescription; /* of it only what [controller] says */
};

/* Reads a subject file. M, m, l and k must be given. Returns 0, or -1 with file, line, key and what is
 * allowed in message (OLD_SUBJECT_MESSAGE_MAX bytes). */
int old_subject_read(struct old_subject *subject, const char *path, char *message);

/* Stroke limit of the actuator, m: the file's, or by the body's scale. */
double old_subject_stroke_m(const struct old_subject *subject);

/* The person and the device that such a file described. What it left to the body's scale is written as numbers. */
void old_subject_part(const struct old_subject *subject, struct person *person,
                      struct device_file *device);

#endif
