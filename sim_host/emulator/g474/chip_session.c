#include "sim_host/emulator/g474/chip_session.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "hal/bus/frame_table.h"
#include "sim_host/log/black_box_log.h"
#include "sim_host/log/sdo_upload.h"
#include "sim_host/subjects/settings_image.h"

enum {
    AFTER_FAULT_TICKS = 2500,
    /* One or two starts fail meanwhile; from the third on the image would leave the settings alone. */
    CRYSTAL_GONE_TICKS = 600,
    CRYSTAL_BACK_TICKS = 6000,
    DESTROYED_NS = 20 * 1000000,
    FIRST_STEP_TICKS = 20000,
    STEP_TICKS = 10000,
    RECORD_DELAY_TICKS = 150,
    SDO_PATIENCE_TICKS = 500,
    STANDBY_TICKS = 3000,
    PORT_C = 2,
    PORT_DRIVE_LEFT = LOOP_PORT_FIRST_NODE,
    PORT_SENSOR_LEFT = LOOP_PORT_FIRST_NODE + 1,
    STORE_CONTROL = 0x1010
};
#define SAVE_SIGNATURE 0x65766173u /* "save", CiA 301 clause 7.5.2.13 */

#define BIT(fault) (1u << SUPERVISOR_FAULT_##fault)

const struct chip_fault_kind chip_faults[CHIP_FAULT_COUNT] = {
    [CHIP_FAULT_NONE] = {"none", SUPERVISOR_FAULT_NONE, 0, CRASH_NONE},
    [CHIP_FAULT_EMERGENCY_STOP] = {"emergency-stop", SUPERVISOR_FAULT_EMERGENCY_STOP, 0,
                                   CRASH_NONE},
    [CHIP_FAULT_LOST_SENSOR] = {"lost-sensor", SUPERVISOR_FAULT_SENSOR_STALE, 0, CRASH_NONE},
    [CHIP_FAULT_LOST_DRIVE] = {"lost-drive", SUPERVISOR_FAULT_DRIVE_STALE, 0, CRASH_NONE},
    /* Whatever is missed first. */
    [CHIP_FAULT_DESTROYED_FRAMES] = {"destroyed-frames", SUPERVISOR_FAULT_SENSOR_STALE,
                                     BIT(DRIVE_STALE) | BIT(NODE_LOST) | BIT(DRIVE), CRASH_NONE},
    [CHIP_FAULT_HANG] = {"hang", SUPERVISOR_FAULT_RESTARTED, 0, CRASH_WATCHDOG},
    [CHIP_FAULT_CRYSTAL_STOPS] = {"crystal-stops", SUPERVISOR_FAULT_RESTARTED, 0,
                                  CRASH_CLOCK_FAILED},
    [CHIP_FAULT_NO_CRYSTAL] = {"no-crystal", SUPERVISOR_FAULT_RESTARTED, 0, CRASH_CLOCK_FAILED},
    [CHIP_FAULT_TORN_SETTINGS] = {"torn-settings", SUPERVISOR_FAULT_PARAMETERS, 0, CRASH_NONE},
    [CHIP_FAULT_ECC] = {"ecc-error", SUPERVISOR_FAULT_PARAMETERS, BIT(RESTARTED), CRASH_NMI},
    [CHIP_FAULT_SAVE_CUT] = {"save-cut", SUPERVISOR_FAULT_NONE, 0, CRASH_NONE},
};

/* ---- preparing ------------------------------------------------------------------ */

int chip_session_start(struct chip_session *session, const struct loop_config *config,
                       const char *core, const char *image, FILE *log, char *message)
{
    struct loop_config wrapped = *config;
    uint8_t nv[SETTINGS_IMAGE_BYTES];

    chip_bridge_init(&session->bridge, &session->chip);
    wrapped.wrap_bus = chip_bridge_wrap;
    wrapped.wrap_context = &session->bridge;
    session->loop = calloc(1, sizeof *session->loop);
    if (session->loop == NULL || !walk_record_init(&session->record, session->steps, 0.0)) {
        snprintf(message, LOOP_MESSAGE_MAX, "out of memory");
        return -1;
    }
    if (loop_init(session->loop, &wrapped, log, message) != 0) {
        return -1;
    }
    session->started = true;
    chip_bridge_connect(&session->bridge, session->loop);
    session->tool =
        sim_bus_port(&session->loop->bus, sim_bus_attach(&session->loop->bus, "tool", NULL, NULL));
    if (settings_image_of(&session->loop->config.subject, &session->loop->config.params,
                          config->desired_speed_rad_s, session->fault != CHIP_FAULT_SAVE_CUT,
                          nv) != 0) {
        snprintf(message, LOOP_MESSAGE_MAX, "the firmware would refuse these settings");
        return -1;
    }
    if (chip_start(&session->chip, core, image, nv, sizeof nv) != 0) {
        snprintf(message, LOOP_MESSAGE_MAX, "%s", session->chip.message);
        return -1;
    }
    chip_drive_pin(&session->chip, PORT_C, 0, true); /* the emergency stop's contact is closed */
    chip_set_crystal(&session->chip, session->fault != CHIP_FAULT_NO_CRYSTAL);
    if (session->fault == CHIP_FAULT_TORN_SETTINGS) {
        session->chip.flash_registers.state[0][12] = WORD_TORN;
    }
    if (session->fault == CHIP_FAULT_TORN_SETTINGS || session->fault == CHIP_FAULT_SAVE_CUT) {
        chip_bridge_stop_comparing(&session->bridge);
    }
    return 0;
}

void chip_session_free(struct chip_session *session)
{
    walk_record_free(&session->record);
    if (session->started) {
        loop_free(session->loop);
    }
    free(session->loop);
    chip_free(&session->chip);
}

bool chip_session_is_good(const struct chip_session *session)
{
    return session->reached && session->bridge.differences == 0 && session->chip.finding_count == 0;
}

static void trouble(struct chip_session *session, const char *text)
{
    if (session->trouble[0] == '\0') {
        snprintf(session->trouble, sizeof session->trouble, "%s", text);
    }
}

/* ---- walking --------------------------------------------------------------------- */

static void tick(struct chip_session *session)
{
    struct can_msg message;

    chip_bridge_tick(&session->bridge);
    (void)walk_record_take(&session->record, session->loop);
    while (!session->crash_known && can_bus_receive(&session->tool, &message, NULL) == CAN_OK) {
        /* Nobody reads the tool's queue but while it asks. */
    }
}

static void let_pass(struct chip_session *session, unsigned ticks)
{
    for (unsigned i = 0; i < ticks; i++) {
        tick(session);
    }
}

static bool has_walked(const struct chip_session *session, uint64_t last_progress)
{
    const struct walk_record *record = &session->record;

    return record->count >= session->steps &&
           (record->rows[session->steps - 1].measured ||
            session->loop->tick - last_progress > RECORD_DELAY_TICKS) &&
           (double)session->bridge.ticks * 1e-6 * TICK_PERIOD_US >= session->seconds;
}

void chip_session_walk(struct chip_session *session)
{
    const bool never = session->fault == CHIP_FAULT_NO_CRYSTAL ||
                       session->fault == CHIP_FAULT_TORN_SETTINGS ||
                       session->fault == CHIP_FAULT_SAVE_CUT;
    uint64_t last_progress = 0;
    uint32_t seen = 0, waited = 0;

    while (!never && !has_walked(session, last_progress)) {
        tick(session);
        const struct plant *plant = &session->loop->nodes.plant;
        if (session->record.count != seen) {
            seen = session->record.count;
            if (session->on_step != NULL) {
                session->on_step(session->context, seen);
            }
            last_progress = session->loop->tick;
            waited = 0;
        }
        if (session->fault != CHIP_FAULT_NONE && seen >= session->fault_step) {
            return;
        }
        if (plant_fault(plant) != WALK_FAULT_NONE) {
            session->fell = true;
            snprintf(session->trouble, sizeof session->trouble, "fell: %s",
                     walk_fault_name(plant_fault(plant)));
            return;
        }
        if (waited++ > (seen == 0 ? FIRST_STEP_TICKS : STEP_TICKS) && seen < session->steps) {
            trouble(session, session->bridge.ticks > 0 ? "no step within its time"
                                                       : "the image sends no SYNC");
            return;
        }
        if (session->bridge.ticks == 0 && waited > STANDBY_TICKS) {
            trouble(session, "the image sends no SYNC");
            return;
        }
    }
    session->reached = !never;
}

bool chip_session_is_safe(const struct chip_session *session)
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

/* ---- faults ------------------------------------------------------------------------- */

static bool let_it_run(void *context, unsigned waits)
{
    struct chip_session *session = context;

    chip_bridge_tick(&session->bridge);
    return waits < SDO_PATIENCE_TICKS;
}

static void fetch_crash(struct chip_session *session)
{
    session->crash_known = true;
    if (black_box_fetch_crash(&session->tool, let_it_run, session, &session->crash,
                              session->trouble, sizeof session->trouble) != 0) {
        session->crash_known = false;
    }
}

/* Without a crystal nothing may be sent; with it back the image starts again. */
static void be_without_crystal(struct chip_session *session)
{
    chip_bridge_stop_comparing(&session->bridge);
    chip_set_crystal(&session->chip, false);
    let_pass(session, 10);
    session->bridge.heard = false;
    let_pass(session, CRYSTAL_GONE_TICKS);
    if (session->bridge.heard) {
        trouble(session, "the image sends without its crystal");
    }
    if (!chip_session_is_safe(session)) {
        trouble(session, "a spring is loaded while the image is silent");
    }
    chip_set_crystal(&session->chip, true);
    let_pass(session, CRYSTAL_BACK_TICKS);
}

/* A word of the settings that the image reads in place fails from now on. */
static void spoil_settings(struct chip_session *session)
{
    struct flash_model *flash = &session->chip.flash_registers;

    for (unsigned page = 0; page < MODEL_PAGES; page++) {
        for (unsigned i = 2; i < MODEL_PAGE_WORDS; i++) {
            if (flash->state[page][i] == WORD_WRITTEN) {
                flash->state[page][i] = WORD_TORN;
            }
        }
    }
    memset(flash->in_cache, 0, sizeof flash->in_cache);
    chip_bridge_stop_comparing(&session->bridge);
}

static void save_and_cut(struct chip_session *session)
{
    struct flash_model *flash = &session->chip.flash_registers;
    struct sdo_upload tool = {
        .bus = &session->tool, .node = NODE_CONTROLLER, .wait = let_it_run, .context = session};
    const uint32_t resets = session->chip.resets;

    let_pass(session, STANDBY_TICKS);
    session->crash_known = true; /* the tool's queue is read from here on */
    flash->power_fails_at = flash->operations + session->cut;
    const enum sdo_upload_result saved = sdo_write(&tool, STORE_CONTROL, 1, SAVE_SIGNATURE, 4);
    session->cut_hit = session->chip.resets != resets;
    if (!session->cut_hit && (saved != SDO_UPLOAD_DONE || flash->operations == 0)) {
        trouble(session, "the settings were not saved");
    }
    flash->power_fails_at = UINT32_MAX;
    if (!session->cut_hit) {
        chip_power_cycle(&session->chip);
    }
}

static void bring_fault(struct chip_session *session)
{
    struct chip_bridge *bridge = &session->bridge;
    const uint64_t now_ns = chip_now_ns(&session->chip);

    switch (session->fault) {
    case CHIP_FAULT_EMERGENCY_STOP:
        chip_drive_pin(&session->chip, PORT_C, 0, false);
        session->loop->rig.stop_pressed = true; /* the host's task presses along */
        break;
    case CHIP_FAULT_LOST_SENSOR:
        sim_bus_connect(&session->loop->bus, PORT_SENSOR_LEFT, false);
        break;
    case CHIP_FAULT_LOST_DRIVE:
        sim_bus_connect(&session->loop->bus, PORT_DRIVE_LEFT, false);
        break;
    case CHIP_FAULT_DESTROYED_FRAMES:
        chip_bridge_stop_comparing(bridge);
        bridge->destroy_from_ns = now_ns;
        bridge->destroy_until_ns = now_ns + DESTROYED_NS;
        break;
    case CHIP_FAULT_HANG:
        session->chip.hang = true;
        break;
    case CHIP_FAULT_CRYSTAL_STOPS:
    case CHIP_FAULT_NO_CRYSTAL:
        be_without_crystal(session);
        break;
    case CHIP_FAULT_ECC:
        spoil_settings(session);
        break;
    case CHIP_FAULT_SAVE_CUT:
        save_and_cut(session);
        break;
    case CHIP_FAULT_NONE:
    case CHIP_FAULT_TORN_SETTINGS:
    case CHIP_FAULT_COUNT:
        break;
    }
}

static void expect_outcome(struct chip_session *session)
{
    const struct chip_fault_kind *kind = &chip_faults[session->fault];
    const struct chip_bridge *bridge = &session->bridge;
    const bool latched =
        bridge->fault == (uint8_t)kind->latched || (kind->or_latched >> bridge->fault & 1u) != 0;

    if (!latched) {
        snprintf(session->trouble, sizeof session->trouble, "it latches %s instead of %s",
                 supervisor_fault_name((enum supervisor_fault)bridge->fault),
                 supervisor_fault_name(kind->latched));
    } else if ((bridge->state == SUPERVISOR_FAULT) != (kind->latched != SUPERVISOR_FAULT_NONE)) {
        snprintf(session->trouble, sizeof session->trouble, "it ends in state %u", bridge->state);
    } else if (session->crash.cause != (uint32_t)kind->crash) {
        snprintf(session->trouble, sizeof session->trouble, "it left crash record %u instead of %u",
                 (unsigned)session->crash.cause, (unsigned)kind->crash);
    } else if (!chip_session_is_safe(session)) {
        trouble(session, "a spring is still loaded");
    } else {
        session->reached = true;
    }
}

void chip_session_bring_fault(struct chip_session *session)
{
    session->reached = false;
    bring_fault(session);
    let_pass(session, AFTER_FAULT_TICKS);
    if (session->trouble[0] == '\0') {
        chip_bridge_stop_comparing(&session->bridge); /* the host's task has nothing to read from */
        fetch_crash(session);
    }
    if (session->trouble[0] == '\0') {
        expect_outcome(session);
    }
}
