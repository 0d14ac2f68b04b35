/* The MIT-mode drives' protocol, under any frames and commands in any order. */
#include "hal/devices/sea_drive_mit.h"
#include "tests/proof/arbitrary.h"
#include "tests/proof/drives_loop.h"

static struct mit_drives drives;

void proof_drive_mit(void)
{
    struct mit_axis_config config[SIDE_COUNT];
    for (int side = 0; side < SIDE_COUNT; side++) {
        config[side] = (struct mit_axis_config){
            any_u8,          any_u16,
            any_float,       any_float,
            (int8_t)any_int, any_float,
            any_float,       any_float,
            any_float,       {any_float, any_float, any_float, any_float, any_float}};
    }
    mit_drives_init(&drives, config);
    const struct sea_drives interface = mit_drives_interface(&drives);
    drives_loop(&interface);
}
