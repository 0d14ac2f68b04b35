/* What a tool may write into the controller's objects, and when; what a read shows.
 *
 * A parameter is refused with an abort code when it is out of its range, does not fit the
 * others, or describes the body or the spring while the drives are powered. Storing is done
 * at standstill without torque only. The description of the device is refused while the drives are
 * powered, and key by key when it is out of its range; whether its keys fit together is asked when
 * it is stored.
 */
#ifndef FIRMWARE_WRITE_RULES_H
#define FIRMWARE_WRITE_RULES_H

#include <stdbool.h>
#include <stdint.h>

#include "firmware/controller_objects.h"
#include "firmware/program_update.h"
#include "firmware/settings_lock.h"
#include "hal/devices/device_verdict.h"
#include "hal/storage/black_box.h"
#include "hal/storage/crash_record.h"
#include "hal/sync_pulse.h"

/* Who keeps the settings. Both are asked at standstill without torque only, may take 100 ms,
 * and return CO_ABORT_NONE or an abort code. */
struct controller_settings_store_ops {
    uint32_t (*save_settings)(void *context);   /* those in force now */
    uint32_t (*forget_settings)(void *context); /* for good: as delivered from the next start on */
};

struct write_rules {
    struct settings_lock lock;
    struct controller_objects *objects;
    struct controller_comm *comm;
    float before;    /* of the parameter that is being written */
    bool powered;    /* drives may be under torque: body parameters are locked */
    bool standstill; /* both legs are still */
    const struct controller_settings_store_ops *settings_store; /* NULL: nobody keeps settings */
    void *settings_store_context;
    struct black_box *black_box;         /* NULL: there is none */
    struct crash_record *crash;          /* NULL: nobody leaves one */
    const struct sync_pulse *sync_pulse; /* NULL: marks give none */
    struct program_update *update;       /* NULL: no program is taken */
    /* Brings what is read at an index up to date: CONTROLLER_INDEX_... or commissioning. NULL: it is as it is. */
    void (*show)(void *context, uint16_t index);
    void *show_context;
};

/* The hooks of the object dictionary (struct co_access_hooks); context is a struct write_rules.
 * Before a write: CO_ABORT_NONE, or the abort code that refuses it. After one: does what was
 * asked. Before a read: brings the objects up to date. Loop only; storing may take 100 ms,
 * anything else is O(1). */
uint32_t write_rules_writing(void *context, const struct co_entry *entry, const uint8_t *bytes,
                             unsigned length);
void write_rules_written(void *context, const struct co_entry *entry);
uint32_t write_rules_reading(void *context, const struct co_entry *entry);
/* A program that is received (0x1F50), at standstill without torque only. */
uint32_t write_rules_begin(void *context, const struct co_entry *entry, uint32_t total);
uint32_t write_rules_take(void *context, const struct co_entry *entry, const uint8_t *bytes,
                          unsigned length, bool last);

/* Whether the description of the device that was written (0x2050 to 0x2052) fits, for a person where it is
 * a person's; 0x2053 tells what it found. Bounded as device_check. */
enum device_verdict write_rules_check_device(const struct write_rules *rules);

/* Shows in the dictionary what is attached: the settings store, the crash record. O(1). */
void write_rules_show_attached(const struct write_rules *rules);

#endif
