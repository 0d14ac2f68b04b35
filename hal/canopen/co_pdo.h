/* PDOs of a device: mapping by object dictionary, transmission types, dummy mapping
 * (CiA 301 clauses 7.2.2, 7.5.2.34 to 7.5.2.37).
 *
 * Byte-aligned mapping only, which is all these profiles use; an entry with a bit
 * length that is not the object's is refused.
 */
#ifndef HAL_CANOPEN_CO_PDO_H
#define HAL_CANOPEN_CO_PDO_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/bus/can_frame.h"
#include "hal/canopen/co_od.h"

enum { CO_PDO_COUNT = 4, CO_PDO_MAP_MAX = 8 }; /* at most so many PDOs a direction */

enum co_transmission {
    CO_SYNC_ACYCLIC = 0, /* at the next SYNC after a change */
    CO_SYNC_MAX = 240,   /* 1..240: every nth SYNC */
    CO_EVENT_MANUFACTURER = 254,
    CO_EVENT_PROFILE = 255
};

/* Bits of the COB-ID beside the identifier (CiA 301 clauses 7.5.2.35 and 7.5.2.37). */
#define CO_PDO_INVALID 0x80000000U  /* the PDO does not exist */
#define CO_PDO_NO_RTR 0x40000000U   /* TPDO: not on remote request; RPDO: no meaning */
#define CO_PDO_EXTENDED 0x20000000U /* 29 bits of identifier: nobody here has them */

/* What one mapped byte range is, worked out when the mapping is switched on. */
struct co_pdo_slot {
    const struct co_entry *entry; /* NULL: dummy */
    void *base;
    uint8_t size;
};

struct co_pdo {
    /* objects */
    uint32_t cob_id;
    uint8_t type;
    uint16_t inhibit_100us; /* TPDO only */
    uint16_t event_ms;
    uint8_t map_count;
    uint32_t map[CO_PDO_MAP_MAX]; /* index << 16 | sub << 8 | bits */
    /* state */
    struct co_pdo_slot slot[CO_PDO_MAP_MAX];
    uint8_t length; /* bytes mapped */
    bool waiting;   /* RPDO: data for the next SYNC; TPDO: to be sent */
    bool seen;      /* RPDO: received since operational */
    bool timed_out;
    uint8_t sync_count;
    uint8_t data[CAN_FRAME_DATA_MAX];
    uint64_t last_ns; /* RPDO: received; TPDO: sent */
};

/* The PDOs of one device, in a struct of its owner's, and the table of their objects. */
struct co_pdos {
    struct co_dictionary objects; /* 0x1400 to 0x1BFF: co_pdo_objects.h */
    struct co_pdo *rpdo, *tpdo;
    uint8_t rpdo_count, tpdo_count; /* 0 .. CO_PDO_COUNT */
};

/* Works out the slots of pdo->map[0..count-1]. direction: CO_MAP_TX or CO_MAP_RX.
 * Returns CO_ABORT_NONE, or the abort code with nothing changed. Transmit PDOs may
 * not map dummies. */
uint32_t co_pdo_resolve(struct co_pdo *pdo, unsigned count,
                        const struct co_dictionary *dictionaries, unsigned dictionary_count,
                        enum co_access direction);

/* One mapping entry by itself: may it be mapped in this direction? */
uint32_t co_pdo_check_entry(uint32_t map, const struct co_dictionary *dictionaries,
                            unsigned dictionary_count, enum co_access direction,
                            struct co_pdo_slot *slot);

/* Packs the mapped values into out (8 bytes). Returns the length. */
unsigned co_pdo_pack(const struct co_pdo *pdo, uint8_t *out);

static inline bool co_pdo_is_valid(const struct co_pdo *pdo)
{
    return (pdo->cob_id & CO_PDO_INVALID) == 0;
}

/* The 11 bits that are on the bus. */
static inline uint32_t co_pdo_id(const struct co_pdo *pdo)
{
    return pdo->cob_id & CAN_ID_STANDARD_MAX;
}

static inline bool co_pdo_is_synchronous(const struct co_pdo *pdo)
{
    return pdo->type <= CO_SYNC_MAX;
}

#endif
