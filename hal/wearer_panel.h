/* The wearer's own panel: a button to pause and stop, and a light or buzzer that tells what comes.
 *
 * The button's contact is normally open and pulls its line down: a panel that is not there reads as
 * released. It is no emergency stop, and does not replace one.
 */
#ifndef HAL_WEARER_PANEL_H
#define HAL_WEARER_PANEL_H

#include <stdbool.h>

struct wearer_panel_ops {
    /* True while the button is pressed. Loop only; never blocks; O(1). */
    bool (*is_pressed)(void *context);
    /* Switches light or buzzer. Loop only; never blocks; O(1). */
    void (*set_cue)(void *context, bool on);
};

struct wearer_panel {
    const struct wearer_panel_ops *ops;
    void *context;
};

static inline bool wearer_panel_is_pressed(const struct wearer_panel *panel)
{
    return panel->ops->is_pressed(panel->context);
}

static inline void wearer_panel_set_cue(const struct wearer_panel *panel, bool on)
{
    panel->ops->set_cue(panel->context, on);
}

#endif
