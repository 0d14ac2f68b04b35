#include "firmware/settings_lock.h"

#include "firmware/params_guard.h"
#include "hal/canopen/co_defs.h"

enum { INDEX_PARAMETERS = 0x2010 };
#define KEY_MASK UINT32_C(0x00FFFFFF)
enum {
    LOCK_TICKS = TICKS_OF_MS(1000 * SETTINGS_LOCK_S),
    SECOND_TICKS = TICKS_OF_MS(1000),
    RAMP_TICKS = TICKS_OF_MS(1000 * SETTINGS_RAMP_S)
};

static void show(const struct settings_lock *lock, struct controller_objects *objects)
{
    objects->unlocked_s = (uint8_t)((lock->ticks_left + SECOND_TICKS - 1u) / SECOND_TICKS);
    if (lock->ticks_left == 0) {
        objects->unlocked_by = 0;
    }
}

uint32_t settings_lock_try(struct settings_lock *lock, struct controller_objects *objects,
                           uint32_t key)
{
    const uint8_t client = (uint8_t)(key >> 24);
    const bool fits = (key & KEY_MASK) == SETTINGS_LOCK_KEY && client >= 1 && client <= CO_NODE_MAX;
    lock->ticks_left = fits ? (uint32_t)LOCK_TICKS : 0;
    objects->unlocked_by = fits ? client : 0;
    show(lock, objects);
    return fits || key == 0 ? CO_ABORT_NONE : CO_ABORT_VALUE;
}

void settings_lock_note(const struct settings_lock *lock, struct controller_objects *objects,
                        uint16_t index, uint8_t sub, float before, float after)
{
    const struct change_record record = {.time_s = lock->ticks / (uint32_t)SECOND_TICKS,
                                         .index = index,
                                         .sub = sub,
                                         .client = objects->unlocked_by,
                                         .before = before,
                                         .after = after};
    change_log_note(&objects->changes, &record);
    if (index != INDEX_PARAMETERS) {
        return;
    }
    objects->change_number =
        objects->change_number < UINT32_MAX ? objects->change_number + 1u : UINT32_MAX;
    objects->change_client = objects->unlocked_by;
    objects->change_place = sub;
    objects->change_before = before;
    objects->change_after = after;
}

bool settings_lock_begin_ramp(struct settings_lock *lock, uint8_t place, float from, float target)
{
    struct settings_ramp *ramp = NULL;
    for (int i = 0; i < SETTINGS_LOCK_RAMPS; i++) {
        if (lock->ramp[i].place == place) {
            ramp = &lock->ramp[i];
        } else if (lock->ramp[i].place == 0 && (ramp == NULL || ramp->place == 0)) {
            ramp = &lock->ramp[i];
        }
    }
    if (ramp == NULL) {
        return false;
    }
    const float way = target > from ? target - from : from - target;
    *ramp = (struct settings_ramp){place, target, way / (float)RAMP_TICKS};
    return true;
}

static void move(struct settings_ramp *ramp, struct controller_objects *objects, bool at_once)
{
    const size_t offset = control_param_descriptors[ramp->place - 1u].offset;
    const float now = *(const float *)((const char *)&objects->params + offset);
    const float left = ramp->target - now;
    float next = ramp->target;
    if (!at_once && left > ramp->change_per_tick) {
        next = now + ramp->change_per_tick;
    } else if (!at_once && left < -ramp->change_per_tick) {
        next = now - ramp->change_per_tick;
    }
    params_guard_change(&objects->params, &objects->params_crc, offset, next);
    if (next == ramp->target) {
        ramp->place = 0;
    }
}

void settings_lock_move(struct settings_lock *lock, struct controller_objects *objects,
                        bool at_once)
{
    for (int i = 0; i < SETTINGS_LOCK_RAMPS; i++) {
        if (lock->ramp[i].place != 0) {
            move(&lock->ramp[i], objects, at_once);
        }
    }
}

void settings_lock_tick(struct settings_lock *lock, struct controller_objects *objects,
                        bool at_once)
{
    lock->ticks++;
    if (lock->ticks_left > 0) {
        lock->ticks_left--;
        show(lock, objects);
    }
    settings_lock_move(lock, objects, at_once);
}
