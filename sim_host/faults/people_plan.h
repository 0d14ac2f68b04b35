/* The draws of the campaign of people: who walks and how, and which faults a run has.
 *
 * Runs come in blocks of PEOPLE_BLOCK with one scene: a person, a copy of their walk, a device, switches.
 * Sources go round: every second block has a made person, whose cadence, size of the steps, asymmetry and
 * double support are drawn; the others have the recordings in turn, each with every kind of copy in turn.

 * In a campaign of reflex scenes a person walks by reflexes, with a dose that is drawn, a device and switches.
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

enum { PEOPLE_BLOCK = 16, PEOPLE_MADE = -1, PEOPLE_REFLEX = -2, PEOPLE_DEVICES = 2 };

/* In the place of a number of recordings: reflex scenes. */
#define PEOPLE_REFLEX_SCENES UINT32_MAX

struct people_scene_plan {
    uint32_t block;
    int source; /* number of a recording, PEOPLE_MADE or PEOPLE_REFLEX */
    struct made_person_params made;
    double dose; /* PEOPLE_REFLEX: share of the prescribed r0 */
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

/* recordings: how many there are, or PEOPLE_REFLEX_SCENES. O(1). */
void people_plan(uint64_t seed, uint32_t index, unsigned recordings, struct people_plan *plan);

/* Whether such a fault can befall who walks there: nobody who walks by reflexes can be told to stop or to hurry. */
bool people_plan_can(unsigned recordings, enum fault_kind kind);

/* Whether it befalls the person, whatever they wear. */
bool people_plan_befalls(enum fault_kind kind);

/* Whether this fault has to be noticed before the first push when it is there from power-on. */
bool people_plan_must_notice(enum fault_kind kind);

#endif
