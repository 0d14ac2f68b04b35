/* The communication profile area (CiA 301 clause 7.5.2) but for the PDOs: co_pdo_objects.h. */
#include "hal/canopen/co_device.h"

#define OWNER struct co_comm
#define RO CO_READ
#define RW (CO_READ | CO_WRITE)
#define FIXED (CO_READ | CO_CONST)

#define HISTORY(n) \
    CO_ANY(OWNER, history[(n)-1], 0x1003, n, CO_UNSIGNED32, RO, "Standard error field " #n)
#define CONSUMER(n) \
    CO_ANY(OWNER, consumer[(n)-1], 0x1016, n, CO_UNSIGNED32, RW, "Consumer heartbeat time " #n)

const struct co_entry co_comm_objects[] = {
    CO_ANY(OWNER, device_type, 0x1000, 0, CO_UNSIGNED32, FIXED, "Device type"),
    CO_ANY(OWNER, error_register, 0x1001, 0, CO_UNSIGNED8, RO | CO_MAP_TX, "Error register"),
    CO_ANY(OWNER, history_count, 0x1003, 0, CO_UNSIGNED8, RW, "Pre-defined error field"),
    HISTORY(1),
    HISTORY(2),
    HISTORY(3),
    HISTORY(4),
    HISTORY(5),
    HISTORY(6),
    HISTORY(7),
    HISTORY(8),
    CO_ANY(OWNER, sync_cob_id, 0x1005, 0, CO_UNSIGNED32, RW, "COB-ID SYNC message"),
    CO_ANY(OWNER, sync_period_us, 0x1006, 0, CO_UNSIGNED32, RW, "Communication cycle period"),
    CO_STRING(OWNER, name, 0x1008, 0, FIXED, "Manufacturer device name"),
    CO_STRING(OWNER, hardware_version, 0x1009, 0, FIXED, "Manufacturer hardware version"),
    CO_STRING(OWNER, software_version, 0x100A, 0, FIXED, "Manufacturer software version"),
    CO_ANY(OWNER, emcy_cob_id, 0x1014, 0, CO_UNSIGNED32, RO | CO_ADD_NODE, "COB-ID EMCY"),
    CO_ANY(OWNER, emcy_inhibit_100us, 0x1015, 0, CO_UNSIGNED16, RW, "Inhibit time EMCY"),
    CO_ANY(OWNER, heartbeat_consumers, 0x1016, 0, CO_UNSIGNED8, FIXED, "Consumer heartbeat time"),
    CONSUMER(1),
    CONSUMER(2),
    CONSUMER(3),
    CONSUMER(4),
    CO_ANY(OWNER, heartbeat_ms, 0x1017, 0, CO_UNSIGNED16, RW, "Producer heartbeat time"),
    CO_ANY(OWNER, identity_count, 0x1018, 0, CO_UNSIGNED8, FIXED, "Identity object"),
    CO_ANY(OWNER, vendor, 0x1018, 1, CO_UNSIGNED32, FIXED, "Vendor-ID"),
    CO_ANY(OWNER, product, 0x1018, 2, CO_UNSIGNED32, FIXED, "Product code"),
    CO_ANY(OWNER, revision, 0x1018, 3, CO_UNSIGNED32, FIXED, "Revision number"),
    CO_ANY(OWNER, serial, 0x1018, 4, CO_UNSIGNED32, RO, "Serial number"),
    CO_ANY(OWNER, behaviour_count, 0x1029, 0, CO_UNSIGNED8, FIXED, "Error behaviour"),
    CO_OBJECT(OWNER, communication_error_behaviour, 0x1029, 1, CO_UNSIGNED8, RW, 0, 2,
              "Communication error"),
    CO_ANY(OWNER, sdo_count, 0x1200, 0, CO_UNSIGNED8, FIXED, "SDO server parameter"),
    CO_ANY(OWNER, sdo_request_id, 0x1200, 1, CO_UNSIGNED32, RO | CO_ADD_NODE,
           "COB-ID client to server"),
    CO_ANY(OWNER, sdo_answer_id, 0x1200, 2, CO_UNSIGNED32, RO | CO_ADD_NODE,
           "COB-ID server to client"),
};

const uint16_t co_comm_object_count =
    (uint16_t)(sizeof co_comm_objects / sizeof co_comm_objects[0]);
