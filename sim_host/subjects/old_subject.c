/* The one file of body and actuator that there was before persons and devices were parted: read, to be
 * converted. */
#include "sim_host/subjects/old_subject.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "sim_host/persons/law_name.h"
#include "sim_host/text/ini.h"
#include "sim_host/text/number_text.h"

struct old_key {
    const char *section;
    const char *key;
    double minimum, maximum;
    size_t offset;
    const char *meaning;
};

enum { OLD_KEYS = 22, OLD_KEYS_REQUIRED = 4 };

/* Keys with words for values. */
enum word_key { WORD_NAME, WORD_PROTOCOL, WORD_ANKLE_KIND, WORD_KEYS };

/* What a file says, and which keys it has said already. */
struct reading {
    struct old_subject *subject;
    bool given[OLD_KEYS];
    bool word_given[WORD_KEYS];
};

/* The first OLD_KEYS_REQUIRED have no default: a body is nobody's guess. */
#define KEY(section, key, minimum, maximum, field, meaning)                          \
    {                                                                                \
        section, key, minimum, maximum, offsetof(struct old_subject, field), meaning \
    }
static const struct old_key old_keys[OLD_KEYS] = {
    KEY("walker", "M", 0.1, 200.0, torso_mass_kg, "mass at the hip, kg"),
    KEY("walker", "m", 0.0001, 30.0, leg_mass_kg, "mass in the middle of each leg, kg"),
    KEY("walker", "l", 0.1, 1.5, leg_length_m, "leg length, m"),
    KEY("walker", "k", 1.0, 100000.0, spring_N_per_m, "ankle spring, N/m"),
    KEY("walker", "g", 1.0, 20.0, gravity_m_s2, "gravity, m/s^2"),
    KEY("sea", "stroke_max_m", 0.001, 0.6, stroke_max_m, "longest compression, m"),
    KEY("sea", "speed_max_m_s", 0.001, 10.0, speed_max_m_s, "motor speed limit, m/s of spring"),
    KEY("sea", "force_max_N", 0.1, 50000.0, force_max_N, "motor force limit, N"),
    /* Coarser than 30000 the position loop hunts too much for the hand to let go. */
    KEY("sea", "counts_per_m", 30000.0, 1.0e8, counts_per_m, "motor counts per metre of spring"),
    KEY("drive", "rated_force_N", 0.1, 50000.0, rated_force_N,
        "CiA 402: force of the spring at the motor's rated torque, N"),
    KEY("drive", "zero_counts", -1.0e9, 1.0e9, zero_counts,
        "CiA 402: count at the unloaded spring"),
    KEY("drive", "direction", -1.0, 1.0, direction,
        "CiA 402: 1 when counts rise with compression, else -1"),
    KEY("drive", "turns_per_m", 0.1, 100000.0, turns_per_m,
        "CANSimple: motor turns per metre of spring"),
    KEY("drive", "rad_per_m", 0.1, 100000.0, rad_per_m,
        "MIT: motor angle per metre of spring, rad/m"),
    KEY("drive", "zero_rad", -100.0, 100.0, zero_rad,
        "MIT: motor angle at the unloaded spring, rad"),
    KEY("drive", "position_range_rad", 0.1, 1000.0, position_range_rad,
        "MIT: position field, +- rad"),
    KEY("drive", "velocity_range_rad_s", 0.1, 1000.0, velocity_range_rad_s,
        "MIT: velocity field, +- rad/s"),
    KEY("drive", "torque_range_Nm", 0.1, 1000.0, torque_range_Nm, "MIT: torque field, +- Nm"),
    KEY("drive", "kp_Nm_rad", 0.0, 500.0, kp_Nm_rad, "MIT: position gain, Nm/rad"),
    KEY("drive", "kd_Nms_rad", 0.0, 5.0, kd_Nms_rad, "MIT: velocity gain, Nm s/rad"),
    KEY("ankle", "lever_m", 0.01, 0.5, ankle_lever_m, "lever of an ankle joint, m"),
    KEY("ankle", "neutral_rad", -1.0, 1.0, ankle_neutral_rad, "plantarflexion at extension 0, rad"),
};
#undef KEY

static void set_defaults(struct old_subject *subject)
{
    *subject = (struct old_subject){
        .name = "paper's walker",
        .torso_mass_kg = 1.0,
        .leg_mass_kg = 0.01,
        .leg_length_m = 1.0,
        .spring_N_per_m = 100.0,
        .gravity_m_s2 = 9.80665,
        .stroke_max_m = 0.35,
        .speed_max_m_s = 1.9,
        .force_max_N = 90.0,
        .counts_per_m = 13107200.0,
        .ankle_lever_m = 0.12,
        .protocol = DEVICE_CIA402,
        .direction = 1.0,
        .turns_per_m = 200.0, /* a 5 mm screw */
        .rad_per_m = 50.0,    /* a drum of 20 mm radius; AK80-9 ranges */
        .zero_rad = -12.0,
        .position_range_rad = 12.5,
        .velocity_range_rad_s = 50.0,
        .torque_range_Nm = 18.0,
        .kp_Nm_rad = 400.0,
        .kd_Nms_rad = 2.0,
    };
}

static int set_protocol(struct old_subject *subject, const char *value, char *message, size_t size)
{
    static const char *const names[] = {"cia402", "cansimple", "mit"};
    for (int i = 0; i < 3; i++) {
        if (strcmp(value, names[i]) == 0) {
            subject->protocol = (enum device_protocol)(DEVICE_CIA402 + i);
            return 0;
        }
    }
    snprintf(message, size,
             "key \"protocol\": \"%.40s\" is unknown, allowed is cia402, cansimple or mit", value);
    return -1;
}

static int set_ankle_kind(struct old_subject *subject, const char *value, char *message,
                          size_t size)
{
    if (strcmp(value, "linear") == 0) {
        subject->ankle = DEVICE_ANKLE_LINEAR;
        return 0;
    }
    if (strcmp(value, "lever") == 0) {
        subject->ankle = DEVICE_ANKLE_LEVER;
        return 0;
    }
    snprintf(message, size, "key \"kind\": \"%.40s\" is unknown, allowed is linear or lever",
             value);
    return -1;
}

static int set_word(struct reading *reading, enum word_key word, const char *value, char *message,
                    size_t size)
{
    struct old_subject *subject = reading->subject;
    if (reading->word_given[word]) {
        snprintf(message, size, "this key is given twice");
        return -1;
    }
    reading->word_given[word] = true;
    switch (word) {
    case WORD_PROTOCOL:
        return set_protocol(subject, value, message, size);
    case WORD_ANKLE_KIND:
        return set_ankle_kind(subject, value, message, size);
    default:
        snprintf(subject->name, sizeof subject->name, "%.*s", PERSON_NAME_MAX - 1, value);
        return 0;
    }
}

static int set_key(void *context, const char *section, const char *key, const char *value, int line,
                   char *message, size_t size)
{
    static const struct {
        const char *section, *key;
    } words[WORD_KEYS] = {{"subject", "name"}, {"drive", "protocol"}, {"ankle", "kind"}};
    struct reading *reading = (struct reading *)context;
    struct old_subject *subject = reading->subject;
    (void)line;
    if (strcmp(section, "controller") == 0) {
        return person_prescribe(&subject->prescription, key, value, message, size);
    }
    for (int i = 0; i < WORD_KEYS; i++) {
        if (strcmp(section, words[i].section) == 0 && strcmp(key, words[i].key) == 0) {
            return set_word(reading, (enum word_key)i, value, message, size);
        }
    }
    for (int i = 0; i < OLD_KEYS; i++) {
        const struct old_key *k = &old_keys[i];
        if (strcmp(section, k->section) == 0 && strcmp(key, k->key) == 0) {
            if (reading->given[i]) {
                snprintf(message, size, "key \"%s\" (%s) is given twice", key, k->meaning);
                return -1;
            }
            reading->given[i] = true;
            return number_text_read(key, value, k->minimum, k->maximum, k->meaning,
                                    (double *)((char *)subject + k->offset), message, size);
        }
    }
    if (section[0] == '\0') {
        snprintf(message, size, "key \"%.40s\" stands before the first [section]", key);
        return -1;
    }
    snprintf(message, size, "unknown key \"%.40s\" in section [%.40s]", key, section);
    return -1;
}

static int refuse(char *message, const char *path, const char *reason)
{
    snprintf(message, OLD_SUBJECT_MESSAGE_MAX, "%s: %s", path, reason);
    return -1;
}

/* A [drive] key of another protocol would do nothing, and be believed. */
static int check_drive_keys(const struct reading *reading, const char *path, char *message)
{
    static const char *const owners[] = {"CiA 402", "CANSimple", "MIT"};
    const char *own = owners[reading->subject->protocol - DEVICE_CIA402];
    for (int i = 0; i < OLD_KEYS; i++) {
        const struct old_key *k = &old_keys[i];
        if (reading->given[i] && strcmp(k->section, "drive") == 0 &&
            strncmp(k->meaning, own, strlen(own)) != 0) {
            snprintf(message, OLD_SUBJECT_MESSAGE_MAX,
                     "%s: key \"%s\" (%s) does nothing with this subject's protocol, %s", path,
                     k->key, k->meaning, own);
            return -1;
        }
    }
    return 0;
}

/* The motor's stroke must fit the field it is commanded in: beyond, every target would
 * silently be the last that fits. */
static int check_fit(const struct old_subject *subject, const char *path, char *message)
{
    const double stroke_m = old_subject_stroke_m(subject);
    if (subject->protocol == DEVICE_MIT) {
        const double end_rad = subject->zero_rad + stroke_m * subject->rad_per_m;
        if (fabs(subject->zero_rad) > subject->position_range_rad ||
            fabs(end_rad) > subject->position_range_rad) {
            snprintf(
                message, OLD_SUBJECT_MESSAGE_MAX,
                "%s: the motor's angle from \"zero_rad\", %g rad, to %g rad at the full stroke "
                "of %g m lies outside \"position_range_rad\", %g rad",
                path, subject->zero_rad, end_rad, stroke_m, subject->position_range_rad);
            return -1;
        }
    }
    if (fabs(subject->direction) != 1.0) {
        return refuse(message, path, "key \"direction\" is 1 or -1");
    }
    if (subject->zero_counts != floor(subject->zero_counts)) {
        return refuse(message, path, "key \"zero_counts\" is a whole number");
    }
    if (fabs(subject->zero_counts) + stroke_m * subject->counts_per_m > 2.0e9) {
        return refuse(message, path,
                      "\"zero_counts\" and the stroke in \"counts_per_m\" exceed 32 bits");
    }
    return 0;
}

int old_subject_read(struct old_subject *subject, const char *path, char *message)
{
    struct reading reading = {.subject = subject};
    set_defaults(subject);
    subject->stroke_max_m = 0.0; /* not the paper's walker's: by this body's scale */
    subject->speed_max_m_s = 0.0;
    subject->force_max_N = 0.0;
    snprintf(subject->name, sizeof subject->name, "%.*s", PERSON_NAME_MAX - 1, path);
    if (ini_read(path, set_key, &reading, message, OLD_SUBJECT_MESSAGE_MAX) != 0) {
        return -1;
    }
    for (int i = 0; i < OLD_KEYS_REQUIRED; i++) {
        if (!reading.given[i]) {
            snprintf(message, OLD_SUBJECT_MESSAGE_MAX,
                     "%s: section [%s] lacks key \"%s\" (%s), allowed is %g to %g", path,
                     old_keys[i].section, old_keys[i].key, old_keys[i].meaning, old_keys[i].minimum,
                     old_keys[i].maximum);
            return -1;
        }
    }
    if (subject->leg_mass_kg > subject->torso_mass_kg) {
        snprintf(message, OLD_SUBJECT_MESSAGE_MAX,
                 "%s: key \"m\" (%g kg) is above key \"M\" (%g kg)", path, subject->leg_mass_kg,
                 subject->torso_mass_kg);
        return -1;
    }
    return check_drive_keys(&reading, path, message) == 0 && check_fit(subject, path, message) == 0
               ? 0
               : -1;
}

double old_subject_stroke_m(const struct old_subject *subject)
{
    return subject->stroke_max_m > 0.0 ? subject->stroke_max_m : 0.35 * subject->leg_length_m;
}
