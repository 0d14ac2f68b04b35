/* What a report says of the drives: what they could bear (controller/supervisor/derate.h), and which
 * springs nothing unloads when the link is lost.
 */
#ifndef SIM_HOST_CLI_DRIVE_REPORT_H
#define SIM_HOST_CLI_DRIVE_REPORT_H

#include <stdio.h>

#include "firmware/control_task.h"
#include "sim_host/cli/json_writer.h"

/* Lines for people; none where there is nothing to say. */
void drive_report_text(FILE *stream, const struct control_task *task);

/* The object "drives" in an open object. */
void drive_report_json(struct json_writer *json, const struct control_task *task);

#endif
