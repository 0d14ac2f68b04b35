/* The results file of a campaign: one line a run. */
#include <stdlib.h>

#include "sim_host/faults/campaign.h"

void campaign_write(FILE *file, const struct campaign_result *result)
{
    fprintf(file, "%u %d %d %u %u %u %u %d %d %u\n", result->plan.index, result->effective,
            result->late, result->effect_tick, result->noticed_tick, result->unloaded_tick,
            result->unsafe_tick, (int)result->fault, (int)result->walk_fault, result->unsafe);
}

bool campaign_read(const char *line, uint64_t seed, struct campaign_result *result)
{
    enum { FIELDS = 10 }; /* as campaign_write has them */
    long long field[FIELDS];
    for (int i = 0; i < FIELDS; i++) {
        char *end;
        field[i] = strtoll(line, &end, 10);
        if (end == line || field[i] < INT32_MIN || field[i] > (long long)UINT32_MAX) {
            return false;
        }
        line = end;
    }
    if (*line != '\n') {
        return false;
    }
    *result = (struct campaign_result){.effective = field[1] != 0,
                                       .late = field[2] != 0,
                                       .effect_tick = (uint32_t)field[3],
                                       .noticed_tick = (uint32_t)field[4],
                                       .unloaded_tick = (uint32_t)field[5],
                                       .unsafe_tick = (uint32_t)field[6],
                                       .fault = (enum supervisor_fault)field[7],
                                       .walk_fault = (enum walk_fault)field[8],
                                       .unsafe = (unsigned)field[9]};
    campaign_plan(seed, (uint32_t)field[0], &result->plan);
    return true;
}
