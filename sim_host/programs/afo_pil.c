/* afo-pil: the walk with the flashed object code on an emulated Cortex-M4F.
 *
 * The image runs in QEMU, the plant here; every frame that the image sends is
 * compared with what the host's build of the same code sends on the same frames.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "hal/storage/black_box.h"
#include "sim_host/cli/output_file.h"
#include "sim_host/cli/pil_options.h"
#include "sim_host/cli/recording_options.h"
#include "sim_host/cli/walk_options.h"
#include "sim_host/emulator/emulator.h"
#include "sim_host/emulator/pil_bridge.h"
#include "sim_host/log/black_box_log.h"
#include "sim_host/loop/loop.h"
#include "sim_host/loop/walk_record.h"
#include "sim_host/subjects/settings_image.h"

enum {
    EXIT_GOOD = 0,
    EXIT_BAD = 1,
    EXIT_USAGE = 2,
    /* What a restart costs before the first SYNC, with the watchdog's time-out. */
    DEAD_TICKS = TICKS_OF_MS(150),
    AFTER_FAULT_TICKS = TICKS_OF_MS(2500),
    FIRST_STEP_TICKS = TICKS_OF_MS(20000),
    STEP_TICKS = TICKS_OF_MS(10000),
    RECORD_DELAY_TICKS = TICKS_OF_MS(150),
    SDO_PATIENCE_TICKS = 200,
    PORT_DRIVE_LEFT = LOOP_PORT_FIRST_NODE,
    PORT_SENSOR_LEFT = LOOP_PORT_FIRST_NODE + 1
};

struct session {
    struct pil_options options;
    struct loop_config config;
    struct loop *loop;
    struct emulator emulator;
    struct pil_bridge bridge;
    struct walk_record record;
    struct output_file log, costs, black_box_log;
    struct can_bus tool; /* a port of its own, to ask the image over SDO */
    struct black_box black_box;
    struct black_box_summary black_box_summary;
    bool reached, fell, fault_began;
    char trouble[256];
    double wall_s;
};

/* ---- preparing ------------------------------------------------------------------ */

static int complain(const char *message)
{
    fprintf(stderr, "afo-pil: %s\n", message);
    return -1;
}

static int start_image(struct session *session)
{
    uint8_t nv[SETTINGS_IMAGE_BYTES];
    struct settings settings;
    char message[512] = "";

    settings_of_rig(&settings, &session->loop->rig, session->config.desired_speed_rad_s, true);
    if (settings_image(&settings, nv) != 0) {
        return complain("the settings do not fit the parameter memory");
    }
    if (session->options.fault == PIL_FAULT_PARAMETERS) {
        nv[100] ^= 0x10; /* one bit: its CRC must tell */
        session->bridge.comparing = false;
    }
    if (emulator_start(&session->emulator, EMULATOR_PIPES, session->options.image, nv, sizeof nv,
                       message, sizeof message) != 0) {
        return complain(message);
    }
    return pil_bridge_greet(&session->bridge) == 0
               ? 0
               : complain("the image does not answer (is qemu-system-arm installed?)");
}

static int prepare(struct session *session)
{
    const struct pil_options *options = &session->options;
    struct subject subject;
    struct control_params params;
    double speed_rad_s;
    char message[LOOP_MESSAGE_MAX] = "";

    if (walk_options_resolve(&options->walk, &subject, &params, &speed_rad_s, message) != 0 ||
        loop_configure(&session->config, &subject, &params, speed_rad_s, options->sensors,
                       options->seed, message) != 0) {
        return complain(message);
    }
    sensor_options_apply(&options->sensor, &session->config);
    if (options->recording_path != NULL) {
        struct recording_format format;
        recording_format_default(&format);
        if (recording_options_apply(options->recording_path, &format, options->walk.open_loop,
                                    &session->config, message) != 0) {
            return complain(message);
        }
    }
    if ((options->log_path != NULL &&
         output_file_open(&session->log, options->log_path, message, sizeof message) != 0) ||
        (options->costs_path != NULL &&
         output_file_open(&session->costs, options->costs_path, message, sizeof message) != 0) ||
        (options->black_box_path != NULL &&
         output_file_open(&session->black_box_log, options->black_box_path, message,
                          sizeof message) != 0)) {
        return complain(message);
    }
    pil_bridge_init(&session->bridge, &session->emulator);
    session->bridge.corrupt_frame = options->corrupt_frame;
    session->bridge.costs = session->costs.stream;
    session->config.wrap_bus = pil_bridge_wrap;
    session->config.wrap_context = &session->bridge;
    session->loop = calloc(1, sizeof *session->loop);
    if (session->loop == NULL || !walk_record_init(&session->record, options->steps, 0.0)) {
        return complain("out of memory");
    }
    if (loop_init(session->loop, &session->config, session->log.stream, message) != 0) {
        return complain(message);
    }
    session->tool =
        sim_bus_port(&session->loop->bus, sim_bus_attach(&session->loop->bus, "tool", NULL, NULL));
    return start_image(session);
}

/* ---- walking --------------------------------------------------------------------- */

static void begin_fault(struct session *session)
{
    session->fault_began = true;
    session->bridge.inputs = pil_faults[session->options.fault].input;
    if (session->options.fault == PIL_FAULT_LOST_SENSOR) {
        sim_bus_connect(&session->loop->bus, PORT_SENSOR_LEFT, false);
    } else if (session->options.fault == PIL_FAULT_LOST_DRIVE) {
        sim_bus_connect(&session->loop->bus, PORT_DRIVE_LEFT, false);
    }
    if (session->options.fault == PIL_FAULT_EMERGENCY_STOP) {
        session->loop->rig.stop_pressed = true; /* the host's task presses along */
    }
}

static void tick(struct session *session)
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

static bool recording_is_over(const struct session *session)
{
    struct plant_truth truth;
    if (session->options.recording_path == NULL) {
        return false;
    }
    plant_truth(&session->loop->nodes.plant, &truth);
    return truth.finished;
}

static void walk(struct session *session)
{
    const struct pil_options *options = &session->options;
    uint64_t last_progress = 0, patience;
    uint32_t seen = 0;

    for (;;) {
        tick(session);
        const struct walk_record *record = &session->record;
        if (session->bridge.failed) {
            snprintf(session->trouble, sizeof session->trouble, "the emulator is gone or silent");
            return;
        }
        if (record->count != seen) {
            seen = record->count;
            last_progress = session->loop->tick;
        }
        if (recording_is_over(session)) {
            session->reached = seen > 0;
            return;
        }
        if (options->fault != PIL_FAULT_NONE &&
            (seen >= options->fault_step || options->fault == PIL_FAULT_PARAMETERS)) {
            return;
        }
        if (plant_fault(&session->loop->nodes.plant) != WALK_FAULT_NONE) {
            session->fell = true;
            snprintf(session->trouble, sizeof session->trouble, "fell: %s",
                     walk_fault_name(plant_fault(&session->loop->nodes.plant)));
            return;
        }
        if (seen >= options->steps && (record->rows[options->steps - 1].measured ||
                                       session->loop->tick - last_progress > RECORD_DELAY_TICKS)) {
            session->reached = true;
            return;
        }
        patience = seen == 0 ? FIRST_STEP_TICKS : STEP_TICKS;
        if (session->loop->tick - last_progress > patience) {
            snprintf(session->trouble, sizeof session->trouble, "no step within %d s",
                     (int)((uint64_t)patience * TICK_PERIOD_US / 1000000u));
            return;
        }
    }
}

/* True when both springs are unloaded and no motor is under torque. */
static bool is_safe(const struct session *session)
{
    bool safe = true;

    for (int side = 0; side < SIDE_COUNT; side++) {
        struct sea_output sea;
        plant_sea_output(&session->loop->nodes.plant, (enum side)side, &sea);
        safe = safe && fabs(sea.position_m) <= 0.005 * session->config.subject.leg_length_m;
    }
    return safe;
}

static void fail(struct session *session)
{
    const struct pil_fault_kind *kind = &pil_faults[session->options.fault];
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
    } else if (!is_safe(session)) {
        snprintf(session->trouble, sizeof session->trouble, "a spring is still loaded");
    } else {
        session->reached = true;
    }
}

/* ---- black box -------------------------------------------------------------------- */

static bool let_it_run(void *context, unsigned waits)
{
    struct session *session = context;

    tick(session);
    return waits < SDO_PATIENCE_TICKS && !session->bridge.failed;
}

/* A box that no fault has frozen is frozen now. */
static void fetch_black_box(struct session *session)
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
    } else if (black_box_log_write(&session->black_box, version, "can0",
                                   session->black_box_log.stream,
                                   &session->black_box_summary) != 0) {
        session->reached = false;
        snprintf(session->trouble, sizeof session->trouble,
                 "the black box cannot be read or written");
    }
}

/* ---- reporting -------------------------------------------------------------------- */

static void print_difference(FILE *stream, const struct pil_difference *difference)
{
    const struct can_msg *frames[2] = {&difference->host, &difference->image};

    fprintf(stream, "first difference: tick %u, frame %u%s\n", difference->tick, difference->place,
            difference->missing ? ", missing from the image"
            : difference->extra ? ", only from the image"
                                : "");
    for (int i = 0; i < 2; i++) {
        fprintf(stream, "  %s %03X#", i == 0 ? "host " : "image", (unsigned)frames[i]->id);
        for (int j = 0; j < frames[i]->length; j++) {
            fprintf(stream, "%02X", frames[i]->data[j]);
        }
        fputc('\n', stream);
    }
}

static double mean_instructions(const struct pil_bridge *bridge)
{
    return bridge->answer.sequence > 0
               ? (double)bridge->total_instructions / (double)bridge->answer.sequence
               : 0.0;
}

static void print_json(const struct session *session)
{
    const struct pil_bridge *bridge = &session->bridge;
    const struct crash_record *crash = &bridge->hello.crash;

    printf("{\"good\": %s, \"steps\": %u, \"fell\": %s, \"trouble\": \"%s\", \"ticks\": %llu, "
           "\"compared_frames\": %llu, \"differences\": %llu, \"worst_tick_instructions\": %u, "
           "\"worst_tick\": %u, \"mean_tick_instructions\": %.0f, \"stack_unused_bytes\": %u, "
           "\"starts\": %u, \"state\": %u, \"fault\": \"%s\", \"crash_cause\": %u, "
           "\"crash_pc\": %u, \"crash_count\": %u, \"black_box_state\": %u, \"build_id\": %u, "
           "\"black_box_frames\": %u, \"black_box_fault_bits\": %u, \"wall_s\": %.1f}\n",
           session->reached && bridge->differences == 0 ? "true" : "false", session->record.count,
           session->fell ? "true" : "false", session->trouble,
           (unsigned long long)session->loop->tick, (unsigned long long)bridge->compared,
           (unsigned long long)bridge->differences, bridge->worst_instructions, bridge->worst_tick,
           mean_instructions(bridge), bridge->stack_unused, bridge->starts, bridge->state,
           supervisor_fault_name((enum supervisor_fault)bridge->fault), (unsigned)crash->cause,
           (unsigned)crash->pc, (unsigned)crash->count, (unsigned)bridge->hello.black_box_state,
           (unsigned)bridge->hello.build_id, (unsigned)session->black_box_summary.frames,
           (unsigned)session->black_box_summary.reason, session->wall_s);
}

static void print_report(const struct session *session)
{
    const struct pil_bridge *bridge = &session->bridge;

    printf("%u steps on the emulated Cortex-M4F, %llu ticks in %.1f s\n", session->record.count,
           (unsigned long long)session->loop->tick, session->wall_s);
    printf("frames compared with the host's build: %llu, different: %llu\n",
           (unsigned long long)bridge->compared, (unsigned long long)bridge->differences);
    printf("instructions of a tick: %u at worst (tick %u), %.0f on average\n",
           bridge->worst_instructions, bridge->worst_tick, mean_instructions(bridge));
    printf("thread stack never used: %u bytes\n", bridge->stack_unused);
    if (session->options.fault != PIL_FAULT_NONE) {
        printf("after \"%s\": latched \"%s\", crash record %u, springs %s\n",
               pil_faults[session->options.fault].name,
               supervisor_fault_name((enum supervisor_fault)bridge->fault),
               (unsigned)bridge->hello.crash.cause, is_safe(session) ? "unloaded" : "LOADED");
    }
    if (session->trouble[0] != '\0') {
        printf("trouble: %s\n", session->trouble);
    }
    if (bridge->differences > 0) {
        print_difference(stdout, &bridge->first);
    }
}

static double now_s(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static int run(struct session *session)
{
    const double start_s = now_s();
    char message[OUTPUT_PATH_MAX + 256];

    if (prepare(session) != 0) {
        return EXIT_USAGE;
    }
    walk(session);
    if (session->options.fault != PIL_FAULT_NONE) {
        fail(session);
    }
    if (session->black_box_log.stream != NULL && session->trouble[0] == '\0') {
        fetch_black_box(session);
    }
    session->wall_s = now_s() - start_s;
    if ((session->log.stream != NULL &&
         output_file_commit(&session->log, message, sizeof message) != 0) ||
        (session->costs.stream != NULL &&
         output_file_commit(&session->costs, message, sizeof message) != 0) ||
        (session->black_box_log.stream != NULL &&
         output_file_commit(&session->black_box_log, message, sizeof message) != 0)) {
        complain(message);
        return EXIT_BAD;
    }
    if (session->options.json) {
        print_json(session);
    } else if (!session->options.quiet) {
        print_report(session);
    }
    return session->reached && session->bridge.differences == 0 ? EXIT_GOOD : EXIT_BAD;
}

int main(int argc, char **argv)
{
    static struct session session;
    int status;

    session.emulator = (struct emulator){.to_image = -1, .from_image = -1, .uart = -1};
    if (pil_options_parse(&session.options, argc, argv) != 0) {
        return EXIT_USAGE;
    }
    status = run(&session);
    emulator_stop(&session.emulator);
    output_file_discard(&session.log);
    output_file_discard(&session.costs);
    output_file_discard(&session.black_box_log);
    walk_record_free(&session.record);
    if (session.loop != NULL) {
        loop_free(session.loop);
        free(session.loop);
    }
    return status;
}
