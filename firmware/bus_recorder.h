/* A can_bus in front of another that writes everything it sees into a black box.
 *
 * The control task uses it as its bus and knows nothing of it. A tick counts as
 * over when the task asks for the next frame behind its own SYNC. A fault that the task
 * latches freezes the box some ticks later. What takes long, a snapshot, is made behind a tick that had no
 * more to do than usual: no SYNC waits for it.
 */
#ifndef FIRMWARE_BUS_RECORDER_H
#define FIRMWARE_BUS_RECORDER_H

#include <stdbool.h>

#include "firmware/snapshot.h"
#include "hal/bus/can_bus.h"
#include "hal/storage/black_box.h"
#include "model/tick.h"

enum {
    BUS_RECORDER_AFTER_FAULT_TICKS = TICKS_OF_MS(300)
}; /* recorded after a fault before it freezes */

struct bus_recorder {
    struct can_bus inner;
    struct black_box *box;
    struct snapshot_source source;
    bool in_tick;         /* the own SYNC was handed out, its tick runs */
    uint8_t fault;        /* latched at the end of the last tick */
    bool quiet;           /* nobody has asked since the last tick that had little to do */
    bool special;         /* among them is one of those that not each tick has */
    uint32_t frames;      /* received or sent since the last tick ended */
    uint32_t usual_parts; /* of a frame: what ticks have */
};

/* Records what passes between the control task in `source` and `inner` into *box;
 * all stay the caller's. */
void bus_recorder_init(struct bus_recorder *recorder, const struct can_bus *inner,
                       struct black_box *box, const struct snapshot_source *source);

/* True once behind each tick that was quiet and opened no block: there is time for something else. Loop
 * only; O(1). */
bool bus_recorder_take_quiet(struct bus_recorder *recorder);

/* The bus to give to the control task. The first fetch behind a tick takes 40 instructions more, or opens a
 * block with a snapshot: up to 1,700 about twice a second. */
struct can_bus bus_recorder_interface(struct bus_recorder *recorder);

#endif
