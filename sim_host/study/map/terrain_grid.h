/* Places on the grids of terrain_ground.h, shared by its tables and their iteration. */
#ifndef SIM_HOST_STUDY_MAP_TERRAIN_GRID_H
#define SIM_HOST_STUDY_MAP_TERRAIN_GRID_H

#include <stddef.h>

#include "sim_host/study/map/terrain_ground.h"

/* The value at a place, in cells from the first node. */
double terrain_axis_value(const struct terrain_axis *axis, double place);
/* The place of a value; the nearest edge where the value lies beyond. */
float terrain_axis_place(const struct terrain_axis *axis, double value);

/* The cell a place lies in along an axis (the last one's far edge belongs to it), and how far in it. */
static inline int terrain_cell(const struct terrain_axis *axis, float place, float *share)
{
    const int whole = (int)place, cell = whole < axis->count - 1 ? whole : axis->count - 2;
    *share = place - (float)cell;
    return cell;
}

static inline int terrain_apex_nodes(const struct terrain_range *r)
{
    return r->speed.count * r->angle.count * r->swing.count;
}

static inline size_t terrain_push_at(const struct terrain_range *r, int rise, int leg, int ankle)
{
    const size_t row = (size_t)rise * (size_t)r->legs.count + (size_t)leg;
    return (row * (size_t)r->ankle.count + (size_t)ankle) * (size_t)r->push.count;
}

/* The height of rise number `rise`, leg lengths. */
double terrain_rise(const struct terrain_range *range, int rise);

/* Where an apex (stance rate, swing angle, swing rate) strikes a rise; the walker's parameters are those of a table
 * that was made. */
struct terrain_strike terrain_strike_after(const struct terrain_table *table, const double apex[3],
                                           double rise);

#endif
