#include "sim_host/study/map/viability_kernel.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "model/collision.h"
#include "model/trig.h"
#include "sim_host/study/batch_adapter.h"
#include "sim_host/study/pool.h"
#include "sim_host/study/study_walker.h"

/* Between two push-offs of the grid so many more are looked at, by straight line. */
enum { BETWEEN = 4, BOX_IMAGES = 8 };
#define ACCURACY 1e-6 /* of the engine; the images are floats */

struct making {
    struct viability_grid *grid;
    struct walker walker;
    struct stride_settings settings;
    unsigned char *made; /* by row */
};

static double spaced(double low, double high, int index, int count)
{
    return low * exp(log(high / low) * index / (count - 1));
}

static struct viability_state node_state(const struct viability_range *r, int node)
{
    const int a = node / r->rates, w = node % r->rates;
    return (struct viability_state){spaced(r->legs_low_rad, r->legs_high_rad, a, r->legs),
                                    r->rate_low +
                                        (r->rate_high - r->rate_low) * w / (r->rates - 1)};
}

static struct viability_state after_strike(const struct walker *walker, double unit,
                                           const real *strike)
{
    const double difference = strike[STANCE_ANGLE] - strike[SWING_ANGLE];
    const double ankle = collision_clamp_m_s(
        collision_ankle_rate_m_s(walker, difference, strike[STANCE_RATE], strike[SWING_RATE]),
        NULL);
    const double legs = real_abs(difference);
    return (struct viability_state){legs, ankle / (legs * unit)};
}

bool viability_after_apex(const struct gait_walker *gait_walker, const double apex[3],
                          struct viability_state *state)
{
    struct walker walker;
    struct stride_settings settings;
    struct stride_result result = {.fault = STRIDE_OK};
    const struct apex from = {apex[0], apex[1], apex[2]};
    if (study_walker(gait_walker, STUDY_COARSE_UNITS, &walker, &settings) != 0 ||
        stride_to_strike(&walker, &settings, &from, &result) != STRIDE_OK) {
        return false;
    }
    *state = after_strike(&walker, study_rate_unit_m_s(gait_walker), result.strike);
    return state->legs_rad > 0.0;
}

/* A node as a strike. The push-off reads of it only the angles and what the impact makes of the rates: a swing rate
 * is chosen that gives the wanted ankle rate. */
static struct batch_item strike_of(const struct making *making, const struct viability_state *state,
                                   double r0_m)
{
    const double unit = study_rate_unit_m_s(&making->grid->walker), legs = state->legs_rad;
    const double per_swing_rate = collision_ankle_rate_m_s(&making->walker, -legs, 0.0, 1.0);
    return (struct batch_item){
        .apex = {0.0, 0.5 * legs, state->rate * legs * unit / per_swing_rate}, .push_m = r0_m};
}

static struct viability_image image_of(const struct making *making, const struct batch_item *item)
{
    if (item->fault != 0) {
        return (struct viability_image){VIABILITY_NO_IMAGE, 0.0f};
    }
    const real strike[SINGLE_SUPPORT_STATES] = {-item->apex[1], item->apex[1], item->apex[0],
                                                item->apex[2]};
    const struct viability_state next =
        after_strike(&making->walker, study_rate_unit_m_s(&making->grid->walker), strike);
    return (struct viability_image){(float)log(next.legs_rad), (float)next.rate};
}

/* A row of nodes, each with every push-off, side by side on the batch engine. */
static void compute(void *context, int row)
{
    const struct making *making = (const struct making *)context;
    const struct viability_range *r = &making->grid->range;
    const size_t count = (size_t)r->rates * (size_t)r->pushes;
    struct viability_image *image = &making->grid->image[(size_t)row * count];
    struct batch_item *items = malloc(count * sizeof *items);
    if (items == NULL) {
        return;
    }
    for (size_t i = 0; i < count; i++) {
        const int w = (int)(i / (size_t)r->pushes), push = (int)(i % (size_t)r->pushes);
        const struct viability_state state = node_state(r, row * r->rates + w);
        items[i] = strike_of(making, &state, spaced(r->r0_low_m, r->r0_high_m, push, r->pushes));
    }
    const struct batch_walker walker = batch_adapter_walker(&making->walker.params);
    const struct batch_settings settings = {.accuracy = ACCURACY, .from_strike = 1};
    const struct batch_job job = {
        .walkers = &walker, .walker_count = 1, .items = items, .count = count, .strides = 1};
    making->made[row] = batch_run(&settings, &job) == BATCH_OK;
    for (size_t i = 0; i < count; i++) {
        image[i] = image_of(making, &items[i]);
    }
    free(items);
}

static int is_made(void *context, int row)
{
    return ((const struct making *)context)->made[row];
}

int viability_make(struct viability_grid *grid, const struct gait_walker *walker,
                   const struct viability_range *range, int threads)
{
    struct making making = {.grid = grid};
    *grid = (struct viability_grid){
        .walker = *walker, .range = *range, .nodes = range->legs * range->rates};
    grid->image = malloc((size_t)grid->nodes * (size_t)range->pushes * sizeof *grid->image);
    making.made = calloc((size_t)range->legs, 1);
    const struct pool_jobs jobs = {0, range->legs, threads, &making, compute, is_made};
    const bool done =
        grid->image != NULL && making.made != NULL &&
        study_walker(walker, STUDY_COARSE_UNITS, &making.walker, &making.settings) == 0 &&
        pool_run(&jobs) == 1;
    free(making.made);
    if (!done) {
        viability_free(grid);
        return -1;
    }
    return 0;
}

void viability_free(struct viability_grid *grid)
{
    free(grid->image);
    grid->image = NULL;
}

/* ---- sets on the grid -------------------------------------------------------------------- */

/* Position on the grid, in cells. */
struct place {
    double legs, rate;
};

static struct place place_of(const struct viability_range *r, double log_legs, double rate)
{
    const double per_cell = log(r->legs_high_rad / r->legs_low_rad) / (r->legs - 1);
    return (struct place){(log_legs - log(r->legs_low_rad)) / per_cell,
                          (rate - r->rate_low) / (r->rate_high - r->rate_low) * (r->rates - 1)};
}

static bool is_beyond(const struct viability_range *r, const struct place *place)
{
    return !(place->legs >= 0.0 && place->legs <= r->legs - 1 && place->rate >= 0.0 &&
             place->rate <= r->rates - 1);
}

/* The cell a place lies in; the last one's far edge belongs to it. */
static int cell_of(const struct viability_range *r, const struct place *place)
{
    const int a = (int)place->legs, w = (int)place->rate;
    return (a < r->legs - 1 ? a : r->legs - 2) * r->rates + (w < r->rates - 1 ? w : r->rates - 2);
}

static bool has_image(const struct viability_image *image)
{
    return image->log_legs < VIABILITY_NO_IMAGE;
}

/* ---- from inside: nodes ------------------------------------------------------------------- */

static bool all_corners(const struct viability_grid *grid, const unsigned char *set, int cell)
{
    const int rates = grid->range.rates;
    return set[cell] != 0 && set[cell + 1] != 0 && set[cell + rates] != 0 &&
           set[cell + rates + 1] != 0;
}

/* Some push-off of this node, or between two of them by straight line, leads into the set. */
static bool node_stays(const struct viability_grid *grid, const unsigned char *set, int node)
{
    const int pushes = grid->range.pushes;
    const struct viability_image *image = &grid->image[(size_t)node * (size_t)pushes];
    for (int i = 0; i < pushes; i++) {
        if (!has_image(&image[i])) {
            continue;
        }
        const bool more = i + 1 < pushes && has_image(&image[i + 1]);
        const struct viability_image *next = &image[more ? i + 1 : i];
        for (int k = 0; k < (more ? BETWEEN : 1); k++) {
            const float share = (float)k / (float)BETWEEN;
            const float log_legs = image[i].log_legs + share * (next->log_legs - image[i].log_legs);
            const float rate = image[i].rate + share * (next->rate - image[i].rate);
            const struct place place = place_of(&grid->range, (double)log_legs, (double)rate);
            if (!is_beyond(&grid->range, &place) &&
                all_corners(grid, set, cell_of(&grid->range, &place))) {
                return true;
            }
        }
    }
    return false;
}

/* ---- from outside: cells ------------------------------------------------------------------ */

/* Sums of a set of cells over all rectangles that begin at the first: how many lie in any rectangle is four
 * look-ups. */
static void sum_cells(const struct viability_grid *grid, const unsigned char *set, int *sum)
{
    const int legs = grid->range.legs, rates = grid->range.rates;
    for (int a = 0; a < legs; a++) {
        for (int w = 0; w < rates; w++) {
            sum[a * rates + w] =
                a == 0 || w == 0 ? 0
                                 : (set[(a - 1) * rates + w - 1] != 0) + sum[(a - 1) * rates + w] +
                                       sum[a * rates + w - 1] - sum[(a - 1) * rates + w - 1];
        }
    }
}

/* What the push-offs between one of the grid's and the next make of a cell: the box around the images of its
 * corners. */
struct box {
    struct place low, high;
    int images;
};

static void extend_box(const struct viability_grid *grid, const struct viability_image *image,
                       struct box *box)
{
    if (!has_image(image)) {
        return;
    }
    const struct place p = place_of(&grid->range, (double)image->log_legs, (double)image->rate);
    const bool first = box->images == 0;
    box->low.legs = first || p.legs < box->low.legs ? p.legs : box->low.legs;
    box->high.legs = first || p.legs > box->high.legs ? p.legs : box->high.legs;
    box->low.rate = first || p.rate < box->low.rate ? p.rate : box->low.rate;
    box->high.rate = first || p.rate > box->high.rate ? p.rate : box->high.rate;
    box->images++;
}

static bool box_meets(const struct viability_grid *grid, const int *sum, const struct box *box)
{
    const struct viability_range *r = &grid->range;
    /* Where a corner's stride ends in a fault the others stand for it, with a cell to spare. */
    const double spare = box->images < BOX_IMAGES ? 1.0 : 0.0;
    const double a0 = box->low.legs - spare, a1 = box->high.legs + spare;
    const double w0 = box->low.rate - spare, w1 = box->high.rate + spare;
    if (a0 < 0.0 || w0 < 0.0 || a1 > r->legs - 1 || w1 > r->rates - 1) {
        return true;
    }
    const struct place low = {a0, w0}, high = {a1, w1};
    const int from = cell_of(r, &low), to = cell_of(r, &high);
    const int fa = from / r->rates, fw = from % r->rates;
    const int ta = to / r->rates + 1, tw = to % r->rates + 1;
    return sum[ta * r->rates + tw] - sum[fa * r->rates + tw] - sum[ta * r->rates + fw] +
               sum[fa * r->rates + fw] >
           0;
}

/* Some push-off can lead from some state of this cell into the set. */
static bool cell_leads(const struct viability_grid *grid, const int *sum, int cell)
{
    const int corner[4] = {cell, cell + 1, cell + grid->range.rates, cell + grid->range.rates + 1};
    const int pushes = grid->range.pushes;
    for (int i = 0; i + 1 < pushes; i++) {
        struct box box = {.images = 0};
        for (int k = 0; k < BOX_IMAGES; k++) {
            extend_box(grid,
                       &grid->image[(size_t)corner[k / 2] * (size_t)pushes + (size_t)(i + k % 2)],
                       &box);
        }
        if (box.images > 0 && box_meets(grid, sum, &box)) {
            return true;
        }
    }
    return false;
}

static bool is_cell(const struct viability_range *r, int node)
{
    return node / r->rates < r->legs - 1 && node % r->rates < r->rates - 1;
}

int viability_kernel(const struct viability_grid *grid, enum viability_side side,
                     unsigned char *set)
{
    int *sum = malloc((size_t)grid->nodes * sizeof *sum);
    int rounds = 0, taken = 1;
    for (int node = 0; node < grid->nodes; node++) {
        set[node] = side == VIABILITY_INNER || is_cell(&grid->range, node);
    }
    if (sum == NULL) {
        return 0;
    }
    while (taken > 0) {
        taken = 0;
        if (side == VIABILITY_OUTER) {
            sum_cells(grid, set, sum);
        }
        for (int node = 0; node < grid->nodes; node++) {
            const bool stays =
                set[node] != 0 && (side == VIABILITY_OUTER ? cell_leads(grid, sum, node)
                                                           : node_stays(grid, set, node));
            taken += set[node] != 0 && !stays ? 1 : 0;
            set[node] = stays;
        }
        rounds++;
    }
    free(sum);
    return rounds;
}

bool viability_has(const struct viability_grid *grid, enum viability_side side,
                   const unsigned char *set, const struct viability_state *state)
{
    const struct place place = place_of(&grid->range, log(state->legs_rad), state->rate);
    if (is_beyond(&grid->range, &place)) {
        return side == VIABILITY_OUTER;
    }
    const int cell = cell_of(&grid->range, &place);
    return side == VIABILITY_OUTER ? set[cell] != 0 : all_corners(grid, set, cell);
}
