#include "sim_host/emulator/g474/chip_session.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "hal/bus/bytes.h"
#include "hal/bus/frame_table.h"
#include "hal/storage/program_image.h"
#include "sim_host/emulator/g474/mmio_model.h"
#include "sim_host/log/black_box_log.h"
#include "sim_host/log/sdo_upload.h"
#include "sim_host/loop/walk_watch.h"
#include "sim_host/subjects/settings_image.h"

enum { STANDBY_TICKS = 3000, PORT_C = 2, STUCK_AT = 0x5A40 };

#define BIT(fault) (1u << SUPERVISOR_FAULT_##fault)
#define CRASHES_OF_A_WILD_PROGRAM                                                \
    (1u << CRASH_HARD_FAULT | 1u << CRASH_MEMORY_FAULT | 1u << CRASH_BUS_FAULT | \
     1u << CRASH_USAGE_FAULT | 1u << CRASH_ASSERTION | 1u << CRASH_WATCHDOG)

const struct chip_fault_kind chip_faults[CHIP_FAULT_COUNT] = {
    [CHIP_FAULT_NONE] = {"none", SUPERVISOR_FAULT_NONE, 0, CRASH_NONE, NULL, 0},
    [CHIP_FAULT_EMERGENCY_STOP] = {"emergency-stop", SUPERVISOR_FAULT_EMERGENCY_STOP, 0, CRASH_NONE,
                                   NULL, 0},
    [CHIP_FAULT_LOST_SENSOR] = {"lost-sensor", SUPERVISOR_FAULT_SENSOR_STALE, 0, CRASH_NONE, NULL,
                                0},
    [CHIP_FAULT_LOST_DRIVE] = {"lost-drive", SUPERVISOR_FAULT_DRIVE_STALE, 0, CRASH_NONE, NULL, 0},
    [CHIP_FAULT_DRIVE_HANGS] = {"drive-hangs", SUPERVISOR_FAULT_DRIVE_STALE, 0, CRASH_NONE, NULL,
                                0},
    /* Whatever is missed first. */
    [CHIP_FAULT_DESTROYED_FRAMES] = {"destroyed-frames", SUPERVISOR_FAULT_SENSOR_STALE,
                                     BIT(DRIVE_STALE) | BIT(NODE_LOST) | BIT(DRIVE), CRASH_NONE,
                                     NULL, 0},
    [CHIP_FAULT_HANG] = {"hang", SUPERVISOR_FAULT_RESTARTED, 0, CRASH_WATCHDOG, NULL, 0},
    [CHIP_FAULT_CRYSTAL_STOPS] = {"crystal-stops", SUPERVISOR_FAULT_RESTARTED, 0,
                                  CRASH_CLOCK_FAILED, NULL, 0},
    [CHIP_FAULT_NO_CRYSTAL] = {"no-crystal", SUPERVISOR_FAULT_RESTARTED, 0, CRASH_CLOCK_FAILED,
                               NULL, 0},
    [CHIP_FAULT_TORN_SETTINGS] = {"torn-settings", SUPERVISOR_FAULT_PARAMETERS, 0, CRASH_NONE, NULL,
                                  0},
    [CHIP_FAULT_ECC] = {"ecc-error", SUPERVISOR_FAULT_PARAMETERS, BIT(RESTARTED), CRASH_NMI, NULL,
                        0},
    [CHIP_FAULT_SAVE_CUT] = {"save-cut", SUPERVISOR_FAULT_NONE, 0, CRASH_NONE, NULL, 0},
    /* Forgotten, or not yet. */
    [CHIP_FAULT_LOAD_CUT] = {"load-cut", SUPERVISOR_FAULT_PARAMETERS, BIT(NONE), CRASH_NONE, NULL,
                             0},
    [CHIP_FAULT_LOST_WRITE] = {"lost-write", SUPERVISOR_FAULT_RESTARTED, 0, CRASH_LOST_WRITE, NULL,
                               0},
    [CHIP_FAULT_HALF_WRITTEN] = {.name = "half-written", .says = "the program is not whole"},
    [CHIP_FAULT_STUCK_RAM] = {.name = "stuck-ram", .says = "the RAM has failed"},
    [CHIP_FAULT_FIRST_START] = {.name = "first-start"},
    [CHIP_FAULT_OPTIONS_CUT] = {.name = "options-cut"},
    [CHIP_FAULT_SUPPLY_LOW] = {"supply-low", SUPERVISOR_FAULT_EMERGENCY_STOP, 0, CRASH_NONE, NULL,
                               0},
    [CHIP_FAULT_BROWN_OUT] = {"brown-out", SUPERVISOR_FAULT_RESTARTED, 0, CRASH_SUPPLY, NULL, 0},
    [CHIP_FAULT_RAM_SLICE] = {.name = "ram-slice", .says = "the RAM has failed"},
    [CHIP_FAULT_RAM_PARITY] = {"ram-parity", SUPERVISOR_FAULT_RESTARTED, 0, CRASH_RAM_PARITY, NULL,
                               0},
    /* Most registers hold something that breaks down before the test comes to them. */
    [CHIP_FAULT_CORE_REGISTER] = {"core-register", SUPERVISOR_FAULT_RESTARTED, 0, CRASH_REGISTER,
                                  NULL, CRASHES_OF_A_WILD_PROGRAM},
    [CHIP_FAULT_FLOAT_REGISTER] = {"float-register", SUPERVISOR_FAULT_RESTARTED, 0, CRASH_REGISTER,
                                   NULL, 0},
    [CHIP_FAULT_SLOW_OSCILLATOR] = {"slow-oscillator", SUPERVISOR_FAULT_RESTARTED, 0,
                                    CRASH_OSCILLATOR, NULL, 0},
    [CHIP_FAULT_FAST_OSCILLATOR] = {"fast-oscillator", SUPERVISOR_FAULT_RESTARTED, 0,
                                    CRASH_OSCILLATOR, NULL, 0},
    [CHIP_FAULT_DEEP_STACK] = {"deep-stack", SUPERVISOR_FAULT_RESTARTED, 0, CRASH_STACK, NULL, 0},
    [CHIP_FAULT_FLASH_CORRECTED] = {.name = "flash-corrected"},
    [CHIP_FAULT_EARLY_FEED] = {"early-feed", SUPERVISOR_FAULT_RESTARTED, 0, CRASH_WATCHDOG, NULL,
                               0},
    [CHIP_FAULT_RUN_RAM] = {"run-ram", SUPERVISOR_FAULT_RESTARTED, 0, CRASH_MEMORY_FAULT, NULL, 0},
    [CHIP_FAULT_WRITE_PROGRAM] = {"write-program", SUPERVISOR_FAULT_RESTARTED, 0,
                                  CRASH_MEMORY_FAULT, NULL, 0},
    [CHIP_FAULT_FIRST_STORE] = {.name = "first-store"},
    [CHIP_FAULT_DIRTY_RAM] = {.name = "dirty-ram"},
    [CHIP_FAULT_MARK] = {.name = "mark"},
    [CHIP_FAULT_UPDATE] = {.name = "update"},
    [CHIP_FAULT_UPDATE_OLDER] = {.name = "update-older"},
    [CHIP_FAULT_UPDATE_OTHER_BOARD] = {.name = "update-other-board"},
    [CHIP_FAULT_UPDATE_WALKING] = {.name = "update-walking", .or_latched = BIT(NONE)},
    [CHIP_FAULT_UPDATE_CUT] = {.name = "update-cut"},
    [CHIP_FAULT_DAMAGED_PROGRAM] = {.name = "damaged-program", .says = "the program is not whole"},
};

/* As the header says, which is behind the vectors of the image. */
uint32_t chip_session_image_bytes(const struct chip *chip)
{
    const uint8_t *length = chip->flash + CHIP_STARTER_BYTES + PROGRAM_HEADER_OFFSET +
                            offsetof(struct program_header, length);
    return bytes_get_u32(length);
}

bool chip_fault_is_cut(enum chip_fault fault)
{
    return fault == CHIP_FAULT_SAVE_CUT || fault == CHIP_FAULT_LOAD_CUT ||
           fault == CHIP_FAULT_UPDATE_CUT;
}

bool chip_fault_is_update(enum chip_fault fault)
{
    return fault >= CHIP_FAULT_UPDATE && fault <= CHIP_FAULT_UPDATE_CUT;
}

static bool is_first_start(enum chip_fault fault)
{
    return fault == CHIP_FAULT_FIRST_START || fault == CHIP_FAULT_OPTIONS_CUT;
}

/* What is done at standstill: nobody walks before. */
static bool stands(enum chip_fault fault)
{
    return chip_fault_is_cut(fault) ||
           (chip_fault_is_update(fault) && fault != CHIP_FAULT_UPDATE_WALKING);
}

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
                          config->desired_speed_rad_s, !stands(session->fault), nv) != 0) {
        snprintf(message, LOOP_MESSAGE_MAX, "the firmware would refuse these settings");
        return -1;
    }
    if (chip_start(&session->chip, core, image, nv, sizeof nv) != 0) {
        snprintf(message, LOOP_MESSAGE_MAX, "%s", session->chip.message);
        return -1;
    }
    session->chip.dirty_ram = session->fault == CHIP_FAULT_DIRTY_RAM;
    if (session->fault == CHIP_FAULT_FIRST_STORE) {
        chip_lose_first_stores(&session->chip);
    }
    chip_drive_pin(&session->chip, PORT_C, 0, true); /* the emergency stop's contact is closed */
    chip_set_crystal(&session->chip, session->fault != CHIP_FAULT_NO_CRYSTAL);
    if (session->fault == CHIP_FAULT_HALF_WRITTEN) {
        const uint32_t length = chip_session_image_bytes(&session->chip);
        chip_erase(&session->chip, CHIP_STARTER_BYTES + length / 2, length);
    }
    if (is_first_start(session->fault)) {
        session->chip.flash_registers.optr_stored = MODEL_OPTIONS_DELIVERED;
        chip_power_cycle(&session->chip);
        if (session->fault == CHIP_FAULT_OPTIONS_CUT) {
            session->chip.flash_registers.power_fails_at = session->chip.flash_registers.operations;
        }
    }
    if (session->fault == CHIP_FAULT_STUCK_RAM) {
        session->chip.stuck_at = STUCK_AT;
        session->chip.stuck_bit = 1u << 17;
    }
    if (session->fault == CHIP_FAULT_LOST_WRITE) {
        mmio_model_lose(session->lose);
    }
    if (session->fault == CHIP_FAULT_TORN_SETTINGS) {
        session->chip.flash_registers.state[MODEL_STORE_PAGE][12] = WORD_TORN;
    }
    if (session->fault == CHIP_FAULT_TORN_SETTINGS || stands(session->fault) ||
        is_first_start(session->fault)) {
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

void chip_session_complain(struct chip_session *session, const char *text)
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

void chip_session_pass(struct chip_session *session, unsigned ticks)
{
    for (unsigned i = 0; i < ticks; i++) {
        tick(session);
    }
}

/* Nobody walks before the fault. */
static bool never_walks(enum chip_fault fault)
{
    return fault == CHIP_FAULT_NO_CRYSTAL || fault == CHIP_FAULT_TORN_SETTINGS || stands(fault) ||
           fault == CHIP_FAULT_LOST_WRITE || fault == CHIP_FAULT_HALF_WRITTEN ||
           fault == CHIP_FAULT_STUCK_RAM || is_first_start(fault);
}

static void tell_step(const struct chip_session *session, const struct walk_watch *watch)
{
    if (session->on_step != NULL && session->record.count != watch->seen) {
        session->on_step(session->context, session->record.count);
    }
}

static void tell_fall(struct chip_session *session)
{
    session->fell = true;
    snprintf(session->trouble, sizeof session->trouble, "fell: %s",
             walk_fault_name(plant_fault(&session->loop->nodes.plant)));
}

static bool is_long_enough(const struct chip_session *session)
{
    return (double)session->bridge.ticks * 1e-6 * TICK_PERIOD_US >= session->seconds;
}

void chip_session_walk(struct chip_session *session)
{
    struct walk_watch watch;
    unsigned standby = 0;

    walk_watch_init(&watch, session->steps, session->is_recording);
    while (!never_walks(session->fault)) {
        tick(session);
        tell_step(session, &watch);
        const enum walk_end end = walk_watch_tick(&watch, &session->record, session->loop);
        if (end == WALK_RECORDING_OVER || (end == WALK_DONE && is_long_enough(session))) {
            session->reached = watch.seen > 0;
            return;
        }
        if (session->fault != CHIP_FAULT_NONE && watch.seen >= session->fault_step) {
            return;
        }
        if (end == WALK_FELL) {
            tell_fall(session);
            return;
        }
        if (end == WALK_STALLED) {
            chip_session_complain(session, "no step within its time");
            return;
        }
        if (session->bridge.ticks == 0 && standby++ > STANDBY_TICKS) {
            chip_session_complain(session, "the image sends no SYNC");
            return;
        }
    }
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
