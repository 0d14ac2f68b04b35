#include "sim_host/study/laws/walks.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "sim_host/batch/batch.h"
#include "sim_host/batch/parallel_for.h"

enum { PIECE = 64 };

struct walks {
    struct laws_course *courses;
    struct batch_item *items;
    size_t count;
    int strides;
    laws_look *look;
    laws_assess *assess;
    void *context;
};

/* The law's answer to what lies ahead goes into the item. */
static void answer(const struct walks *walks, size_t i)
{
    struct laws_course *course = &walks->courses[i];
    struct laws_walk *walk = &course->walk;
    struct batch_item *item = &walks->items[i];
    struct laws_ahead ahead = {.seen = {walk->apex[0], walk->apex[1], walk->apex[2]}};
    walks->look(walks->context, i, &ahead);
    item->push_m = laws_walk_answer(course->setup, walk, ahead.desired_rad_s, ahead.seen);
    item->slope_rad = ahead.slope_rad;
    item->height_rise = ahead.rise;
}

static int stride_done(void *context, size_t i, struct batch_item *item,
                       const struct batch_slopes *slopes)
{
    const struct walks *walks = (const struct walks *)context;
    struct laws_walk *walk = &walks->courses[i].walk;
    (void)slopes;
    walk->stride =
        (struct laws_stride){.fault = item->fault,
                             .next = {item->apex[0], item->apex[1], item->apex[2]},
                             .apex_to_strike_s = item->times_s[0],
                             .lift_off_to_apex_s = item->times_s[2],
                             .step_length_m = item->step_length_m,
                             .after_collision = {item->inter_leg_rad, item->ankle_rate_m_s}};
    memcpy(walk->apex, item->apex, sizeof walk->apex);
    if (walks->assess(walks->context, i, walk) != 0 || item->fault != 0 ||
        item->strides >= walks->strides) {
        return 1;
    }
    answer(walks, i);
    return 0;
}

static int first_answers(void *context, size_t piece)
{
    const struct walks *walks = (const struct walks *)context;
    const size_t first = piece * PIECE;
    for (size_t i = first; i < first + PIECE && i < walks->count; i++) {
        memcpy(walks->items[i].apex, walks->courses[i].walk.apex, sizeof walks->items[i].apex);
        walks->items[i].walker = (uint32_t)i;
        answer(walks, i);
    }
    return 0;
}

static enum batch_error run(struct walks *walks, struct batch_walker *walkers, int threads)
{
    const struct batch_settings settings = {0};
    const struct batch_job job = {.walkers = walkers,
                                  .walker_count = (uint32_t)walks->count,
                                  .items = walks->items,
                                  .count = walks->count,
                                  .strides = walks->strides,
                                  .stride_done = stride_done,
                                  .context = walks};
    for (size_t i = 0; i < walks->count; i++) {
        walkers[i] = laws_batch_walker(&walks->courses[i].setup->truth);
    }
    (void)parallel_for(threads, (walks->count + PIECE - 1) / PIECE, first_answers, walks);
    return batch_run_threads(&settings, &job, threads);
}

int laws_walks_run(struct laws_course *courses, size_t count, int strides, laws_look *look,
                   laws_assess *assess, void *context, int threads)
{
    struct walks walks = {.courses = courses,
                          .items = calloc(count, sizeof *walks.items),
                          .count = count,
                          .strides = strides,
                          .look = look,
                          .assess = assess,
                          .context = context};
    struct batch_walker *walkers = calloc(count, sizeof *walkers);
    const enum batch_error error = walks.items == NULL || walkers == NULL
                                       ? BATCH_OUT_OF_MEMORY
                                       : run(&walks, walkers, threads);
    if (error != BATCH_OK) {
        fprintf(stderr, "afo study laws: %s\n", batch_error_name(error));
    }
    free(walks.items);
    free(walkers);
    return error == BATCH_OK ? 0 : -1;
}
