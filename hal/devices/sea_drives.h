/* Both SEA drives behind one interface, whatever protocol they speak.
 *
 * The controller thinks in metres of spring and in commands ("enabled, at 0.05 m,
 * armed"); a protocol turns that into frames, walks the drive's own state
 * machine towards the command, and turns frames into readings with their age.
 */
#ifndef HAL_DEVICES_SEA_DRIVES_H
#define HAL_DEVICES_SEA_DRIVES_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/bus/can_bus.h"
#include "model/foot_contact.h"
#include "model/sea_state.h"
#include "model/side.h"
#include "model/tick.h"

/* What a drive tells slowly counts for so long: ten of the slow PDO's periods. */
enum { SEA_DRIVE_SLOW_TICKS = TICKS_OF_MS(1000) };

struct sea_drive_reading {
    float precompression_m; /* motor position in metres of spring */
    float force_N;          /* of the motor on the spring, compression positive */
    enum drive_state state;
    enum latch_state latch;    /* as the node reports it, with the position */
    uint16_t age_ticks;        /* of all but the force; 0 = newest cycle; UINT16_MAX = never */
    uint16_t force_age_ticks;  /* UINT16_MAX = never, or the protocol has none */
    enum foot_contact contact; /* of the other foot, as it is wired to the latch */
    bool warning;              /* the drive warns of something; it may go on */
    bool has_temperature;      /* the drive tells it, and did so within SEA_DRIVE_SLOW_TICKS */
    bool has_supply;           /* likewise */
    float temperature_degC;
    float supply_V; /* of the DC link */
    bool absent;    /* this leg has no drive */
    bool foreign;   /* another node speaks with this drive's identifier */
};

struct sea_drive_command {
    float precompression_m;
    bool enable;
    bool latch_armed;
    bool clear_fault; /* ask the drive to leave its fault state; one tick is enough */
    bool repeat; /* send it though it is not new: somebody else may have told the drive otherwise */
    bool unconfigured; /* not set up: frames of ours would mean something else to it */
    bool operational;  /* it obeys PDOs now */
};

struct sea_drives_ops {
    /* Takes a frame if it is one of the drives' and says whether it did. */
    bool (*receive)(void *context, const struct can_msg *message);
    void (*read)(const void *context, enum side leg, struct sea_drive_reading *reading);
    /* A cycle has ended: readings grow one tick older (saturating). */
    void (*age)(void *context);
    /* Sends this tick's command frames; SIDE_COUNT commands. Returns the first
     * failure of can_bus_send, CAN_OK if none; frames not sent are sent again
     * at the next tick. */
    enum can_result (*command)(void *context, const struct sea_drive_command *command,
                               const struct can_bus *bus);
};

struct sea_drives {
    const struct sea_drives_ops *ops;
    void *context;
    const uint32_t *rx_malformed; /* frames that could not be read, up to the last age; saturates */
};

static inline bool sea_drives_receive(const struct sea_drives *drives,
                                      const struct can_msg *message)
{
    return drives->ops->receive(drives->context, message);
}

static inline void sea_drives_read(const struct sea_drives *drives, enum side leg,
                                   struct sea_drive_reading *reading)
{
    /* What a protocol does not tell stays unknown. */
    *reading = (struct sea_drive_reading){.age_ticks = UINT16_MAX, .force_age_ticks = UINT16_MAX};
    drives->ops->read(drives->context, leg, reading);
}

static inline void sea_drives_age(const struct sea_drives *drives)
{
    drives->ops->age(drives->context);
}

static inline enum can_result sea_drives_command(const struct sea_drives *drives,
                                                 const struct sea_drive_command *command,
                                                 const struct can_bus *bus)
{
    return drives->ops->command(drives->context, command, bus);
}

#endif
