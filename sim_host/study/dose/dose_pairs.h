/* The pairs of a dose: the same person and seed with the device and without it. */
#ifndef SIM_HOST_STUDY_DOSE_DOSE_PAIRS_H
#define SIM_HOST_STUDY_DOSE_DOSE_PAIRS_H

#include "sim_host/study/dose/dose_study.h"

/* Means and extremes are of the pairs in which neither fell. */
struct dose_pairs {
    uint32_t count, fell, fell_alone;   /* fell: with the device */
    uint32_t fell_worn_only;            /* with the device only */
    uint32_t earliest;                  /* steps before the first fall with the device */
    struct dose_result with, alone;     /* means */
    double least_percent, most_percent; /* change of ankle work */
    double
        least_margin_share; /* push margin, by that without the device; HUGE_VAL: none was asked for */
};

void dose_pair_up(const struct dose_study *study, uint32_t person, uint32_t late, uint32_t r0,
                  struct dose_pairs *pairs);

/* Change of a measure, in percent. */
double dose_percent(double now, double before);

/* The largest r0 up to which, in every pair, whoever walks without the device walks with it, and keeps at least half of
 * the push margin; m. 0: already the smallest takes more. */
double dose_margin_holds_m(const struct dose_study *study, uint32_t person, uint32_t late);

#endif
