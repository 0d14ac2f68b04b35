#include "sim_host/subjects/host_task.h"

static bool is_pressed(void *context)
{
    return ((const struct host_task *)context)->stop_pressed;
}

static const struct emergency_stop_ops stop_ops = {is_pressed};

static struct sea_drives init_cia402(struct host_task *rig, const struct device_description *device)
{
    struct cia402_axis_config axes[SIDE_COUNT];
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        const struct device_leg *own = &device->leg[leg];
        axes[leg] = (struct cia402_axis_config){
            .counts_per_m = own->counts_per_m,
            .zero_counts = own->zero_counts,
            .direction = (int8_t)own->direction,
            .rated_force_N = own->rated_force_N,
        };
    }
    cia402_drives_init(&rig->cia402, axes);
    return cia402_drives_interface(&rig->cia402);
}

static struct sea_drives init_cansimple(struct host_task *rig,
                                        const struct device_description *device)
{
    struct cansimple_axis_config axes[SIDE_COUNT];
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        const struct device_leg *own = &device->leg[leg];
        axes[leg] = (struct cansimple_axis_config){(uint8_t)own->drive_node, own->turns_per_m,
                                                   own->zero_turns, (int8_t)own->direction};
    }
    cansimple_drives_init(&rig->cansimple, axes);
    return cansimple_drives_interface(&rig->cansimple);
}

static struct sea_drives init_mit(struct host_task *rig, const struct device_description *device)
{
    struct mit_axis_config axes[SIDE_COUNT];
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        const struct device_leg *own = &device->leg[leg];
        axes[leg] =
            (struct mit_axis_config){.motor_id = (uint8_t)own->drive_node,
                                     .answer_id = (uint16_t)own->answer_id,
                                     .rad_per_m = own->rad_per_m,
                                     .zero_rad = own->zero_rad,
                                     .direction = (int8_t)own->direction,
                                     .kp_Nm_rad = own->kp_Nm_rad,
                                     .kd_Nms_rad = own->kd_Nms_rad,
                                     .spring_N_per_m = own->spring_N_per_m,
                                     .stroke_max_m = own->stroke_max_m,
                                     .ranges = {own->position_range_rad, own->velocity_range_rad_s,
                                                own->torque_range_Nm, 500.0f, 5.0f}};
    }
    mit_drives_init(&rig->mit, axes);
    return mit_drives_interface(&rig->mit);
}

static struct sea_drives init_drives(struct host_task *rig, const struct device_description *device)
{
    switch (device->leg[SIDE_LEFT].protocol) {
    case DEVICE_CANSIMPLE:
        return init_cansimple(rig, device);
    case DEVICE_MIT:
        return init_mit(rig, device);
    default:
        return init_cia402(rig, device);
    }
}

bool host_task_configures(const struct subject *subject)
{
    return subject->device.description.leg[SIDE_LEFT].protocol == DEVICE_CIA402;
}

int host_task_init(struct host_task *rig, const struct subject *subject,
                   const struct control_params *params, struct can_bus bus,
                   double desired_speed_rad_s, bool walk_requested)
{
    const struct device_description *device = &subject->device.description;
    *rig = (struct host_task){.params = *params};
    struct control_task_config config = {
        .params = &rig->params,
        .bus = bus,
        .drives = init_drives(rig, device),
        .stop = {&stop_ops, rig},
        .desired_speed_rad_s = (float)desired_speed_rad_s,
        .walk_requested = walk_requested,
    };
    config.configure_nodes = host_task_configures(subject);
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        const struct device_leg *own = &device->leg[leg];
        const int32_t zero = own->zero_counts;
        const int32_t travel = (int32_t)(own->stroke_max_m * own->counts_per_m);
        config.setup.counts_per_m[leg] = (uint32_t)own->counts_per_m;
        config.setup.limit_min_counts[leg] = own->direction < 0 ? zero - travel : zero;
        config.setup.limit_max_counts[leg] = own->direction < 0 ? zero : zero + travel;
        config.setup.rated_force_N[leg] = own->rated_force_N;
        config.setup.following_error_counts[leg] =
            (uint32_t)(0.1f * (float)params->leg_length_m * own->counts_per_m);
        config.setup.speed_needed_counts_s[leg] =
            (uint32_t)((float)params->sea_speed_max_m_s * own->counts_per_m);
        config.setup.ankle_is_lever[leg] = own->ankle == DEVICE_ANKLE_LEVER;
        config.leg_sensor[leg] = (struct leg_sensor_config){
            .angle_zero_rad = own->leg_zero_rad,
            .angle_direction = (int8_t)own->leg_direction,
            .ankle_is_lever = own->ankle == DEVICE_ANKLE_LEVER,
            .ankle_lever_m = own->ankle_lever_m,
            .ankle_neutral_rad = own->ankle_neutral_rad,
        };
    }
    return control_task_init(&rig->task, &config);
}
