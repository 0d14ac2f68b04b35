#include "hal/canopen/co_pdo_objects.h"

#define RPDO(n, index) CO_PDO_RPDO(struct co_pdo_four, n, index)
#define TPDO(n, index) CO_PDO_TPDO(struct co_pdo_four, n, index)
#define MAPPING(field, index, name) CO_PDO_MAPPING(struct co_pdo_four, field, index, name)

static const struct co_entry objects[] = {
    RPDO(0, 0x1400),
    RPDO(1, 0x1401),
    RPDO(2, 0x1402),
    RPDO(3, 0x1403),
    MAPPING(rpdo[0], 0x1600, "RPDO mapping parameter"),
    MAPPING(rpdo[1], 0x1601, "RPDO mapping parameter"),
    MAPPING(rpdo[2], 0x1602, "RPDO mapping parameter"),
    MAPPING(rpdo[3], 0x1603, "RPDO mapping parameter"),
    TPDO(0, 0x1800),
    TPDO(1, 0x1801),
    TPDO(2, 0x1802),
    TPDO(3, 0x1803),
    MAPPING(tpdo[0], 0x1A00, "TPDO mapping parameter"),
    MAPPING(tpdo[1], 0x1A01, "TPDO mapping parameter"),
    MAPPING(tpdo[2], 0x1A02, "TPDO mapping parameter"),
    MAPPING(tpdo[3], 0x1A03, "TPDO mapping parameter"),
};

struct co_pdos co_pdo_four_init(struct co_pdo_four *four)
{
    const struct co_pdos pdos = {
        .objects = {objects, (uint16_t)(sizeof objects / sizeof objects[0]), four},
        .rpdo = four->rpdo,
        .tpdo = four->tpdo,
        .rpdo_count = CO_PDO_COUNT,
        .tpdo_count = CO_PDO_COUNT,
    };
    four->subs = CO_PDO_SUBS;
    return pdos;
}
