/* The chip's own supply: a detector at 2.9 V, whose interrupt says that power is going, and the
 * parity of RAM. The brown-out reset at 2.5 V comes later (option_bytes.h).
 *
 * Between the two the loop unloads: the drives still have their energy, for 3.3 V is made from
 * their supply and falls last.
 */
#ifndef HAL_PORT_STM32G474_SUPPLY_H
#define HAL_PORT_STM32G474_SUPPLY_H

#include <stdbool.h>
#include <stdint.h>

struct supply {
    volatile bool low;      /* now */
    volatile bool was_low;  /* since supply_is_low was asked last */
    volatile uint32_t dips; /* since the start; saturates */
};

/* Starts the detector and its interrupt, and gives SYSCFG its clock. Returns 0, or the address of a
 * register that does not hold what was written. Start-up only. */
uint32_t supply_init(struct supply *supply);

/* Its interrupt, IRQ_PVD, at both edges. Below 50 instructions. */
void supply_interrupt(struct supply *supply);

/* True while the supply is below 2.9 V, and once more for each dip since the last call. Loop; O(1). */
static inline bool supply_is_low(struct supply *supply)
{
    const bool low = supply->low || supply->was_low;

    supply->was_low = false;
    return low;
}

/* From the NMI handler: true when RAM failed its parity; the flag is cleared. O(1). */
bool supply_ram_parity_failed(void);

#endif
