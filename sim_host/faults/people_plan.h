/* The draws of the campaign of people: who walks and how, and which faults a run has.
 *
 * Runs come in blocks of PEOPLE_BLOCK with one scene: a person, a copy of their walk, a device, switches.
 * Sources go round: every second block has a made person, whose cadence, size of the steps, asymmetry and
 * double support are drawn; the others have the recordings in turn, each with every kind of copy in turn.
 * Pure: run i of seed s among n recordings is the same run on every machine.
 */
#ifndef SIM_HOST_FAULTS_PEOPLE_PLAN_H
#define SIM_HOST_FAULTS_PEOPLE_PLAN_H

#include <stdbool.h>
#include <stdint.h>

#include "sim_host/faults/injector.h"
#include "sim_host/plant/changed_copy.h"
#include "sim_host/plant/foot_switch.h"
#include "sim_host/plant/made_person.h"
#include "sim_host/plant/sensors.h"

enum { PEOPLE_BLOCK = 16, PEOPLE_MADE = -1, PEOPLE_DEVICES = 2 };

struct people_scene_plan {
    uint32_t block;
    int source; /* number of a recording, or PEOPLE_MADE */
    struct made_person_params made;
    enum copy_kind copy;
    double phase;    /* of COPY_STOP, and where in a long recording the scene begins */
    unsigned device; /* 0 .. PEOPLE_DEVICES - 1 */
    enum foot_switch_preset_kind switches;
    enum sensor_preset_kind sensors;
    uint64_t seed; /* of sensors and switches */
};

struct people_plan {
    uint32_t index;
    struct people_scene_plan scene;
    bool from_power_on; /* the faults' time counts from there; else from a walk under way */
    uint8_t count;
    struct fault_shot shot[INJECTOR_SHOTS];
};

/* recordings: how many there are. O(1). */
void people_plan(uint64_t seed, uint32_t index, unsigned recordings, struct people_plan *plan);

/* Whether this fault has to be noticed before the first push when it is there from power-on. */
bool people_plan_must_notice(enum fault_kind kind);

#endif
