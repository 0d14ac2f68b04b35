/* The iteration on the tables of terrain_ground.h, and the law made from what it comes to. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sim_host/study/map/terrain_grid.h"
#include "sim_host/study/pool.h"

enum { BLOCK = TERRAIN_PUSHES_BLOCK };
#define SETTLED_RATIO 1e-3 /* of a value, what all rounds to come may still change */
#define SETTLED_CHANCE 1e-5
#define STEADY_RATIO 0.02 /* between two ratios of changes that are taken for the same */

struct solving {
    const struct terrain_table *table;
    struct terrain_value *value;
    const float *speed_rad_s; /* of each node of the axis */
};

/* ---- what a push-off is worth -------------------------------------------------------------- */

static float value_at(const struct terrain_table *table, const struct terrain_value *value,
                      const struct terrain_apex *at)
{
    const struct terrain_range *r = &table->range;
    float s[3], sum = 0.0f, best = 0.0f;
    const int speed = terrain_cell(&r->speed, at->speed, &s[0]);
    const int angle = terrain_cell(&r->angle, at->angle, &s[1]);
    const int swing = terrain_cell(&r->swing, at->swing, &s[2]);
    for (int k = 0; k < 8; k++) {
        const int node =
            ((speed + k / 4) * r->angle.count + angle + k / 2 % 2) * r->swing.count + swing + k % 2;
        const float here = value->apex[node];
        sum += (k / 4 ? s[0] : 1.0f - s[0]) * (k / 2 % 2 ? s[1] : 1.0f - s[1]) *
               (k % 2 ? s[2] : 1.0f - s[2]) * here;
        best = k == 0 || here > best ? here : best;
    }
    return value->side == TERRAIN_OUTER ? best : sum;
}

/* What a next apex of that speed costs. */
static float charge(const struct solving *solving, float speed_place)
{
    const struct terrain_goal *goal = &solving->value->goal;
    float share;
    if (goal->question == TERRAIN_CHANCE || goal->price == 0.0) {
        return 0.0f;
    }
    const int cell = terrain_cell(&solving->table->range.speed, speed_place, &share);
    const double low = (double)solving->speed_rad_s[cell],
                 high = (double)solving->speed_rad_s[cell + 1];
    return (float)(goal->price * ((low + (double)share * (high - low)) / goal->limit_rad_s - 1.0));
}

static void value_pushes(void *context, int row)
{
    const struct solving *solving = (const struct solving *)context;
    const struct terrain_range *r = &solving->table->range;
    const size_t count = (size_t)r->ankle.count * (size_t)r->push.count;
    for (size_t i = (size_t)row * count; i < ((size_t)row + 1) * count; i++) {
        const struct terrain_apex *apex = &solving->table->apex[i];
        solving->value->push[i] =
            apex->speed < 0.0f
                ? 0.0f
                : value_at(solving->table, solving->value, apex) - charge(solving, apex->speed);
    }
}

/* ---- what an apex is worth ----------------------------------------------------------------- */

/* Adds to sum[] what each push-off is worth after a strike. */
static void add_strike(const struct terrain_table *table, const struct terrain_value *value,
                       const struct terrain_strike *strike, int rise, float *restrict sum)
{
    const struct terrain_range *r = &table->range;
    float a, b;
    const int leg = terrain_cell(&r->legs, strike->legs, &a);
    const int ankle = terrain_cell(&r->ankle, strike->ankle, &b);
    const float *restrict w00 = &value->push[terrain_push_at(r, rise, leg, ankle)];
    const float *restrict w01 = w00 + r->push.count;
    const float *restrict w10 = &value->push[terrain_push_at(r, rise, leg + 1, ankle)];
    const float *restrict w11 = w10 + r->push.count;
    const float s00 = (1.0f - a) * (1.0f - b), s01 = (1.0f - a) * b, s10 = a * (1.0f - b),
                s11 = a * b;
    for (int p = 0; p < r->push.count; p += BLOCK) {
        for (int k = p; k < p + BLOCK; k++) {
            if (value->side == TERRAIN_OUTER) {
                const float one = w00[k] > w01[k] ? w00[k] : w01[k];
                const float two = w10[k] > w11[k] ? w10[k] : w11[k];
                sum[k] += one > two ? one : two;
            } else {
                sum[k] += s00 * w00[k] + s01 * w01[k] + s10 * w10[k] + s11 * w11[k];
            }
        }
    }
}

static float value_of(const struct terrain_table *table, const struct terrain_value *value,
                      const struct terrain_strike *strike)
{
    const struct terrain_range *r = &table->range;
    float sum[TERRAIN_PUSHES_MAX] = {0.0f}, best;
    for (int i = 0; i < r->rises; i++) {
        if (strike[i].legs >= 0.0f) {
            add_strike(table, value, &strike[i], i, sum);
        }
    }
    best = sum[0];
    for (int p = 1; p < r->push.count; p++) {
        best = sum[p] > best ? sum[p] : best;
    }
    return (value->goal.question == TERRAIN_STEPS ? 1.0f : 0.0f) + best / (float)r->rises;
}

static void value_apexes(void *context, int row)
{
    const struct solving *solving = (const struct solving *)context;
    const struct terrain_range *r = &solving->table->range;
    for (int node = row * r->swing.count; node < (row + 1) * r->swing.count; node++) {
        solving->value->apex[node] =
            value_of(solving->table, solving->value,
                     &solving->table->strike[(size_t)node * (size_t)r->rises]);
    }
}

static bool round_of(struct solving *solving, int threads)
{
    const struct terrain_range *r = &solving->table->range;
    const struct pool_jobs pushes = {0,   r->rises * r->legs.count, threads, solving, value_pushes,
                                     NULL};
    const struct pool_jobs apexes = {
        0, r->speed.count * r->angle.count, threads, solving, value_apexes, NULL};
    return pool_run(&pushes) == 1 && pool_run(&apexes) == 1;
}

/* ---- to rest ------------------------------------------------------------------------------- */

/* How the value of the start changes from round to round: in the end by one factor, all values alike. */
struct progress {
    double last, change, ratio;
    int steady; /* rounds since the ratio came to rest */
};

static void watch(struct progress *progress, double now)
{
    const double change = now - progress->last;
    const double ratio = progress->change != 0.0 ? change / progress->change : 0.0;
    const bool same =
        ratio > 0.0 && ratio < 1.0 && fabs(ratio - progress->ratio) < STEADY_RATIO * (1.0 - ratio);
    progress->steady = same ? progress->steady + 1 : 0;
    progress->ratio = ratio;
    progress->change = change;
    progress->last = now;
}

static bool steps_settled(const struct progress *progress)
{
    return progress->steady >= 2 && fabs(progress->change) * progress->ratio <
                                        SETTLED_RATIO * (1.0 - progress->ratio) * progress->last;
}

static bool chances_settled(const float *before, const float *now, int nodes)
{
    float most = 0.0f;
    for (int node = 0; node < nodes; node++) {
        most = before[node] - now[node] > most ? before[node] - now[node] : most;
    }
    return (double)most < SETTLED_CHANCE;
}

/* All the rounds to come, if they go on as the last two. */
static void leap(const struct terrain_table *table, const float *before, double ratio,
                 struct terrain_value *value)
{
    const float gain = (float)(ratio / (1.0 - ratio));
    for (int node = 0; node < terrain_apex_nodes(&table->range); node++) {
        value->apex[node] += gain * (value->apex[node] - before[node]);
    }
}

static void iterate(struct solving *solving, const double start[3], int rounds_max, int threads,
                    float *before)
{
    struct terrain_value *value = solving->value;
    const enum terrain_question question = value->goal.question;
    const int nodes = terrain_apex_nodes(&solving->table->range);
    struct progress progress = {0.0, 0.0, 0.0, 0};
    while (value->rounds < rounds_max && !value->settled) {
        double worth;
        memcpy(before, value->apex, (size_t)nodes * sizeof *before);
        if (!round_of(solving, threads)) {
            return;
        }
        value->rounds++;
        (void)terrain_law(solving->table, value, start, 0.0, HUGE_VAL, &worth);
        watch(&progress, worth);
        value->settled = question == TERRAIN_CHANCE ? chances_settled(before, value->apex, nodes)
                                                    : steps_settled(&progress);
        if (question == TERRAIN_STEPS && progress.steady >= 3 && !value->settled) {
            leap(solving->table, before, progress.ratio, value);
            progress.steady = 0;
        }
    }
}

int terrain_solve(const struct terrain_table *table, enum terrain_side side,
                  const struct terrain_goal *goal, const double start[3], int rounds_max,
                  int threads, struct terrain_value *value)
{
    const struct terrain_range *r = &table->range;
    const int nodes = terrain_apex_nodes(r);
    const size_t pushes = terrain_push_at(r, r->rises, 0, 0);
    float *before = malloc((size_t)nodes * sizeof *before);
    float *speed = malloc((size_t)r->speed.count * sizeof *speed);
    *value = (struct terrain_value){.side = side, .goal = *goal};
    value->apex = calloc((size_t)nodes, sizeof *value->apex);
    value->push = malloc(pushes * sizeof *value->push);
    const bool room = before != NULL && speed != NULL && value->apex != NULL && value->push != NULL;
    if (room) {
        struct solving solving = {table, value, speed};
        for (int i = 0; i < r->speed.count; i++) {
            speed[i] = (float)terrain_axis_value(&r->speed, i);
        }
        for (int node = 0; node < nodes; node++) {
            value->apex[node] = goal->question == TERRAIN_CHANCE ? 1.0f : 0.0f;
        }
        iterate(&solving, start, rounds_max, threads, before);
    } else {
        terrain_value_free(value);
    }
    free(before);
    free(speed);
    return room ? 0 : -1;
}

void terrain_value_free(struct terrain_value *value)
{
    free(value->apex);
    free(value->push);
    value->apex = NULL;
    value->push = NULL;
}

/* ---- the law -------------------------------------------------------------------------------- */

/* Where the parabola through the best and its neighbours has its vertex, in nodes from the best. */
static double vertex(const float *sum, int best, int count)
{
    if (best == 0 || best == count - 1) {
        return 0.0;
    }
    const double low = (double)sum[best - 1], high = (double)sum[best + 1];
    const double bend = low - 2.0 * (double)sum[best] + high;
    return bend < 0.0 ? 0.5 * (low - high) / bend : 0.0;
}

double terrain_law(const struct terrain_table *table, const struct terrain_value *value,
                   const double apex[3], double low_m, double high_m, double *worth)
{
    const struct terrain_range *r = &table->range;
    float sum[TERRAIN_PUSHES_MAX] = {0.0f};
    int best = -1;
    for (int i = 0; i < r->rises; i++) {
        const struct terrain_strike strike = terrain_strike_after(table, apex, terrain_rise(r, i));
        if (strike.legs >= 0.0f) {
            add_strike(table, value, &strike, i, sum);
        }
    }
    for (int p = 0; p < r->push.count; p++) {
        const double r0_m = terrain_axis_value(&r->push, p);
        if (r0_m >= low_m && r0_m <= high_m && (best < 0 || sum[p] > sum[best])) {
            best = p;
        }
    }
    *worth = (value->goal.question == TERRAIN_STEPS ? 1.0 : 0.0) +
             (best < 0 ? 0.0 : (double)sum[best] / r->rises);
    if (best < 0) {
        return low_m;
    }
    const double r0_m = terrain_axis_value(&r->push, best + vertex(sum, best, r->push.count));
    return r0_m < low_m ? low_m : r0_m > high_m ? high_m : r0_m;
}
