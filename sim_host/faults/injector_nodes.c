/* Faults of sensors, drives, plant, controller and commands. */
#include <string.h>

#include "hal/bus/frame_table.h"
#include "hal/canopen/co_defs.h"
#include "sim_host/faults/injector_internal.h"

/* Twelve uniform numbers: a bell of standard deviation 1, without a library. */
static double noise(struct shot_state *state)
{
    double sum = -6.0;
    for (int i = 0; i < 12; i++) {
        sum += injector_random(&state->rng);
    }
    return sum;
}

/* ---- sensors ------------------------------------------------------------------ */

static void measure(struct shot_state *state, struct loop *loop, double angle_rad, double ankle)
{
    state->changed++;
    leg_sensor_node_measure(&loop->nodes.sensor[injector_side(&state->shot)], angle_rad, ankle);
}

static double ankle_unit(const struct loop *loop, double metres)
{
    return walker_nodes_ankle(&loop->nodes, SIDE_LEFT, metres);
}

static void hold_sensor(struct shot_state *state, struct loop *loop)
{
    const struct fault_shot *shot = &state->shot;
    const enum side side = injector_side(shot);
    const struct sensor_sample *sample = &loop->nodes.sample[side];
    const double angle_rad = sample->leg_angle_rad;
    const double ankle = walker_nodes_ankle(&loop->nodes, side, sample->ankle_extension_m);
    const double strength = shot->magnitude;
    static const double zero = 0.0;
    switch (shot->kind) {
    case FAULT_ANGLE_STUCK:
        measure(state, loop, state->held[0], ankle);
        break;
    case FAULT_ANKLE_STUCK:
        measure(state, loop, angle_rad, state->held[1]);
        break;
    case FAULT_ANGLE_OFFSET:
    case FAULT_ANGLE_JUMP:
        measure(state, loop, angle_rad + strength, ankle);
        break;
    case FAULT_ANGLE_DRIFT:
        state->held[0] += TICK_PERIOD_US / 1e6 * strength;
        measure(state, loop, angle_rad + state->held[0], ankle);
        break;
    case FAULT_ANGLE_NOISE:
        measure(state, loop, angle_rad + strength * noise(state), ankle);
        break;
    case FAULT_ANKLE_OFFSET:
        measure(state, loop, angle_rad, ankle + ankle_unit(loop, strength));
        break;
    case FAULT_ANKLE_NOISE:
        measure(state, loop, angle_rad, ankle + ankle_unit(loop, strength * noise(state)));
        break;
    case FAULT_SENSOR_DEAD:
        measure(state, loop, 0.0, 0.0);
        break;
    case FAULT_SENSOR_NOT_FINITE:
        measure(state, loop, zero / zero, ankle);
        break;
    case FAULT_SENSOR_SILENT:
        state->changed++;
        leg_sensor_node_silence(&loop->nodes.sensor[side], true);
        break;
    default:
        break;
    }
}

/* ---- drives -------------------------------------------------------------------- */

/* Shares of force and speed; an actuator as built has them in its parts' limits. */
static void limit_drive(struct sea *sea, double force, double speed)
{
    struct sea_config *built = &sea->built.config;
    sea->params.force_limit_N *= force;
    sea->params.speed_limit_m_s *= speed;
    built->current_peak_A *= force;
    built->current_continuous_A *= force;
    built->speed_limit_m_s *= speed;
}

/* A motor on less voltage is slower in proportion, and gives its force as long as it stands. */
static void lower_supply(struct sea *sea, double share)
{
    sea->params.dc_link_V *= share;
    sea->built.config.supply_V *= share;
    if (!sea->params.as_built) {
        sea->params.speed_limit_m_s *= share;
    }
}

static void heat_drive(struct sea *sea, double celsius)
{
    sea->temperature_degC = celsius;
    sea->params.ambient_degC = sea->built.config.ambient_degC = celsius;
    sea->built.motor.winding_degC = sea->built.motor.housing_degC = celsius;
}

static void start_drive(struct shot_state *state, struct loop *loop)
{
    const struct fault_shot *shot = &state->shot;
    struct sea *sea = &loop->nodes.plant.sea[injector_side(shot)];
    struct sea_params *params = &sea->params;
    switch (shot->kind) {
    case FAULT_DRIVE_FAULT:
        drive_node_inject_fault(&loop->nodes.drive[injector_side(shot)], 0x4310);
        break;
    case FAULT_DRIVE_RESET: {
        struct drive_node *drive = &loop->nodes.drive[injector_side(shot)];
        const struct can_msg reset = {
            .id = FRAME_NMT, .length = 2, .data = {CO_NMT_RESET_NODE, drive->config.node_id}};
        (void)drive_node_receive(drive, &reset, drive->now_ns);
        break;
    }
    case FAULT_DRIVE_FORCELESS:
        limit_drive(sea, 1e-6, 1.0);
        break;
    case FAULT_DRIVE_WEAK:
    case FAULT_FORCE_SHARE:
        limit_drive(sea, shot->magnitude, 1.0);
        break;
    case FAULT_DRIVE_SLOW:
    case FAULT_SPEED_SHARE:
        limit_drive(sea, 1.0, shot->magnitude);
        break;
    case FAULT_BATTERY_LOW:
        lower_supply(sea, shot->magnitude);
        break;
    case FAULT_DRIVE_HOT:
        heat_drive(sea, shot->magnitude);
        break;
    case FAULT_DRIVE_HANGS:
        sim_bus_connect(&loop->bus,
                        INJECTOR_PORT_FIRST_NODE + (injector_side(shot) == SIDE_LEFT
                                                        ? WALKER_DRIVE_LEFT
                                                        : WALKER_DRIVE_RIGHT),
                        false);
        limit_drive(sea, 1.0, 1e-6 / params->speed_limit_m_s);
        break;
    case FAULT_MOTOR_JAMMED:
        params->coulomb_N = 1e6;
        sea->built.config.transmission_coulomb_N = 1e6;
        break;
    case FAULT_ENCODER_OFFSET:
        params->zero_offset_m += shot->magnitude;
        break;
    default:
        break;
    }
}

static void stop_drive(struct shot_state *state, struct loop *loop)
{
    const struct fault_shot *shot = &state->shot;
    struct sea *sea = &loop->nodes.plant.sea[injector_side(shot)];
    sea->params = state->sea;
    sea->built.config = state->sea.built;
    if (shot->kind == FAULT_DRIVE_FAULT) {
        drive_node_inject_fault(&loop->nodes.drive[injector_side(shot)], 0);
    } else if (shot->kind == FAULT_DRIVE_HANGS) {
        sim_bus_connect(&loop->bus,
                        INJECTOR_PORT_FIRST_NODE + (injector_side(shot) == SIDE_LEFT
                                                        ? WALKER_DRIVE_LEFT
                                                        : WALKER_DRIVE_RIGHT),
                        true);
    }
}

static void hold_drive(struct shot_state *state, struct loop *loop)
{
    const enum side side = injector_side(&state->shot);
    struct drive_node *drive = &loop->nodes.drive[side];
    if (state->shot.kind == FAULT_LATCH_STUCK_ARMED) {
        drive->objects.outputs |= DRIVE_OUTPUT_LATCH_ARMED;
        state->changed++;
    } else if (state->shot.kind == FAULT_ENCODER_STUCK) {
        struct drive_axis_feedback feedback = drive->feedback;
        feedback.position_m = state->held[0];
        drive_node_measure(drive, &feedback);
        state->changed++;
    }
}

/* ---- plant, clock, commands ----------------------------------------------------- */

static void start_plant(struct shot_state *state, struct loop *loop)
{
    const struct fault_shot *shot = &state->shot;
    struct plant *plant = &loop->nodes.plant;
    const double weight = plant->config.walk.body.hip_mass_kg; /* impulses scale with the body */
    switch (shot->kind) {
    case FAULT_SPRING_BROKEN:
        plant_set_spring_scale(plant, injector_side(shot), 0.0);
        break;
    case FAULT_SPRING_SOFT:
    case FAULT_SPRING_STIFF:
        plant_set_spring_scale(plant, injector_side(shot), shot->magnitude);
        break;
    case FAULT_PUSH:
        plant_push(plant, shot->magnitude * weight, injector_between(state, -0.2, 0.2) * weight);
        break;
    case FAULT_SLIP:
        plant->walk.params.friction = shot->magnitude;
        break;
    case FAULT_TRIP:
        plant->walk.params.trip_extension_m = -1.0; /* the next pass of the legs ends it */
        break;
    case FAULT_STAIRS:
        plant_lay_stair(plant, shot->magnitude);
        break;
    default:
        break;
    }
}

static void reset_controller(struct loop *loop)
{
    struct loop_config *config = &loop->config;
    const bool pressed = loop->rig.stop_pressed;
    sim_bus_reset_port(&loop->bus, LOOP_PORT_CONTROLLER);
    (void)host_task_init(&loop->rig, &config->subject, &config->params,
                         sim_bus_port(&loop->bus, LOOP_PORT_CONTROLLER),
                         config->desired_speed_rad_s, false); /* nobody has asked it yet */
    loop->rig.stop_pressed = pressed;
    loop_wire_power(loop);
}

static void flip_parameter(struct shot_state *state, struct loop *loop)
{
    /* The numbers, not the pointer to the gait branch behind them. */
    uint8_t *bytes = (uint8_t *)&loop->rig.task.node.objects.params;
    const double size = (double)(CONTROL_PARAM_COUNT * sizeof(real));
    const size_t at = (size_t)(injector_random(&state->rng) * size);
    bytes[at] = (uint8_t)(bytes[at] ^ (1u << (unsigned)(injector_random(&state->rng) * 8.0)));
    state->changed++;
}

static void start_command(struct shot_state *state, struct loop *loop)
{
    struct controller_objects *objects = &loop->rig.task.node.objects;
    switch (state->shot.kind) {
    case FAULT_CONTROLLER_RESET:
        reset_controller(loop);
        state->changed++;
        break;
    case FAULT_EMERGENCY_STOP:
        loop->rig.stop_pressed = true;
        break;
    case FAULT_REQUEST_ENDS:
        objects->walk_requested = 0;
        break;
    case FAULT_SPEED_JUMPS:
        objects->desired_speed_rad_s = (float)state->shot.magnitude;
        break;
    case FAULT_PARAMETER_FLIPS:
        flip_parameter(state, loop);
        break;
    default:
        break;
    }
}

static void stop_command(struct shot_state *state, struct loop *loop)
{
    struct controller_objects *objects = &loop->rig.task.node.objects;
    switch (state->shot.kind) {
    case FAULT_EMERGENCY_STOP:
        loop->rig.stop_pressed = false;
        break;
    case FAULT_SPEED_JUMPS:
        objects->desired_speed_rad_s = state->speed;
        break;
    default:
        break;
    }
}

static void babble(struct shot_state *state, struct loop *loop, bool on)
{
    struct can_msg noise_frame = {.id = state->shot.kind == FAULT_BABBLE_HIGH ? 0x001 : 0x7FF,
                                  .length = 8};
    memset(noise_frame.data, 0x55, sizeof noise_frame.data);
    sim_bus_babble(&loop->bus, INJECTOR_PORT_FOREIGN, &noise_frame, on ? UINT64_MAX : 0);
}

static bool pulls_plug(const struct fault_shot *shot)
{
    return shot->kind == FAULT_NODE_UNPLUGGED || shot->kind == FAULT_CONTROLLER_UNPLUGGED;
}

static int plug_of(const struct fault_shot *shot)
{
    return shot->kind == FAULT_CONTROLLER_UNPLUGGED ? LOOP_PORT_CONTROLLER
                                                    : INJECTOR_PORT_FIRST_NODE + shot->node;
}

void injector_start(struct shot_state *state, struct loop *loop)
{
    const struct fault_shot *shot = &state->shot;
    const enum side side = injector_side(shot);
    const struct plant *plant = &loop->nodes.plant;
    state->sea = plant->sea[side].params;
    state->walk = plant->walk.params;
    state->speed = loop->rig.task.node.objects.desired_speed_rad_s;
    state->held[0] = loop->nodes.sample[side].leg_angle_rad;
    state->held[1] =
        walker_nodes_ankle(&loop->nodes, side, loop->nodes.sample[side].ankle_extension_m);
    if (shot->kind == FAULT_ANGLE_DRIFT) {
        state->held[0] = 0.0;
    } else if (shot->kind == FAULT_ENCODER_STUCK) {
        state->held[0] = loop->nodes.drive[side].feedback.position_m;
    } else if (shot->kind == FAULT_SENSORS_SWAPPED) {
        loop->nodes.assembly.legs_swapped = true;
    } else if (shot->kind == FAULT_BABBLE_HIGH || shot->kind == FAULT_BABBLE_LOW) {
        babble(state, loop, true);
    } else if (pulls_plug(shot)) {
        sim_bus_connect(&loop->bus, plug_of(shot), false);
    }
    start_drive(state, loop);
    start_plant(state, loop);
    start_command(state, loop);
    injector_person_start(state, loop);
}

void injector_stop(struct shot_state *state, struct loop *loop)
{
    const struct fault_shot *shot = &state->shot;
    struct plant *plant = &loop->nodes.plant;
    injector_person_stop(state, loop);
    switch (fault_kinds[shot->kind].group) {
    case FAULT_GROUP_DRIVE:
        stop_drive(state, loop);
        break;
    case FAULT_GROUP_PLANT:
        if (shot->kind == FAULT_SLIP || shot->kind == FAULT_TRIP) {
            plant->walk.params.friction = state->walk.friction;
            plant->walk.params.trip_extension_m = state->walk.trip_extension_m;
        } else if (shot->kind >= FAULT_SPRING_BROKEN && shot->kind <= FAULT_SPRING_STIFF) {
            plant_set_spring_scale(plant, injector_side(shot), 1.0);
        }
        break;
    case FAULT_GROUP_SENSOR:
        loop->nodes.assembly.legs_swapped = false;
        break;
    case FAULT_GROUP_BUS:
        if (shot->kind == FAULT_BABBLE_HIGH || shot->kind == FAULT_BABBLE_LOW) {
            babble(state, loop, false);
        } else if (pulls_plug(shot)) {
            sim_bus_connect(&loop->bus, plug_of(shot), true);
        }
        break;
    default:
        stop_command(state, loop);
        break;
    }
}

void injector_hold(struct shot_state *state, struct loop *loop)
{
    injector_person_hold(state, loop);
    if (fault_kinds[state->shot.kind].group == FAULT_GROUP_SENSOR) {
        hold_sensor(state, loop);
    } else {
        hold_drive(state, loop);
    }
}
