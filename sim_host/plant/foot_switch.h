/* A foot switch under a simulated person's foot: the only part of the plant's sensing that may read the
 * recorded contact.
 *
 * The recorded contact goes in, once a tick, and a switch's signal comes out: late by a bias of its own
 * for closing and for opening, with jitter, and with bounce behind each edge. The device knows none of
 * these numbers. What is decided with such switches is simulated from truth, and is to be called so.
 *
 * No heap, no globals; O(1); plain data, a copy is a snapshot; same seed, same signal on every machine.
 */
#ifndef SIM_HOST_PLANT_FOOT_SWITCH_H
#define SIM_HOST_PLANT_FOOT_SWITCH_H

#include <stdbool.h>
#include <stdint.h>

#include "model/foot_contact.h"
#include "sim_host/random/rng.h"

enum foot_switch_fault {
    FOOT_SWITCH_WELL = 0,
    FOOT_SWITCH_STUCK_UP = 1,
    FOOT_SWITCH_STUCK_DOWN = 2,
    FOOT_SWITCH_MISSING = 3, /* the node says that it does not know */
    FOOT_SWITCH_CHATTER = 4, /* another value at every tick, by chance */
    FOOT_SWITCH_FALSE = 5,   /* closes at any time in swing, and opens again 30 ms later */
    FOOT_SWITCH_FAULT_COUNT = 6
};

struct foot_switch_params {
    bool present;
    double close_bias_s; /* 0 .. 0.1: the signal's edge behind the foot's */
    double open_bias_s;  /* the same for toe-off */
    double jitter_s;     /* 0 .. 0.05, added: uniform in [0, this) */
    double bounce_s;     /* 0 .. 0.02: so long the signal is random behind an edge */
    enum foot_switch_fault fault;
    double fault_from_s; /* of the plant's time */
};

/* Presets. "seeded" draws each bias from 0 .. 40 ms. */
enum foot_switch_preset_kind {
    FOOT_SWITCH_NONE = 0,
    FOOT_SWITCH_SEEDED = 1,
    FOOT_SWITCH_EXACT = 2, /* no bias, no jitter, no bounce: no real switch is so */
    FOOT_SWITCH_10MS = 3,  /* every edge so late, with jitter and bounce */
    FOOT_SWITCH_20MS = 4,
    FOOT_SWITCH_40MS = 5,
    FOOT_SWITCH_PRESET_COUNT = 6
};

enum { FOOT_SWITCH_EDGES = 4 }; /* on their way at the same time */

struct foot_switch {
    struct foot_switch_params params;
    struct rng rng;
    struct {
        double time_s;
        bool down;
    } edge[FOOT_SWITCH_EDGES];
    unsigned edges;
    bool foot_down; /* the foot itself at the last tick */
    bool down;      /* the signal without bounce */
    double bounce_until_s;
    double false_s; /* when the fault "false" closes it */
};

/* Fills every field for one leg (stream: a number of its own for each). jitter 3 ms, bounce 4 ms, but
 * for NONE and EXACT. */
void foot_switch_preset(enum foot_switch_preset_kind kind, uint64_t seed, uint64_t stream,
                        struct foot_switch_params *params);

/* The names on the command line, in the order of the enums. */
extern const char *const foot_switch_preset_names[FOOT_SWITCH_PRESET_COUNT];
extern const char *const foot_switch_fault_names[FOOT_SWITCH_FAULT_COUNT];

/* NULL if every field is in range, else the name of the first that is not. */
const char *foot_switch_params_check(const struct foot_switch_params *params);

/* The foot stands as given, and has done so for long. Params are copied. */
void foot_switch_init(struct foot_switch *foot, const struct foot_switch_params *params, bool down,
                      uint64_t seed, uint64_t stream);

/* One tick: the foot as it is at now_s. known: the recording has contacts. Returns the signal. */
enum foot_contact foot_switch_update(struct foot_switch *foot, bool down, bool known, double now_s);

#endif
