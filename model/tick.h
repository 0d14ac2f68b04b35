/* The tick: the one period that everything which happens once a cycle is computed from.
 *
 * SYNC goes out at this period; sensors and drives sample at it, the controller and the plant
 * advance by it. A build may choose another: make TICK_US=2000 BITRATE=500000 BUILD=build/slow.
 * A time in ticks is written TICKS_OF_MS(time), and no other number of ticks stands for a time.
 */
#ifndef MODEL_TICK_H
#define MODEL_TICK_H

#include <assert.h>

#ifndef TICK_PERIOD_US
#define TICK_PERIOD_US 1000
#endif

/* Ticks that last at least so many milliseconds (whole, 0..2e6). A constant. */
#define TICKS_OF_MS(ms) (((ms)*1000 + TICK_PERIOD_US - 1) / TICK_PERIOD_US)

static_assert(TICK_PERIOD_US >= 1000 && TICK_PERIOD_US <= 10000,
              "1 ms is what the fastest bus carries, 10 ms the most that the gait bears");
static_assert(TICK_PERIOD_US % 100 == 0, "a drive is told the tick in whole tenths of a ms");

#endif
