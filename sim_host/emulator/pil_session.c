#include "sim_host/emulator/pil_session.h"

#include <math.h>
#include <string.h>

#include "model/tick.h"
#include "sim_host/loop/walk_watch.h"

enum {
    /* What a restart costs before the first SYNC, with the watchdog's time-out. */
    DEAD_TICKS = TICKS_OF_MS(150),
    AFTER_FAULT_TICKS = TICKS_OF_MS(2500),
    SDO_PATIENCE_TICKS = TICKS_OF_MS(200),
    PORT_DRIVE_LEFT = LOOP_PORT_FIRST_NODE,
    PORT_SENSOR_LEFT = LOOP_PORT_FIRST_NODE + 1
};

/* ---- walking --------------------------------------------------------------------- */

static void tick(struct pil_session *session)
{
    loop_tick(session->loop);
    (void)walk_record_take(&session->record, session->loop);
    if (session->bridge.dead) { /* the image restarts: the bus is without SYNC meanwhile */
        session->bridge.inputs &= (uint32_t)PIL_EMERGENCY_STOP;
        for (int i = 0; i < DEAD_TICKS; i++) {
            loop_tick(session->loop);
        }
        pil_bridge_revive(&session->bridge);
    }
}

void pil_session_walk(struct pil_session *session)
{
    struct walk_watch watch;
    walk_watch_init(&watch, session->steps, session->is_recording);
    for (;;) {
        tick(session);
        if (session->bridge.failed) {
            snprintf(session->trouble, sizeof session->trouble, "the emulator is gone or silent");
            return;
        }
        if (session->on_step != NULL && session->record.count != watch.seen) {
            session->on_step(session->context, session->record.count);
        }
        const enum walk_end end = walk_watch_tick(&watch, &session->record, session->loop);
        if (end == WALK_RECORDING_OVER) {
            session->reached = watch.seen > 0;
            return;
        }
        if (session->fault != PIL_FAULT_NONE &&
            (watch.seen >= session->fault_step || session->fault == PIL_FAULT_PARAMETERS)) {
            return;
        }
        if (end == WALK_FELL) {
            session->fell = true;
            snprintf(session->trouble, sizeof session->trouble, "fell: %s",
                     walk_fault_name(plant_fault(&session->loop->nodes.plant)));
            return;
        }
        if (end == WALK_DONE) {
            session->reached = true;
            return;
        }
        if (end == WALK_STALLED) {
            snprintf(session->trouble, sizeof session->trouble, "no step within %d s",
                     walk_watch_limit_s(&watch));
            return;
        }
    }
}

/* ---- a fault --------------------------------------------------------------------- */

static void begin_fault(struct pil_session *session)
{
    session->bridge.inputs = pil_faults[session->fault].input;
    if (session->fault == PIL_FAULT_LOST_SENSOR) {
        sim_bus_connect(&session->loop->bus, PORT_SENSOR_LEFT, false);
    } else if (session->fault == PIL_FAULT_LOST_DRIVE) {
        sim_bus_connect(&session->loop->bus, PORT_DRIVE_LEFT, false);
    }
    if (session->fault == PIL_FAULT_EMERGENCY_STOP) {
        session->loop->rig.stop_pressed = true; /* the host's task presses along */
    }
}

bool pil_session_is_unloaded(const struct pil_session *session)
{
    bool safe = true;

    for (int side = 0; side < SIDE_COUNT; side++) {
        struct sea_output sea;
        plant_sea_output(&session->loop->nodes.plant, (enum side)side, &sea);
        safe = safe &&
               fabs(sea.position_m) <= 0.005 * session->loop->config.subject.person.leg_length_m;
    }
    return safe;
}

void pil_session_bring_fault(struct pil_session *session)
{
    const struct pil_fault_kind *kind = &pil_faults[session->fault];
    const struct pil_bridge *bridge = &session->bridge;

    if (session->trouble[0] != '\0') {
        return;
    }
    begin_fault(session);
    for (int i = 0; i < AFTER_FAULT_TICKS && !session->bridge.failed; i++) {
        tick(session);
    }
    if (bridge->failed) {
        snprintf(session->trouble, sizeof session->trouble, "the emulator is gone or silent");
    } else if (bridge->fault != (uint8_t)kind->latched) {
        snprintf(session->trouble, sizeof session->trouble, "it says \"%s\" instead of \"%s\"",
                 supervisor_fault_name((enum supervisor_fault)bridge->fault),
                 supervisor_fault_name(kind->latched));
    } else if (bridge->state != SUPERVISOR_FAULT) {
        snprintf(session->trouble, sizeof session->trouble, "it ends in state %u", bridge->state);
    } else if (bridge->hello.crash.cause != (uint32_t)kind->crash) {
        snprintf(session->trouble, sizeof session->trouble, "it left crash record %u instead of %u",
                 (unsigned)bridge->hello.crash.cause, (unsigned)kind->crash);
    } else if (!pil_session_is_unloaded(session)) {
        snprintf(session->trouble, sizeof session->trouble, "a spring is still loaded");
    } else {
        session->reached = true;
    }
}

/* ---- black box -------------------------------------------------------------------- */

static bool let_it_run(void *context, unsigned waits)
{
    struct pil_session *session = context;

    tick(session);
    return waits < SDO_PATIENCE_TICKS && !session->bridge.failed;
}

void pil_session_fetch_black_box(struct pil_session *session, FILE *stream)
{
    char version[BLACK_BOX_VERSION_MAX + 1];
    struct crash_record crash;

    session->bridge.comparing = false; /* the host's task has no black box to read from */
    if (black_box_fetch_crash(&session->tool, let_it_run, session, &crash, session->trouble,
                              sizeof session->trouble) != 0) {
        session->reached = false;
        return;
    }
    if (memcmp(&crash, &session->bridge.hello.crash, sizeof crash) != 0) {
        session->reached = false;
        snprintf(session->trouble, sizeof session->trouble,
                 "the crash record over SDO is not the one left");
        return;
    }
    if (black_box_fetch(&session->tool, let_it_run, session, true, &session->black_box, version,
                        session->trouble, sizeof session->trouble) != 0) {
        session->reached = false;
    } else if (black_box_log_write(&session->black_box, version, "can0", stream,
                                   &session->black_box_summary) != 0) {
        session->reached = false;
        snprintf(session->trouble, sizeof session->trouble,
                 "the black box cannot be read or written");
    }
}
