/* The SDO client, under any answers in any order, with a bus that may refuse any frame. */
#include "hal/canopen/co_sdo_client.h"
#include "tests/proof/arbitrary.h"

static struct co_sdo_client client;

void proof_sdo_client(void)
{
    uint8_t value[CO_VALUE_MAX];
    co_sdo_client_init(&client, (uint8_t)Frama_C_interval(1, 127), any_u64);
    //@ loop widen_hints client.position, CO_VALUE_MAX; loop widen_hints client.length, CO_VALUE_MAX;
    for (;;) {
        struct can_msg message;
        any_message(&message);
        (void)co_sdo_client_receive(&client, &message, any_u64);
        //@ assert length: client.length <= CO_VALUE_MAX;
        switch (any_u8 % 4) {
        case 0:
            co_sdo_client_read(&client, any_u16, any_u8, any_u64);
            break;
        case 1:
            any_bytes(value, sizeof value);
            co_sdo_client_write(&client, any_u16, any_u8, value,
                                (unsigned)Frama_C_interval(1, CO_VALUE_MAX), any_u64);
            break;
        default:
            (void)co_sdo_client_poll(&client, &any_bus, any_u64);
            break;
        }
    }
}
