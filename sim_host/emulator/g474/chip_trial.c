#include "sim_host/emulator/g474/chip_trial.h"

#include <string.h>

#include "hal/bus/bytes.h"
#include "hal/bus/frame_table.h"
#include "sim_host/emulator/g474/chip_update.h"
#include "sim_host/emulator/g474/mmio_model.h"
#include "sim_host/log/black_box_log.h"
#include "sim_host/log/sdo_upload.h"

enum {
    AFTER_FAULT_TICKS = 2500,
    /* One or two starts fail meanwhile; from the third on the image would leave the settings alone. */
    CRYSTAL_GONE_TICKS = 600,
    CRYSTAL_BACK_TICKS = 6000,
    DESTROYED_NS = 20 * 1000000,
    SDO_PATIENCE_TICKS = 500,
    STANDBY_TICKS = 3000,
    PORT_C = 2,
    PORT_DRIVE_LEFT = LOOP_PORT_FIRST_NODE,
    PORT_SENSOR_LEFT = LOOP_PORT_FIRST_NODE + 1,
    STORE_CONTROL = 0x1010,
    RESTORE_CONTROL = 0x1011,
    COUNTERS = 0x2020,
    COUNTERS_CYCLES = 28,
    IDENTITY = 0x2030,
    IDENTITY_PARAMS = 3,
    AFTER_CUT_TICKS = 20, /* behind its first word about its state */
    INSTALL_TICKS = 4000,
    SCAN_TICKS = 10000 /* the program looks through all of itself */
};
/* CiA 301, clauses 7.5.2.13 and 7.5.2.14. */
#define SAVE_SIGNATURE 0x65766173u
#define LOAD_SIGNATURE 0x64616F6Cu

/* The image comes to a stop, and the starter tells why. */
static void judge_silent(struct chip_session *session, const char *says)
{
    if (strstr(session->chip.uart, says) == NULL) {
        snprintf(session->trouble, sizeof session->trouble,
                 "the virtual COM port does not say \"%s\"", says);
    } else if (session->bridge.heard) {
        chip_session_complain(session, "the image sends");
    } else if (session->chip.led_edges == 0) {
        chip_session_complain(session, "LD2 does not blink");
    } else if (!chip_session_is_safe(session)) {
        chip_session_complain(session, "a spring is still loaded");
    } else {
        session->reached = true;
    }
}

static bool let_it_run(void *context, unsigned waits)
{
    struct chip_session *session = context;

    chip_bridge_tick(&session->bridge);
    return waits < SDO_PATIENCE_TICKS;
}

static struct sdo_upload tool_of(struct chip_session *session)
{
    return (struct sdo_upload){
        .bus = &session->tool, .node = NODE_CONTROLLER, .wait = let_it_run, .context = session};
}

static void fetch_crash(struct chip_session *session)
{
    session->crash_known = true;
    if (black_box_fetch_crash(&session->tool, let_it_run, session, &session->crash,
                              session->trouble, sizeof session->trouble) != 0) {
        session->crash_known = false;
    }
    struct sdo_upload tool = tool_of(session);
    uint8_t cycles[4] = {0};
    size_t length;
    (void)sdo_upload(&tool, COUNTERS, COUNTERS_CYCLES, cycles, sizeof cycles, &length);
    session->told_cycles = bytes_get_u32(cycles);
}

/* Without a crystal nothing may be sent; with it back the image starts again. */
static void be_without_crystal(struct chip_session *session)
{
    chip_bridge_stop_comparing(&session->bridge);
    chip_set_crystal(&session->chip, false);
    chip_session_pass(session, 10);
    session->bridge.heard = false;
    chip_session_pass(session, CRYSTAL_GONE_TICKS);
    if (session->bridge.heard) {
        chip_session_complain(session, "the image sends without its crystal");
    }
    if (!chip_session_is_safe(session)) {
        chip_session_complain(session, "a spring is loaded while the image is silent");
    }
    chip_set_crystal(&session->chip, true);
    chip_session_pass(session, CRYSTAL_BACK_TICKS);
}

/* The image starts, sees that a register does not hold what it wrote, and tries again later. */
static void lose_writes(struct chip_session *session)
{
    chip_bridge_stop_comparing(&session->bridge);
    chip_session_pass(session, CRYSTAL_GONE_TICKS);
    if (session->bridge.heard) {
        chip_session_complain(session,
                              "the image sends with a register that is not as it should be");
    }
    mmio_model_lose(0);
    chip_session_pass(session, CRYSTAL_BACK_TICKS);
}

/* A word of the settings that the image reads in place fails from now on. */
static void spoil_settings(struct chip_session *session)
{
    struct flash_model *flash = &session->chip.flash_registers;

    for (unsigned page = MODEL_STORE_PAGE; page < MODEL_PAGES; page++) {
        for (unsigned i = 2; i < MODEL_PAGE_WORDS; i++) {
            if (flash->state[page][i] == WORD_WRITTEN) {
                flash->state[page][i] = WORD_TORN;
            }
        }
    }
    memset(flash->in_cache, 0, sizeof flash->in_cache);
    chip_bridge_stop_comparing(&session->bridge);
}

static bool read_params_crc(struct chip_session *session, uint32_t *crc)
{
    struct sdo_upload tool = tool_of(session);
    uint8_t bytes[4] = {0};
    size_t length;

    const enum sdo_upload_result result =
        sdo_upload(&tool, IDENTITY, IDENTITY_PARAMS, bytes, sizeof bytes, &length);
    *crc = bytes_get_u32(bytes);
    return result == SDO_UPLOAD_DONE && length == sizeof bytes;
}

static bool kept_settings(struct chip_session *session)
{
    uint32_t crc;
    return read_params_crc(session, &crc) && crc == session->params_crc;
}

/* Asks the image, at standstill, to save or to forget its settings, and cuts its power. */
static void ask_and_cut(struct chip_session *session)
{
    struct sdo_upload tool = tool_of(session);
    const bool save = session->fault == CHIP_FAULT_SAVE_CUT;

    chip_session_pass(session, STANDBY_TICKS);
    session->crash_known = true; /* the tool's queue is read from here on */
    if (!read_params_crc(session, &session->params_crc)) {
        chip_session_complain(session, "the image does not tell which settings it has");
        return;
    }
    chip_cuts_begin(&session->cuts, &session->chip);
    const enum sdo_upload_result result =
        save ? sdo_write(&tool, STORE_CONTROL, 1, SAVE_SIGNATURE, 4)
             : sdo_write(&tool, RESTORE_CONTROL, 1, LOAD_SIGNATURE, 4);
    chip_cuts_finish(&session->cuts);
    if (!session->cuts.hit && (result != SDO_UPLOAD_DONE || session->cuts.operations == 0)) {
        chip_session_complain(session, "the image did not do what it was asked");
    }
    session->bridge.state = UINT8_MAX; /* until it says something */
}

static void update(struct chip_session *session)
{
    struct sdo_upload tool = tool_of(session);

    chip_bridge_stop_comparing(&session->bridge);
    if (session->fault != CHIP_FAULT_UPDATE_WALKING) {
        chip_session_pass(session, STANDBY_TICKS);
    }
    session->crash_known = true;
    chip_update_run(session, &tool);
    session->bridge.state = UINT8_MAX;
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
    case CHIP_FAULT_LOST_WRITE:
        lose_writes(session);
        break;
    case CHIP_FAULT_HALF_WRITTEN:
    case CHIP_FAULT_STUCK_RAM:
        chip_bridge_stop_comparing(bridge);
        break;
    case CHIP_FAULT_DAMAGED_PROGRAM:
        chip_bridge_stop_comparing(bridge);
        chip_damage(&session->chip,
                    CHIP_STARTER_BYTES + chip_session_image_bytes(&session->chip) - 8);
        chip_session_pass(session, SCAN_TICKS);
        break;
    case CHIP_FAULT_UPDATE:
    case CHIP_FAULT_UPDATE_OLDER:
    case CHIP_FAULT_UPDATE_OTHER_BOARD:
    case CHIP_FAULT_UPDATE_WALKING:
    case CHIP_FAULT_UPDATE_CUT:
        update(session);
        break;
    case CHIP_FAULT_ECC:
        spoil_settings(session);
        break;
    case CHIP_FAULT_SAVE_CUT:
    case CHIP_FAULT_LOAD_CUT:
        ask_and_cut(session);
        break;
    case CHIP_FAULT_NONE:
    case CHIP_FAULT_TORN_SETTINGS:
    case CHIP_FAULT_COUNT:
        break;
    }
}

static void judge(struct chip_session *session)
{
    const struct chip_fault_kind *kind = &chip_faults[session->fault];
    const struct chip_bridge *bridge = &session->bridge;
    const bool latched =
        bridge->fault == (uint8_t)kind->latched || (kind->or_latched >> bridge->fault & 1u) != 0;

    if (!latched) {
        snprintf(session->trouble, sizeof session->trouble, "it latches %s instead of %s",
                 supervisor_fault_name((enum supervisor_fault)bridge->fault),
                 supervisor_fault_name(kind->latched));
    } else if ((bridge->state == SUPERVISOR_FAULT) != (bridge->fault != SUPERVISOR_FAULT_NONE)) {
        snprintf(session->trouble, sizeof session->trouble, "it ends in state %u", bridge->state);
    } else if (session->crash.cause != (uint32_t)kind->crash) {
        snprintf(session->trouble, sizeof session->trouble, "it left crash record %u instead of %u",
                 (unsigned)session->crash.cause, (unsigned)kind->crash);
    } else if (chip_fault_is_update(session->fault)) {
        struct sdo_upload tool = tool_of(session);
        chip_update_judge(session, &tool);
        session->reached = session->trouble[0] == '\0';
    } else if (session->fault == CHIP_FAULT_LOST_WRITE && session->crash.detail != session->lose) {
        snprintf(session->trouble, sizeof session->trouble,
                 "the record names register %#x, not %#x", (unsigned)session->crash.detail,
                 (unsigned)session->lose);
    } else if (chip_fault_is_cut(session->fault) && bridge->fault == SUPERVISOR_FAULT_NONE &&
               !kept_settings(session)) {
        chip_session_complain(session, "it goes on with other settings");
    } else if (!chip_session_is_safe(session)) {
        chip_session_complain(session, "a spring is still loaded");
    } else {
        session->reached = true;
    }
}

void chip_trial_run(struct chip_session *session)
{
    session->reached = false;
    bring_fault(session);
    if (!chip_fault_is_cut(session->fault)) {
        chip_session_pass(session, AFTER_FAULT_TICKS);
    }
    for (unsigned i = 0; i < INSTALL_TICKS && session->bridge.state == UINT8_MAX; i++) {
        chip_session_pass(session, 1); /* it starts; a program may be put into its place before */
    }
    if (chip_fault_is_cut(session->fault)) {
        chip_session_pass(session, AFTER_CUT_TICKS);
    }
    if (chip_faults[session->fault].says != NULL) {
        judge_silent(session, chip_faults[session->fault].says);
        return;
    }
    if (session->trouble[0] == '\0') {
        chip_bridge_stop_comparing(&session->bridge); /* the host's task has nothing to read from */
        fetch_crash(session);
    }
    if (session->trouble[0] == '\0') {
        judge(session);
    }
    chip_cuts_end(&session->cuts, chip_session_is_good(session) ? NULL
                                  : session->trouble[0] != '\0' ? session->trouble
                                                                : session->chip.findings[0]);
    session->reached = session->reached && session->cuts.bad == 0;
}
