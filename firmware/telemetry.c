#include "firmware/telemetry.h"

#include "hal/bytes.h"

#define SPEED_UNITS_PER_RAD_S 10000.0f
#define R0_UNITS_PER_METRE 100000.0f

static uint16_t scaled_u16(float value, float units)
{
    return (uint16_t)bytes_saturate_i32(value * units, 0, UINT16_MAX);
}

void telemetry_pack_step(uint8_t data[8], const struct step_record *step,
                         enum supervisor_fault fault)
{
    bytes_put_u16(data, scaled_u16(step->measured_speed_rad_s, SPEED_UNITS_PER_RAD_S));
    bytes_put_u16(data + 2, scaled_u16(step->commanded_speed_rad_s, SPEED_UNITS_PER_RAD_S));
    bytes_put_u16(data + 4, scaled_u16(step->r0_m, R0_UNITS_PER_METRE));
    data[6] = (uint8_t)(step->number & 0xFFu);
    data[7] = (uint8_t)((step->side == SIDE_RIGHT ? 0x80u : 0u) | ((unsigned)fault & 0x7Fu));
}

void telemetry_pack_state(uint8_t data[2], const struct controller_output *output,
                          bool emergency_stop)
{
    data[0] = (uint8_t)((emergency_stop ? 0x80u : 0u) | ((unsigned)output->state & 0x7Fu));
    data[1] = (uint8_t)output->fault;
}
