#include "sim_host/study/paper/basin_walks.h"

#include <stdlib.h>
#include <string.h>

#include "sim_host/study/batch_adapter.h"

struct walks {
    const struct basin_start *starts;
    struct basin_end *ends;
    int strides;
};

static int is_there(const struct basin_start *start, const double x[3])
{
    int near = 1;
    for (int k = 0; k < 3; k++) {
        near = near && real_abs(x[k] - start->gait[k]) < BASIN_NEAR;
    }
    return near;
}

static int end_walk(void *context, size_t index, struct batch_item *item,
                    const struct batch_slopes *slopes)
{
    struct walks *walks = context;
    const struct basin_start *start = &walks->starts[index];
    struct basin_end *end = &walks->ends[index];
    (void)slopes;
    end->strides = (int)item->strides;
    if (item->fault != 0) {
        end->outcome = BASIN_FALLS;
        end->fault = (enum stride_fault)item->fault;
        return 1;
    }
    if (end->strides < walks->strides && is_there(start, item->apex)) {
        end->outcome = BASIN_CONVERGES;
        return 1;
    }
    batch_adapter_push(start->problem, item);
    return 0;
}

int basin_walks(const struct basin_start *starts, size_t count, int strides, struct basin_end *ends)
{
    struct batch_item *items = calloc(count, sizeof *items);
    if (items == NULL) {
        return -1;
    }
    struct walks walks = {starts, ends, strides};
    for (size_t i = 0; i < count; i++) {
        ends[i] = (struct basin_end){.outcome = BASIN_WALKS_ON};
        memcpy(items[i].apex, starts[i].x, sizeof items[i].apex);
        batch_adapter_push(starts[i].problem, &items[i]);
        if (is_there(&starts[i], starts[i].x)) {
            ends[i].outcome = BASIN_CONVERGES;
            items[i].fault = BATCH_ADAPTER_SKIP;
        }
    }
    const struct batch_walker walker = batch_adapter_walker(&starts[0].problem->params);
    const struct batch_settings settings = {.accuracy = BATCH_ADAPTER_ACCURACY};
    const struct batch_job job = {.walkers = &walker,
                                  .walker_count = 1,
                                  .items = items,
                                  .count = count,
                                  .strides = strides,
                                  .stride_done = end_walk,
                                  .context = &walks};
    const enum batch_error error = batch_run(&settings, &job);
    for (size_t i = 0; i < count; i++) {
        if (ends[i].outcome == BASIN_WALKS_ON) {
            ends[i].strides = strides;
        }
    }
    free(items);
    return error == BATCH_OK ? 0 : -1;
}
