#include "sim_host/persons/person_muscles.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#include "sim_host/text/nearest.h"
#include "sim_host/text/number_text.h"

#define STRENGTH_LEAST 0.05
#define STRENGTH_MOST 2.0
#define NOISE_MOST_PERCENT (100.0 * REFLEX_NOISE_MOST)
#define MOST_WHOLE 1e9

enum { TEXT_MAX = 128 };

/* What a key of [muscles] is. */
enum kind { KIND_NUMBER, KIND_WHOLE, KIND_GAIN, KIND_NOISE, KIND_TABLE, KIND_TEXT, KIND_STRENGTH };

struct muscle_key {
    const char *key, *unit;
    double minimum, maximum;
    size_t offset; /* of a number in struct person_muscles; of a strength: the muscle */
    enum kind kind;
    const char *meaning;
};

#define FIELD(name) offsetof(struct person_muscles, name)
#define GAIN(name, published, unit, meaning) \
    {#name, unit, -REFLEX_GAIN_MOST, REFLEX_GAIN_MOST, FIELD(gains.name), KIND_GAIN, meaning},
#define STRENGTH(name, id, meaning)                                                      \
    {                                                                                    \
        name "_strength", "1", STRENGTH_LEAST, STRENGTH_MOST, id, KIND_STRENGTH, meaning \
    }
static const struct muscle_key keys[PERSON_MUSCLE_KEYS] = {
    [PERSON_MUSCLES_NOISE] = {"noise", "%", 0.01, NOISE_MOST_PERCENT, FIELD(noise_percent),
                              KIND_NOISE, "of every stimulation, or none"},
    {"reflexes", "", 0.0, 0.0, 0, KIND_TABLE,
     "table of gains, healthy or published; gains below change it"},
    REFLEX_GAINS(GAIN) /* */
    {"start_speed_m_s", "m/s", 0.0, 3.0, FIELD(start_speed_m_s), KIND_NUMBER,
     "of the hip at the start"},
    {"start_lean_rad", "rad", -0.5, 0.5, FIELD(start_lean_rad), KIND_NUMBER,
     "of the trunk at the start, forward"},
    STRENGTH("sol", MUSCLE_SOL, "soleus, a share of its full force"),
    STRENGTH("ta", MUSCLE_TA, "tibialis anterior"),
    STRENGTH("gas", MUSCLE_GAS, "gastrocnemius"),
    STRENGTH("vas", MUSCLE_VAS, "vasti"),
    STRENGTH("ham", MUSCLE_HAM, "hamstrings"),
    STRENGTH("glu", MUSCLE_GLU, "glutei"),
    STRENGTH("hfl", MUSCLE_HFL, "hip flexors"),
    {"tuned_seed", "1", 0.0, MOST_WHOLE, FIELD(tuned_seed), KIND_WHOLE, "seed of the tuning"},
    {"tuned_walks", "1", 0.0, MOST_WHOLE, FIELD(tuned_walks), KIND_WHOLE, "persons tried"},
    {"tuned_value", "1", 0.0, 1e6, FIELD(tuned_value), KIND_NUMBER,
     "the objective's value of these gains"},
    {"tuned_with", "", 0.0, 0.0, FIELD(tuned_with), KIND_TEXT, "the device worn meanwhile"},
};
#undef GAIN
#undef STRENGTH
#undef FIELD

static const char *const section_names[PERSON_MUSCLE_SECTIONS] = {"muscles", "left.muscles",
                                                                  "right.muscles"};

void person_muscles_default(struct person_muscles *muscles)
{
    struct reflex_person_params params;
    reflex_person_default(80.0, 1.0, &params);
    memset(muscles, 0, sizeof *muscles);
    muscles->noise_percent = 100.0 * params.noise_share;
    muscles->gains = params.gains;
    muscles->start_speed_m_s = params.start_speed_m_s;
    muscles->start_lean_rad = params.start_lean_rad;
    for (int side = 0; side < SIDE_COUNT; side++) {
        for (int i = 0; i < MUSCLE_COUNT; i++) {
            muscles->strength[side][i] = 1.0;
        }
    }
}

static int section_of(const char *section)
{
    for (int i = 0; i < PERSON_MUSCLE_SECTIONS; i++) {
        if (strcmp(section, section_names[i]) == 0) {
            return i;
        }
    }
    return -1;
}

bool person_muscles_has(const char *section)
{
    return section_of(section) >= 0;
}

static bool gives(const struct person_muscles *muscles, int section)
{
    for (int i = 0; i < PERSON_MUSCLE_KEYS; i++) {
        if (muscles->given[section][i]) {
            return true;
        }
    }
    return false;
}

bool person_muscles_given(const struct person_muscles *muscles)
{
    return gives(muscles, 0) || gives(muscles, 1) || gives(muscles, 2);
}

/* ---- a key ---------------------------------------------------------------------------------------------------- */

static double *number_at(struct person_muscles *muscles, const struct muscle_key *key)
{
    return (double *)(void *)((char *)muscles + key->offset);
}

static int take_number(struct person_muscles *muscles, const struct muscle_key *key,
                       const char *value, char *message, size_t size)
{
    double number;
    if (number_text_read(key->key, value, key->minimum, key->maximum, key->meaning, &number,
                         message, size) != 0) {
        return -1;
    }
    if (key->kind == KIND_WHOLE && number != floor(number)) {
        snprintf(message, size, "key \"%s\" (%s): %g is not a whole number", key->key, key->meaning,
                 number);
        return -1;
    }
    *number_at(muscles, key) = number;
    return 0;
}

static int take_noise(struct person_muscles *muscles, const struct muscle_key *key,
                      const char *value, char *message, size_t size)
{
    if (strcmp(value, "none") == 0) {
        muscles->noise_percent = 100.0 * REFLEX_NOISE_NONE;
        return 0;
    }
    return take_number(muscles, key, value, message, size);
}

static int take_table(struct person_muscles *muscles, const char *value, char *message, size_t size)
{
    static const char *const tables[] = {"healthy", "published"};
    for (int i = 0; i < PERSON_MUSCLE_KEYS; i++) {
        if (keys[i].kind == KIND_GAIN && muscles->given[0][i]) {
            snprintf(message, size, "key \"reflexes\" must stand before key \"%s\", which it sets",
                     keys[i].key);
            return -1;
        }
    }
    if (strcmp(value, tables[0]) == 0) {
        reflex_gains_healthy(&muscles->gains);
    } else if (strcmp(value, tables[1]) == 0) {
        reflex_gains_published(&muscles->gains);
    } else {
        char reason[TEXT_MAX];
        nearest_refuse(value, tables, 2, sizeof tables[0], reason, sizeof reason);
        snprintf(message, size, "key \"reflexes\": %s", reason);
        return -1;
    }
    return 0;
}

static int take_strength(struct person_muscles *muscles, int section, const struct muscle_key *key,
                         const char *value, char *message, size_t size)
{
    double strength;
    if (number_text_read(key->key, value, key->minimum, key->maximum, key->meaning, &strength,
                         message, size) != 0) {
        return -1;
    }
    for (int side = 0; side < SIDE_COUNT; side++) {
        const bool is_own = section == 1 + side;
        if (section == 0 && gives(muscles, 1 + side)) {
            snprintf(message, size, "section [muscles] sets both legs: it must stand before [%s]",
                     section_names[1 + side]);
            return -1;
        }
        if (section == 0 || is_own) {
            muscles->strength[side][key->offset] = strength;
        }
    }
    return 0;
}

static int take_value(struct person_muscles *muscles, int section, const struct muscle_key *key,
                      const char *value, char *message, size_t size)
{
    switch (key->kind) {
    case KIND_NOISE:
        return take_noise(muscles, key, value, message, size);
    case KIND_TABLE:
        return take_table(muscles, value, message, size);
    case KIND_STRENGTH:
        return take_strength(muscles, section, key, value, message, size);
    case KIND_TEXT:
        snprintf(muscles->tuned_with, sizeof muscles->tuned_with, "%.*s", PERSON_TUNED_WITH_MAX - 1,
                 value);
        return 0;
    default:
        return take_number(muscles, key, value, message, size);
    }
}

static int refuse(const char *section, const char *key, char *message, size_t size)
{
    const char *near = nearest_name(key, keys, PERSON_MUSCLE_KEYS, sizeof keys[0]);
    snprintf(message, size, "unknown key \"%.40s\" in section [%s]%s%s", key, section,
             near != NULL ? "; nearest: " : "", near != NULL ? near : "");
    return -1;
}

int person_muscles_take(struct person_muscles *muscles, const char *section, const char *key,
                        const char *value, char *message, size_t size)
{
    const int number = section_of(section);
    for (int i = 0; i < PERSON_MUSCLE_KEYS; i++) {
        if (strcmp(key, keys[i].key) != 0) {
            continue;
        }
        if (number > 0 && keys[i].kind != KIND_STRENGTH) {
            snprintf(message, size, "key \"%s\" is of both legs: it belongs into [muscles]", key);
            return -1;
        }
        if (muscles->given[number][i]) {
            snprintf(message, size, "key \"%s\" (%s) is given twice", key, keys[i].meaning);
            return -1;
        }
        const int result = take_value(muscles, number, &keys[i], value, message, size);
        muscles->given[number][i] = true;
        return result;
    }
    return refuse(section, key, message, size);
}

int person_muscles_check(const struct person_muscles *muscles, char *message, size_t size)
{
    const int noise = PERSON_MUSCLES_NOISE;
    if (person_muscles_given(muscles) && !muscles->given[0][noise]) {
        snprintf(message, size,
                 "section [muscles] lacks key \"noise\" (%s), allowed is none, or %g to %g %%",
                 keys[noise].meaning, keys[noise].minimum, keys[noise].maximum);
        return -1;
    }
    return 0;
}

/* ---- use and output ------------------------------------------------------------------------------------------- */

void person_muscles_apply(const struct person_muscles *muscles, struct reflex_person_params *params)
{
    params->gains = muscles->gains;
    params->noise_share = muscles->noise_percent / 100.0;
    params->start_speed_m_s = muscles->start_speed_m_s;
    params->start_lean_rad = muscles->start_lean_rad;
    for (int side = 0; side < SIDE_COUNT; side++) {
        for (int i = 0; i < MUSCLE_COUNT; i++) {
            params->muscle[side][i].force_max_N *= muscles->strength[side][i];
        }
    }
}

static void write_number(FILE *stream, const struct muscle_key *key, double value)
{
    char number[NUMBER_TEXT_MAX], line[TEXT_MAX];
    number_text(value, number, sizeof number);
    snprintf(line, sizeof line, "%s = %s", key->key, number);
    fprintf(stream, "%-34s ; %s: %s\n", line, key->unit, key->meaning);
}

static void write_key(FILE *stream, const struct person_muscles *muscles, int section,
                      const struct muscle_key *key)
{
    switch (key->kind) {
    case KIND_NOISE:
        if (muscles->noise_percent > 0.0) {
            write_number(stream, key, muscles->noise_percent);
        } else {
            fprintf(stream, "noise = none\n");
        }
        return;
    case KIND_TABLE: /* the gains are all written */
        return;
    case KIND_TEXT:
        if (muscles->tuned_with[0] != '\0') {
            fprintf(stream, "%s = %s\n", key->key, muscles->tuned_with);
        }
        return;
    case KIND_STRENGTH:
        write_number(stream, key, muscles->strength[section - 1][key->offset]);
        return;
    default:
        write_number(stream, key,
                     *(const double *)(const void *)((const char *)muscles + key->offset));
    }
}

void person_muscles_write(FILE *stream, const struct person_muscles *muscles)
{
    if (!person_muscles_given(muscles)) {
        return;
    }
    for (int section = 0; section < PERSON_MUSCLE_SECTIONS; section++) {
        fprintf(stream, "\n[%s]\n", section_names[section]);
        for (int i = 0; i < PERSON_MUSCLE_KEYS; i++) {
            const bool of_a_leg = keys[i].kind == KIND_STRENGTH;
            if (of_a_leg == (section > 0)) {
                write_key(stream, muscles, section, &keys[i]);
            }
        }
    }
}

void person_muscles_print_keys(FILE *stream)
{
    for (int i = 0; i < PERSON_MUSCLE_KEYS; i++) {
        const struct muscle_key *k = &keys[i];
        char range[TEXT_MAX] = "";
        if (k->kind != KIND_TABLE && k->kind != KIND_TEXT) {
            snprintf(range, sizeof range, "%g to %g %s", k->minimum, k->maximum, k->unit);
        }
        fprintf(stream, "  %-20s %-20s %s\n", k->key, range, k->meaning);
    }
}
