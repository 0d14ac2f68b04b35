/* The results file of the campaign of people: one line a run. */
#include <stdlib.h>

#include "sim_host/faults/people_campaign.h"

void people_result_write(FILE *file, const struct people_result *result)
{
    fprintf(file, "%u %d %d %u %u %u %u %d %u %u %d\n", result->plan.index, result->assisted,
            result->late, result->noticed_tick, result->first_push_tick, result->unsafe_tick,
            result->pushes, (int)result->fault, result->unsafe, result->unsafe_device,
            (int)result->fall);
}

bool people_result_read(const char *line, uint64_t seed, unsigned recordings,
                        struct people_result *result)
{
    enum { FIELDS = 11 }; /* as people_result_write has them */
    long long field[FIELDS];
    for (int i = 0; i < FIELDS; i++) {
        char *end;
        field[i] = strtoll(line, &end, 10);
        if (end == line || field[i] < 0 || field[i] > (long long)UINT32_MAX) {
            return false;
        }
        line = end;
    }
    if (*line != '\n' || field[10] >= PEOPLE_FALLS) {
        return false;
    }
    *result = (struct people_result){.assisted = field[1] != 0,
                                     .late = field[2] != 0,
                                     .noticed_tick = (uint32_t)field[3],
                                     .first_push_tick = (uint32_t)field[4],
                                     .unsafe_tick = (uint32_t)field[5],
                                     .pushes = (unsigned)field[6],
                                     .fault = (enum supervisor_fault)field[7],
                                     .unsafe = (unsigned)field[8],
                                     .unsafe_device = (unsigned)field[9],
                                     .fall = (enum people_fall)field[10]};
    people_plan(seed, (uint32_t)field[0], recordings, &result->plan);
    return true;
}
