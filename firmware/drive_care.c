#include "firmware/drive_care.h"

#include "firmware/telemetry.h"
#include "hal/bus/bytes.h"
#include "hal/canopen/co_defs.h"

/* A drive whose position was heard so lately is there: then what it does not tell is missing. */
enum { HEARD_TICKS = TICKS_OF_MS(50) };
/* Of CONTROLLER_EMCY_SPARED: what it is about. */
enum { CAUSE_SPARED = 1, CAUSE_WITHDRAWN = 2 };
#define PERCENT 100.0f

void drive_care_init(struct derate_limits limit[SIDE_COUNT], struct controller_objects *objects,
                     const struct device_description *device)
{
    objects->loaded_without_link = 0;
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        const struct device_leg *own = &device->leg[leg];
        const bool driven = device_leg_is_driven(own);
        limit[leg] = (struct derate_limits){0};
        if (driven) {
            limit[leg] =
                (struct derate_limits){own->temperature_warn_degC, own->temperature_stop_degC,
                                       own->supply_min_V, own->supply_max_V};
        }
        if (driven && own->unload == DEVICE_UNLOAD_NONE) {
            objects->loaded_without_link |= (uint8_t)(1u << leg);
        }
    }
}

static uint8_t percent_of(float share)
{
    return (uint8_t)(share * PERCENT + 0.5f);
}

static uint8_t register_bits(unsigned cause)
{
    return cause == DERATE_TEMPERATURE                                 ? CO_ERROR_TEMPERATURE
           : cause == DERATE_SUPPLY_LOW || cause == DERATE_SUPPLY_HIGH ? CO_ERROR_VOLTAGE
                                                                       : CO_ERROR_GENERIC;
}

static void tell(const struct derate *derate, struct co_device *device)
{
    const unsigned left = derate->leg[SIDE_LEFT].cause, right = derate->leg[SIDE_RIGHT].cause;
    const uint8_t vendor[5] = {(uint8_t)left, (uint8_t)right, percent_of(derate->share),
                               derate->withdrawn ? derate->withdrew_cause : (uint8_t)DERATE_NONE,
                               derate->withdrew_leg};
    if (derate->withdrawn) {
        co_device_raise_for(device, CONTROLLER_EMCY_SPARED, CAUSE_WITHDRAWN,
                            register_bits(derate->withdrew_cause), vendor);
    } else {
        co_device_clear_for(device, CONTROLLER_EMCY_SPARED, CAUSE_WITHDRAWN);
    }
    if (left != DERATE_NONE || right != DERATE_NONE) {
        co_device_raise_for(device, CONTROLLER_EMCY_SPARED, CAUSE_SPARED,
                            register_bits(left != DERATE_NONE ? left : right), vendor);
    } else {
        co_device_clear_for(device, CONTROLLER_EMCY_SPARED, CAUSE_SPARED);
    }
}

void drive_care_update(struct controller *controller, const struct derate_limits limit[SIDE_COUNT],
                       const struct sea_drives *drives, uint32_t tick, bool busy,
                       struct co_device *device)
{
    const struct derate *derate = &controller->derate;
    const uint32_t since =
        derate->begun ? tick - derate->tick : tick + (uint32_t)DRIVE_CARE_PHASE_TICKS;
    struct derate_reading reading[SIDE_COUNT];
    if (since < (uint32_t)DRIVE_CARE_TICKS || (busy && since < 2u * (uint32_t)DRIVE_CARE_TICKS)) {
        return;
    }
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        struct sea_drive_reading drive;
        sea_drives_read(drives, (enum side)leg, &drive);
        reading[leg] = (struct derate_reading){.heard = drive.age_ticks <= HEARD_TICKS,
                                               .has_temperature = drive.has_temperature,
                                               .has_supply = drive.has_supply,
                                               .warning = drive.warning,
                                               .temperature_degC = drive.temperature_degC,
                                               .supply_V = drive.supply_V};
    }
    if (controller_bear(controller, limit, reading, tick)) {
        tell(&controller->derate, device);
    }
}

void drive_care_show(struct controller_objects *objects, const struct derate *derate,
                     const struct sea_drives *drives)
{
    objects->drive_warnings = 0;
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        struct sea_drive_reading drive;
        sea_drives_read(drives, (enum side)leg, &drive);
        objects->drive_temperature_0_1_degC[leg] =
            (int16_t)bytes_saturate_i32(drive.temperature_degC * 10.0f, INT16_MIN, INT16_MAX);
        objects->drive_supply_10_mV[leg] = (uint16_t)bytes_saturate_i32(
            drive.has_supply ? drive.supply_V * 100.0f : 0.0f, 0, UINT16_MAX);
        objects->drive_warnings |= (uint8_t)(drive.warning ? 1u << leg : 0u);
        objects->spared_cause[leg] = derate->leg[leg].cause;
    }
    objects->push_share_percent = percent_of(derate->share);
    objects->withdrawn = derate->withdrawn ? 1 : 0;
    objects->withdrew_cause = derate->withdrew_cause;
    objects->withdrew_leg = derate->withdrew_leg;
}
