/* What a person is tuned for, as one number; lower is better.
 *
 * A walk that ends in a fall costs 100, and up to 100 more the earlier it ends. Of any other walk the sum is taken over
 * objective_terms of  weight (d / unit)^2,  d being how far a measure lies outside its band; it costs
 * sum / (1 + sum / 100), which stays below a fall's. The value is the mean over some walks, each with its own seed of
 * noise and with pushes at the hip.
 * The bands of the joints are single marks of the curves, rounded from Perry & Burnfield (2010), Gait Analysis, ch. 3-6.
 */
#ifndef SIM_HOST_STUDY_PERSON_OBJECTIVE_H
#define SIM_HOST_STUDY_PERSON_OBJECTIVE_H

#include "sim_host/study/person/gait_measure.h"

#define OBJECTIVE_FALL 100.0

struct objective_term {
    const char *name, *unit_text;
    double low, high; /* the band */
    double unit, weight;
    double (*measure)(const struct gait_summary *summary, enum side side);
    bool of_a_leg; /* the mean of both legs' costs */
};

enum { OBJECTIVE_TERMS = 14 };
extern const struct objective_term objective_terms[OBJECTIVE_TERMS];

/* Of one walk that was to last until_s. */
double objective_of(const struct gait_summary *summary, double until_s);

/* The share that a term has in it. */
double objective_share(const struct objective_term *term, const struct gait_summary *summary);

#endif
