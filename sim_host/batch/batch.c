#include "sim_host/batch/batch.h"

#include <stdlib.h>
#include <string.h>

#include "model/stride.h"
#include "model/trig.h"
#include "sim_host/batch/choice_internal.h"
#include "sim_host/batch/parallel_for.h"

/* A walker in its own units, and the way back. */
struct prepared {
    double mass_ratio, stiffness, length_m, time_s;
};

/* Which items are in the block, and where the run stands. */
struct run {
    const struct batch_job *job;
    const struct prepared *walkers;
    struct block_precision precision;
    struct block block;
    size_t item[BATCH_BLOCK];
    size_t next, end; /* first item not yet taken; one past the last of this run's */
};

static int prepare(const struct batch_walker *from, struct prepared *to)
{
    const struct walker_params params = {from->hip_mass_kg, from->leg_mass_kg, from->leg_length_m,
                                         from->ankle_stiffness_N_m, from->gravity_m_s2};
    struct walker walker;
    if (walker_init(&walker, &params) != WALKER_OK) {
        return 0;
    }
    to->mass_ratio = params.leg_mass_kg / params.hip_mass_kg;
    to->stiffness = params.ankle_stiffness_N_m * params.leg_length_m /
                    (params.hip_mass_kg * params.gravity_m_s2);
    to->length_m = params.leg_length_m;
    to->time_s = walker.time_unit_s;
    return 1;
}

/* The push-off of the next stride, m. */
static double push_of(const struct batch_item *item)
{
    if (item->gain_m_s == 0.0) {
        return item->push_m;
    }
    const double push = item->push_m + item->gain_m_s * (-item->apex[0] - item->target_speed_rad_s);
    return push < 0.0 ? 0.0 : push;
}

/* The fault that an item has before its next stride. */
static int start_fault(const struct run *run, const struct batch_item *item, double push)
{
    const int is_level = item->slope_rad == 0.0 && item->height_rise == 0.0;
    const int level_only = run->precision.want_slopes || run->precision.from_strike;
    if (!real_is_finite(item->apex[0]) || !real_is_finite(item->apex[1]) ||
        !real_is_finite(item->apex[2]) || !real_is_finite(push) || push < 0.0 ||
        !(real_abs(item->slope_rad) < REAL_HALF_PI) || !real_is_finite(item->height_rise) ||
        (level_only && !is_level)) {
        return STRIDE_BAD_INPUT;
    }
    if (run->precision.from_strike) {
        const int apart = item->apex[1] > 0.0 && item->apex[1] < REAL_HALF_PI;
        return apart && !run->precision.want_slopes ? STRIDE_OK : STRIDE_BAD_INPUT;
    }
    if (item->apex[0] >= 0.0) {
        return STRIDE_WALKING_BACKWARDS;
    }
    return real_abs(item->apex[1]) > REAL_PI ? STRIDE_INTER_LEG_ANGLE : STRIDE_OK;
}

/* Writes an item's next stride into a slot: its start, or the fault it has already. */
static void load(struct run *run, int slot)
{
    struct block *b = &run->block;
    const struct batch_item *item = &run->job->items[run->item[slot]];
    const struct prepared *w = &run->walkers[item->walker];
    const double push = push_of(item);
    b->mass_ratio[slot] = w->mass_ratio;
    b->stiffness[slot] = w->stiffness;
    b->push[slot] = push / w->length_m;
    b->state[COLUMN_TS][slot] = run->precision.from_strike ? -item->apex[1] : 0.0;
    b->state[COLUMN_WS][slot] = item->apex[0] * w->time_s;
    b->state[COLUMN_TN][slot] = item->apex[1];
    b->state[COLUMN_WN][slot] = item->apex[2] * w->time_s;
    b->time[0][slot] = b->time[1][slot] = b->time[2][slot] = 0.0;
    b->step[slot] = b->ankle_rate[slot] = b->opening[slot] = 0.0;
    b->clamped[slot] = b->series[slot] = 0;

    b->slope_rad[slot] = item->slope_rad;
    b->rise[slot] = item->height_rise * (item->slope_rad == 0.0 ? 1.0 : real_cos(item->slope_rad));
    const int is_level = item->slope_rad == 0.0 && item->height_rise == 0.0;
    run->precision.has_ground |= !is_level;

    b->fault[slot] = start_fault(run, item, push);
    if (run->precision.want_slopes) {
        for (int d = 0; d < BATCH_DIRECTIONS; d++) {
            for (int c = 0; c < COLUMN_COUNT; c++) {
                b->slope[d][c][slot] = 0.0;
            }
        }
        b->slope[0][COLUMN_WS][slot] = b->slope[1][COLUMN_TN][slot] = b->slope[2][COLUMN_WN][slot] =
            1.0;
    }
}

/* Back to SI units: a rate is 1/time_s, an angle 1, r0 length_m. */
static void store_slopes(const struct run *run, int slot, struct batch_slopes *slopes)
{
    static const int column[3] = {COLUMN_WS, COLUMN_TN, COLUMN_WN};
    const struct batch_item *item = &run->job->items[run->item[slot]];
    const struct prepared *w = &run->walkers[item->walker];
    const double unit[3] = {1.0 / w->time_s, 1.0, 1.0 / w->time_s};
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            slopes->by_apex[i][j] = run->block.slope[j][column[i]][slot] * unit[i] / unit[j];
        }
        slopes->by_push[i] = run->block.slope[3][column[i]][slot] * unit[i] / w->length_m;
    }
}

static void store(const struct run *run, int slot, struct batch_item *item)
{
    const struct block *b = &run->block;
    const struct prepared *w = &run->walkers[item->walker];
    item->fault = (int32_t)b->fault[slot];
    if (item->fault == STRIDE_OK) {
        item->apex[0] = b->state[COLUMN_WS][slot] / w->time_s;
        item->apex[1] = b->state[COLUMN_TN][slot];
        item->apex[2] = b->state[COLUMN_WN][slot] / w->time_s;
        item->strides++;
    }
    for (int i = 0; i < 3; i++) {
        item->times_s[i] = b->time[i][slot] * w->time_s;
    }
    item->step_length_m = b->step[slot] * w->length_m;
    item->inter_leg_rad = b->opening[slot];
    item->ankle_rate_m_s = b->ankle_rate[slot] * w->length_m / w->time_s;
    item->clamped = (int32_t)b->clamped[slot];
    item->series = (int32_t)b->series[slot];
}

/* Takes over a slot's stride; 0 when its item is done. */
static int finish_stride(struct run *run, int slot)
{
    const struct batch_job *job = run->job;
    const size_t index = run->item[slot];
    struct batch_item *item = &job->items[index];
    struct batch_slopes *slopes = job->slopes == NULL ? NULL : &job->slopes[index];
    store(run, slot, item);
    if (slopes != NULL && item->fault == STRIDE_OK) {
        store_slopes(run, slot, slopes);
    }
    if (job->stride_done != NULL && job->stride_done(job->context, index, item, slopes) != 0) {
        return 0;
    }
    return item->fault == STRIDE_OK && item->strides < job->strides;
}

/* Fills the block's slots from `slot` on with items that wait; the block's count follows. */
static void enlist(struct run *run, int slot)
{
    const struct batch_job *job = run->job;
    for (; slot < BATCH_BLOCK && run->next < run->end; run->next++) {
        const struct batch_item *item = &job->items[run->next];
        if (item->fault == STRIDE_OK && item->strides < job->strides) {
            run->item[slot++] = run->next;
        }
    }
    run->block.count = slot;
}

static void run_items(struct run *run)
{
    block_stride_fn *const stride_block = choice_stride();
    enlist(run, 0);
    while (run->block.count > 0) {
        run->precision.has_ground = 0;
        for (int slot = 0; slot < run->block.count; slot++) {
            load(run, slot);
        }
        stride_block(&run->block, &run->precision);
        int kept = 0;
        for (int slot = 0; slot < run->block.count; slot++) {
            if (finish_stride(run, slot)) {
                run->item[kept++] = run->item[slot];
            }
        }
        enlist(run, kept);
    }
}

/* A thread takes neighbouring items a piece at a time: enough for full vectors, few enough that all threads end
 * together. */
#define PIECE_ITEMS_MOST 2048
#define PIECE_ITEMS_LEAST 64
#define PIECES_PER_THREAD 16

struct shared {
    size_t piece_items;
    const struct batch_job *job;
    const struct prepared *walkers;
    struct block_precision precision;
};

static int run_piece(void *context, size_t piece)
{
    const struct shared *shared = context;
    struct run *run = aligned_alloc(64, (sizeof *run + 63) / 64 * 64);
    if (run == NULL) {
        return BATCH_OUT_OF_MEMORY;
    }
    memset(run, 0, sizeof *run);
    run->job = shared->job;
    run->walkers = shared->walkers;
    run->precision = shared->precision;
    run->next = piece * shared->piece_items;
    run->end = run->next + shared->piece_items < run->job->count ? run->next + shared->piece_items
                                                                 : run->job->count;
    run_items(run);
    free(run);
    return BATCH_OK;
}

static size_t piece_items(size_t count, int threads)
{
    const size_t share = count / ((size_t)parallel_for_threads(threads) * PIECES_PER_THREAD);
    const size_t rounded = share / PIECE_ITEMS_LEAST * PIECE_ITEMS_LEAST;
    return rounded < PIECE_ITEMS_LEAST  ? PIECE_ITEMS_LEAST
           : rounded > PIECE_ITEMS_MOST ? PIECE_ITEMS_MOST
                                        : rounded;
}

static enum batch_error check_job(const struct batch_settings *settings,
                                  const struct batch_job *job, struct block_precision *precision)
{
    if (!choice_precision(settings, precision)) {
        return BATCH_BAD_ACCURACY;
    }
    precision->want_slopes = job->slopes != NULL;
    precision->from_strike = settings->from_strike;
    for (size_t i = 0; i < job->count; i++) {
        if (job->items[i].walker >= job->walker_count) {
            return BATCH_BAD_INDEX;
        }
    }
    return BATCH_OK;
}

enum batch_error batch_run_threads(const struct batch_settings *settings,
                                   const struct batch_job *job, int threads)
{
    struct shared shared = {.job = job};
    enum batch_error error = check_job(settings, job, &shared.precision);
    if (error != BATCH_OK || job->count == 0) {
        return error;
    }
    struct prepared *walkers = malloc(job->walker_count * sizeof *walkers);
    error = walkers == NULL ? BATCH_OUT_OF_MEMORY : BATCH_OK;
    for (uint32_t i = 0; error == BATCH_OK && i < job->walker_count; i++) {
        error = prepare(&job->walkers[i], &walkers[i]) ? BATCH_OK : BATCH_BAD_WALKER;
    }
    if (error == BATCH_OK) {
        shared.walkers = walkers;
        shared.piece_items = threads == 1 ? PIECE_ITEMS_MOST : piece_items(job->count, threads);
        const size_t pieces = (job->count + shared.piece_items - 1) / shared.piece_items;
        error = (enum batch_error)parallel_for(threads, pieces, run_piece, &shared);
    }
    free(walkers);
    return error;
}

enum batch_error batch_run(const struct batch_settings *settings, const struct batch_job *job)
{
    return batch_run_threads(settings, job, 1);
}

const char *batch_error_name(enum batch_error error)
{
    switch (error) {
    case BATCH_OK:
        return "no error";
    case BATCH_BAD_ACCURACY:
        return "accuracy must be 1e-12 to 1e-4";
    case BATCH_BAD_WALKER:
        return "a walker's parameter is outside its limits (model/walker.h)";
    case BATCH_BAD_INDEX:
        return "an item names a walker that was not given";
    case BATCH_OUT_OF_MEMORY:
        return "out of memory: run fewer walkers at a time";
    case BATCH_NO_SUCH_VECTORS:
        return "this processor has no vectors of that width";
    }
    return "unknown error";
}
