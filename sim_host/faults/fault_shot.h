/* What both campaigns do with one fault of a run: draw it, and tell of it. */
#ifndef SIM_HOST_FAULTS_FAULT_SHOT_H
#define SIM_HOST_FAULTS_FAULT_SHOT_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "sim_host/cli/json_writer.h"
#include "sim_host/faults/injector_shot.h"

/* Draws node, duration (short ones more often than long), magnitude and seed of a fault of this kind; its
 * start is the caller's. Returns where the magnitude lies in its kind's range, 0 to 1. */
double fault_shot_draw(uint64_t *state, enum fault_kind kind, struct fault_shot *shot);

/* " and", for another one than the first; its name, magnitude, node and time. */
void fault_shot_tell(FILE *stream, const struct fault_shot *shot, bool another);

/* ", WHAT at TICK"; nothing for UINT32_MAX, never. */
void fault_tick_tell(FILE *stream, const char *what, uint32_t tick);

/* Puts the faults of a run into an object that is open, as the list "faults". */
void fault_shots_describe(struct json_writer *json, const struct fault_shot *shot, unsigned count);

#endif
