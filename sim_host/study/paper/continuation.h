/* Following a family of periodic walks in one parameter, through folds, by pseudo-arclength.
 *
 * Unknowns are the apex state and the parameter, in scaled units; each point is corrected by Newton on
 * (periodicity, distance along the tangent). Folds (the parameter turns back) and period doublings (an
 * eigenvalue passes -1) between two points are located by a secant along the branch.
 */
#ifndef SIM_HOST_STUDY_PAPER_CONTINUATION_H
#define SIM_HOST_STUDY_PAPER_CONTINUATION_H

#include "sim_host/gait/orbit.h"

enum continuation_event { EVENT_NONE = 0, EVENT_FOLD = 1, EVENT_DOUBLING = 2 };

enum continuation_end {
    END_REACHED = 0,  /* the far end of the parameter's range */
    END_RETURNED = 1, /* turned at a fold and came back to the near end */
    END_STOPPED = 2,  /* the visitor said so */
    END_LOST = 3,     /* no further walk found: the last point's neighbourhood says why */
    END_TOO_LONG = 4  /* the limit on the number of points */
};

struct branch_point {
    double parameter;
    struct orbit orbit; /* evaluated with derivatives */
    struct eigenvalue values[3];
    double tangent[LINEAR_MAX];      /* along the branch, scaled, last entry the parameter's */
    double fold_test, doubling_test; /* change sign at the events */
    enum continuation_event event;
};

struct continuation {
    struct problem
        problem; /* prepared; its varied parameter is overwritten as the branch is followed */
    enum parameter over;
    double from, to;
    double slack; /* how far behind `from` is not yet a return: rounding at a birth */
    double first_step,
        longest_step; /* arclength in units where to - from is 1, rates in sqrt(g/l) */
    int most_points;
    int locate_events;
};

/* Told of each point in order, located events included. Return 0 to stop. */
typedef int branch_visitor(void *context, const struct branch_point *point);

/* Why it ended, for END_LOST. */
struct continuation_report {
    enum continuation_end end;
    enum orbit_status last_status; /* of the last correction that failed */
    enum stride_fault last_fault;
    double parameter; /* of the last good point */
    int points;
};

/* Follows from a walk near start->x at parameter `from` towards `to`. start_tangent (may be NULL) gives
 * the first direction, scaled like branch_point.tangent; else the one in which the parameter moves
 * towards `to`. */
struct continuation_report continuation_follow(const struct continuation *continuation,
                                               const double start_x[3], const double *start_tangent,
                                               branch_visitor *visit, void *context);

const char *continuation_end_name(enum continuation_end end);

#endif
