/* The part of afo-sim's JSON that a recorded wearer adds. */
#ifndef SIM_HOST_CLI_RECORDING_REPORT_H
#define SIM_HOST_CLI_RECORDING_REPORT_H

#include <stdio.h>

#include "sim_host/loop/gait_record.h"

/* Writes `, "left": {...}, "right": {...}`: per leg the times (s of the recording) of
 * apex, heel strike and toe-off as the controller estimated them, and beside each
 * list the times at which it knew; the latch's releases; the recording's own heel
 * strikes and toe-offs; and the RMS error of the gait phase (share of a stride). */
void recording_report_json(FILE *stream, const struct gait_record *record);

#endif
