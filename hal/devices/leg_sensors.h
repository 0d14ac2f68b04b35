/* Both legs' sensors: frames in, angles and extensions with their age out.
 *
 * CiA 406 encoders which answer every SYNC with one frame: the leg angle's count, then the ankle's,
 * which is an extension or, for an ankle with a lever, an angle of plantarflexion. Widths and scales
 * are the device's. An ankle sensor that is a node of its own tells its count in a frame of its own, also
 * at every SYNC; both make one reading, as old as the older. A 0 stands for those of hal/bus/frame_table.h: leg angle INTEGER24 in
 * 2*pi/2^24 rad, ankle INTEGER16 in 10 um or in 2*pi/2^16 rad.
 * A sensor that has a foot switch tells its state in TPDO3, one byte, on change and every 50 ms.
 */
#ifndef HAL_DEVICES_LEG_SENSORS_H
#define HAL_DEVICES_LEG_SENSORS_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/bus/can_frame.h"
#include "model/foot_contact.h"
#include "model/side.h"

enum { LEG_SENSOR_LEVERS = 4 };

/* How one leg's counts become a leg angle and an ankle extension. */
struct leg_sensor_config {
    float angle_zero_rad;   /* reading when the leg is vertical: mounting offset */
    int8_t angle_direction; /* +1 when the count rises with the foot going ahead, else -1 */
    bool ankle_is_lever;    /* ankle counts are an angle; extension = lever * sin(...) */
    float ankle_lever_m;    /* lever only, > 0; with a table, at the neutral angle */
    /* A lever by a table: at so many steps of this plantarflexion beyond neutral. Between two it is straight,
     * beyond the last constant; the extension is its integral over the angle. Step 0: lever * sin(...). */
    float ankle_table_rad;
    float ankle_table_m[LEG_SENSOR_LEVERS];
    float ankle_neutral_rad; /* lever only: plantarflexion at extension 0 */
    float leg_counts_per_turn, ankle_counts_per_unit; /* of a metre, or with a lever of a turn */
    float ankle_zero_m;                               /* linear only: reading at extension 0 */
    uint8_t leg_bytes, ankle_bytes;                   /* 2, 3 or 4 */
    bool ankle_reversed; /* the ankle's count falls with plantarflexion */
    bool ankle_is_apart; /* it is a node of its own, with a frame of its own */
};

struct leg_sensor_reading {
    float leg_angle_rad;
    float ankle_extension_m; /* >= 0 for a lever; linear ankles may read below 0 by noise */
    uint16_t age_ticks;      /* 0 = both are from the newest cycle; UINT16_MAX = never */
    uint16_t leg_age_ticks, ankle_age_ticks; /* of each */
    int8_t duplicate_id_count;               /* different frames more than cycles: duplicate_id.h */
    uint16_t foot_age_ticks;                 /* of the switch's frame; UINT16_MAX = never */
    enum foot_contact foot; /* FOOT_UNKNOWN without a frame for FOOT_AGE_MAX_TICKS */
};

struct leg_sensors {
    struct leg_sensor_config config[SIDE_COUNT];
    struct leg_sensor_reading reading[SIDE_COUNT];
    uint32_t rx_malformed; /* right identifier, wrong length or type; saturates */
};

/* Starts with no readings. config: SIDE_COUNT entries, copied. */
void leg_sensors_init(struct leg_sensors *sensors, const struct leg_sensor_config *config);

/* Takes a frame if it belongs to a leg sensor and says whether it did. A frame
 * of the wrong length is counted and changes nothing. Loop only; O(1). */
bool leg_sensors_receive(struct leg_sensors *sensors, const struct can_msg *message);

/* A cycle has ended: every reading grows one tick older (saturating). */
void leg_sensors_age(struct leg_sensors *sensors);

#endif
