/* afo study dose: what a push-off does to a person who walks by reflexes, over its dose and its delay, in pairs with the
 * same walk without the device. */
#ifndef SIM_HOST_STUDY_DOSE_DOSE_STUDY_H
#define SIM_HOST_STUDY_DOSE_DOSE_STUDY_H

#include <stdio.h>

#include "sim_host/study/dose/dose_trial.h"

enum { DOSE_PERSONS_MAX = 8, DOSE_VALUES_MAX = 16, DOSE_SEEDS_MAX = 20 };

struct dose_study {
    const char *person[DOSE_PERSONS_MAX], *device;
    double r0_m[DOSE_VALUES_MAX], late_s[DOSE_VALUES_MAX];
    uint32_t persons, r0s, lates, seeds, steps, jobs;
    double push_step_N;
    const char *out, *csv_path;
    bool json, markdown;
    int argc;
    char **argv;
    struct dose_result *result; /* of every walk */
};

/* Walks go by person, seed, and in each: without the device, then by delay and r0. */
uint32_t dose_study_walks(const struct dose_study *study);
/* The first walk's number of a person's seed: that without the device. */
uint32_t dose_study_number(const struct dose_study *study, uint32_t person, uint32_t seed);
void dose_study_trial(const struct dose_study *study, uint32_t index, struct dose_trial *trial);
const struct dose_result *dose_study_alone(const struct dose_study *study, uint32_t person,
                                           uint32_t seed);
const struct dose_result *dose_study_with(const struct dose_study *study, uint32_t person,
                                          uint32_t seed, uint32_t late, uint32_t r0);

/* A line a walk; what it was stands in the first columns. */
void dose_report_csv(FILE *stream, const struct dose_study *study);
void dose_report_json(FILE *stream, const struct dose_study *study);
/* Sentences, a paragraph a person and delay. Each tells what this model does, and what the seeds' spread is. */
void dose_report_text(FILE *stream, const struct dose_study *study);
/* The same as two tables: a line a person, delay and dose, and how far the push margin holds. */
void dose_report_markdown(FILE *stream, const struct dose_study *study);
/* The table of the picture: a line a person, seed and delay, over r0; at r0 = 0 the walk without the device. */
void dose_report_plot(FILE *stream, const struct dose_study *study);

/* afo study dose. */
int dose_main(int argc, char **argv);

#endif
