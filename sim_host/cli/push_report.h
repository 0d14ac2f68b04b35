/* The figures of each leg's pushes in text and JSON. */
#ifndef SIM_HOST_CLI_PUSH_REPORT_H
#define SIM_HOST_CLI_PUSH_REPORT_H

#include <stdio.h>

#include "sim_host/cli/json_writer.h"
#include "sim_host/loop/push_record.h"

/* A block of lines; nothing where no spring was ever released and no stance counts. */
void push_report_text(FILE *stream, const struct push_record *record, const struct loop *loop);

/* The member "push": an object with left, right and symmetry. */
void push_report_json(struct json_writer *json, const struct push_record *record,
                      const struct loop *loop);

/* A table with a line a leg; a header first. */
void push_report_csv(FILE *stream, const struct push_record *record, const struct loop *loop);

#endif
