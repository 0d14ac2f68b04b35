/* The cascade of period doublings: from a period-1 gait, each doubling located, the doubled walk born there
 * followed to its own doubling, and so on. */
#ifndef SIM_HOST_STUDY_PAPER_CASCADE_H
#define SIM_HOST_STUDY_PAPER_CASCADE_H

#include "sim_host/study/paper/continuation.h"

#define CASCADE_MAX 10

struct doubling {
    double parameter;
    int new_period;
    double x[3]; /* of the walk that loses stability */
    double residual;
    double
        ratio; /* (previous interval) / (this one); 0 when there are fewer than three doublings */
};

/* Told when a doubling is found. */
typedef void cascade_visitor(void *context, const struct doubling *doubling);

/* From the walk of problem->period at x (parameter `from`) towards `to`. problem must be prepared at
 * `from`. Finds at most `most` (<= CASCADE_MAX) doublings; returns how many. *report tells of the
 * continuation that ended the cascade. */
int cascade_find(const struct problem *problem, enum parameter over, double from, double to,
                 const double x[3], int most, struct doubling *doublings,
                 struct continuation_report *report, cascade_visitor *visit, void *context);

/* The walk of twice the period that is born at a doubling, followed to parameter `to` (between this
 * doubling and the next is where it is stable). 1 found: x receives it. */
int cascade_double_to(const struct problem *problem, enum parameter over,
                      const struct doubling *doubling, double to, double x[3]);

#endif
