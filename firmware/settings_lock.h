/* Who may change the controller's parameters over SDO, and what was changed.
 *
 * The parameters (0x2010) are locked. A tool unlocks them for SETTINGS_LOCK_S by writing its key to
 * 0x2000:05: the letters "set" and, in the upper byte, the client number of its user, 1 to 127. 0 locks at
 * once, and so does a wrong key. 0x2001 shows for whom they are unlocked and for how long still. The key is no
 * secret: it keeps a tool that means another node, or a script that was left running, from changing a gain, and
 * gives every change somebody who made it.
 *
 * A change of a parameter of the law while a spring may be loaded does not act at once: the value in force
 * moves evenly to the one written, in SETTINGS_RAMP_S; a third one at the same time is refused.
 * 0x2010 shows the value in force.
 */
#ifndef FIRMWARE_SETTINGS_LOCK_H
#define FIRMWARE_SETTINGS_LOCK_H

#include <stdbool.h>
#include <stdint.h>

#include "firmware/controller_objects.h"
#include "model/tick.h"

enum { SETTINGS_LOCK_S = 60, SETTINGS_RAMP_S = 5, SETTINGS_LOCK_RAMPS = 2 };

/* "set" as it lies on the bus; the client number stands above it. */
#define SETTINGS_LOCK_KEY UINT32_C(0x00746573)
static inline uint32_t settings_lock_key_of(uint8_t client)
{
    return SETTINGS_LOCK_KEY | (uint32_t)client << 24;
}

/* A parameter on its way. */
struct settings_ramp {
    uint8_t place; /* its sub-index in 0x2010; 0 = none */
    float target, change_per_tick;
};

struct settings_lock {
    uint32_t ticks;      /* since the start; wraps after 49 days */
    uint32_t ticks_left; /* 0 = locked */
    struct settings_ramp ramp[SETTINGS_LOCK_RAMPS];
};

/* A key was written. Returns CO_ABORT_NONE or CO_ABORT_VALUE, and locks. O(1). */
uint32_t settings_lock_try(struct settings_lock *lock, struct controller_objects *objects,
                           uint32_t key);

/* O(1). */
static inline bool settings_lock_is_open(const struct settings_lock *lock)
{
    return lock->ticks_left > 0;
}

/* Takes note of a change of object index:sub in the ring of 0x2005, and of a parameter (0x2010) in
 * 0x2004. O(1). */
void settings_lock_note(const struct settings_lock *lock, struct controller_objects *objects,
                        uint16_t index, uint8_t sub, float before, float after);

/* Lets parameter `place` move from `from`, in force, to target. Returns false when as many others are on their way. O(1). */
bool settings_lock_begin_ramp(struct settings_lock *lock, uint8_t place, float from, float target);

/* Moves what is on its way by one tick's part; at_once: no spring can be loaded, so it arrives.
 * O(SETTINGS_LOCK_RAMPS). */
void settings_lock_move(struct settings_lock *lock, struct controller_objects *objects,
                        bool at_once);

/* Once a tick: the time goes on, and with it the ramps. Loop only; O(SETTINGS_LOCK_RAMPS). */
void settings_lock_tick(struct settings_lock *lock, struct controller_objects *objects,
                        bool at_once);

#endif
