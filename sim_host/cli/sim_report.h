/* What afo sim says about a walk: for people, as JSON, as CSV. */
#ifndef SIM_HOST_CLI_SIM_REPORT_H
#define SIM_HOST_CLI_SIM_REPORT_H

#include <stdio.h>

#include "sim_host/cli/sim_options.h"
#include "sim_host/loop/loop.h"
#include "sim_host/loop/walk_record.h"

struct sim_outcome {
    bool fell;
    char fault[128]; /* "" = none; what ended the walk, in words */
    double wall_s;
};

void sim_report_text(FILE *stream, const struct sim_options *options, const struct loop *loop,
                     const struct walk_record *record, const struct sim_outcome *outcome);
void sim_report_json(FILE *stream, const struct sim_options *options, const struct loop *loop,
                     const struct walk_record *record, const struct sim_outcome *outcome);

/* Per step: header and one line a step. Times count from the record's gait.origin_s: of a recording by
 * its own clock. */
void sim_report_csv(FILE *stream, const struct walk_record *record, double target_rad_s);

/* Per tick: header, then one line for each call. event: enum walk_event_kind or -1. Times count from
 * origin_s of the plant. */
void sim_tick_header(FILE *stream, const struct loop *loop);
void sim_tick_line(FILE *stream, const struct loop *loop, int event, double origin_s);

#endif
