/* The tuning of a person who walks by reflexes: gains and start by CMA-ES (cma_es.h) for the objective (objective.h).
 *
 * Every generation has its own seeds of noise, which all of its persons walk with, so that none is chosen for being
 * lucky with one. The result is the search's mean, and not the best of all tries, which was the luckiest one.
 * The state is a text file, written whole behind every generation; from it the tuning goes on with the same bits.
 */
#ifndef SIM_HOST_STUDY_PERSON_TUNING_H
#define SIM_HOST_STUDY_PERSON_TUNING_H

#include "sim_host/study/person/cma_es.h"
#include "sim_host/study/person/person_walk.h"

enum { TUNING_NUMBERS = REFLEX_GAIN_COUNT + 2, TUNING_WALKS_MOST = 8 };

struct tuning_plan {
    struct subject subject; /* whose person it begins with */
    bool worn;
    double r0_m; /* with worn */
    uint64_t seed;
    int generations; /* in all, those of the file among them */
    int walks;       /* for each person, 1 .. TUNING_WALKS_MOST */
    double walk_s;
    double noise_share, push_m_s;
    double sigma;           /* of the first steps, as a share of each number */
    double step_s;          /* of the muscles */
    int jobs;               /* threads; no result depends on them */
    const char *state_path; /* or NULL */
};

struct tuning {
    struct tuning_plan plan;
    struct cma_es search;
    double scale[TUNING_NUMBERS]; /* what 1 of the search is in each number */
};

/* Begins, or goes on from the state file where there is one. Returns 0, or -1 with the reason in message
 * (LOOP_MESSAGE_MAX bytes): a file that is none, or of another plan. */
int tuning_begin(struct tuning *tuning, const struct tuning_plan *plan, char *message);

/* One generation. *mean_value and *best_value are its tries'. Returns 0, or -1 with the reason in message. */
int tuning_generation(struct tuning *tuning, double *mean_value, double *best_value, char *message);

/* The objective of the search's mean, over `walks` walks whose seeds no generation had. Returns 0 or -1. */
int tuning_value(const struct tuning *tuning, int walks, double *value, char *message);

/* The person with the search's mean. */
void tuning_person(const struct tuning *tuning, struct person *person);

#endif
