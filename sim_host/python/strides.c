/* The return map for many walkers: slices of the caller's arrays through the batch engine, on all cores. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "model/stride.h"
#include "sim_host/batch/batch.h"
#include "sim_host/batch/parallel_for.h"
#include "sim_host/python/library.h"

/* Walkers of a slice: full vectors many times over, and few enough that a core keeps them near. */
enum { SLICE_MOST = 1024, SLICE_LEAST = 64, SLICES_PER_THREAD = 16 };

int afo_walker_check(const struct afo_walker *walker, char *text)
{
    const struct walker_params params = {walker->M, walker->m, walker->l, walker->k, walker->g};
    struct walker derived;
    const enum walker_error error = walker_init(&derived, &params);
    if (error != WALKER_OK) {
        snprintf(text, AFO_TEXT, "%s", walker_error_name(error));
        return -1;
    }
    return 0;
}

const char *afo_fault_name(int fault)
{
    return stride_fault_name((enum stride_fault)fault);
}

struct slices {
    const struct afo_walker *walker;
    const struct afo_strides *job;
    size_t size;
};

struct slice {
    struct batch_item items[SLICE_MOST];
    struct batch_slopes slopes[SLICE_MOST];
};

static void load(const struct afo_strides *job, size_t first, size_t count,
                 struct batch_item *items)
{
    memset(items, 0, count * sizeof *items);
    for (size_t i = 0; i < count; i++) {
        memcpy(items[i].apex, &job->x[3 * (first + i)], sizeof items[i].apex);
        items[i].push_m = job->r0[first + i];
        if (job->speed != NULL) {
            items[i].gain_m_s = job->kp;
            items[i].target_speed_rad_s = job->speed[first + i];
        }
    }
}

static void store(const struct afo_strides *job, size_t first, size_t count,
                  const struct slice *slice)
{
    for (size_t i = 0; i < count; i++) {
        const struct batch_item *item = &slice->items[i];
        const size_t at = first + i;
        const int good = item->fault == STRIDE_OK;
        for (size_t c = 0; c < 3; c++) {
            job->next[3 * at + c] = good ? item->apex[c] : (double)NAN;
        }
        if (job->done != NULL) {
            job->done[at] = item->strides;
        }
        if (job->fault != NULL) {
            job->fault[at] = (int8_t)item->fault;
        }
        if (job->by_x != NULL) {
            for (size_t c = 0; c < 9; c++) {
                job->by_x[9 * at + c] = good ? slice->slopes[i].by_apex[c / 3][c % 3] : (double)NAN;
            }
            for (size_t c = 0; c < 3; c++) {
                job->by_r0[3 * at + c] = good ? slice->slopes[i].by_push[c] : (double)NAN;
            }
        }
    }
}

static int run_slice(void *context, size_t number)
{
    const struct slices *slices = context;
    const struct afo_strides *job = slices->job;
    const struct afo_walker *w = slices->walker;
    const size_t first = number * slices->size;
    const size_t left = job->count - first, count = left < slices->size ? left : slices->size;
    const struct batch_walker walker = {w->M, w->m, w->l, w->k, w->g};
    const struct batch_settings settings = {.accuracy = job->accuracy};
    struct slice *slice = malloc(sizeof *slice);
    if (slice == NULL) {
        return BATCH_OUT_OF_MEMORY;
    }
    load(job, first, count, slice->items);
    const struct batch_job batch = {.walkers = &walker,
                                    .walker_count = 1,
                                    .items = slice->items,
                                    .slopes = job->by_x != NULL ? slice->slopes : NULL,
                                    .count = count,
                                    .strides = job->strides};
    const enum batch_error error = batch_run(&settings, &batch);
    if (error == BATCH_OK) {
        store(job, first, count, slice);
    }
    free(slice);
    return error;
}

static size_t slice_size(const struct afo_strides *job)
{
    const size_t share =
        job->count / ((size_t)parallel_for_threads(job->threads) * SLICES_PER_THREAD);
    const size_t rounded = share / SLICE_LEAST * SLICE_LEAST;
    return rounded < SLICE_LEAST ? SLICE_LEAST : rounded > SLICE_MOST ? SLICE_MOST : rounded;
}

int afo_strides_run(const struct afo_walker *walker, const struct afo_strides *job, char *text)
{
    if (afo_walker_check(walker, text) != 0) {
        return -1;
    }
    struct slices slices = {walker, job, slice_size(job)};
    const size_t pieces = (job->count + slices.size - 1) / slices.size;
    const int error = parallel_for(job->threads, pieces, run_slice, &slices);
    if (error != BATCH_OK) {
        snprintf(text, AFO_TEXT, "%s", batch_error_name((enum batch_error)error));
        return -1;
    }
    return 0;
}
