/* The emergency-stop input: a table of functions and a context.
 *
 * The contact is normally closed and feeds the input, so that an open contact
 * and a broken wire both read as pressed.
 */
#ifndef HAL_EMERGENCY_STOP_H
#define HAL_EMERGENCY_STOP_H

#include <stdbool.h>

struct emergency_stop_ops {
    /* True while the button is pressed, or the wire broken, or the port cannot
     * tell. Loop or ISR; never blocks; O(1). */
    bool (*is_pressed)(void *context);
};

struct emergency_stop {
    const struct emergency_stop_ops *ops;
    void *context;
};

static inline bool emergency_stop_is_pressed(const struct emergency_stop *stop)
{
    return stop->ops->is_pressed(stop->context);
}

#endif
