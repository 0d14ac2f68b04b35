/* A line that gives a pulse when a mark comes: by it cameras and motion capture line their records up
 * with the log of the bus.
 */
#ifndef HAL_SYNC_PULSE_H
#define HAL_SYNC_PULSE_H

/* Length of a pulse. Marks that come within it lengthen it and have no edge of their own. */
enum { SYNC_PULSE_US = 10000 };

struct sync_pulse_ops {
    /* Lets the line go high now, and low again SYNC_PULSE_US later by itself. Loop only; never
     * blocks; O(1). */
    void (*give)(void *context);
};

struct sync_pulse {
    const struct sync_pulse_ops *ops;
    void *context;
};

static inline void sync_pulse_give(const struct sync_pulse *pulse)
{
    pulse->ops->give(pulse->context);
}

#endif
