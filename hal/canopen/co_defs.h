/* Numbers of CANopen (CiA 301), checked against can-facts and against the Python
 * package canopen 2.x (canopen/sdo/exceptions.py, canopen/nmt.py), which tests use
 * as a peer. */
#ifndef HAL_CANOPEN_CO_DEFS_H
#define HAL_CANOPEN_CO_DEFS_H

enum co_cob { /* function codes; + node */
              CO_COB_NMT = 0x000,
              CO_COB_SYNC = 0x080,
              CO_COB_EMCY = 0x080,
              CO_COB_TPDO1 = 0x180,
              CO_COB_RPDO1 = 0x200,
              CO_COB_PDO_STEP = 0x100,
              CO_COB_SDO_ANSWER = 0x580,
              CO_COB_SDO_REQUEST = 0x600,
              CO_COB_HEARTBEAT = 0x700
};

enum co_nmt_command {
    CO_NMT_START = 1,
    CO_NMT_STOP = 2,
    CO_NMT_ENTER_PRE_OPERATIONAL = 128,
    CO_NMT_RESET_NODE = 129,
    CO_NMT_RESET_COMMUNICATION = 130
};

enum co_nmt_state {
    CO_STATE_BOOT_UP = 0,
    CO_STATE_STOPPED = 4,
    CO_STATE_OPERATIONAL = 5,
    CO_STATE_PRE_OPERATIONAL = 127
};

/* SDO abort codes, CiA 301 table 22. */
#define CO_ABORT_NONE 0x00000000U
#define CO_ABORT_TOGGLE 0x05030000U
#define CO_ABORT_TIMEOUT 0x05040000U
#define CO_ABORT_COMMAND 0x05040001U
#define CO_ABORT_MEMORY 0x05040005U
#define CO_ABORT_ACCESS 0x06010000U
#define CO_ABORT_WRITE_ONLY 0x06010001U
#define CO_ABORT_READ_ONLY 0x06010002U
#define CO_ABORT_NO_OBJECT 0x06020000U
#define CO_ABORT_NOT_MAPPABLE 0x06040041U
#define CO_ABORT_PDO_LENGTH 0x06040042U
#define CO_ABORT_INCOMPATIBLE 0x06040043U
#define CO_ABORT_LENGTH 0x06070010U
#define CO_ABORT_TOO_LONG 0x06070012U
#define CO_ABORT_TOO_SHORT 0x06070013U
#define CO_ABORT_NO_SUB 0x06090011U
#define CO_ABORT_VALUE 0x06090030U
#define CO_ABORT_TOO_HIGH 0x06090031U
#define CO_ABORT_TOO_LOW 0x06090032U
#define CO_ABORT_GENERAL 0x08000000U
#define CO_ABORT_NOT_STORED 0x08000020U
#define CO_ABORT_LOCAL_CONTROL 0x08000021U
#define CO_ABORT_DEVICE_STATE 0x08000022U
#define CO_ABORT_NO_DATA 0x08000024U

/* Emergency error codes, CiA 301 table 26. */
enum co_emcy_code {
    CO_EMCY_NONE = 0x0000,
    CO_EMCY_GENERIC = 0x1000,
    CO_EMCY_CAN_OVERRUN = 0x8110,
    CO_EMCY_CAN_PASSIVE = 0x8120,
    CO_EMCY_HEARTBEAT = 0x8130,
    CO_EMCY_BUS_OFF_RECOVERED = 0x8140,
    CO_EMCY_PDO_TOO_SHORT = 0x8210,
    CO_EMCY_PDO_TOO_LONG = 0x8220,
    CO_EMCY_RPDO_TIMEOUT = 0x8250
};

enum co_error_register { /* object 0x1001 */
                         CO_ERROR_GENERIC = 0x01,
                         CO_ERROR_CURRENT = 0x02,
                         CO_ERROR_VOLTAGE = 0x04,
                         CO_ERROR_TEMPERATURE = 0x08,
                         CO_ERROR_COMMUNICATION = 0x10,
                         CO_ERROR_PROFILE = 0x20,
                         CO_ERROR_MANUFACTURER = 0x80
};

/* Bit 30 of 0x1005: this device sends SYNC (CiA 301 clause 7.5.2.5). */
#define CO_SYNC_PRODUCER 0x40000000U

enum { CO_COB_INVALID_BIT = 31, CO_NODE_MAX = 127 };

#endif
