/* The CiA 402 drives' protocol, under any frames and commands in any order. */
#include "hal/devices/sea_drive_cia402.h"
#include "tests/proof/arbitrary.h"

static struct cia402_drives drives;

static void choose_command(struct sea_drive_command *command)
{
    command->precompression_m = any_float;
    command->enable = any_bool();
    command->latch_armed = any_bool();
    command->repeat = any_bool();
    command->clear_fault = any_bool();
    command->unconfigured = any_bool();
    command->operational = any_bool();
}

void proof_drive_cia402(void)
{
    struct cia402_axis_config config[SIDE_COUNT];
    for (int side = 0; side < SIDE_COUNT; side++) {
        /* settings_check() lets these pass: zero within half the range of a count. */
        config[side] = (struct cia402_axis_config){
            any_float, Frama_C_interval(-(1 << 30) + 32, (1 << 30) - 32), any_bool() ? 1 : -1,
            any_float};
    }
    cia402_drives_init(&drives, config);
    const struct sea_drives interface = cia402_drives_interface(&drives);
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
