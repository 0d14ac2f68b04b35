/* afo-pil's command line: what it is told to walk, and the faults it can bring. */
#ifndef SIM_HOST_CLI_PIL_OPTIONS_H
#define SIM_HOST_CLI_PIL_OPTIONS_H

#include <stdbool.h>
#include <stdint.h>

#include "controller/supervisor/supervisor.h"
#include "hal/storage/crash_record.h"
#include "sim_host/cli/sensor_options.h"
#include "sim_host/cli/walk_options.h"

/* Faults of the device and its surroundings, one a walk. */
enum pil_fault {
    PIL_FAULT_NONE,
    PIL_FAULT_EMERGENCY_STOP,
    PIL_FAULT_LOST_SENSOR,
    PIL_FAULT_LOST_DRIVE,
    PIL_FAULT_HANG,
    PIL_FAULT_SUPERVISOR,
    PIL_FAULT_HARD_FAULT,
    PIL_FAULT_STACK,
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

struct pil_options {
    struct walk_options walk;
    struct sensor_options sensor;
    const char *image;
    uint32_t steps;
    enum sensor_preset_kind sensors;
    uint64_t seed;
    enum pil_fault fault;
    uint32_t fault_step;
    uint64_t corrupt_frame;
    const char *log_path, *costs_path, *black_box_path, *recording_path;
    bool json;
    bool quiet;
};

/* Sets the defaults and takes the arguments; ends the program where they are wrong (status 2) or ask for help.
 * Returns 0, or -1 when the arguments could not be parsed at all. */
int pil_options_parse(struct pil_options *options, int argc, char **argv);

#endif
