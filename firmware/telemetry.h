/* What the controller tells about itself: layout of its two PDOs.
 *
 * TELEMETRY, once per step, 8 bytes, little-endian:
 *   0-1 measured apex speed, 0.1 mrad/s    2-3 commanded speed, 0.1 mrad/s
 *   4-5 r0, 10 um                          6   step number modulo 256
 *   7   bit 7: side (1 = right); bits 0-6: latched fault
 * CONTROLLER_STATE, on change and every SLOW_PDO_TICKS, 2 bytes:
 *   0   bit 7: emergency stop pressed; bits 0-6: supervisor state
 *   1   latched fault
 */
#ifndef FIRMWARE_TELEMETRY_H
#define FIRMWARE_TELEMETRY_H

#include <stdbool.h>
#include <stdint.h>

#include "controller/controller.h"

/* Both write their whole payload; values beyond a field's range saturate. */
void telemetry_pack_step(uint8_t data[8], const struct step_record *step,
                         enum supervisor_fault fault);
void telemetry_pack_state(uint8_t data[2], const struct controller_output *output,
                          bool emergency_stop);

#endif
