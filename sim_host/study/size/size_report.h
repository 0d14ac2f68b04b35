/* The tables of afo size. */
#ifndef SIM_HOST_STUDY_SIZE_SIZE_REPORT_H
#define SIM_HOST_STUDY_SIZE_SIZE_REPORT_H

#include <stdio.h>

#include "sim_host/study/size/size.h"

struct size_result {
    const char *device, *person;
    const struct size_setup *setup;
    const struct size_row *rows;
    int count;
    bool chirp;
};

void size_report_text(FILE *stream, const struct size_result *result);
void size_report_json(FILE *stream, const struct size_result *result);

#endif
