/* The leg sensors' decoder, under any frames in any order and any mounting. */
#include "hal/devices/leg_sensors.h"
#include "tests/proof/arbitrary.h"

static struct leg_sensors sensors;

void proof_leg_sensors(void)
{
    struct leg_sensor_config config[SIDE_COUNT];
    for (int side = 0; side < SIDE_COUNT; side++) {
        config[side] = (struct leg_sensor_config){.angle_zero_rad = any_float,
                                                  .angle_direction = (int8_t)any_int,
                                                  .ankle_is_lever = any_bool(),
                                                  .ankle_lever_m = any_float,
                                                  .ankle_neutral_rad = any_float,
                                                  .leg_counts_per_turn = any_float,
                                                  .ankle_counts_per_unit = any_float,
                                                  .ankle_zero_m = any_float,
                                                  .leg_bytes = (uint8_t)Frama_C_interval(2, 4),
                                                  .ankle_bytes = (uint8_t)Frama_C_interval(2, 4),
                                                  .ankle_reversed = any_bool(),
                                                  .ankle_is_apart = any_bool()};
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
