/* A device's own emergencies: errors of any code raised, cleared and sent in any order, at any time, over a bus that
 * may refuse any frame. */
#include "hal/canopen/co_device_internal.h"
#include "tests/proof/arbitrary.h"

static struct co_device device;

void proof_device_errors(void)
{
    device.bus = any_bus;
    for (;;) {
        uint8_t vendor[5];
        any_bytes(vendor, sizeof vendor);
        device.comm.emcy_cob_id = any_u32;
        device.comm.emcy_inhibit_100us = any_u16;
        device.state = any_bool() ? CO_STATE_STOPPED : CO_STATE_OPERATIONAL;
        const uint16_t code = (uint16_t)Frama_C_interval(1, UINT16_MAX);
        switch (any_u8 % 4) {
        case 0:
            co_device_raise_for(&device, code, any_u8, any_u8, any_bool() ? vendor : NULL);
            break;
        case 1:
            co_device_clear_for(&device, any_u16, any_u8);
            break;
        case 2:
            (void)co_device_has_error(&device, any_u16);
            break;
        default:
            (void)co_device_process_emcy(&device, any_u64);
            break;
        }
        //@ assert queued: 0 <= device.emcy_count <= CO_EMCY_QUEUE;
        //@ assert kept: 0 <= device.comm.history_count <= CO_HISTORY_MAX;
    }
}
