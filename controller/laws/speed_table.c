#include "controller/laws/speed_table.h"

enum { NEWTON_STEPS = 4 };

enum speed_table_result speed_table_check(const struct speed_table *table)
{
    if (table->count < 4 || table->count > SPEED_TABLE_MAX) {
        return SPEED_TABLE_BAD_COUNT;
    }
    if (!(table->r0_min_m > REAL(0.0)) || !(table->r0_step_m > REAL(0.0)) ||
        !real_is_finite(table->r0_min_m) || !real_is_finite(table->r0_step_m)) {
        return SPEED_TABLE_BAD_GRID;
    }
    real below = REAL(0.0);
    for (uint32_t i = 0; i < table->count; i++) {
        const real speed = table->speed_rad_s[i];
        if (!(speed > below) || !real_is_finite(speed)) {
            return SPEED_TABLE_NOT_RISING;
        }
        below = speed;
    }
    return SPEED_TABLE_OK;
}

/* The cubic through four neighbouring entries in Newton's divided-difference
 * form over s = (r0 - r0[first]) / step: exact at the entries. It interpolates
 * the squares of the speeds, because v grows with the square root of r0 and its
 * square is nearly straight. */
struct cubic {
    real c0, c1, c2, c3;
};

static struct cubic cubic_through(const real *speed)
{
    const real y[4] = {speed[0] * speed[0], speed[1] * speed[1], speed[2] * speed[2],
                       speed[3] * speed[3]};
    const real d1 = y[1] - y[0];
    const real d2 = y[2] - REAL(2.0) * y[1] + y[0];
    const real d3 = y[3] - REAL(3.0) * y[2] + REAL(3.0) * y[1] - y[0];
    return (struct cubic){y[0], d1, d2 * REAL(0.5), d3 * (REAL(1.0) / REAL(6.0))};
}

static real cubic_value(const struct cubic *c, real s)
{
    return c->c0 + s * (c->c1 + (s - REAL(1.0)) * (c->c2 + (s - REAL(2.0)) * c->c3));
}

static real cubic_slope(const struct cubic *c, real s)
{
    return c->c1 + c->c2 * (REAL(2.0) * s - REAL(1.0)) +
           c->c3 * (REAL(3.0) * s * s - REAL(6.0) * s + REAL(2.0));
}

/* First of the four entries around the interval [interval, interval + 1]. */
static uint16_t stencil_first(const struct speed_table *table, uint16_t interval)
{
    const uint16_t last_first = (uint16_t)(table->count - 4);
    const uint16_t first = interval > 0 ? (uint16_t)(interval - 1) : 0;
    return first < last_first ? first : last_first;
}

real speed_table_inverse(const struct speed_table *table, real speed_rad_s)
{
    uint16_t low = 0;
    uint16_t high = (uint16_t)(table->count - 1);
    if (!(speed_rad_s > table->speed_rad_s[low])) {
        return table->r0_min_m;
    }
    if (speed_rad_s >= table->speed_rad_s[high]) {
        return table->r0_min_m + table->r0_step_m * (real)high;
    }
    while (high - low > 1) { /* at most 6 rounds for 64 entries */
        const uint16_t middle = (uint16_t)((low + high) / 2);
        if (table->speed_rad_s[middle] <= speed_rad_s) {
            low = middle;
        } else {
            high = middle;
        }
    }
    const uint16_t first = stencil_first(table, low);
    const struct cubic c = cubic_through(&table->speed_rad_s[first]);
    const real from = (real)(low - first);
    const real rise = table->speed_rad_s[low + 1] - table->speed_rad_s[low];
    const real square = speed_rad_s * speed_rad_s;
    real s = from + (speed_rad_s - table->speed_rad_s[low]) / rise;
    for (int i = 0; i < NEWTON_STEPS; i++) {
        const real slope = cubic_slope(&c, s);
        if (!(slope > REAL(0.0))) {
            break; /* the last answer stands: the table rises, its cubic need not */
        }
        s = real_clamp(s - (cubic_value(&c, s) - square) / slope, from, from + REAL(1.0));
    }
    return table->r0_min_m + table->r0_step_m * ((real)first + s);
}

real speed_table_speed(const struct speed_table *table, real r0_m)
{
    const real last = (real)(table->count - 1);
    const real position = real_clamp((r0_m - table->r0_min_m) / table->r0_step_m, REAL(0.0), last);
    uint16_t interval = 0;
    if (real_is_within(position, REAL(0.0), last)) {
        interval = (uint16_t)position;
    }
    if (interval > table->count - 2) {
        interval = (uint16_t)(table->count - 2);
    }
    const uint16_t first = stencil_first(table, interval);
    const struct cubic c = cubic_through(&table->speed_rad_s[first]);
    return real_sqrt(cubic_value(&c, position - (real)first));
}
