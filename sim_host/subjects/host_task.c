#include "sim_host/subjects/host_task.h"

#include "hal/devices/device_config.h"

static bool is_pressed(void *context)
{
    return ((const struct host_task *)context)->stop_pressed;
}

static const struct emergency_stop_ops stop_ops = {is_pressed};

static void feed(void *context)
{
    (void)context;
}

static const struct watchdog_ops watchdog_ops = {feed};
static const struct watchdog no_watchdog = {&watchdog_ops, NULL};

bool host_task_configures(const struct subject *subject)
{
    return device_is_canopen(&subject->device.description);
}

int host_task_init(struct host_task *rig, const struct subject *subject,
                   const struct control_params *params, struct can_bus bus,
                   double desired_speed_rad_s, bool walk_requested)
{
    const struct device_description *device = &subject->device.description;
    *rig = (struct host_task){.params = *params};
    watchdog_gate_init(&rig->gate, &no_watchdog);
    drive_power_init(&rig->drive_power, NULL);
    device_drives_init(&rig->drives, device);
    struct control_task_config config = {
        .params = &rig->params,
        .bus = bus,
        .drives = device_drives_interface(&rig->drives),
        .stop = {&stop_ops, rig},
        .desired_speed_rad_s = (float)desired_speed_rad_s,
        .walk_requested = walk_requested,
        .configure_nodes = true,
    };
    device_node_setup(device, params->leg_length_m, params->sea_speed_max_m_s, &config.setup);
    device_leg_sensors(device, config.leg_sensor);
    const int verdict = control_task_init(&rig->task, &config);
    control_task_describe(&rig->task, device);
    return verdict;
}

unsigned host_task_poll(struct host_task *rig)
{
    const unsigned progress = control_task_poll(&rig->task);
    const bool fed = watchdog_gate_report(&rig->gate, progress);
    if ((progress & (unsigned)CONTROL_TASK_TICKED) != 0) {
        drive_power_update(&rig->drive_power, &rig->task, fed);
    }
    return progress;
}
