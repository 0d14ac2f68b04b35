/* The CiA 402 drives' protocol, under any frames and commands in any order. */
#include "hal/devices/sea_drive_cia402.h"
#include "tests/proof/arbitrary.h"
#include "tests/proof/drives_loop.h"

static struct cia402_drives drives;

void proof_drive_cia402(void)
{
    struct cia402_axis_config config[SIDE_COUNT];
    for (int side = 0; side < SIDE_COUNT; side++) {
        /* device_keys.h allows less: a zero within 1e9 counts. */
        config[side] = (struct cia402_axis_config){
            any_float, Frama_C_interval(-(1 << 30) + 32, (1 << 30) - 32), any_bool() ? 1 : -1,
            any_float};
    }
    cia402_drives_init(&drives, config);
    const struct sea_drives interface = cia402_drives_interface(&drives);
    drives_loop(&interface);
}
