#include "sim_host/programs/bus_wait.h"

#include "hal/port_socketcan/socketcan_bus.h"
#include "sim_host/cli/bus_program.h"
#include "sim_host/cli/program.h"

enum { WAIT_NS = 20000000, WAITS_MAX = 100, RECOVERY_WAITS = 5 };

bool bus_wait(void *context, unsigned waits)
{
    struct socketcan_bus *socket = (struct socketcan_bus *)context;
    const struct can_bus bus = socketcan_bus_interface(socket);
    char advice[SOCKETCAN_ADVICE_MAX];
    if (waits % RECOVERY_WAITS == 0) {
        can_bus_recover(&bus);
    }
    if (socketcan_bus_advice(socket, advice, sizeof advice)) {
        program_complain("%s", advice);
    }
    (void)socketcan_bus_wait(socket, socketcan_now_ns() + WAIT_NS);
    return waits < WAITS_MAX && !bus_program_is_to_end();
}

bool bus_wait_pause(void *context, unsigned milliseconds)
{
    struct socketcan_bus *socket = (struct socketcan_bus *)context;
    const struct can_bus bus = socketcan_bus_interface(socket);
    const uint64_t end_ns = socketcan_now_ns() + milliseconds * UINT64_C(1000000);
    struct can_msg message;
    while (socketcan_now_ns() < end_ns && !bus_program_is_to_end()) {
        while (can_bus_receive(&bus, &message, NULL) == CAN_OK) {
            /* heartbeats, and answers to other tools */
        }
        (void)socketcan_bus_wait(socket, end_ns);
    }
    return !bus_program_is_to_end();
}
