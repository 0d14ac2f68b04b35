/* The watchdog's oscillator (LSI, 32 kHz) measured against the crystal: LPTIM1 counts it, TIM2 gives
 * the time. If the two do not agree, either the watchdog's time-out or every tick is wrong.
 */
#ifndef HAL_PORT_STM32G474_LSI_METER_H
#define HAL_PORT_STM32G474_LSI_METER_H

#include <stdbool.h>
#include <stdint.h>

/* DS12288 gives 29.5 to 34 kHz over supply and temperature; 5 % more is not this oscillator. */
enum { LSI_LOWEST_HZ = 28000, LSI_HIGHEST_HZ = 35700 };

struct lsi_meter {
    uint32_t since_us;
    uint32_t since; /* the count then */
    uint32_t hz;    /* as measured last; 0 = not yet */
};

/* Starts the counter. Returns 0, or the address of a register that does not hold what was written.
 * Start-up only, below 1 ms. */
uint32_t lsi_meter_init(struct lsi_meter *meter);

/* Between 0.5 and 1.5 s after the last measurement it measures anew; before it does nothing, later
 * it begins again (the counter wraps after 1.8 s). Returns true when there is a new value. Loop;
 * below 80 instructions. */
bool lsi_meter_update(struct lsi_meter *meter, uint32_t now_us);

/* False when it was measured and is out of range. Pure. */
static inline bool lsi_meter_is_good(const struct lsi_meter *meter)
{
    return meter->hz == 0U ||
           (meter->hz >= (uint32_t)LSI_LOWEST_HZ && meter->hz <= (uint32_t)LSI_HIGHEST_HZ);
}

#endif
