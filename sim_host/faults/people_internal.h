/* A campaign of people at work: its sources, and the scene that is at hand. Private to its files. */
#ifndef SIM_HOST_FAULTS_PEOPLE_INTERNAL_H
#define SIM_HOST_FAULTS_PEOPLE_INTERNAL_H

#include "sim_host/faults/people_campaign.h"

struct source {
    char name[PEOPLE_NAME_MAX];
    struct recording recording;
    bool exact, walks;
};

struct people_campaign {
    struct loop loop;  /* snapshots hold pointers into it: it never moves */
    struct loop saved; /* of the scene below */
    struct loop alone; /* the same without the device, of a reflex scene */
    bool by_reflexes;
    struct subject subject[PEOPLE_DEVICES];
    unsigned sources;
    struct source source[PEOPLE_RECORDINGS_MAX];
    /* The scene that is at hand. */
    bool has_scene, scene_is_good, scene_is_walked, alone_is_walked;
    struct people_scene_plan plan;
    struct loop_config config;
    struct recording walk;
    struct person_truth truth;
    double changes_s; /* of the recording: the person stops, or something else begins */
    FILE *log;
};

/* Makes this scene the one at hand. False where it cannot be had. */
bool people_scene_enter(struct people_campaign *campaign, const struct people_scene_plan *plan);

/* A loop of the scene as after power-on. False with a message (LOOP_MESSAGE_MAX bytes). */
bool people_scene_power_on(struct people_campaign *campaign, char *message);

/* A loop of the scene as its walk is under way. */
bool people_scene_walk(struct people_campaign *campaign);

/* The same walk as far, of a reflex scene, without the device. */
bool people_scene_walk_alone(struct people_campaign *campaign);

/* The length of what is walked, s; and the tick at which this time of it comes. */
double people_scene_lasts_s(const struct people_campaign *campaign);
uint32_t people_scene_tick_at(const struct people_campaign *campaign, double time_s);

#endif
