/* The PDOs' objects, 0x1400 to 0x1BFF (CiA 301 clauses 7.5.2.34 to 7.5.2.37): entries for
 * a table over a struct that has as many PDOs as the device needs, and the usual one.
 *
 * owner is the struct: `uint8_t subs` (CO_PDO_SUBS), `struct co_pdo rpdo[]`, `tpdo[]`.
 */
#ifndef HAL_CANOPEN_CO_PDO_OBJECTS_H
#define HAL_CANOPEN_CO_PDO_OBJECTS_H

#include "hal/canopen/co_pdo.h"

enum { CO_PDO_SUBS = 5 }; /* highest sub-index of 0x1400 and 0x1800 */

#define CO_PDO_MAP_ENTRY(owner, field, index, n)                                 \
    CO_ANY(owner, field.map[(n)-1], index, n, CO_UNSIGNED32, CO_READ | CO_WRITE, \
           "Mapping entry " #n)

#define CO_PDO_MAPPING(owner, field, index, name)                                           \
    CO_OBJECT(owner, field.map_count, index, 0, CO_UNSIGNED8, CO_READ | CO_WRITE, 0,        \
              CO_PDO_MAP_MAX, name),                                                        \
        CO_PDO_MAP_ENTRY(owner, field, index, 1), CO_PDO_MAP_ENTRY(owner, field, index, 2), \
        CO_PDO_MAP_ENTRY(owner, field, index, 3), CO_PDO_MAP_ENTRY(owner, field, index, 4), \
        CO_PDO_MAP_ENTRY(owner, field, index, 5), CO_PDO_MAP_ENTRY(owner, field, index, 6), \
        CO_PDO_MAP_ENTRY(owner, field, index, 7), CO_PDO_MAP_ENTRY(owner, field, index, 8)

#define CO_PDO_RPDO(owner, n, index)                                                 \
    CO_ANY(owner, subs, index, 0, CO_UNSIGNED8, CO_READ | CO_CONST,                  \
           "RPDO communication parameter"),                                          \
        CO_ANY(owner, rpdo[n].cob_id, index, 1, CO_UNSIGNED32, CO_READ | CO_WRITE,   \
               "COB-ID used by RPDO"),                                               \
        CO_ANY(owner, rpdo[n].type, index, 2, CO_UNSIGNED8, CO_READ | CO_WRITE,      \
               "Transmission type"),                                                 \
        CO_ANY(owner, rpdo[n].event_ms, index, 5, CO_UNSIGNED16, CO_READ | CO_WRITE, \
               "Event timer")

#define CO_PDO_TPDO(owner, n, index)                                                      \
    CO_ANY(owner, subs, index, 0, CO_UNSIGNED8, CO_READ | CO_CONST,                       \
           "TPDO communication parameter"),                                               \
        CO_ANY(owner, tpdo[n].cob_id, index, 1, CO_UNSIGNED32, CO_READ | CO_WRITE,        \
               "COB-ID used by TPDO"),                                                    \
        CO_ANY(owner, tpdo[n].type, index, 2, CO_UNSIGNED8, CO_READ | CO_WRITE,           \
               "Transmission type"),                                                      \
        CO_ANY(owner, tpdo[n].inhibit_100us, index, 3, CO_UNSIGNED16, CO_READ | CO_WRITE, \
               "Inhibit time"),                                                           \
        CO_ANY(owner, tpdo[n].event_ms, index, 5, CO_UNSIGNED16, CO_READ | CO_WRITE,      \
               "Event timer")

/* Four of each, as predefined by CiA 301. */
struct co_pdo_four {
    uint8_t subs;
    struct co_pdo rpdo[CO_PDO_COUNT];
    struct co_pdo tpdo[CO_PDO_COUNT];
};

/* What co_device_config.pdos takes for *four, which stays the caller's. */
struct co_pdos co_pdo_four_init(struct co_pdo_four *four);

#endif
