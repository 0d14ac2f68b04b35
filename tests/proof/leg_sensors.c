/* The leg sensors' decoder, under any frames in any order and any mounting. */
#include "hal/devices/leg_sensors.h"
#include "tests/proof/arbitrary.h"

static struct leg_sensors sensors;

void proof_leg_sensors(void)
{
    struct leg_sensor_config config[SIDE_COUNT];
    for (int side = 0; side < SIDE_COUNT; side++) {
        config[side] = (struct leg_sensor_config){any_float, (int8_t)any_int, any_bool(), any_float,
                                                  any_float};
        config[side].ankle_is_apart = any_bool();
        config[side].ankle_reversed = any_bool();
        config[side].ankle_table_rad = any_float;
        for (int i = 0; i < LEG_SENSOR_LEVERS; i++) {
            config[side].ankle_table_m[i] = any_float;
        }
    }
    leg_sensors_init(&sensors, config);
    for (;;) {
        struct can_msg message;
        any_message(&message);
        (void)leg_sensors_receive(&sensors, &message);
        if (any_bool()) {
            leg_sensors_age(&sensors);
        }
    }
}
