#include "firmware/commissioning_objects.h"

#include "model/tick.h"

struct motion_request commissioning_request(const struct controller_objects *objects)
{
    return (struct motion_request){.order = objects->motion_order,
                                   .renewal = objects->motion_renewal,
                                   .kind = (enum motion_kind)objects->motion_kind,
                                   .side = (enum side)objects->motion_side,
                                   .share = objects->motion_share,
                                   .seconds = objects->motion_seconds,
                                   .frequency_Hz = objects->motion_frequency_Hz};
}

/* UINT16_MAX stays: it never came. */
static uint16_t ms_of_ticks(uint16_t ticks)
{
    const uint32_t ms = (uint32_t)ticks * TICK_PERIOD_US / 1000u;
    return ms < UINT16_MAX ? (uint16_t)ms : UINT16_MAX;
}

static void show_motion(struct controller_objects *objects, const struct motion *motion)
{
    objects->motion_phase = (uint8_t)motion->phase;
    objects->motion_outcome = (uint8_t)motion->outcome;
    objects->motion_outcome_order = motion->order;
    objects->motion_allowed_share = motion_share_allowed(motion);
    objects->motion_bandwidth_Hz = motion->bandwidth_Hz;
    objects->motion_last_frequency_Hz = motion->last_frequency_Hz;
    objects->motion_release_ms = ms_of_ticks(motion->release_ticks);
    objects->motion_unload_ms = ms_of_ticks(motion->unload_ticks);
}

void commissioning_show(struct controller_objects *objects, const struct motion *motion,
                        const struct leg_sensors *sensors, const struct sea_drives *drives)
{
    show_motion(objects, motion);
    for (int side = 0; side < SIDE_COUNT; side++) {
        const struct leg_sensor_reading *leg = &sensors->reading[side];
        const struct motion_sample *sample = &motion->sample[side];
        struct sea_drive_reading drive;
        sea_drives_read(drives, (enum side)side, &drive);
        objects->measured_motor_m[side] = drive.precompression_m;
        objects->measured_ankle_m[side] = leg->ankle_extension_m;
        objects->measured_angle_rad[side] = leg->leg_angle_rad;
        objects->measured_latch[side] = (uint8_t)drive.latch;
        objects->measured_drive[side] = (uint8_t)drive.state;
        objects->measured_foot[side] = (uint8_t)leg->foot;
        objects->sample_force_N[side] = sample->force_N;
        objects->sample_motor_m[side] = sample->position_m;
        objects->sample_number[side] = sample->number;
    }
}
