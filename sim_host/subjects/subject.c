#include "sim_host/subjects/subject.h"

#include <math.h>
#include <stdio.h>

#include "sim_host/gait/late_gait.h"

void subject_default(struct subject *subject)
{
    person_default(&subject->person);
    device_file_default(&subject->device);
    subject->actuators.as_built = false;
    subject->is_person = false;
    subject->names_no_device = false;
}

int subject_read(struct subject *subject, const char *person_path, const char *device_path,
                 char *message)
{
    subject_default(subject);
    if (person_path != NULL && person_read(&subject->person, person_path, message) != 0) {
        return -1;
    }
    if (device_path == NULL) {
        subject->names_no_device = person_path != NULL;
        return 0;
    }
    return device_file_read(&subject->device, device_path, message) == 0
               ? actuators_of(&subject->device, device_path, &subject->actuators, message)
               : -1;
}

/* Of the legs that have a drive, the smaller number. */
static double smallest(const struct subject *subject, enum device_leg_key key)
{
    double result = HUGE_VAL;
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        if (device_leg_is_driven(&subject->device.description.leg[leg])) {
            result = fmin(result, device_file_number(&subject->device, (enum side)leg, key));
        }
    }
    return result;
}

double subject_spring_N_per_m(const struct subject *subject)
{
    return smallest(subject, DEVICE_LEG_spring_N_per_m);
}

double subject_stroke_m(const struct subject *subject)
{
    return smallest(subject, DEVICE_LEG_stroke_max_m);
}

double subject_speed_max_m_s(const struct subject *subject)
{
    return smallest(subject, DEVICE_LEG_speed_max_m_s);
}

double subject_force_max_N(const struct subject *subject)
{
    return smallest(subject, DEVICE_LEG_force_max_N);
}

double subject_latch_delay_s(const struct subject *subject)
{
    double sum_s = 0.0;
    int driven = 0;
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        if (device_leg_is_driven(&subject->device.description.leg[leg])) {
            sum_s += device_file_number(&subject->device, (enum side)leg, DEVICE_LEG_latch_delay_s);
            driven++;
        }
    }
    return driven > 0 && !subject->is_person ? sum_s / driven : 0.0;
}

struct gait_walker subject_gait_walker(const struct subject *subject)
{
    const struct person *person = &subject->person;
    return (struct gait_walker){person->torso_mass_kg, person->leg_mass_kg, person->leg_length_m,
                                subject_spring_N_per_m(subject), person->gravity_m_s2};
}

enum gait_curve_error subject_gait(const struct subject *subject, double r0_m,
                                   struct gait_point *gait)
{
    const struct gait_walker walker = subject_gait_walker(subject);
    return late_gait_curve(&walker, subject_latch_delay_s(subject), r0_m, 0.0, 1, gait, NULL);
}
