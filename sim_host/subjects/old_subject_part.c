/* An old subject file's numbers to a person's and a device's. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "hal/bus/frame_table.h"
#include "sim_host/subjects/old_subject.h"

/* What such files could not say, and was the same for all. */
enum { OLD_DRIVE_ID = 1, OLD_MIT_ANSWER_ID = 0x11 };

static void part_person(const struct old_subject *subject, struct person *person)
{
    *person = subject->prescription;
    snprintf(person->name, sizeof person->name, "%s", subject->name);
    person->torso_mass_kg = subject->torso_mass_kg;
    person->leg_mass_kg = subject->leg_mass_kg;
    person->leg_length_m = subject->leg_length_m;
    person->gravity_m_s2 = subject->gravity_m_s2;
}

/* Limits that were not told were those of the plant's preset. */
static double limit(double told, double by_scale)
{
    return told > 0.0 ? told : by_scale;
}

static void part_leg(const struct old_subject *subject, struct device_file *device, enum side leg)
{
    const double l = subject->leg_length_m, k = subject->spring_N_per_m;
    const double stroke_m = old_subject_stroke_m(subject);
    const bool cia402 = subject->protocol == DEVICE_CIA402;
    const bool latch_in_drive = cia402;
    const struct {
        enum device_leg_key key;
        double number;
    } numbers[] = {
        {DEVICE_LEG_protocol, subject->protocol},
        {DEVICE_LEG_drive_node, OLD_DRIVE_ID + (int)leg},
        {DEVICE_LEG_answer_id, OLD_MIT_ANSWER_ID + (int)leg},
        {DEVICE_LEG_direction, cia402 ? subject->direction : 1.0},
        {DEVICE_LEG_counts_per_m, subject->counts_per_m},
        {DEVICE_LEG_zero_counts, subject->zero_counts},
        {DEVICE_LEG_turns_per_m, subject->turns_per_m},
        {DEVICE_LEG_rad_per_m, subject->rad_per_m},
        {DEVICE_LEG_zero_rad, subject->zero_rad},
        {DEVICE_LEG_position_range_rad, subject->position_range_rad},
        {DEVICE_LEG_velocity_range_rad_s, subject->velocity_range_rad_s},
        {DEVICE_LEG_torque_range_Nm, subject->torque_range_Nm},
        {DEVICE_LEG_kp_Nm_rad, subject->kp_Nm_rad},
        {DEVICE_LEG_kd_Nms_rad, subject->kd_Nms_rad},
        {DEVICE_LEG_rated_force_N, limit(subject->rated_force_N, 0.35 * l * k)},
        {DEVICE_LEG_spring_N_per_m, k},
        {DEVICE_LEG_stroke_max_m, stroke_m},
        {DEVICE_LEG_speed_max_m_s,
         limit(subject->speed_max_m_s, 0.6 * sqrt(subject->gravity_m_s2 * l))},
        {DEVICE_LEG_force_max_N, limit(subject->force_max_N, 2.5 * k * stroke_m)},
        {DEVICE_LEG_latch, latch_in_drive ? DEVICE_LATCH_DRIVE : DEVICE_LATCH_BOARD},
        {DEVICE_LEG_latch_node, NODE_DRIVE_LEFT + (int)leg},
        {DEVICE_LEG_unload, latch_in_drive ? DEVICE_UNLOAD_DRIVE : DEVICE_UNLOAD_NONE},
        {DEVICE_LEG_ankle, subject->ankle},
        {DEVICE_LEG_ankle_lever_m, subject->ankle_lever_m},
        {DEVICE_LEG_ankle_neutral_rad, subject->ankle_neutral_rad},
    };
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++) {
        device_file_set(device, leg, numbers[i].key, numbers[i].number);
    }
}

void old_subject_part(const struct old_subject *subject, struct person *person,
                      struct device_file *device)
{
    part_person(subject, person);
    device_file_default(device);
    snprintf(device->name, sizeof device->name, "%s", subject->name);
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        part_leg(subject, device, (enum side)leg);
    }
}
