/* A can_bus in front of another that writes everything it sees into a black box.
 *
 * The control task uses it as its bus and knows nothing of it. A tick counts as
 * over when the task asks for the next frame behind its own SYNC. A fault that the task
 * latches freezes the box some ticks later. What takes long, a snapshot, is made at the end of a period that
 * had no more to do than usual.
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
    bool ended;           /* the period is over, its SYNC not yet sent */
    bool special;         /* among them is one of those that not each period has */
    uint32_t frames;      /* of this period, received or sent since the last one ended */
    uint32_t usual_parts; /* of a frame: what periods have */
};

/* Records what passes between the control task in `source` and `inner` into *box;
 * all stay the caller's. */
void bus_recorder_init(struct bus_recorder *recorder, const struct can_bus *inner,
                       struct black_box *box, const struct snapshot_source *source);

/* The period is over, the next SYNC about to be sent: opens a block with a snapshot where it is time and the
 * period was quiet: that SYNC leaves later by the copy, up to 1,700 instructions about twice a second. Returns true when it was quiet and nothing was opened: there is time for something else. Who
 * does not call it leaves it to the sending of the SYNC. Loop only; 40 instructions, or a snapshot. */
bool bus_recorder_end_period(struct bus_recorder *recorder);

/* The bus to give to the control task. */
struct can_bus bus_recorder_interface(struct bus_recorder *recorder);

#endif
