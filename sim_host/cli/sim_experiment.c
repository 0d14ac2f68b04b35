#include "sim_host/cli/sim_experiment.h"

#include "sim_host/persons/law_name.h"

enum { DIGITS = 9 };

static void who(struct json_writer *json, const struct sim_options *options,
                const struct loop_config *config)
{
    const struct control_params *params = &config->params;
    json_open_object(json, "who");
    json_text(json, "name", config->subject.person.name);
    json_text(json, "person_file", options->walk.person_path);
    json_text(json, "device_file", options->walk.device_path);
    json_text(json, "recording", options->recording.path);
    json_text(json, "plant", options->recording.by_reflexes ? "reflex" : NULL);
    json_bool(json, "without_device", options->recording.without_device);
    json_number(json, "torso_mass_kg", (double)params->torso_mass_kg, DIGITS);
    json_number(json, "leg_mass_kg", (double)params->leg_mass_kg, DIGITS);
    json_number(json, "leg_length_m", (double)params->leg_length_m, DIGITS);
    json_number(json, "ankle_stiffness_N_m", (double)params->spring_stiffness_n_m, DIGITS);
    json_close_object(json);
}

static void law(struct json_writer *json, const struct loop_config *config)
{
    const struct control_params *params = &config->params;
    json_text(json, "law", law_name_of((enum law_mode)params->law));
    json_number(json, "kp_m_s_rad", (double)params->kp_m_s_rad, DIGITS);
    json_number(json, "start_r0_m", (double)params->start_r0_m, DIGITS);
    if (params->law == (real)LAW_OPEN_LOOP) {
        json_number(json, "open_loop_r0_m", (double)params->open_loop_r0_m, DIGITS);
    }
    json_number(json, "target_speed_rad_s", config->desired_speed_rad_s, DIGITS);
    json_number(json, "engage_steps", (double)params->engage_steps, DIGITS);
}

static void sensors(struct json_writer *json, const struct sim_options *options,
                    const struct loop_config *config)
{
    static const char *const names[SIDE_COUNT] = {"left", "right"};
    json_open_object(json, "sensors");
    json_text(json, "preset", options->sensing.preset_name);
    for (int side = 0; side < SIDE_COUNT; side++) {
        const struct sensor_params *sensor = &config->plant.sensors[side];
        json_open_object(json, names[side]);
        json_number(json, "latency_s", sensor->latency_s, DIGITS);
        json_number(json, "angle_noise_counts", sensor->angle_noise_counts, DIGITS);
        json_number(json, "angle_wander_rad", sensor->angle_coloured_rad, DIGITS);
        json_number(json, "angle_offset_rad", sensor->angle_offset_rad, DIGITS);
        json_number(json, "drop_probability", sensor->drop_probability, DIGITS);
        json_close_object(json);
    }
    json_close_object(json);
}

static void disturbances(struct json_writer *json, const struct sim_options *options,
                         const struct loop_config *config)
{
    json_open_object(json, "ground");
    json_number(json, "slope_deg", options->ground.slope_deg, DIGITS);
    json_number(json, "terrain_mm", options->ground.terrain_mm, DIGITS);
    json_close_object(json);
    json_open_object(json, "push");
    json_number(json, "impulse_Ns", options->ground.push_Ns, DIGITS);
    json_number(json, "at_s", options->ground.push_s, DIGITS);
    json_number(json, "for_s", options->ground.push_for_s, DIGITS);
    json_close_object(json);
    json_open_object(json, "injected_fault");
    json_text(json, "name", loop_fault_name(config->fault));
    if (config->fault == LOOP_FAULT_NONE) {
        json_null(json, "after_step");
    } else {
        json_unsigned(json, "after_step", config->fault_step);
        json_unsigned(json, "and_ms", options->fault_delay_ms);
    }
    json_close_object(json);
}

void sim_experiment_json(struct json_writer *json, const struct sim_options *options,
                         const struct loop_config *config)
{
    who(json, options, config);
    law(json, config);
    sensors(json, options, config);
    json_unsigned(json, "seed", options->sensing.seed);
    json_number(json, "release_late_s", options->release_late_s, DIGITS);
    disturbances(json, options, config);
    if (options->steps == UINT32_MAX) {
        json_null(json, "steps_asked_for");
    } else {
        json_unsigned(json, "steps_asked_for", options->steps);
    }
}
