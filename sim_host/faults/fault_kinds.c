#include "sim_host/faults/fault_kinds.h"

#define FAULT_INFO(NAME, name, group, lasting, notice, shortest, longest, least, greatest, unit) \
    {name, FAULT_GROUP_##group, lasting, notice, shortest, longest, least, greatest, unit},
const struct fault_kind_info fault_kinds[FAULT_ALL_KINDS] = {FAULT_TABLE(FAULT_INFO)
                                                                 PEOPLE_FAULT_TABLE(FAULT_INFO)};

bool fault_kind_is_foreign(enum fault_kind kind)
{
    return (kind >= FAULT_FOREIGN_SENSOR && kind <= FAULT_FOREIGN_NMT) ||
           kind == FAULT_FOREIGN_SDO || kind == FAULT_FOREIGN_SDO_CONTROLLER;
}
