/* Prints what a campaign found: a table with a row for each kind of fault, and single runs in words. */
#ifndef SIM_HOST_FAULTS_SUMMARY_H
#define SIM_HOST_FAULTS_SUMMARY_H

#include <stdio.h>

#include "sim_host/faults/campaign.h"

/* One row a class (single faults), one for pairs, one for all; then every unsafe or
 * late run. Returns how many runs were unsafe or late. Sorts in memory of its own. */
unsigned summary_table(FILE *stream, const struct campaign_result *results, uint32_t count,
                       bool markdown);

/* Prints one run in words. */
void summary_tell(FILE *stream, const struct campaign_result *result);

#endif
