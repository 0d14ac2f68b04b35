#include "firmware/orthosis.h"

#include <assert.h>
#include <string.h>

#include "firmware/version.h"
#include "hal/canopen/co_defs.h"
#include "hal/devices/device_check.h"
#include "hal/devices/device_config.h"

static_assert((int)CONTROL_TASK_COMMANDED == (int)WATCHDOG_CONTROL &&
                  (int)CONTROL_TASK_BUS_ALIVE == (int)WATCHDOG_BUS &&
                  (int)CONTROL_TASK_SUPERVISED == (int)WATCHDOG_SUPERVISOR,
              "the task's signs of progress are the gate's");

/* Crash after crash, and the bus never worked between: what is read may be the reason. */
static bool must_not_read(const struct orthosis_config *config)
{
    return config->streak != NULL &&
           crash_streak_length(config->streak) >= (uint32_t)CRASH_STREAK_LIMIT;
}

static void read_settings(struct orthosis *orthosis, struct settings *settings,
                          const struct orthosis_config *config)
{
    if (must_not_read(config)) {
        param_store_attach(&orthosis->store, config->nv);
        orthosis->store_result = PARAM_STORE_NOT_READ;
    } else {
        orthosis->store_result = settings_load(settings, &orthosis->store, config->nv);
    }
    if (orthosis->store_result == PARAM_STORE_OK) {
        orthosis->settings_result = settings_check(settings);
    }
    if (orthosis->store_result != PARAM_STORE_OK || orthosis->settings_result != SETTINGS_OK) {
        settings_default(settings);
        /* Settings that nobody looked at are not to blame. */
        orthosis->forced_fault =
            must_not_read(config) ? SUPERVISOR_FAULT_RESTARTED : SUPERVISOR_FAULT_PARAMETERS;
    }
}

static void latch(struct orthosis *orthosis, enum supervisor_fault fault)
{
    supervisor_force_fault(&orthosis->task.controller.supervisor, fault);
}

/* ---- what is asked over the bus --------------------------------------------- */

static uint32_t abort_code_of(enum param_store_result result)
{
    return result == PARAM_STORE_OK ? CO_ABORT_NONE : CO_ABORT_NOT_STORED;
}

/* Nobody's settings are not to be kept: they would pass for somebody's at the next start. */
static uint32_t save_settings(void *context)
{
    struct orthosis *orthosis = context;
    struct control_task *task = &orthosis->task;
    struct control_params *params = &task->node.objects.params;
    const struct settings_parts parts = {
        .control = params,
        .device = &task->node.objects.device,
        .desired_speed_rad_s = task->node.objects.desired_speed_rad_s,
        .walk_at_start = orthosis->walk_at_start,
    };

    if (orthosis->forced_fault != SUPERVISOR_FAULT_NONE) {
        return CO_ABORT_DEVICE_STATE;
    }
    if (write_rules_check_device(&task->node.rules) != DEVICE_OK) {
        return CO_ABORT_VALUE; /* 0x2053 tells why */
    }
    orthosis->store_result = settings_save_parts(&parts, &orthosis->store, true);
    if (orthosis->store_result == PARAM_STORE_OK && params->branch != NULL) {
        params->branch = settings_branch(&orthosis->store);
    }
    return abort_code_of(orthosis->store_result);
}

/* From now on there are none: no walk before the next start, nor after it. */
static uint32_t forget_settings(void *context)
{
    struct orthosis *orthosis = context;

    orthosis->forced_fault = SUPERVISOR_FAULT_PARAMETERS;
    return abort_code_of(param_store_forget(&orthosis->store, true));
}

static const struct controller_settings_store_ops settings_store_ops = {save_settings,
                                                                        forget_settings};

/* Saving and forgetting keep the loop for longer than half the watchdog's time. Each part is
 * bounded and there is a bounded number of them. At most one feed a tick of the real time, so
 * that parts which end at once, or a clock that stands, feed nothing. */
static void feed_between(void *context)
{
    struct orthosis *orthosis = context;
    const uint64_t now_ns = clock_now_ns(orthosis->clock);

    if (now_ns - orthosis->fed_ns >= TICK_PERIOD_US * UINT64_C(1000)) {
        orthosis->fed_ns = now_ns;
        orthosis->watchdog->ops->feed(orthosis->watchdog->context);
    }
}

/* ---- start ------------------------------------------------------------------ */

/* Behind any other reset nobody expects a drive to move: only power-on obeys settings that ask for
 * a walk. */
static bool is_power_on(const struct orthosis_config *config)
{
    return config->streak != NULL && !crash_streak_is_kept(config->streak);
}

static void init_task(struct orthosis *orthosis, const struct settings *settings,
                      const struct orthosis_config *config)
{
    struct control_task_config task = {
        .params = &settings->control,
        .stop = config->stop,
        .configure_nodes = true,
        .desired_speed_rad_s = settings->desired_speed_rad_s,
        .walk_requested = settings->walk_at_start != 0u && is_power_on(config),
    };
    const struct snapshot_source source = {&orthosis->task, &orthosis->drives};

    device_drives_init(&orthosis->drives, &settings->device);
    device_node_setup(&settings->device, settings->control.leg_length_m,
                      settings->control.sea_speed_max_m_s, &task.setup);
    device_leg_sensors(&settings->device, task.leg_sensor);
    bus_recorder_init(&orthosis->recorder, &config->bus, config->black_box, &source);
    task.bus = bus_recorder_interface(&orthosis->recorder);
    task.drives = device_drives_interface(&orthosis->drives);
    (void)control_task_init(&orthosis->task, &task); /* cannot fail: the settings were checked */
    control_task_describe(&orthosis->task, &settings->device);
    controller_node_attach(&orthosis->task.node, &settings_store_ops, orthosis, config->black_box,
                           config->crash, &orthosis->update);
}

/* What a crash or another reset cut short is kept until somebody has fetched it. */
static void init_black_box(const struct orthosis_config *config, const struct settings *settings)
{
    struct black_box *box = config->black_box;

    if (black_box_is_valid(box) && config->restarted) {
        black_box_freeze(box, 1u << SUPERVISOR_FAULT_RESTARTED);
    } else if (black_box_has_recording(box)) { /* by the pin, a debugger or a tool */
        black_box_freeze(box, BLACK_BOX_REASON_RESET);
    }
    if (!black_box_is_valid(box) || box->header.state != (uint32_t)BLACK_BOX_FROZEN) {
        black_box_start(box, version_build_id(), params_guard_crc(&settings->control));
    }
}

static void begin_scan(struct orthosis *orthosis)
{
    const struct program_slots *program = orthosis->program;

    program_scan_begin(&orthosis->program_scan, &program->memory, program->slot, program->room,
                       program->hardware);
}

void orthosis_init(struct orthosis *orthosis, const struct orthosis_config *config)
{
    struct settings *settings = &orthosis->settings;

    memset(orthosis, 0, sizeof *orthosis);
    read_settings(orthosis, settings, config);
    orthosis->walk_at_start = settings->walk_at_start;
    init_black_box(config, settings);
    orthosis->program = config->program;
    orthosis->in_quiet_ticks = config->in_quiet_ticks;
    program_update_init(&orthosis->update, config->program);
    init_task(orthosis, settings, config);
    watchdog_gate_init(&orthosis->gate, config->watchdog);
    if (config->program != NULL) {
        begin_scan(orthosis);
    }
    orthosis->watchdog = config->watchdog;
    orthosis->clock = config->clock;
    orthosis->store.between = config->clock != NULL ? feed_between : NULL;
    orthosis->store.between_context = orthosis;
    drive_power_init(&orthosis->drive_power, config->drive_power);
    orthosis->wearer = config->wearer;
    orthosis->task.node.rules.sync_pulse = config->sync_pulse;
    orthosis->streak = config->streak;
    if (config->streak != NULL) {
        telemetry_report_crashes(&orthosis->task.node.objects, &orthosis->task.node.device,
                                 crash_streak_length(config->streak));
    }
    if (orthosis->forced_fault != SUPERVISOR_FAULT_NONE) {
        latch(orthosis, orthosis->forced_fault);
    } else if (config->restarted) {
        latch(orthosis, SUPERVISOR_FAULT_RESTARTED);
    }
}

/* What it reads is used in the next tick, and told in that tick's state: a replay reads it back. */
static void look_after_wearer(struct orthosis *orthosis)
{
    const enum wearer_cue cue = controller_cue(&orthosis->task.controller);

    orthosis->task.node.objects.wearer_pin = wearer_panel_is_pressed(orthosis->wearer) ? 1 : 0;
    wearer_panel_set_cue(orthosis->wearer, cue == WEARER_CUE_SOON || cue == WEARER_CUE_FADES);
}

/* Once through the program, again and again. */
static void look_after_program(struct orthosis *orthosis)
{
    struct program_scan *scan = &orthosis->program_scan;

    program_scan_go_on(scan, &orthosis->program->memory, ORTHOSIS_PROGRAM_WORDS);
    if (scan->done) {
        orthosis->program_damaged = orthosis->program_damaged || scan->verdict != PROGRAM_GOOD;
        orthosis->program_rounds += orthosis->program_rounds < UINT32_MAX ? 1u : 0u;
        begin_scan(orthosis);
    }
}

static void look_after_itself(struct orthosis *orthosis)
{
    if (orthosis->program != NULL) {
        look_after_program(orthosis);
    }
    if (orthosis->in_quiet_ticks != NULL) {
        orthosis->in_quiet_ticks();
    }
}

/* Where nothing may move, a node that is silent is asked in each tick, and none may be quiet for as long as it is.
 * An odd number: the board tells by two looks whether the line moves, which it does once a tick. */
enum { LOOK_TICKS = 15 };

static bool must_look(struct orthosis *orthosis)
{
    const enum supervisor_state state = orthosis->task.output.state;
    orthosis->unlooked_ticks++;
    return orthosis->unlooked_ticks >= LOOK_TICKS &&
           (state == SUPERVISOR_FAULT || state == SUPERVISOR_INIT);
}

/* The SYNC waits for nothing that is not done in each cycle: the nodes count by it. */
void orthosis_start_cycle(struct orthosis *orthosis)
{
    /* In every tick: nothing that keeps the device busy may put the wearer off. */
    if (orthosis->wearer != NULL) {
        look_after_wearer(orthosis);
    }
    bus_recovery_update(&orthosis->recovery, control_task_start_cycle(&orthosis->task),
                        &orthosis->recorder.inner);
    if (orthosis->looked_at_tick == orthosis->task.tick) { /* no bus, no tick: the tests go on */
        look_after_itself(orthosis);
    }
    orthosis->looked_at_tick = orthosis->task.tick;
}

unsigned orthosis_poll(struct orthosis *orthosis)
{
    struct control_task *task = &orthosis->task;
    unsigned progress;

    if (orthosis->forced_fault != SUPERVISOR_FAULT_NONE) {
        latch(orthosis, orthosis->forced_fault);
    }
    progress = control_task_poll(task);
    const bool ticked = (progress & (unsigned)CONTROL_TASK_TICKED) != 0u;
    if (ticked) {
        program_update_tick(&orthosis->update);
    }
    /* Until the first own SYNC came back no command was ever sent, nothing can move, and a
     * bus that is not there yet is no reason to restart. Nor can a drive be reached then,
     * whatever it does: it gets no power. (The tick wraps, the time does not.) */
    const bool has_bus = task->now_ns != 0u;
    if (has_bus && orthosis->streak != NULL) {
        crash_streak_end(orthosis->streak);
    }
    const bool fed =
        watchdog_gate_report(&orthosis->gate, has_bus ? progress : (uint32_t)WATCHDOG_ALL);
    if (ticked) {
        drive_power_update(&orthosis->drive_power, task, fed);
    }
    /* Behind the tick's edge of the permit line, as where there is no tick: the board counts its edges. */
    if (bus_recorder_take_quiet(&orthosis->recorder) || (ticked && must_look(orthosis))) {
        orthosis->unlooked_ticks = 0;
        look_after_itself(orthosis);
    }
    return progress;
}
