/* What afo walker says of its walk at the end. */
#ifndef SIM_HOST_CLI_WALKER_REPORT_H
#define SIM_HOST_CLI_WALKER_REPORT_H

#include <stdint.h>

#include "hal/bus/can_bus.h"

struct walker_figures {
    const char *interface;
    unsigned apexes, falls;
    char last_fall[32]; /* "" = none */
    uint64_t sync_ticks, clock_ticks, silences;
    uint64_t unanswered; /* SYNCs heard too late to be answered */
    uint32_t kernel_full, went_down;
    const double *apex_speed_rad_s; /* apexes of them */
};

/* On standard output. */
void walker_report_text(const struct walker_figures *figures, const struct can_bus_status *status);
void walker_report_json(const struct walker_figures *figures, const struct can_bus_status *status);

#endif
