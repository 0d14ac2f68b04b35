/* Faults of the device and its surroundings that a walk on the emulator can bring, and what must follow. */
#ifndef SIM_HOST_EMULATOR_PIL_FAULTS_H
#define SIM_HOST_EMULATOR_PIL_FAULTS_H

#include <stdint.h>

#include "controller/supervisor/supervisor.h"
#include "hal/storage/crash_record.h"

/* One a walk. */
enum pil_fault {
    PIL_FAULT_NONE,
    PIL_FAULT_EMERGENCY_STOP,
    PIL_FAULT_LOST_SENSOR,
    PIL_FAULT_LOST_DRIVE,
    PIL_FAULT_HANG,
    PIL_FAULT_SUPERVISOR,
    PIL_FAULT_HARD_FAULT,
    PIL_FAULT_STACK,
    PIL_FAULT_EXECUTE_RAM,
    PIL_FAULT_WRITE_PROGRAM,
    PIL_FAULT_ASSERTION,
    PIL_FAULT_PARAMETERS,
    PIL_FAULT_COUNT
};

struct pil_fault_kind {
    const char *name;
    uint32_t input;                /* what the image is told to do */
    enum supervisor_fault latched; /* what it must say then */
    enum crash_cause crash;        /* and the record it must leave */
};

/* By enum pil_fault. */
extern const struct pil_fault_kind pil_faults[PIL_FAULT_COUNT];

#endif
