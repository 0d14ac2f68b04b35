/* The CANSimple drives' protocol, under any frames and commands in any order. */
#include "hal/devices/sea_drive_cansimple.h"
#include "tests/proof/arbitrary.h"
#include "tests/proof/drives_loop.h"

static struct cansimple_drives drives;

void proof_drive_cansimple(void)
{
    struct cansimple_axis_config config[SIDE_COUNT];
    for (int side = 0; side < SIDE_COUNT; side++) {
        config[side] =
            (struct cansimple_axis_config){any_u8, any_float, any_float, (int8_t)any_int};
    }
    cansimple_drives_init(&drives, config);
    const struct sea_drives interface = cansimple_drives_interface(&drives);
    drives_loop(&interface);
}
