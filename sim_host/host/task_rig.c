#include "sim_host/host/task_rig.h"

static bool is_pressed(void *context)
{
    return ((const struct task_rig *)context)->stop_pressed;
}

static const struct emergency_stop_ops stop_ops = {is_pressed};

int task_rig_init(struct task_rig *rig, const struct subject *subject,
                  const struct control_params *params, struct can_bus bus,
                  double desired_speed_rad_s, bool walk_requested)
{
    struct cia402_axis_config axes[LEG_COUNT];
    *rig = (struct task_rig){.params = *params};
    struct control_task_config config = {
        .params = &rig->params,
        .bus = bus,
        .drives = cia402_drives_interface(&rig->cia402),
        .stop = {&stop_ops, rig},
        .desired_speed_rad_s = (float)desired_speed_rad_s,
        .walk_requested = walk_requested,
    };
    config.configure_nodes = true;
    for (int leg = 0; leg < LEG_COUNT; leg++) {
        const double stroke_m = subject->stroke_max_m > 0.0 ? subject->stroke_max_m
                                                            : 0.35 * subject->leg_length_m;
        config.setup.counts_per_m[leg] = (uint32_t)subject->counts_per_m;
        config.setup.limit_max_counts[leg] = (int32_t)(stroke_m * subject->counts_per_m);
        config.setup.following_error_counts[leg] =
            (uint32_t)(0.1 * subject->leg_length_m * subject->counts_per_m);
        config.setup.ankle_is_lever[leg] = subject->ankle == ANKLE_LEVER;
        axes[leg] = (struct cia402_axis_config){(float)subject->counts_per_m, 0, 1};
        config.leg_sensor[leg] = (struct leg_sensor_config){
            .angle_direction = 1,
            .ankle_is_lever = subject->ankle == ANKLE_LEVER,
            .ankle_lever_m = (float)subject->ankle_lever_m,
            .ankle_neutral_rad = (float)subject->ankle_neutral_rad,
        };
    }
    cia402_drives_init(&rig->cia402, axes);
    return control_task_init(&rig->task, &config);
}
