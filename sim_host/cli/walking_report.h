/* A walk in the units of gait analysis, for a report and as JSON; of a recorded person also which events were found. */
#ifndef SIM_HOST_CLI_WALKING_REPORT_H
#define SIM_HOST_CLI_WALKING_REPORT_H

#include <stdio.h>

#include "sim_host/cli/json_writer.h"
#include "sim_host/loop/walking.h"

/* The object "walking": means over the last steps; null where something is not known. */
void walking_report_json(struct json_writer *json, const struct walk_record *record,
                         const struct loop *loop);

/* The same as lines; nothing before the first whole stride. */
void walking_report_text(FILE *stream, const struct walk_record *record, const struct loop *loop);

#endif
