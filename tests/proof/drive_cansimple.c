/* The CANSimple drives' protocol, under any frames and commands in any order. */
#include "hal/devices/sea_drive_cansimple.h"
#include "tests/proof/arbitrary.h"

static struct cansimple_drives drives;

static void choose_command(struct sea_drive_command *command)
{
    command->precompression_m = any_float;
    command->enable = any_bool();
    command->latch_armed = any_bool();
    command->clear_fault = any_bool();
    command->unconfigured = any_bool();
    command->operational = any_bool();
}

void proof_drive_cansimple(void)
{
    struct cansimple_axis_config config[SIDE_COUNT];
    for (int side = 0; side < SIDE_COUNT; side++) {
        config[side] =
            (struct cansimple_axis_config){any_u8, any_float, any_float, (int8_t)any_int};
    }
    cansimple_drives_init(&drives, config);
    const struct sea_drives interface = cansimple_drives_interface(&drives);
    for (;;) {
        struct can_msg message;
        struct sea_drive_reading reading;
        struct sea_drive_command command[SIDE_COUNT];
        any_message(&message);
        (void)sea_drives_receive(&interface, &message);
        if (any_bool()) {
            sea_drives_age(&interface);
            for (int side = 0; side < SIDE_COUNT; side++) {
                sea_drives_read(&interface, (enum side)side, &reading);
                //@ assert state: DRIVE_UNKNOWN <= reading.state <= DRIVE_FAULT;
                //@ assert latch: LATCH_UNKNOWN <= reading.latch <= LATCH_OPEN;
                choose_command(&command[side]);
            }
            (void)sea_drives_command(&interface, command, &any_bus);
        }
    }
}
