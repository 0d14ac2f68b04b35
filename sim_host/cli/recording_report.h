/* The part of JSON that a recorded person adds to a walk. */
#ifndef SIM_HOST_CLI_RECORDING_REPORT_H
#define SIM_HOST_CLI_RECORDING_REPORT_H

#include "sim_host/cli/json_writer.h"
#include "sim_host/loop/gait_record.h"

/* Writes the members "left" and "right": per leg the times (s of the recording) of
 * apex, heel strike and toe-off as the controller estimated them, and beside each
 * list the times at which it knew; the latch's releases, and the motor's position at each (m of
 * spring); the recording's own heel
 * strikes and toe-offs; and the RMS error of the gait phase (share of a stride). */
void recording_report_json(struct json_writer *json, const struct gait_record *record);

#endif
