/* A walk with the flashed object code on the emulator, the fault that comes in it, and the black box behind
 * it. Who has set up loop, bridge and record starts it. */
#ifndef SIM_HOST_EMULATOR_PIL_SESSION_H
#define SIM_HOST_EMULATOR_PIL_SESSION_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "hal/storage/black_box.h"
#include "sim_host/emulator/pil_bridge.h"
#include "sim_host/emulator/pil_faults.h"
#include "sim_host/log/black_box_log.h"
#include "sim_host/loop/loop.h"
#include "sim_host/loop/walk_record.h"

struct pil_session {
    struct loop *loop;
    struct emulator emulator;
    struct pil_bridge bridge;
    struct walk_record record;
    struct can_bus tool; /* a port of its own, to ask the image over SDO */
    uint32_t steps;
    bool is_recording;
    enum pil_fault fault;
    uint32_t fault_step;
    /* Called once a step; NULL = nobody listens. */
    void (*on_step)(void *context, uint32_t steps);
    void *context;
    /* Results. */
    bool reached; /* all steps, or the safe state behind a fault */
    bool fell;
    char trouble[256]; /* "" = none */
    struct black_box black_box;
    struct black_box_summary black_box_summary;
};

/* Walks to the last step, the fault, the recording's end or trouble. */
void pil_session_walk(struct pil_session *session);

/* Brings the fault and waits for the safe state; nothing behind trouble. */
void pil_session_bring_fault(struct pil_session *session);

/* True when both springs are unloaded. */
bool pil_session_is_unloaded(const struct pil_session *session);

/* Reads crash record and black box over SDO and writes the box as a log. A box that no fault has frozen
 * is frozen now. */
void pil_session_fetch_black_box(struct pil_session *session, FILE *stream);

#endif
