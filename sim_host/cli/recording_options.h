/* A person in the walker's place, recorded or walking by reflexes, from the command line. */
#ifndef SIM_HOST_CLI_RECORDING_OPTIONS_H
#define SIM_HOST_CLI_RECORDING_OPTIONS_H

#include <argp.h>
#include <stdbool.h>

#include "sim_host/loop/loop.h"
#include "sim_host/plant/recorded_person.h"

/* What is asked of a recording. */
struct recording_options {
    const char *path;    /* NULL: no recording */
    bool by_reflexes;    /* a person who walks by reflexes; no recording then */
    bool without_device; /* who walks by reflexes feels nothing of the device */
    struct recording_format format;
    bool format_given; /* some of the format is not the default */
    bool open_loop;    /* keep the law */
    enum foot_switch_preset_kind switches;
    enum foot_switch_fault switch_fault; /* of both feet */
    double switch_fault_s;               /* from so long after its beginning on */
    enum plant_latch_fault latch_fault;  /* of both latches */
    double latch_fault_s;
    const char *fit_path; /* NULL: no fitting run */
    bool switches_given;
};

/* Child parser: its input is a struct recording_options, set up by recording_options_init. A column is
 * "ROLE=NAME", e.g. "thigh_l=LT Thigh Pitch"; roles: time, and thigh, shank, ankle, contact with _l or
 * _r. An empty name: the recording has no such column. */
extern const struct argp recording_options_parser;

/* No recording; "seeded" switches. */
void recording_options_init(struct recording_options *options);

/* The recording's person instead of the walker, and the controller's rules, law and timing for them.
 * Returns 0, or -1 with the reason in message (LOOP_MESSAGE_MAX bytes). The file itself is read by
 * loop_init(). */
int recording_options_apply(const struct recording_options *options, struct loop_config *config,
                            char *message);

/* The same for a recording with the default format and switches, for who has no other option of it;
 * `path` NULL: nothing is done. */
int recording_options_play(const char *path, bool open_loop, struct loop_config *config,
                           char *message);

/* Whether a person stands in the walker's place. */
static inline bool recording_options_person(const struct recording_options *options)
{
    return options->path != NULL || options->by_reflexes;
}

#endif
