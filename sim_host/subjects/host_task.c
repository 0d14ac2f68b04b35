#include "sim_host/subjects/host_task.h"

static bool is_pressed(void *context)
{
    return ((const struct host_task *)context)->stop_pressed;
}

static const struct emergency_stop_ops stop_ops = {is_pressed};

static struct sea_drives init_cia402(struct host_task *rig, const struct subject *subject)
{
    struct cia402_axis_config axes[SIDE_COUNT];
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        axes[leg] = (struct cia402_axis_config){
            .counts_per_m = (float)subject->counts_per_m,
            .zero_counts = (int32_t)subject->zero_counts,
            .direction = subject->direction < 0.0 ? -1 : 1,
            .rated_force_N = (float)subject_rated_force_N(subject),
        };
    }
    cia402_drives_init(&rig->cia402, axes);
    return cia402_drives_interface(&rig->cia402);
}

static struct sea_drives init_cansimple(struct host_task *rig, const struct subject *subject)
{
    struct cansimple_axis_config axes[SIDE_COUNT];
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        axes[leg] = (struct cansimple_axis_config){leg == SIDE_LEFT ? VENDOR_DRIVE_ID_LEFT
                                                                    : VENDOR_DRIVE_ID_RIGHT,
                                                   (float)subject->turns_per_m, 0.0f, 1};
    }
    cansimple_drives_init(&rig->cansimple, axes);
    return cansimple_drives_interface(&rig->cansimple);
}

static struct sea_drives init_mit(struct host_task *rig, const struct subject *subject)
{
    struct mit_axis_config axes[SIDE_COUNT];
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        axes[leg] = (struct mit_axis_config){
            .motor_id = leg == SIDE_LEFT ? VENDOR_DRIVE_ID_LEFT : VENDOR_DRIVE_ID_RIGHT,
            .answer_id = leg == SIDE_LEFT ? MIT_ANSWER_ID_LEFT : MIT_ANSWER_ID_RIGHT,
            .rad_per_m = (float)subject->rad_per_m,
            .zero_rad = (float)subject->zero_rad,
            .direction = 1,
            .kp_Nm_rad = (float)subject->kp_Nm_rad,
            .kd_Nms_rad = (float)subject->kd_Nms_rad,
            .spring_N_per_m = (float)subject->spring_N_per_m,
            .stroke_max_m = (float)subject_stroke_m(subject),
            .ranges = {(float)subject->position_range_rad, (float)subject->velocity_range_rad_s,
                       (float)subject->torque_range_Nm, 500.0f, 5.0f}};
    }
    mit_drives_init(&rig->mit, axes);
    return mit_drives_interface(&rig->mit);
}

static struct sea_drives init_drives(struct host_task *rig, const struct subject *subject)
{
    switch (subject->protocol) {
    case DRIVE_PROTOCOL_CANSIMPLE:
        return init_cansimple(rig, subject);
    case DRIVE_PROTOCOL_MIT:
        return init_mit(rig, subject);
    default:
        return init_cia402(rig, subject);
    }
}

int host_task_init(struct host_task *rig, const struct subject *subject,
                   const struct control_params *params, struct can_bus bus,
                   double desired_speed_rad_s, bool walk_requested)
{
    *rig = (struct host_task){.params = *params};
    struct control_task_config config = {
        .params = &rig->params,
        .bus = bus,
        .drives = init_drives(rig, subject),
        .stop = {&stop_ops, rig},
        .desired_speed_rad_s = (float)desired_speed_rad_s,
        .walk_requested = walk_requested,
    };
    config.configure_nodes = subject->protocol == DRIVE_PROTOCOL_CIA402;
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        const double stroke_m = subject_stroke_m(subject);
        config.setup.counts_per_m[leg] = (uint32_t)subject->counts_per_m;
        const int32_t zero = (int32_t)subject->zero_counts;
        const int32_t travel = (int32_t)(stroke_m * subject->counts_per_m);
        config.setup.limit_min_counts[leg] = subject->direction < 0.0 ? zero - travel : zero;
        config.setup.limit_max_counts[leg] = subject->direction < 0.0 ? zero : zero + travel;
        config.setup.rated_force_N[leg] = (float)subject_rated_force_N(subject);
        config.setup.following_error_counts[leg] =
            (uint32_t)(0.1 * subject->leg_length_m * subject->counts_per_m);
        config.setup.speed_needed_counts_s[leg] =
            (uint32_t)((double)params->sea_speed_max_m_s * subject->counts_per_m);
        config.setup.ankle_is_lever[leg] = subject->ankle == ANKLE_LEVER;
        config.leg_sensor[leg] = (struct leg_sensor_config){
            .angle_direction = 1,
            .ankle_is_lever = subject->ankle == ANKLE_LEVER,
            .ankle_lever_m = (float)subject->ankle_lever_m,
            .ankle_neutral_rad = (float)subject->ankle_neutral_rad,
        };
    }
    return control_task_init(&rig->task, &config);
}
