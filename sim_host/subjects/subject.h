/* Who walks with what: a person with a device on.
 *
 * Persons and devices have a file each (sim_host/persons, sim_host/devices). From both come the
 * controller's parameters and the plant's, separately: the plant never sees the controller's structs.
 */
#ifndef SIM_HOST_SUBJECTS_SUBJECT_H
#define SIM_HOST_SUBJECTS_SUBJECT_H

#include <stdbool.h>
#include <stddef.h>

#include "controller/control_params.h"
#include "sim_host/devices/device_file.h"
#include "sim_host/gait/gait_curve.h"
#include "sim_host/nodes/walker_nodes.h"
#include "sim_host/persons/person.h"
#include "sim_host/subjects/actuators.h"

enum { SUBJECT_MESSAGE_MAX = 768 };

struct subject {
    struct person person;
    struct device_file device;
    struct actuators actuators; /* of the plant: by the device's [plant] sections, or idealised */
    bool is_person;             /* a person walks; the compass' gaits need not suit the spring */
    bool names_no_device; /* a person file came without a device: the default one is the paper's */
};

/* Time there is to load a spring at the highest cadence that is provided for, 130 steps a minute: from
 * the own heel strike to shortly before the other's, s. */
#define SUBJECT_LOAD_S (0.8 * 60.0 / 130.0)

/* The paper's walker with virtual drives. */
void subject_default(struct subject *subject);

/* Reads a person's file and a device's; NULL stands for the default one. Returns 0, or -1 with the reason in
 * message (SUBJECT_MESSAGE_MAX bytes); *subject is then not to be used. */
int subject_read(struct subject *subject, const char *person_path, const char *device_path,
                 char *message);

/* Of the device, what the law knows one number of: the spring, N/m, of a leg that has one; and the smaller
 * limit of both legs: stroke, m; speed, m/s; force, N. */
double subject_spring_N_per_m(const struct subject *subject);
double subject_stroke_m(const struct subject *subject);
double subject_speed_max_m_s(const struct subject *subject);
double subject_force_max_N(const struct subject *subject);

/* What the laws allow for of the latches' delay, s: the mean of the legs'. 0 for a person: their law knows no
 * compass' gaits, and gives the prescribed precompression whatever a late latch takes of its work. */
double subject_latch_delay_s(const struct subject *subject);

/* The drives as the virtual nodes are to play them. */
struct walker_drives subject_drives(const struct subject *subject);

/* The subject's body and spring as the study tools know them. */
struct gait_walker subject_gait_walker(const struct subject *subject);

/* Its steady gait at a precompression, the latches as late as they are declared. */
enum gait_curve_error subject_gait(const struct subject *subject, double r0_m,
                                   struct gait_point *gait);

/* The controller's parameters for this subject: gains and limits scaled from the
 * paper's walker (kp with l sqrt(l/g), speeds with sqrt(g/l), lengths with l and
 * the spring's energy), finv computed from the model for this very walker, then
 * the person's prescription. A device without a latch that reports CLOSED is refused for a person
 * (body = 1). Returns 0, or -1 with the reason in message, which proposes a device where none was named. */
int subject_control_params(const struct subject *subject, struct control_params *params,
                           char *message);

#endif
