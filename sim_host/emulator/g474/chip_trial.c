#include "sim_host/emulator/g474/chip_trial.h"

#include <string.h>

#include "hal/bus/bytes.h"
#include "hal/bus/frame_table.h"
#include "sim_host/emulator/g474/chip_mark.h"
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
    COUNTERS_CORRECTED = 29,
    IDENTITY = 0x2030,
    IDENTITY_PARAMS = 3,
    AFTER_CUT_TICKS = 20, /* behind its first word about its state */
    INSTALL_TICKS = 4000,
    SCAN_TICKS = 20000, /* the program looks through all of itself */
    BROWN_OUT_TICKS = 5,
    LOW_SUPPLY_TICKS = 300,
    LOAD_TICKS = 3000,
    CUT_TICKS = 600,
    GUARD_BYTES = 32,
    LSI_HZ = 32000,
    REGISTER_R10 = 10,
    FLOAT_S29 = CORE_STICK_S0 + 29
};
/* CiA 301, clauses 7.5.2.13 and 7.5.2.14. */
#define SAVE_SIGNATURE 0x65766173u
#define LOAD_SIGNATURE 0x64616F6Cu

static const double HUNG_M_S = 1e-6;

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
    (void)sdo_upload(&tool, COUNTERS, COUNTERS_CORRECTED, cycles, sizeof cycles, &length);
    session->told_corrected = bytes_get_u32(cycles);
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
    const char *missing = chip_cuts_begin(&session->cuts, &session->chip);
    if (missing != NULL) {
        chip_session_complain(session, missing);
        return;
    }
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

/* The host's task hears the marks, too: the comparison goes on. */
static void set_marks(struct chip_session *session)
{
    struct sdo_upload tool = tool_of(session);

    session->crash_known = true;
    chip_mark_run(session, &tool);
}

/* The fault has come; until the image starts again because of it, or notices nothing. What is wrong
 * is right again afterwards, so that the record can be fetched. */
static void wait_until_noticed(struct chip_session *session)
{
    struct chip *chip = &session->chip;
    const uint32_t starts = chip->resets;

    session->brought_ns = chip_now_ns(chip);
    for (unsigned i = 0; i < SCAN_TICKS && chip->resets == starts; i++) {
        chip_session_pass(session, 1);
    }
    if (chip->resets == starts) {
        chip_session_complain(session, "the image does not notice it");
        return;
    }
    session->noticed_ns = chip_now_ns(chip);
}

static void lower_supply(struct chip_session *session, uint32_t millivolts, unsigned ticks)
{
    chip_bridge_stop_comparing(&session->bridge);
    chip_set_supply(&session->chip, millivolts);
    chip_session_pass(session, ticks);
    chip_set_supply(&session->chip, 3300);
}

/* A fault of the chip itself, which its tests must notice. */
static void break_chip(struct chip_session *session)
{
    struct chip *chip = &session->chip;
    /* The thread's stack lies at the bottom of RAM. */
    const uint32_t margin = GUARD_BYTES;

    chip_bridge_stop_comparing(&session->bridge);
    switch (session->fault) {
    case CHIP_FAULT_RAM_SLICE:
        chip->stuck_at = (uint32_t)CHIP_UNUSED_RAM;
        chip->stuck_bit = 1u << 17;
        break;
    case CHIP_FAULT_RAM_PARITY:
        chip_weaken(chip, 0x20000000u + (uint32_t)CHIP_UNUSED_RAM);
        break;
    case CHIP_FAULT_CORE_REGISTER:
        chip->stuck_register = REGISTER_R10;
        chip->stuck_register_bits = 1u;
        break;
    case CHIP_FAULT_FLOAT_REGISTER:
        chip->stuck_register = FLOAT_S29;
        chip->stuck_register_bits = 1u;
        break;
    case CHIP_FAULT_SLOW_OSCILLATOR:
        chip_set_lsi(chip, 26000);
        break;
    case CHIP_FAULT_FAST_OSCILLATOR:
        chip_set_lsi(chip, 38000);
        break;
    case CHIP_FAULT_EARLY_FEED:
        chip_feed_watchdog(chip);
        chip_feed_watchdog(chip);
        break;
    case CHIP_FAULT_RUN_RAM:
        chip->wild = CHIP_WILD_IN_RAM;
        chip->hang = true;
        break;
    case CHIP_FAULT_WRITE_PROGRAM:
        chip->wild = CHIP_WILD_IN_FLASH;
        chip->hang = true;
        break;
    default:
        memset(chip->ram + margin, 0, sizeof(uint32_t));
        break;
    }
    wait_until_noticed(session);
    chip->stuck_register_bits = 0;
    chip_set_lsi(chip, LSI_HZ);
    if (session->fault == CHIP_FAULT_RAM_PARITY) {
        chip_weaken(chip, 0);
    }
}

/* A word of the program has one wrong bit, which is mended at each read: it goes on walking. */
static void weaken_flash(struct chip_session *session)
{
    struct chip *chip = &session->chip;

    chip_weaken(chip, 0x08000000u + CHIP_STARTER_BYTES + chip_session_image_bytes(chip) - 8);
    session->brought_ns = chip_now_ns(chip);
    for (unsigned i = 0; i < SCAN_TICKS && chip->weak_reads == 0; i++) {
        chip_session_pass(session, 1);
    }
    chip_weaken(chip, 0);
    session->noticed_ns = chip_now_ns(chip);
}

/* A drive hangs under torque and holds its motor, behind it a loaded spring: no frame helps, only PC5. */
static void hang_drive(struct chip_session *session)
{
    struct loop *loop = session->loop;
    struct sea *sea = &loop->nodes.plant.sea[SIDE_LEFT];
    const double loaded_m = 0.5 * (double)loop->rig.task.controller.last_step.r0_m;

    for (unsigned i = 0; i < LOAD_TICKS && sea->position_m < loaded_m; i++) {
        chip_session_pass(session, 1);
    }
    sim_bus_connect(&loop->bus, PORT_DRIVE_LEFT, false);
    sea->params.speed_limit_m_s = sea->built.config.speed_limit_m_s = HUNG_M_S;
    session->brought_ns = chip_now_ns(&session->chip);
    for (unsigned i = 0; i < CUT_TICKS && !loop->nodes.torque_is_off; i++) {
        chip_session_pass(session, 1);
    }
    session->noticed_ns = chip_now_ns(&session->chip);
    if (sea->position_m < loaded_m) {
        chip_session_complain(session, "no spring was loaded behind the drive");
    } else if (!loop->nodes.torque_is_off) {
        chip_session_complain(session, "the image leaves a drive that hangs its torque");
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
    case CHIP_FAULT_DRIVE_HANGS:
        hang_drive(session);
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
        wait_until_noticed(session);
        break;
    case CHIP_FAULT_FIRST_START:
    case CHIP_FAULT_OPTIONS_CUT:
    case CHIP_FAULT_DIRTY_RAM:
    case CHIP_FAULT_FIRST_STORE:
        break;
    case CHIP_FAULT_SUPPLY_LOW:
        chip_bridge_stop_comparing(bridge);
        lower_supply(session, 2800, LOW_SUPPLY_TICKS);
        break;
    case CHIP_FAULT_BROWN_OUT:
        lower_supply(session, 2400, BROWN_OUT_TICKS);
        break;
    case CHIP_FAULT_RAM_SLICE:
    case CHIP_FAULT_RAM_PARITY:
    case CHIP_FAULT_CORE_REGISTER:
    case CHIP_FAULT_FLOAT_REGISTER:
    case CHIP_FAULT_SLOW_OSCILLATOR:
    case CHIP_FAULT_FAST_OSCILLATOR:
    case CHIP_FAULT_DEEP_STACK:
    case CHIP_FAULT_EARLY_FEED:
    case CHIP_FAULT_RUN_RAM:
    case CHIP_FAULT_WRITE_PROGRAM:
        break_chip(session);
        break;
    case CHIP_FAULT_FLASH_CORRECTED:
        weaken_flash(session);
        break;
    case CHIP_FAULT_MARK:
        set_marks(session);
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

/* Faults that do not hinder a walk. */
static bool goes_on(enum chip_fault fault)
{
    return fault == CHIP_FAULT_FLASH_CORRECTED || fault == CHIP_FAULT_MARK ||
           fault == CHIP_FAULT_DIRTY_RAM || fault == CHIP_FAULT_FIRST_STORE ||
           fault == CHIP_FAULT_FIRST_START || fault == CHIP_FAULT_OPTIONS_CUT;
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
    } else if (session->crash.cause != (uint32_t)kind->crash &&
               (kind->or_crash >> session->crash.cause & 1u) == 0) {
        snprintf(session->trouble, sizeof session->trouble, "it left crash record %u instead of %u",
                 (unsigned)session->crash.cause, (unsigned)kind->crash);
    } else if (chip_fault_is_update(session->fault)) {
        struct sdo_upload tool = tool_of(session);
        chip_update_judge(session, &tool);
        session->reached = session->trouble[0] == '\0';
    } else if (session->fault == CHIP_FAULT_FLASH_CORRECTED && session->told_corrected == 0) {
        chip_session_complain(session, "it counts no corrected error (0x2020:29)");
    } else if (session->fault == CHIP_FAULT_FIRST_START &&
               session->chip.flash_registers.optr != MODEL_OPTIONS_SET) {
        chip_session_complain(session, "the option bytes are not as wanted");
    } else if (session->fault == CHIP_FAULT_OPTIONS_CUT &&
               session->chip.flash_registers.optr != MODEL_OPTIONS_TORN) {
        chip_session_complain(session, "torn option bytes were written");
    } else if (session->fault == CHIP_FAULT_LOST_WRITE && session->crash.detail != session->lose) {
        snprintf(session->trouble, sizeof session->trouble,
                 "the record names register %#x, not %#x", (unsigned)session->crash.detail,
                 (unsigned)session->lose);
    } else if (chip_fault_is_cut(session->fault) && bridge->fault == SUPERVISOR_FAULT_NONE &&
               !kept_settings(session)) {
        chip_session_complain(session, "it goes on with other settings");
    } else if (!goes_on(session->fault) && !chip_session_is_safe(session)) {
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
