/* The controller's laws (float) on the double return map: what a comparison of laws runs on.
 *
 * A setup is a law with the parameters of the walker that it believes in, and the walker that truly walks. A walk
 * is plain data. Threads may share a setup, but not a walk.
 */
#ifndef SIM_HOST_STUDY_LAWS_SETUP_H
#define SIM_HOST_STUDY_LAWS_SETUP_H

#include "controller/laws/step_law.h"
#include "sim_host/batch/batch.h"
#include "sim_host/study/map/laws_map.h"
#include "sim_host/subjects/subject.h"

/* The terrain speed of the predictive law in these studies, rad/s on a leg of 1 m. Its gait survives footholds
 * within 10 mm. A subject's own parameters allow for nothing of the kind unless its file says so. */
#define LAWS_TERRAIN_SPEED 0.8

struct law_setup {
    struct control_params params; /* the law's */
    struct gait_walker truth;     /* the map's */
    enum laws_accuracy accuracy;
};

struct laws_walk {
    struct step_law law;
    double apex[3]; /* true state: stance rate, swing angle, swing rate */
    double r0_m;    /* of the last push-off */
    struct laws_stride stride;
    int steps;
};

/* The law's parameters for a subject; the truth is the subject's own body. Jumps of the command are not
 * ramped, and on uneven ground the predictive law may want LAWS_TERRAIN_SPEED. Returns 0, or -1 with the reason in message (SUBJECT_MESSAGE_MAX). */
int law_setup_init(struct law_setup *setup, const struct subject *subject, enum law_mode law,
                   char *message);

/* A steady gait as the law knows it: its apex state; returns its r0. */
double law_setup_gait(const struct law_setup *setup, double speed_rad_s, double apex[3]);

/* A walk from an apex state, the law having commanded r0_m and speed_rad_s so far. */
void laws_walk_start(const struct law_setup *setup, struct laws_walk *walk, const double apex[3],
                     double r0_m, double speed_rad_s);

/* The law's next push-off, m, when it sees seen[3]. */
double laws_walk_answer(const struct law_setup *setup, struct laws_walk *walk, double desired_rad_s,
                        const double seen[3]);

/* One stride: the law sees seen[3] (NULL: the true apex) and answers, the map walks. Returns the fault. */
int laws_walk_step(const struct law_setup *setup, struct laws_walk *walk, double desired_rad_s,
                   const double seen[3], double slope_rad, double rise);

/* The same walker for the batch engine. */
struct batch_walker laws_batch_walker(const struct gait_walker *walker);

#endif
