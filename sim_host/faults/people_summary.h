/* Prints what a campaign of people found: a table by fault, the unsafe runs by cause, and single runs. */
#ifndef SIM_HOST_FAULTS_PEOPLE_SUMMARY_H
#define SIM_HOST_FAULTS_PEOPLE_SUMMARY_H

#include <stdio.h>

#include "sim_host/faults/people_campaign.h"

/* A row a fault (single faults), one for pairs, one for all; how many runs were unsafe by each criterion; then
 * every unsafe or late run. Returns how many runs were unsafe or late, those that are loaded behind a closed
 * latch and nothing else not among them. */
unsigned people_summary(FILE *stream, const struct people_campaign *campaign,
                        const struct people_result *results, uint32_t count, bool markdown);

/* Prints one run in words. */
void people_summary_tell(FILE *stream, const struct people_campaign *campaign,
                         const struct people_result *result);

#endif
