/* The muscle section of a person file: how a person who walks by reflexes (sim_host/reflex) is made.
 *
 *     [muscles]       noise (none, or percent), reflexes (healthy, published), any gain of reflexes.h by its name,
 *                     start_speed_m_s, start_lean_rad, SOL_strength and so on for both legs,
 *                     tuned_seed, tuned_walks, tuned_value, tuned_with: where the gains come from
 *     [left.muscles]  [right.muscles]   strengths of one leg
 *
 * It speaks of the simulated person alone. The controller and its settings know nothing of it.
 */
#ifndef SIM_HOST_PERSONS_PERSON_MUSCLES_H
#define SIM_HOST_PERSONS_PERSON_MUSCLES_H

#include <stdbool.h>
#include <stdio.h>

#include "sim_host/reflex/reflex_person.h"

enum {
    PERSON_MUSCLE_KEYS = REFLEX_GAIN_COUNT + MUSCLE_COUNT + 8, /* of [muscles] */
    PERSON_MUSCLE_SECTIONS = 1 + SIDE_COUNT,
    PERSON_TUNED_WITH_MAX = 64
};

/* Key "noise" of [muscles]: the one that a section must have. */
enum { PERSON_MUSCLES_NOISE = 0 };

struct person_muscles {
    bool given[PERSON_MUSCLE_SECTIONS][PERSON_MUSCLE_KEYS]; /* what the file said already */
    double noise_percent;                                   /* of every stimulation; 0: none */
    struct reflex_gains gains;
    double start_speed_m_s, start_lean_rad;
    double strength[SIDE_COUNT][MUSCLE_COUNT]; /* shares of the full one */
    double tuned_seed, tuned_walks, tuned_value;
    char tuned_with[PERSON_TUNED_WITH_MAX]; /* the device worn meanwhile */
};

/* A healthy person, new to the device, with the preset REFLEX_NOISE_NONE; nothing given. */
void person_muscles_default(struct person_muscles *muscles);

/* Whether this is one of its three sections. */
bool person_muscles_has(const char *section);

/* Takes a key. Returns 0, or -1 with the reason in message (size bytes): unknown, given twice, out of range, or behind
 * what it would take back. */
int person_muscles_take(struct person_muscles *muscles, const char *section, const char *key,
                        const char *value, char *message, size_t size);

/* After the last key: 0, or -1 where there is a section and no word on the noise. */
int person_muscles_check(const struct person_muscles *muscles, char *message, size_t size);

/* Whether the file has such a section. */
bool person_muscles_given(const struct person_muscles *muscles);

/* Puts it on a person made by reflex_person_default(). */
void person_muscles_apply(const struct person_muscles *muscles,
                          struct reflex_person_params *params);

/* Writes the sections, if given; reading them gives the same numbers again. The stream keeps its error. */
void person_muscles_write(FILE *stream, const struct person_muscles *muscles);

/* Prints every key, its range and meaning. */
void person_muscles_print_keys(FILE *stream);

#endif
