/* From a box of parts to a device file and a page to sign: the steps of commissioning.
 *
 * The tool reads the nodes over SDO and asks the controller for motions (objects 0x2060 to 0x2062). The
 * controller decides how far and how fast; a tool that goes away ends in unloaded springs. Each step can
 * be repeated, skipped with a reason, and interrupted. What a step finds is written down at once.
 *
 * A step that has a finding is FAILED, and the steps that need it are not run: loads grow only behind
 * steps that passed.
 */
#ifndef SIM_HOST_COMMISSION_COMMISSION_H
#define SIM_HOST_COMMISSION_COMMISSION_H

#include <stdbool.h>
#include <stdio.h>

#include "controller/signals.h"
#include "sim_host/ctl/ctl.h"
#include "sim_host/devices/device_file.h"

/* X(NAME, name, needs, what it shows); needs: bits 1 << COMMISSION_x. */
#define COMMISSION_STEPS_TABLE(X)                                                              \
    X(IDENTIFY, "identify", 0, "the nodes are there, once each, and are what the file says")   \
    X(REST, "rest", 1 << COMMISSION_IDENTIFY, "unloaded, every motor reads zero")              \
    X(MOVES, "moves", 1 << COMMISSION_REST,                                                    \
      "each motor moves by itself, the right way, as far as asked")                            \
    X(ZERO, "zero", 1 << COMMISSION_IDENTIFY, "the leg sensors' offsets, from quiet standing") \
    X(SENSORS, "sensors", 1 << COMMISSION_IDENTIFY,                                            \
      "each leg's sensor follows its own leg, the right way")                                  \
    X(LATCH, "latch", 1 << COMMISSION_MOVES,                                                   \
      "the latch holds, opens when it is armed, and tells it")                                 \
    X(SPRING, "spring", 1 << COMMISSION_MOVES | 1 << COMMISSION_LATCH,                         \
      "spring constant and friction, up to 15 %")                                              \
    X(BANDWIDTH, "bandwidth", 1 << COMMISSION_SPRING, "how fast the motor follows")            \
    X(LINK, "link", 1 << COMMISSION_SPRING,                                                    \
      "the drives unload by themselves when the link is lost")                                 \
    X(STOP, "stop", 1 << COMMISSION_IDENTIFY, "the emergency stop is seen, and its release")   \
    X(SWITCHES, "switches", 1 << COMMISSION_IDENTIFY, "the foot switches")

#define COMMISSION_STEP_NUMBER(id, name, needs, shows) COMMISSION_##id,
enum commission_step { COMMISSION_STEPS_TABLE(COMMISSION_STEP_NUMBER) COMMISSION_STEPS };
#undef COMMISSION_STEP_NUMBER

enum commission_verdict {
    COMMISSION_NOT_DONE = 0,
    COMMISSION_PASSED = 1,
    COMMISSION_FAILED = 2,      /* something was found */
    COMMISSION_SKIPPED = 3,     /* with a reason */
    COMMISSION_INTERRUPTED = 4, /* it was broken off, or the controller did not answer */
    COMMISSION_NO_PART = 5      /* the device has nothing of this kind */
};

enum {
    COMMISSION_FINDINGS = 8,
    COMMISSION_LINE = 320,
    COMMISSION_TEXT = 1024,
    COMMISSION_WHEN = 32
};

struct commission_result {
    enum commission_verdict verdict;
    char when[COMMISSION_WHEN];
    char done[COMMISSION_TEXT];   /* what was measured */
    char reason[COMMISSION_LINE]; /* SKIPPED, INTERRUPTED, NO_PART */
    unsigned finding_count;
    char finding[COMMISSION_FINDINGS][COMMISSION_LINE];
};

/* What a person's hands do for a step. */
enum commission_hand {
    COMMISSION_HAND_STAND,   /* stand upright and still, feet side by side */
    COMMISSION_HAND_SWING,   /* this leg forward and back */
    COMMISSION_HAND_TAP,     /* the foot switch of this leg, until the latch of the other opens */
    COMMISSION_HAND_FREE,    /* both feet are in the air, no switch is pressed */
    COMMISSION_HAND_SWITCH,  /* the foot switches of this leg are pressed, and stay so */
    COMMISSION_HAND_PRESS,   /* the emergency stop */
    COMMISSION_HAND_RELEASE, /* and release it */
    COMMISSION_HAND_NOTHING  /* no more */
};

/* The person beside the device. instruct: says what to do now; the tool then looks for it. confirm:
 * asks a question about a leg: 1 yes, 0 no, -1 nobody answers. */
struct commission_operator {
    void (*instruct)(void *context, enum commission_hand hand, enum side leg, const char *words);
    int (*confirm)(void *context, enum side leg, const char *question);
    void *context;
};

/* Whom a drive's data sheet says it is; 0 = not told. */
struct commission_identity {
    uint32_t vendor, product;
};

struct commission {
    struct ctl ctl;              /* opened to the controller's node */
    struct device_file declared; /* as its file says it */
    struct device_file device;   /* the same with what was found: zeros, unload */
    struct commission_identity expected[SIDE_COUNT]; /* of the drives, from their EDS */
    struct commission_operator person;
    struct commission_result result[COMMISSION_STEPS];
    char now[COMMISSION_WHEN]; /* what results are dated with */
    /* Read from the controller when a step begins. */
    double stiffness_N_m, largest_m, tolerance_m;
    double renewal; /* the last sign of life that was sent */
};

/* The device that is set up. All steps are open. */
void commission_declare(struct commission *commission, const struct device_file *device);

const char *commission_step_name(enum commission_step step);
const char *commission_step_shows(enum commission_step step);
const char *commission_verdict_name(enum commission_verdict verdict);

/* The step of that name; -1 for none, with the nearest in message (OBJECT_MESSAGE_MAX bytes). */
int commission_step_named(const char *name, char *message);

/* Which of the steps that this one needs has neither passed nor been skipped; -1: none is missing. */
int commission_missing(const struct commission *commission, enum commission_step step);

/* Runs one step, and says so on ctl.out; its old result is forgotten. Every motion it asked for has ended
 * when it returns. Does nothing but write down INTERRUPTED when a needed step is missing. */
enum commission_verdict commission_run(struct commission *commission, enum commission_step step);

/* Marks a step as skipped. reason: never empty. */
void commission_skip(struct commission *commission, enum commission_step step, const char *reason);

/* True when no step is open, failed or interrupted. */
bool commission_is_complete(const struct commission *commission);

/* The vendor and product of an EDS file ([DeviceInfo]). Returns 0, or -1 with the reason in message. */
int commission_read_eds(struct commission_identity *identity, const char *path, char *message);

/* The results as a file, to go on from, with what was found for the device file. Reading a file that is not
 * there leaves all steps open, and so does one of this device before its file was changed: that is then told
 * in message. Return 0, or -1 with the reason in message (OBJECT_MESSAGE_MAX bytes): another device's record
 * is refused. */
int commission_record_read(struct commission *commission, const char *path, char *message);
void commission_record_write(const struct commission *commission, FILE *stream);

/* One self-contained HTML page: done, found, accepted, hazards, and where to sign. */
void commission_page_write(const struct commission *commission, FILE *stream);

/* The steps in their order and what is recorded of each, as one JSON object. */
void commission_list_write(const struct commission *commission, FILE *stream);

#endif
