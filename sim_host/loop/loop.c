#include "sim_host/loop/loop.h"

#include <assert.h>
#include <string.h>

#include "firmware/version.h"
#include "hal/bus/frame_table.h"
#include "sim_host/bus/bus_budget.h"
#include "sim_host/devices/eds_gate.h"
#include "sim_host/log/black_box_log.h"
#include "sim_host/log/candump_log.h"

enum { TICK_NS = TICK_PERIOD_US * 1000 };

static_assert((int)SPEED_TABLE_MAX <= (int)OWN_PUSH_GAITS_MAX, "own_push has room for all gaits");

const char *loop_fault_name(enum loop_fault fault)
{
    static const char *const names[LOOP_FAULT_COUNT] = {"none", "cut-drives", "never-armed",
                                                        "swapped", "crossed"};
    return (unsigned)fault < LOOP_FAULT_COUNT ? names[fault] : "unknown";
}

/* ---- configuration -------------------------------------------------------- */

/* The lever that a leg of the device has at the ankle: its plant's own table, else the description's. */
static void lever_of(const struct subject *subject, int side, struct sea_table *table)
{
    const double *number = subject->device.number[side];
    const double step_rad = number[DEVICE_LEG_ankle_table_rad];
    *table = (struct sea_table){0};
    if (subject->actuators.as_built && subject->actuators.config[side].lever_table.count > 0) {
        *table = subject->actuators.config[side].lever_table;
    } else if (step_rad > 0.0) {
        table->count = 1 + LEG_SENSOR_LEVERS;
        table->y[0] = number[DEVICE_LEG_ankle_lever_m];
        for (int i = 1; i <= LEG_SENSOR_LEVERS; i++) {
            table->x[i] = i * step_rad;
            table->y[i] = number[DEVICE_LEG_ankle_table_1_m + i - 1];
        }
    }
}

static void configure_actuators(struct plant_config *plant, const struct subject *subject)
{
    const double leg_length_m = subject->person.leg_length_m;
    for (int side = 0; side < SIDE_COUNT; side++) {
        const double *number = subject->device.number[side];
        struct sea_params *sea = &plant->sea[side];
        struct sensor_params *sensors = &plant->sensors[side];
        sensors->ankle_is_lever = subject->device.description.leg[side].ankle == DEVICE_ANKLE_LEVER;
        sensors->ankle_lever_m = number[DEVICE_LEG_ankle_lever_m];
        sensors->ankle_neutral_rad = number[DEVICE_LEG_ankle_neutral_rad];
        lever_of(subject, side, &sensors->ankle_table);
        if (subject->actuators.as_built) {
            sea_params_as_built(&subject->actuators.config[side], sea);
        }
        if (!device_leg_is_driven(&subject->device.description.leg[side])) {
            continue;
        }
        /* What the drive reports in is what it was told. */
        sea->counts_per_m = number[DEVICE_LEG_counts_per_m];
        sea->rated_force_N = number[DEVICE_LEG_rated_force_N] > 0.0
                                 ? number[DEVICE_LEG_rated_force_N]
                                 : sea->rated_force_N;
        if (!subject->actuators.as_built) {
            sea->stroke_max_m = number[DEVICE_LEG_stroke_max_m];
            sea->end_stop_max_m = sea->stroke_max_m + 0.005 * leg_length_m;
            sea->speed_limit_m_s = number[DEVICE_LEG_speed_max_m_s];
            sea->force_limit_N = number[DEVICE_LEG_force_max_N];
        }
    }
}

int loop_configure(struct loop_config *config, const struct subject *subject,
                   const struct control_params *params, double desired_speed_rad_s,
                   enum sensor_preset_kind sensors, uint64_t seed, char *message)
{
    memset(config, 0, sizeof *config);
    config->subject = *subject;
    config->params = *params;
    config->desired_speed_rad_s = desired_speed_rad_s;
    struct gait_point start;
    const enum gait_curve_error error =
        subject_gait(subject, (double)config->params.start_r0_m, &start);
    if (error != GAIT_CURVE_OK && subject->is_person) {
        memset(&start, 0, sizeof start); /* no compass walks: its start is nobody's */
    } else if (error != GAIT_CURVE_OK) {
        snprintf(message, LOOP_MESSAGE_MAX, "no steady gait to start from at r0 = %g m: %s",
                 (double)config->params.start_r0_m, gait_curve_error_name(error));
        return -1;
    }
    const struct walker3_params body = {.hip_mass_kg = subject->person.torso_mass_kg,
                                        .leg_mass_kg = subject->person.leg_mass_kg,
                                        .leg_length_m = subject->person.leg_length_m,
                                        .gravity_m_s2 = subject->person.gravity_m_s2};
    plant_config_for(&body, subject_spring_N_per_m(subject), SEA_REAL, sensors, &config->plant);
    configure_actuators(&config->plant, subject);
    config->plant.seed = seed;
    config->plant.start = (struct walk_pose){.stance = SIDE_LEFT,
                                             .theta_s_rad = start.lift_off[0],
                                             .theta_n_rad = start.lift_off[1],
                                             .theta_s_rate_rad_s = start.lift_off[2],
                                             .theta_n_rate_rad_s = start.lift_off[3]};
    return 0;
}

void loop_configure_person(struct loop_config *config, unsigned engage_steps)
{
    struct control_params *params = &config->params;
    params->engage_steps = (real)engage_steps;
    config->plant.start_hold.least_load_m = 0.0;
    config->own_push = (struct own_push_params){
        .present = true,
        .target_rad_s = config->desired_speed_rad_s,
        .start_rad_s = (double)speed_table_speed(&params->table, params->start_r0_m),
        .ramp_rad_s = (double)params->speed_ramp_rad_s,
        .count = (int)params->table.count,
        .rest_first_m = (double)params->table.r0_min_m,
        .rest_step_m = (double)params->table.r0_step_m,
        .gain_m_s_rad = (double)params->kp_m_s_rad,
        .rest_max_m = (double)params->r0_max_m,
        .spring_N_per_m = subject_spring_N_per_m(&config->subject),
    };
    for (int i = 0; i < config->own_push.count; i++) {
        config->own_push.speed_rad_s[i] = (double)params->table.speed_rad_s[i];
    }
}

/* ---- the bus's hooks ------------------------------------------------------- */

static void write_log(void *context, const struct sim_bus_event *event)
{
    struct loop *loop = (struct loop *)context;
    if (event->kind != SIM_BUS_FRAME || loop->log == NULL) {
        return;
    }
    loop->logged_frames++;
    /* The stream keeps its error; who opened it asks for it. */
    (void)candump_write(loop->log, event->time_ns / 1000u, "can0", &event->message);
}

static bool is_drive_frame(uint32_t id)
{
    return id == FRAME_DRIVE_STATE_LEFT || id == FRAME_DRIVE_STATE_RIGHT ||
           id == FRAME_DRIVE_TARGETS || id == FRAME_DRIVE_COMMAND_LEFT ||
           id == FRAME_DRIVE_COMMAND_RIGHT;
}

static struct sim_bus_fault inject(void *context, const struct can_msg *message, unsigned sender,
                                   uint64_t time_ns)
{
    const struct loop *loop = (const struct loop *)context;
    struct sim_bus_fault fault = {.kind = SIM_BUS_FAULT_NONE};
    (void)sender;
    (void)time_ns;
    if (!loop->fault_active) {
        return fault;
    }
    if (loop->config.fault == LOOP_FAULT_CUT_DRIVES && is_drive_frame(message->id)) {
        fault.kind = SIM_BUS_FAULT_DROP;
    } else if (loop->config.fault == LOOP_FAULT_NEVER_ARMED &&
               (message->id == FRAME_DRIVE_COMMAND_LEFT ||
                message->id == FRAME_DRIVE_COMMAND_RIGHT) &&
               (message->data[4] & 1u) != 0) {
        fault.kind = SIM_BUS_FAULT_ALTER;
        fault.flip[4] = 1; /* bit 16 of the outputs at bytes 2..5 */
    }
    return fault;
}

/* ---- building -------------------------------------------------------------- */

static void wake_node(void *context, uint64_t now_ns)
{
    const struct loop_wake *wake = (const struct loop_wake *)context;
    (void)walker_nodes_poll(&wake->loop->nodes, wake->node, now_ns);
}

static void wake_task(void *context, uint64_t now_ns)
{
    (void)now_ns;
    (void)host_task_poll((struct host_task *)context);
}

static bool sheet_refuses(const void *context, const struct can_msg *request,
                          struct can_msg *answer)
{
    return eds_gate_refuses((const struct eds_file *)context, request, answer);
}

void loop_obey_sheets(struct walker_nodes *nodes, const struct eds_file *const eds[SIDE_COUNT])
{
    for (int side = 0; side < SIDE_COUNT; side++) {
        if (eds[side] != NULL) {
            nodes->gate[side] = (struct walker_gate){sheet_refuses, eds[side]};
        }
    }
}

static int init_nodes(struct loop *loop, char *message)
{
    static const char *const names[WALKER_NODES] = {"drive left", "sensor left", "drive right",
                                                    "sensor right"};
    struct can_bus ports[WALKER_NODES];
    for (int i = 0; i < WALKER_NODES; i++) {
        loop->wake[i] = (struct loop_wake){loop, (enum walker_node)i};
        const int port = sim_bus_attach(&loop->bus, names[i], wake_node, &loop->wake[i]);
        ports[i] = sim_bus_port(&loop->bus, port);
    }
    if (walker_nodes_init(&loop->nodes, &loop->config.plant,
                          &loop->config.subject.device.description, ports, 0, message) != 0) {
        return -1;
    }
    loop_obey_sheets(&loop->nodes, loop->config.drive_eds);
    return 0;
}

/* The levers that the device has at a recorded person's ankles are the ones that their ankles move. */
static void wear(struct loop_config *config)
{
    const struct subject *subject = &config->subject;
    const struct actuators *actuators = &subject->actuators;
    for (int side = 0; side < SIDE_COUNT; side++) {
        const double *number = subject->device.number[side];
        struct recording_ankle *ankle = &config->plant.recording_format.ankle[side];
        if (subject->device.description.leg[side].ankle == DEVICE_ANKLE_LEVER) {
            ankle->lever_m = number[DEVICE_LEG_ankle_lever_m];
            ankle->neutral_rad = number[DEVICE_LEG_ankle_neutral_rad];
        }
        if (actuators->as_built) {
            ankle->lever_m = actuators->config[side].lever_m;
        }
        lever_of(subject, side, &ankle->lever_table);
    }
}

int loop_init(struct loop *loop, const struct loop_config *config, FILE *log, char *message)
{
    memset(loop, 0, sizeof *loop);
    loop->config = *config;
    wear(&loop->config);
    loop->log = log;
    own_push_init(&loop->own_push, &config->own_push);
    if (bus_budget_check_build(message, LOOP_MESSAGE_MAX) != 0) {
        return -1;
    }
    sim_bus_init(&loop->bus, BUS_BITRATE);
    sim_bus_set_tap(&loop->bus, log != NULL ? write_log : NULL, loop);
    sim_bus_set_fault_hook(&loop->bus, inject, loop);
    const int port = sim_bus_attach(&loop->bus, "controller", wake_task, &loop->rig);
    struct can_bus bus = sim_bus_port(&loop->bus, port);
    if (config->wrap_bus != NULL) {
        bus = config->wrap_bus(config->wrap_context, bus);
    }
    if (host_task_init(&loop->rig, &config->subject, &config->params, bus,
                       config->desired_speed_rad_s, !config->standby) != CONTROL_PARAMS_OK) {
        snprintf(message, LOOP_MESSAGE_MAX, "the control task refuses its parameters");
        return -1;
    }
    power_relay_init(&loop->relay);
    loop_wire_power(loop);
    if (log != NULL) {
        (void)black_box_log_identify(log, "can0", version_build_id(),
                                     loop->rig.task.node.objects.params_crc, version_text());
    }
    return init_nodes(loop, message);
}

void loop_wire_power(struct loop *loop)
{
    power_relay_let_go(&loop->relay);
    drive_power_init(&loop->rig.drive_power, &loop->relay.lines);
}

void loop_free(struct loop *loop)
{
    walker_nodes_free(&loop->nodes);
}

/* ---- one period ------------------------------------------------------------ */

static void begin_fault(struct loop *loop)
{
    const struct loop_config *config = &loop->config;
    if (loop->fault_active || config->fault == LOOP_FAULT_NONE ||
        loop->rig.task.controller.last_step.number < config->fault_step ||
        loop->fault_waited_ticks++ < config->fault_delay_ticks) {
        return;
    }
    loop->fault_active = true;
    loop->nodes.assembly.legs_swapped = config->fault == LOOP_FAULT_SWAPPED;
    loop->nodes.assembly.feet_swapped = config->fault == LOOP_FAULT_SWAPPED;
    loop->nodes.assembly.drives_crossed = config->fault == LOOP_FAULT_CROSSED;
}

void loop_end_period(struct loop *loop, uint64_t now_ns)
{
    for (int i = 0; i < WALKER_NODES; i++) {
        (void)walker_nodes_poll(&loop->nodes, (enum walker_node)i, now_ns);
    }
    own_push_tick(&loop->own_push, &loop->nodes.plant);
    loop->nodes.torque_is_off = !power_relay_advance(&loop->relay);
    walker_nodes_advance(&loop->nodes);
    begin_fault(loop);
    walker_nodes_measure(&loop->nodes);
    loop->tick++;
}

void loop_tick(struct loop *loop)
{
    const uint64_t sync_ns = loop->tick * (uint64_t)TICK_NS;
    sim_bus_run_until(&loop->bus, sync_ns);
    (void)control_task_start_cycle(&loop->rig.task); /* refused: counted, seen by the supervisor */
    sim_bus_run_until(&loop->bus, sync_ns + TICK_NS - 1);
    loop_end_period(loop, sync_ns + TICK_NS - 1);
}
