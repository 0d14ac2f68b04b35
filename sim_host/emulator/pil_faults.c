#include "sim_host/emulator/pil_faults.h"

#include "hal/pil_record.h"

const struct pil_fault_kind pil_faults[PIL_FAULT_COUNT] = {
    [PIL_FAULT_NONE] = {"none", 0, SUPERVISOR_FAULT_NONE, CRASH_NONE},
    [PIL_FAULT_EMERGENCY_STOP] = {"emergency-stop", PIL_EMERGENCY_STOP,
                                  SUPERVISOR_FAULT_EMERGENCY_STOP, CRASH_NONE},
    [PIL_FAULT_LOST_SENSOR] = {"lost-sensor", 0, SUPERVISOR_FAULT_SENSOR_STALE, CRASH_NONE},
    [PIL_FAULT_LOST_DRIVE] = {"lost-drive", 0, SUPERVISOR_FAULT_DRIVE_STALE, CRASH_NONE},
    [PIL_FAULT_HANG] = {"hang", PIL_DO_HANG, SUPERVISOR_FAULT_RESTARTED, CRASH_WATCHDOG},
    [PIL_FAULT_SUPERVISOR] = {"stalled-supervisor", PIL_DO_STALL_SUPERVISOR,
                              SUPERVISOR_FAULT_RESTARTED, CRASH_WATCHDOG},
    [PIL_FAULT_HARD_FAULT] = {"hard-fault", PIL_DO_HARD_FAULT, SUPERVISOR_FAULT_RESTARTED,
                              CRASH_BUS_FAULT},
    [PIL_FAULT_STACK] = {"stack-overflow", PIL_DO_OVERFLOW_STACK, SUPERVISOR_FAULT_RESTARTED,
                         CRASH_MEMORY_FAULT},
    [PIL_FAULT_EXECUTE_RAM] = {"execute-ram", PIL_DO_EXECUTE_RAM, SUPERVISOR_FAULT_RESTARTED,
                               CRASH_MEMORY_FAULT},
    [PIL_FAULT_WRITE_PROGRAM] = {"write-program", PIL_DO_WRITE_PROGRAM, SUPERVISOR_FAULT_RESTARTED,
                                 CRASH_MEMORY_FAULT},
    [PIL_FAULT_ASSERTION] = {"assertion", PIL_DO_ASSERT, SUPERVISOR_FAULT_RESTARTED,
                             CRASH_ASSERTION},
    [PIL_FAULT_PARAMETERS] = {"bad-parameters", 0, SUPERVISOR_FAULT_PARAMETERS, CRASH_NONE},
};
