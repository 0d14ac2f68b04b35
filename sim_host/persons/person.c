#include "sim_host/persons/person.h"

#include <assert.h>
#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "sim_host/persons/law_name.h"
#include "sim_host/text/ini.h"
#include "sim_host/text/nearest.h"
#include "sim_host/text/number_text.h"

struct person_key {
    const char *key, *unit;
    double minimum, maximum;
    size_t offset;
    const char *meaning;
};

enum { PERSON_KEYS = 4, PERSON_KEYS_REQUIRED = 3 };
#define SPEED_MIN_RAD_S 0.001
#define SPEED_MAX_RAD_S 20.0

/* The first PERSON_KEYS_REQUIRED have no default: a body is nobody's guess. */
#define KEY(field, unit, minimum, maximum, meaning)                             \
    {                                                                           \
#field, unit, minimum, maximum, offsetof(struct person, field), meaning \
    }
static const struct person_key person_keys[PERSON_KEYS] = {
    KEY(torso_mass_kg, "kg", 0.1, 200.0, "M, the mass at the hip"),
    KEY(leg_mass_kg, "kg", 0.0001, 30.0, "m, the mass in the middle of each leg"),
    KEY(leg_length_m, "m", 0.1, 1.5, "l, hip to heel"),
    KEY(gravity_m_s2, "m/s^2", 1.0, 20.0, "g"),
};
#undef KEY
static const struct person_key speed_key = {"speed_rad_s",
                                            "rad/s",
                                            SPEED_MIN_RAD_S,
                                            SPEED_MAX_RAD_S,
                                            offsetof(struct person, speed_rad_s),
                                            "forward apex speed to walk at"};

/* What a file says, and which keys it has said already. */
struct reading {
    struct person *person;
    bool given[PERSON_KEYS], name_given;
};

void person_default(struct person *person)
{
    *person = (struct person){.name = "paper's walker",
                              .torso_mass_kg = 1.0,
                              .leg_mass_kg = 0.01,
                              .leg_length_m = 1.0,
                              .gravity_m_s2 = 9.80665};
    person_muscles_default(&person->muscles);
}

static double *field_of(struct person *person, const struct person_key *key)
{
    return (double *)((char *)person + key->offset);
}

static int take_number(struct person *person, const struct person_key *key, const char *value,
                       char *message, size_t size)
{
    return number_text_read(key->key, value, key->minimum, key->maximum, key->meaning,
                            field_of(person, key), message, size);
}

/* Parameters that are numbers of something, or of a kind, and so have no halves. */
static int check_whole(const char *key, double value, char *message, size_t size)
{
    static const char *const keys[] = {"body", "law", "engage_steps", "engage_ramp_steps"};
    for (size_t i = 0; i < sizeof keys / sizeof keys[0]; i++) {
        if (strcmp(key, keys[i]) == 0 && value != floor(value)) {
            snprintf(message, size, "key \"%s\": %g is not a whole number", key, value);
            return -1;
        }
    }
    return 0;
}

static int take_parameter(struct person *person, int number, const char *value, char *message,
                          size_t size)
{
    const struct control_param_descriptor *d = &control_param_descriptors[number];
    enum law_mode law;
    if (person->control_overridden[number]) {
        snprintf(message, size, "key \"%s\" (%s) is given twice", d->name, d->meaning);
        return -1;
    }
    person->control_overridden[number] = true;
    const bool is_law = strcmp(d->name, "law") == 0;
    if (is_law && law_from_name(value, &law) == 0) {
        person->control_override[number] = (double)law;
        return 0;
    }
    if (is_law && isalpha((unsigned char)value[0])) {
        char reason[PERSON_MESSAGE_MAX / 2];
        law_name_refuse(value, reason, sizeof reason);
        snprintf(message, size, "key \"law\" (%s): %s", d->meaning, reason);
        return -1;
    }
    if (number_text_read(d->name, value, (double)d->minimum, (double)d->maximum, d->meaning,
                         &person->control_override[number], message, size) != 0) {
        return -1;
    }
    return check_whole(d->name, person->control_override[number], message, size);
}

int person_prescribe(struct person *person, const char *key, const char *value, char *message,
                     size_t size)
{
    for (int i = 0; i < CONTROL_PARAM_COUNT; i++) {
        if (strcmp(key, control_param_descriptors[i].name) == 0) {
            return take_parameter(person, i, value, message, size);
        }
    }
    if (strcmp(key, speed_key.key) == 0) {
        if (person->speed_rad_s > 0.0) {
            snprintf(message, size, "key \"%s\" (%s) is given twice", key, speed_key.meaning);
            return -1;
        }
        return take_number(person, &speed_key, value, message, size);
    }
    const char *near = nearest_name(key, control_param_descriptors, CONTROL_PARAM_COUNT,
                                    sizeof control_param_descriptors[0]);
    snprintf(message, size, "unknown key \"%.40s\" in section [prescription]%s%s", key,
             near != NULL ? "; nearest: " : "", near != NULL ? near : "");
    return -1;
}

static int take_body(struct reading *reading, const char *key, const char *value, char *message,
                     size_t size)
{
    if (strcmp(key, "name") == 0) {
        if (reading->name_given) {
            snprintf(message, size, "key \"name\" is given twice");
            return -1;
        }
        reading->name_given = true;
        snprintf(reading->person->name, PERSON_NAME_MAX, "%.*s", PERSON_NAME_MAX - 1, value);
        return 0;
    }
    for (int i = 0; i < PERSON_KEYS; i++) {
        const struct person_key *k = &person_keys[i];
        if (strcmp(key, k->key) == 0) {
            if (reading->given[i]) {
                snprintf(message, size, "key \"%s\" (%s) is given twice", key, k->meaning);
                return -1;
            }
            reading->given[i] = true;
            return take_number(reading->person, k, value, message, size);
        }
    }
    const char *near = nearest_name(key, person_keys, PERSON_KEYS, sizeof person_keys[0]);
    snprintf(message, size, "unknown key \"%.40s\" in section [person]%s%s", key,
             near != NULL ? "; nearest: " : "", near != NULL ? near : "");
    return -1;
}

static int take_key(void *context, const char *section, const char *key, const char *value,
                    int line, char *message, size_t size)
{
    struct reading *reading = (struct reading *)context;
    (void)line;
    if (strcmp(section, "person") == 0) {
        return take_body(reading, key, value, message, size);
    }
    if (strcmp(section, "prescription") == 0) {
        return person_prescribe(reading->person, key, value, message, size);
    }
    if (person_muscles_has(section)) {
        return person_muscles_take(&reading->person->muscles, section, key, value, message, size);
    }
    if (section[0] == '\0') {
        snprintf(message, size, "key \"%.40s\" stands before the first [section]", key);
    } else {
        snprintf(message, size,
                 "section [%.40s] is none of a person file: those are [person], [prescription], "
                 "[muscles], [left.muscles] and [right.muscles]",
                 section);
    }
    return -1;
}

int person_read(struct person *person, const char *path, char *message)
{
    struct reading reading = {.person = person};
    person_default(person);
    snprintf(person->name, sizeof person->name, "%.*s", PERSON_NAME_MAX - 1, path);
    if (ini_read(path, take_key, &reading, message, PERSON_MESSAGE_MAX) != 0) {
        return -1;
    }
    for (int i = 0; i < PERSON_KEYS_REQUIRED; i++) {
        const struct person_key *k = &person_keys[i];
        if (!reading.given[i]) {
            snprintf(message, PERSON_MESSAGE_MAX,
                     "%s: section [person] lacks key \"%s\" (%s), allowed is %g to %g %s", path,
                     k->key, k->meaning, k->minimum, k->maximum, k->unit);
            return -1;
        }
    }
    if (person->leg_mass_kg > person->torso_mass_kg) {
        snprintf(message, PERSON_MESSAGE_MAX,
                 "%s: key \"leg_mass_kg\" (%g kg) is above key \"torso_mass_kg\" (%g kg)", path,
                 person->leg_mass_kg, person->torso_mass_kg);
        return -1;
    }
    char lacks[PERSON_MESSAGE_MAX / 2];
    if (person_muscles_check(&person->muscles, lacks, sizeof lacks) != 0) {
        snprintf(message, PERSON_MESSAGE_MAX, "%s: %s", path, lacks);
        return -1;
    }
    return 0;
}

void person_override(struct person *person, const char *parameter, double value)
{
    for (int i = 0; i < CONTROL_PARAM_COUNT; i++) {
        if (strcmp(control_param_descriptors[i].name, parameter) == 0) {
            person->control_overridden[i] = true;
            person->control_override[i] = value;
            return;
        }
    }
    assert(false);
}

bool person_overrides(const struct person *person, size_t offset)
{
    for (int i = 0; i < CONTROL_PARAM_COUNT; i++) {
        if (control_param_descriptors[i].offset == offset) {
            return person->control_overridden[i];
        }
    }
    return false;
}

static void write_key(FILE *stream, const char *key, double value, const char *unit,
                      const char *meaning)
{
    char number[NUMBER_TEXT_MAX], line[128];
    number_text(value, number, sizeof number);
    snprintf(line, sizeof line, "%s = %s", key, number);
    fprintf(stream, "%-34s ; %s: %s\n", line, unit, meaning);
}

void person_write(FILE *stream, const struct person *person)
{
    fprintf(stream, "[person]\nname = %s\n", person->name);
    for (int i = 0; i < PERSON_KEYS; i++) {
        const struct person_key *k = &person_keys[i];
        const double value = *(const double *)((const char *)person + k->offset);
        write_key(stream, k->key, value, k->unit, k->meaning);
    }
    fprintf(stream, "\n[prescription]\n");
    if (person->speed_rad_s > 0.0) {
        write_key(stream, speed_key.key, person->speed_rad_s, speed_key.unit, speed_key.meaning);
    }
    for (int i = 0; i < CONTROL_PARAM_COUNT; i++) {
        const struct control_param_descriptor *d = &control_param_descriptors[i];
        if (person->control_overridden[i]) {
            write_key(stream, d->name, person->control_override[i], d->unit, d->meaning);
        }
    }
    person_muscles_write(stream, &person->muscles);
}
