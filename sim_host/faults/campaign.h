/* The fault campaign: runs drawn from a seed, each from a saved state of a steady walk.
 *
 * A scene is a steady walk, saved with everything that is in struct loop. A run restores a
 * scene's state and injects one or two faults at a moment of the step. The oracle decides what
 * follows. The same scene also goes on without a fault: a run's fault was effective when bus or
 * plant differ from that. Run i of seed s is the same run on every machine.
 */
#ifndef SIM_HOST_FAULTS_CAMPAIGN_H
#define SIM_HOST_FAULTS_CAMPAIGN_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "sim_host/faults/injector.h"
#include "sim_host/faults/oracle.h"

enum {
    CAMPAIGN_SCENES = 7,
    CAMPAIGN_PHASE_TICKS = 1200, /* a step lasts 0.9 to 1.1 s: every phase of it */
    CAMPAIGN_TAIL_TICKS = 3600,  /* after the last fault's end: steps have stopped by then */
    CAMPAIGN_TICKS = CAMPAIGN_PHASE_TICKS + 500 + 3000 + CAMPAIGN_TAIL_TICKS
};

struct campaign_plan {
    uint32_t index;
    uint8_t scene;
    uint8_t count;
    struct fault_shot shot[INJECTOR_SHOTS];
};

struct campaign_result {
    struct campaign_plan plan;
    bool effective;
    bool late; /* was not noticed within the time of its kind */
    uint32_t effect_tick, noticed_tick, unloaded_tick, unsafe_tick; /* ORACLE_NEVER: not */
    enum supervisor_fault fault;
    enum walk_fault walk_fault;
    unsigned unsafe;
};

struct campaign; /* large; campaign_create() */

const char *campaign_scene_name(unsigned scene);

/* Draws run `index` of a seed. Pure; O(1). */
void campaign_plan(uint64_t seed, uint32_t index, struct campaign_plan *plan);

/* Who walks the scenes. NULL: the paper's walker with the virtual device. */
struct campaign_walker {
    const char *person_path, *device_path;
};

/* Walks the scenes and saves them, on the heap; takes some seconds. An actuator of parts ([plant]) walks by
 * the predictive law, which bears its latch; speeds that a walker is not served at become ones that it
 * is. NULL after a message on stderr. Release with campaign_destroy(). */
struct campaign *campaign_create(const struct campaign_walker *walker);
void campaign_destroy(struct campaign *campaign);

/* Makes one run. log: candump of every frame; ticks: one CSV line a tick; either may be NULL.
 * About 40 ms. */
void campaign_run(struct campaign *campaign, const struct campaign_plan *plan, FILE *log,
                  FILE *ticks, struct campaign_result *result);

/* One line of a results file, and back; false for a line that is none. */
void campaign_write(FILE *file, const struct campaign_result *result);
bool campaign_read(const char *line, uint64_t seed, struct campaign_result *result);

#endif
