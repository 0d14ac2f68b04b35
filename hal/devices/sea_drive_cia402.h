/* SEA drives that speak CiA 402, cyclic synchronous position.
 *
 * Per cycle: one shared RPDO with both target positions, or one for each drive where one of them
 * has no dummy entries; controlword and latch on change and every SLOW_PDO_TICKS; statusword and actual position come back
 * at every SYNC (hal/bus/frame_table.h). Controlword and statusword bits: CiA 402-2,
 * as collected with their sources in sim_host/nodes' drive.
 *
 * The motor's force comes with the slow PDO (0x6077); whether the latch holds the
 * spring is the maker's bit 14 of the statusword.
 *
 * No kick on enable: until the drive reports "operation enabled" its target is
 * its own actual position.
 */
#ifndef HAL_DEVICES_SEA_DRIVE_CIA402_H
#define HAL_DEVICES_SEA_DRIVE_CIA402_H

#include "hal/devices/sea_drives.h"
#include "hal/devices/sea_latch.h"

struct cia402_axis_config {
    float counts_per_m;  /* motor counts per metre of spring, > 0 */
    int32_t zero_counts; /* count at the unloaded spring */
    int8_t direction;    /* +1 when counts rise with compression, else -1 */
    float rated_force_N; /* 1000 per mille of 0x6077; 0 = the force is not known */
    /* What this drive has otherwise than the virtual one; all false: it is like that. */
    bool absent;                                /* this leg has no CiA 402 drive */
    bool own_target;                            /* its target is the only one in its frame */
    bool no_outputs;                            /* its frame of the controlword has no outputs */
    bool no_torque, no_temperature, no_voltage; /* not in its slow PDO */
    bool no_follows_bit;                        /* bit 12 of its statusword says nothing */
    bool interpolated;   /* interpolated position: bit 4 of the controlword runs it */
    bool no_latch_bit;   /* the statusword does not tell of the latch */
    uint8_t latch_bit;   /* of the statusword; 0 = 14 */
    uint8_t contact_bit; /* likewise, of the other foot's contact at the latch; 0 = none */
};

struct cia402_axis {
    struct cia402_axis_config config;
    int32_t position_counts;
    uint16_t statusword;
    int16_t torque_per_mille;
    int16_t temperature_0_1_degC;
    uint32_t supply_mV;
    uint16_t age_ticks;
    uint16_t slow_age_ticks;
    struct sea_latch_sender sender; /* of controlword and outputs */
    int8_t duplicate_id_count;      /* different states more than cycles: duplicate_id.h */
    uint8_t reset_ticks;            /* of a fault reset under way: the bit is set, then low again */
};

struct cia402_drives {
    struct cia402_axis axis[SIDE_COUNT];
    uint32_t rx_malformed; /* saturates */
};

/* Starts with nothing received. config: SIDE_COUNT entries, copied. */
void cia402_drives_init(struct cia402_drives *drives, const struct cia402_axis_config *config);

/* The drives behind the common interface; *drives stays the caller's. */
struct sea_drives cia402_drives_interface(struct cia402_drives *drives);

#endif
