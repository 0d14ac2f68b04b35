/* The campaign of people: faults drawn from a seed, into walks of recorded and made people.
 *
 * A scene is a walk from power-on; where it has come so far, its state is saved with everything that is in
 * struct loop. A run goes on from there, or begins at power-on, with one or two faults (people_plan.h).
 * person_judge.h decides what is unsafe at the person; the criteria of oracle.h stay beside it.
 */
#ifndef SIM_HOST_FAULTS_PEOPLE_CAMPAIGN_H
#define SIM_HOST_FAULTS_PEOPLE_CAMPAIGN_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "sim_host/faults/people_plan.h"
#include "sim_host/faults/person_judge.h"

enum { PEOPLE_RECORDINGS_MAX = 64, PEOPLE_NAME_MAX = 64 };

/* Who walks by reflexes may fall, and whose fall it is tells the pair: the same scene, seed and time without a part of it.
 * Values are in results files. */
enum people_fall {
    PEOPLE_STOOD = 0,
    PEOPLE_FELL_ALONE = 1,   /* without the device, too */
    PEOPLE_FELL_WEARING = 2, /* with the device, without its faults */
    PEOPLE_FELL_BY_FAULT = 3,
    PEOPLE_FALLS = 4
};

/* "the person's own", ... */
const char *people_fall_name(enum people_fall fall);

struct people_result {
    struct people_plan plan;
    bool assisted; /* the device assisted when the first fault began, or later */
    bool late;     /* a push came before a fault of assembly was noticed that has to be */
    uint32_t noticed_tick, first_push_tick,
        unsafe_tick; /* PERSON_JUDGE_NEVER: not; from the run's begin */
    unsigned pushes;
    enum supervisor_fault fault;
    unsigned unsafe;        /* bits of enum person_unsafe */
    unsigned unsafe_device; /* bits of enum oracle_unsafe */
    enum people_fall fall;
};

struct people_campaign; /* large */

/* Reads person, devices and the recordings of a folder (data/NAME.csv, data/people/NAME.csv, by name; NULL:
 * none). NULL after a complaint on stderr. */
struct people_campaign *people_campaign_create(const char *person, const char *const *devices,
                                               const char *data);
/* The same for a person who walks by reflexes. */
struct people_campaign *people_campaign_create_reflex(const char *person,
                                                      const char *const *devices);
void people_campaign_destroy(struct people_campaign *campaign);

/* How many, or PEOPLE_REFLEX_SCENES. */
unsigned people_campaign_recordings(const struct people_campaign *campaign);

/* "gait_young/limp" or "made 1.12 s, size 0.9 ..." */
void people_campaign_name(const struct people_campaign *campaign,
                          const struct people_scene_plan *plan, char *name, size_t size);

/* Makes one run. log: candump of every frame; ticks: one CSV line a tick; either may be NULL. 30 to 150 ms.
 * False where the scene cannot be had (no stride to stop in): the result says nothing was unsafe. */
bool people_campaign_run(struct people_campaign *campaign, const struct people_plan *plan,
                         FILE *log, FILE *ticks, struct people_result *result);

/* One line of a results file, and back; false for a line that is none. */
void people_result_write(FILE *file, const struct people_result *result);
bool people_result_read(const char *line, uint64_t seed, unsigned recordings,
                        struct people_result *result);

#endif
