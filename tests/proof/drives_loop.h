/* Drives of any protocol, under any frames and commands in any order. */
#ifndef TESTS_PROOF_DRIVES_LOOP_H
#define TESTS_PROOF_DRIVES_LOOP_H

#include "hal/devices/sea_drives.h"
#include "tests/proof/arbitrary.h"

static void choose_command(struct sea_drive_command *command)
{
    command->precompression_m = any_float;
    command->enable = any_bool();
    command->latch_armed = any_bool();
    command->clear_fault = any_bool();
    command->repeat = any_bool();
    command->unconfigured = any_bool();
    command->operational = any_bool();
}

static void drives_loop(const struct sea_drives *drives)
{
    for (;;) {
        struct can_msg message;
        struct sea_drive_reading reading;
        struct sea_drive_command command[SIDE_COUNT];
        any_message(&message);
        (void)sea_drives_receive(drives, &message);
        if (any_bool()) {
            sea_drives_age(drives);
            for (int side = 0; side < SIDE_COUNT; side++) {
                sea_drives_read(drives, (enum side)side, &reading);
                //@ assert state: DRIVE_UNKNOWN <= reading.state <= DRIVE_FAULT;
                //@ assert latch: LATCH_UNKNOWN <= reading.latch <= LATCH_OPEN;
                choose_command(&command[side]);
            }
            (void)sea_drives_command(drives, command, &any_bus);
        }
    }
}

#endif
