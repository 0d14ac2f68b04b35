/* The master's view of the nodes: heartbeats, boot-ups and emergencies of any content, in any order. */
#include "hal/canopen/network.h"
#include "tests/proof/arbitrary.h"

static struct network network;

void proof_network(void)
{
    network_init(&network);
    for (;;) {
        struct can_msg message;
        any_message(&message);
        (void)network_receive(&network, &message);
        switch (any_u8 % 6) {
        case 0:
            network_update(&network, &any_bus, any_u32);
            break;
        case 1:
            (void)network_enter_pre_operational(&network, &any_bus, any_u8);
            break;
        case 2:
            (void)network_stop_all(&network, &any_bus);
            break;
        case 3:
            network_clear_booted(&network);
            break;
        case 4:
            (void)network_is_overdue(&network, network_index(&network, any_u8) % NETWORK_NODES);
            break;
        default:
            (void)network_all_operational(&network);
            (void)network_has_error(&network);
            break;
        }
    }
}
