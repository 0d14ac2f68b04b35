#include <math.h>
#include <stdlib.h>

#include "model/collision.h"
#include "sim_host/study/map/terrain_grid.h"
#include "sim_host/study/pool.h"
#include "sim_host/study/study_walker.h"

/* ---- places on the grids ----------------------------------------------------------------- */

double terrain_axis_value(const struct terrain_axis *axis, double place)
{
    return axis->low + (axis->high - axis->low) * pow(place / (axis->count - 1), axis->power);
}

float terrain_axis_place(const struct terrain_axis *axis, double value)
{
    const double share = (value - axis->low) / (axis->high - axis->low);
    const double inside = share > 0.0 ? (share < 1.0 ? share : 1.0) : 0.0;
    return (float)(pow(inside, 1.0 / axis->power) * (axis->count - 1));
}

double terrain_rise(const struct terrain_range *range, int rise)
{
    return range->rise_most * (2.0 * rise + 1.0 - range->rises) / range->rises;
}

static size_t strike_nodes(const struct terrain_range *r)
{
    return (size_t)r->rises * (size_t)r->legs.count * (size_t)r->ankle.count;
}

/* ---- the tables ---------------------------------------------------------------------------- */

struct making {
    struct terrain_table *table;
    unsigned char *wanted; /* strike nodes that some apex leads to */
    struct walker walker;
    struct stride_settings settings;
};

static struct terrain_strike strike_from(const struct terrain_table *table,
                                         const struct walker *walker,
                                         const struct stride_settings *settings,
                                         const struct apex *apex, double rise)
{
    const struct ground ground = {0.0, rise};
    struct stride_result result = {.fault = STRIDE_OK};
    if (stride_to_strike_on_ground(walker, settings, apex, &ground, &result) != STRIDE_OK) {
        return (struct terrain_strike){-1.0f, 0.0f};
    }
    const double difference = result.strike[STANCE_ANGLE] - result.strike[SWING_ANGLE];
    const double ankle =
        collision_clamp_m_s(collision_ankle_rate_m_s(walker, difference, result.strike[STANCE_RATE],
                                                     result.strike[SWING_RATE]),
                            NULL);
    const double legs = real_abs(difference);
    if (!(legs > 0.0)) {
        return (struct terrain_strike){-1.0f, 0.0f};
    }
    return (struct terrain_strike){
        terrain_axis_place(&table->range.legs, legs),
        terrain_axis_place(&table->range.ankle,
                           ankle / (legs * study_rate_unit_m_s(&table->walker)))};
}

struct terrain_strike terrain_strike_after(const struct terrain_table *table, const double apex[3],
                                           double rise)
{
    const struct apex from = {apex[0], apex[1], apex[2]};
    struct walker walker;
    struct stride_settings settings;
    if (study_walker(&table->walker, STUDY_COARSE_UNITS, &walker, &settings) != 0) {
        return (struct terrain_strike){-1.0f, 0.0f};
    }
    return strike_from(table, &walker, &settings, &from, rise);
}

/* One speed and angle of the apex. */
static void compute_strikes(void *context, int row)
{
    const struct making *making = (const struct making *)context;
    const struct terrain_range *r = &making->table->range;
    const int speed = row / r->angle.count, angle = row % r->angle.count;
    for (int s = 0; s < r->swing.count; s++) {
        const int node = row * r->swing.count + s;
        const struct apex apex = {-terrain_axis_value(&r->speed, speed),
                                  terrain_axis_value(&r->angle, angle),
                                  terrain_axis_value(&r->swing, s)};
        for (int i = 0; i < r->rises; i++) {
            making->table->strike[(size_t)node * (size_t)r->rises + (size_t)i] = strike_from(
                making->table, &making->walker, &making->settings, &apex, terrain_rise(r, i));
        }
    }
}

/* The corners of the cell that every strike lies in. */
static void mark_wanted(struct making *making)
{
    const struct terrain_range *r = &making->table->range;
    for (int node = 0; node < terrain_apex_nodes(r); node++) {
        for (int i = 0; i < r->rises; i++) {
            const struct terrain_strike *s =
                &making->table->strike[(size_t)node * (size_t)r->rises + (size_t)i];
            float share;
            if (s->legs >= 0.0f) {
                const int leg = terrain_cell(&r->legs, s->legs, &share);
                const int ankle = terrain_cell(&r->ankle, s->ankle, &share);
                for (int k = 0; k < 4; k++) {
                    making->wanted[terrain_push_at(r, i, leg + k / 2, ankle + k % 2) /
                                   (size_t)r->push.count] = 1;
                }
            }
        }
    }
}

/* The push-off reads of the strike the angles and what the impact makes of the rates: rates are chosen that give the
 * wanted ankle rate. The legs stand symmetric about the normal of the line from toe to toe. */
static struct terrain_apex apex_after(const struct making *making, double legs, double ankle,
                                      double rise, double r0_m)
{
    const struct terrain_range *r = &making->table->range;
    const struct ground ground = {0.0, rise};
    struct stride_result result = {.fault = STRIDE_OK};
    const double per_rate = collision_ankle_rate_m_s(&making->walker, -legs, 0.0, 1.0);
    result.incline_rad = ground_incline_rad(&ground, legs);
    result.strike[STANCE_ANGLE] = result.incline_rad - 0.5 * legs;
    result.strike[SWING_ANGLE] = result.incline_rad + 0.5 * legs;
    result.strike[STANCE_RATE] = 0.0;
    result.strike[SWING_RATE] =
        ankle * legs * study_rate_unit_m_s(&making->table->walker) / per_rate;
    if (stride_push_off(&making->walker, &making->settings, r0_m, &result) != STRIDE_OK ||
        stride_from_lift_off(&making->walker, &making->settings, &result) != STRIDE_OK) {
        return (struct terrain_apex){-1.0f, 0.0f, 0.0f};
    }
    return (struct terrain_apex){terrain_axis_place(&r->speed, -result.next.stance_rate_rad_s),
                                 terrain_axis_place(&r->angle, result.next.swing_angle_rad),
                                 terrain_axis_place(&r->swing, result.next.swing_rate_rad_s)};
}

/* One rise and angle between the legs. */
static void compute_apexes(void *context, int row)
{
    const struct making *making = (const struct making *)context;
    const struct terrain_range *r = &making->table->range;
    const int rise = row / r->legs.count, leg = row % r->legs.count;
    for (int a = 0; a < r->ankle.count; a++) {
        const size_t at = terrain_push_at(r, rise, leg, a);
        const bool wanted = making->wanted[at / (size_t)r->push.count] != 0;
        for (int p = 0; p < r->push.count; p++) {
            making->table->apex[at + (size_t)p] =
                wanted ? apex_after(making, terrain_axis_value(&r->legs, leg),
                                    terrain_axis_value(&r->ankle, a), terrain_rise(r, rise),
                                    terrain_axis_value(&r->push, p))
                       : (struct terrain_apex){-1.0f, 0.0f, 0.0f};
        }
    }
}

static bool is_range(const struct terrain_range *r)
{
    const struct terrain_axis *axes[] = {&r->speed, &r->angle, &r->swing,
                                         &r->legs,  &r->ankle, &r->push};
    for (int i = 0; i < 6; i++) {
        if (axes[i]->count < 2 || !(axes[i]->high > axes[i]->low) || !(axes[i]->power > 0.0)) {
            return false;
        }
    }
    return r->rises >= 1 && r->rises <= TERRAIN_RISES_MAX && r->push.count <= TERRAIN_PUSHES_MAX &&
           r->push.count % TERRAIN_PUSHES_BLOCK == 0;
}

int terrain_make(struct terrain_table *table, const struct gait_walker *walker,
                 const struct terrain_range *range, int threads)
{
    struct making making = {.table = table};
    *table = (struct terrain_table){.walker = *walker, .range = *range};
    if (!is_range(range) ||
        study_walker(walker, STUDY_COARSE_UNITS, &making.walker, &making.settings) != 0) {
        return -1;
    }
    const size_t strikes = strike_nodes(range);
    table->strike =
        malloc((size_t)terrain_apex_nodes(range) * (size_t)range->rises * sizeof *table->strike);
    table->apex = malloc(strikes * (size_t)range->push.count * sizeof *table->apex);
    making.wanted = calloc(strikes, 1);
    const struct pool_jobs from_apex = {
        0, range->speed.count * range->angle.count, threads, &making, compute_strikes, NULL};
    const struct pool_jobs from_strike = {
        0, range->rises * range->legs.count, threads, &making, compute_apexes, NULL};
    bool done = table->strike != NULL && table->apex != NULL && making.wanted != NULL &&
                pool_run(&from_apex) == 1;
    if (done) {
        mark_wanted(&making);
        done = pool_run(&from_strike) == 1;
    }
    free(making.wanted);
    if (!done) {
        terrain_free(table);
        return -1;
    }
    return 0;
}

void terrain_free(struct terrain_table *table)
{
    free(table->strike);
    free(table->apex);
    table->strike = NULL;
    table->apex = NULL;
}
