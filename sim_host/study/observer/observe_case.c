#include "sim_host/study/observer/observe_case.h"

#include "sim_host/cli/walk_options.h"

int observe_case_configure(const struct observe_case *want, struct loop_config *config,
                           char *message)
{
    struct walk_options options;
    struct subject subject;
    struct control_params params;
    double speed;
    walk_options_init(&options);
    options.speed.apex_rad_s = want->speed_rad_s;
    options.law_given = true;
    options.law = want->law;
    if (walk_options_resolve(&options, &subject, &params, &speed, message) != 0 ||
        loop_configure(config, &subject, &params, speed, want->sensors, want->seed, message) != 0) {
        return -1;
    }
    for (int side = 0; side < SIDE_COUNT; side++) {
        config->plant.sensors[side].latency_s = want->latency_s;
        config->plant.sensors[side].angle_noise_counts = want->noise_counts;
    }
    config->params.sensor_latency_s = (real)want->latency_s;
    return 0;
}
