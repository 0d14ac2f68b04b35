/* Counts of ticks that last at their largest value instead of beginning anew. */
#ifndef CONTROLLER_SCREENING_TICK_COUNT_H
#define CONTROLLER_SCREENING_TICK_COUNT_H

#include <stdbool.h>
#include <stdint.h>

/* One more, at most UINT16_MAX - 1: UINT16_MAX is AGE_NEVER. */
static inline uint16_t count_up(uint16_t count)
{
    return count < UINT16_MAX - 1 ? (uint16_t)(count + 1) : count;
}

/* Ticks in a row: one more while it holds, else none. */
static inline uint16_t count_while(uint16_t count, bool holds)
{
    return holds ? count_up(count) : 0;
}

#endif
